// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/protocol/verdict_json.hpp"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "surefoot/core/angles.hpp"
#include "surefoot/gate/verdict_text.hpp"

namespace surefoot::gate_process {
namespace {

constexpr double kTenthMmPerM = 1e4;
constexpr std::int64_t kOpenTenthMm = 0xffff;  // min_clearance_tenth_mm with nothing overhead

// Divides by 1e4 instead of multiplying by 1e-4. The quotient is the double nearest to the decimal
// number, so 0.2311 m is written as 0.2311.
double metres(std::int64_t tenth_mm) {
    return static_cast<double>(tenth_mm) / kTenthMmPerM;
}

const char* name_of(gate::Foot foot) {
    switch (foot) {
        case gate::Foot::left: return "left";
        case gate::Foot::right: return "right";
        case gate::Foot::none: break;
    }
    return "none";
}

std::string hexadecimal(std::uint64_t value) {
    char text[17];
    std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(value));
    return text;
}

}  // namespace

int result_code(const gate::Verdict& verdict) noexcept {
    if (verdict.decision == gate::Decision::ok && verdict.reasons.empty()) return 0;
    return verdict.decision == gate::Decision::not_traversable ? 1 : -1;
}

const char* verdict_name(const gate::Verdict& verdict) noexcept {
    if (verdict.decision == gate::Decision::ok && result_code(verdict) != 0)
        return to_string(gate::Decision::error);
    return to_string(verdict.decision);
}

Json reasons_array(gate::ReasonSet reasons) {
    return gate::names_of(reasons);
}

Json evidence_object(const gate::Verdict& verdict) {
    const gate::Evidence& e = verdict.evidence;
    const double patch_sigma_tenth_mm = std::sqrt(e.max_patch_sigma_sq_tenth_mm2);
    return {{"primary", to_string(verdict.primary)},
            {"worst_cell_m",
             e.has_worst_cell ? Json{metres(e.worst_x_tenth_mm), metres(e.worst_y_tenth_mm)}
                              : Json(nullptr)},
            {"foot", name_of(e.foot)},
            {"value_m", metres(e.value_tenth_mm)},
            {"limit_m", metres(e.limit_tenth_mm)},
            {"stance_height_m",
             e.stance_known ? Json(metres(e.stance_height_tenth_mm)) : Json(nullptr)},
            {"height_delta_m", metres(e.height_delta_tenth_mm)},
            {"max_tilt_deg", number(std::atan(std::sqrt(e.max_tilt_tan_sq)) * kDegPerRad)},
            {"max_patch_sigma_m", number(patch_sigma_tenth_mm / kTenthMmPerM)},
            {"max_drift_m", metres(e.max_drift_tenth_mm)},
            {"min_clearance_m",
             e.min_clearance_tenth_mm < kOpenTenthMm ? Json(metres(e.min_clearance_tenth_mm))
                                                     : Json(nullptr)},
            {"cells", e.cells},
            {"known_cells", e.known_cells},
            {"attested_cells", e.attested_cells},
            {"unproven", gate::unproven_names(e)}};
}

Json verdict_object(const gate::Verdict& verdict, const std::string& text) {
    constexpr std::int64_t kNsPerMs = 1'000'000;
    const std::int64_t life_ns = verdict.valid_until_ns - verdict.decided_ns;
    return {{"verdict", verdict_name(verdict)},
            {"result_code", result_code(verdict)},
            {"reasons", reasons_array(verdict.reasons)},
            {"primary", to_string(verdict.primary)},
            {"text", text},
            {"evidence", evidence_object(verdict)},
            {"command", verdict.command},
            {"sequence", verdict.sequence},
            {"connection", verdict.connection},
            {"map_version", verdict.map_version},
            {"config_hash", hexadecimal(verdict.config_hash)},
            {"decided_ns", std::to_string(verdict.decided_ns)},
            {"valid_until_ns", std::to_string(verdict.valid_until_ns)},
            {"valid_for_ms", life_ns > 0 ? life_ns / kNsPerMs : 0}};
}

}  // namespace surefoot::gate_process

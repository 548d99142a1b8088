// SPDX-License-Identifier: Apache-2.0
#include "cli/json/verdict_answers.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/gate_process/protocol/verdict_json.hpp"
#include "service/live/ground_box.hpp"
#include "surefoot/core/angles.hpp"

namespace surefoot::app {
namespace {

// This JSON type keeps the order of the keys, so the same run always gives the same bytes.
using gate_process::Json;
using gate_process::number;

constexpr int kIndent = 2;

}  // namespace

std::string failure_json(const std::string& error, int exit_code) {
    return Json{{"error", error}, {"exit_code", exit_code}}.dump(kIndent);
}

std::string verdict_json(const gate::Verdict& verdict,
                         const std::string& text,
                         const std::vector<std::string>& assumed) {
    const gate::Evidence& e = verdict.evidence;
    Json evidence = {
        {"primary", to_string(verdict.primary)},
        {"worst_cell_m",
         e.has_worst_cell ? Json{kTenthMm_m * static_cast<double>(e.worst_x_tenth_mm),
                                 kTenthMm_m * static_cast<double>(e.worst_y_tenth_mm)}
                          : Json(nullptr)},
        {"value_m", kTenthMm_m * static_cast<double>(e.value_tenth_mm)},
        {"limit_m", kTenthMm_m * static_cast<double>(e.limit_tenth_mm)},
        {"stance_height_m",
         e.stance_known ? Json(kTenthMm_m * static_cast<double>(e.stance_height_tenth_mm))
                        : Json(nullptr)},
        {"height_delta_m", kTenthMm_m * static_cast<double>(e.height_delta_tenth_mm)},
        {"max_tilt_deg", number(std::atan(std::sqrt(e.max_tilt_tan_sq)) * kDegPerRad)},
        {"max_patch_sigma_m", number(kTenthMm_m * std::sqrt(e.max_patch_sigma_sq_tenth_mm2))},
        {"max_drift_m", kTenthMm_m * static_cast<double>(e.max_drift_tenth_mm)},
        {"cells", e.cells},
        {"known_cells", e.known_cells},
        {"vouched_cells", e.attested_cells}};
    const Json object = {{"verdict", to_string(verdict.decision)},
                         {"reasons", gate_process::reasons_array(verdict.reasons)},
                         {"text", text},
                         {"evidence", evidence},
                         {"assumed", assumed},
                         {"command", verdict.command},
                         {"map_version", verdict.map_version},
                         {"config_hash", fmt::format("{:016x}", verdict.config_hash)}};
    return object.dump(kIndent);
}

}  // namespace surefoot::app

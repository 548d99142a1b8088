// SPDX-License-Identifier: Apache-2.0
#include "cli/json/audit_answers.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/live/ground_box.hpp"

namespace surefoot::app {
namespace {

using gate_process::dump_indented;
using gate_process::Json;

Json summary_json(const gate_process::AuditSummary& summary) {
    Json damage = nullptr;
    if (summary.damage) {
        damage = {
            {"file", summary.damage->file},
            {"offset", summary.damage->offset},
            {"frame", summary.damage->sequence ? Json(*summary.damage->sequence) : Json(nullptr)},
            {"what", summary.damage->what}};
    }
    return {{"files", summary.files},
            {"bytes", summary.bytes},
            {"runs", summary.runs},
            {"verdicts", summary.verdicts},
            {"gaps", summary.gaps},
            {"lost", summary.lost},
            {"acts", summary.acts},
            {"unfinished", summary.unfinished},
            {"damage", damage}};
}

}  // namespace

std::string audit_json(const gate_process::AuditSummary& summary) {
    return dump_indented(summary_json(summary));
}

std::string audit_acts_json(const gate_process::AuditSummary& summary,
                            const std::vector<gate_process::Act>& acts) {
    Json object = summary_json(summary);
    Json list = Json::array();
    for (const gate_process::Act& act : acts) {
        list.push_back({{"time_ns", act.time_ns},
                        {"act", to_string(act.kind)},
                        {"outcome", to_string(act.outcome)},
                        {"role", to_string(act.role)},
                        {"connection", act.connection},
                        {"radius_m", kTenthMm_m * act.radius_tenth_mm},
                        {"left_out", act.left_out},
                        {"text", act.text}});
    }
    object["list"] = list;
    return dump_indented(object);
}

std::string audit_replay_json(const gate_process::AuditSummary& summary,
                              const AuditReplay& replay) {
    Json object = summary_json(summary);
    object["equal"] = replay.equal;
    object["different"] = replay.different;
    Json first = nullptr;
    if (replay.first) {
        Json fields = Json::array();
        for (const gate_process::FieldDifference& d : replay.first->fields)
            fields.push_back(
                {{"field", d.field}, {"recorded", d.recorded}, {"replayed", d.replayed}});
        first = {{"file", replay.first->file},
                 {"offset", replay.first->offset},
                 {"frame", replay.first->sequence},
                 {"fields", fields}};
    }
    object["first_difference"] = first;
    return dump_indented(object);
}

}  // namespace surefoot::app

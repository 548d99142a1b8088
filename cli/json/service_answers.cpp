// SPDX-License-Identifier: Apache-2.0
#include "cli/json/service_answers.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/json_text.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::app {
namespace {

using gate_process::dump_indented;
using gate_process::Json;

Json event_json(const RexLinkRow& row) {
    using rex_link::LinkEventKind;
    const rex_link::LinkEvent& event = row.event;
    Json object = {{"time_s", seconds_from_ns(event.time_ns)}, {"event", to_string(event.kind)}};
    switch (event.kind) {
        case LinkEventKind::connected: break;
        case LinkEventKind::disconnected:
        case LinkEventKind::damaged: object["text"] = event.text; break;
        case LinkEventKind::joystick: object["command"] = event.command; break;
        case LinkEventKind::question:
            object["sequence"] = event.sequence;
            object["command"] = event.command;
            break;
        case LinkEventKind::answer:
            object["sequence"] = event.sequence;
            object["command"] = event.command;
            object["verdict"] = to_string(event.verdict);
            object["text"] = event.text;
            break;
        case LinkEventKind::inhibited: object["reason"] = to_string(event.inhibit); break;
        case LinkEventKind::tone:
            object["tone"] = to_string(event.tone);
            object["file"] = row.tone_file.empty() ? Json(nullptr) : Json(row.tone_file);
            break;
        case LinkEventKind::motion:
            object["command"] = event.command;
            object["duration_s"] = seconds_from_ns(event.duration_ns);
            break;
    }
    return object;
}

}  // namespace

std::string serve_json(const std::vector<AskedStep>& steps) {
    Json list = Json::array();
    for (const AskedStep& step : steps) {
        list.push_back({{"command", step.command},
                        {"moved", step.moved},
                        {"verdict", step.verdict},
                        {"text", step.text}});
    }
    return dump_indented(Json{{"movements", list}});
}

std::string rex_link_json(const std::string& url, const std::vector<RexLinkRow>& rows) {
    Json list = Json::array();
    for (const RexLinkRow& row : rows) list.push_back(event_json(row));
    const auto count = [&rows](rex_link::LinkEventKind kind) {
        return std::count_if(rows.begin(), rows.end(), [kind](const RexLinkRow& row) {
            return row.event.kind == kind;
        });
    };
    const Json object = {{"url", url},
                         {"connections", count(rex_link::LinkEventKind::connected)},
                         {"questions", count(rex_link::LinkEventKind::question)},
                         {"motions", count(rex_link::LinkEventKind::motion)},
                         {"inhibited", count(rex_link::LinkEventKind::inhibited)},
                         {"events", list}};
    return dump_indented(object);
}

}  // namespace surefoot::app

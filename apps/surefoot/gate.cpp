// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/gate.hpp"

#include <fmt/format.h>

#include <cmath>

#include "apps/surefoot/explain.hpp"
#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/numbers.hpp"
#include "apps/surefoot/offline_map.hpp"
#include "apps/surefoot/source.hpp"
#include "apps/surefoot/verbs.hpp"
#include "service/gate_process/audit/audit_log.hpp"
#include "surefoot/gate/verdict_text.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::app {
namespace {

int exit_code_of(gate::Decision decision) {
    switch (decision) {
        case gate::Decision::ok: return kExitOk;
        case gate::Decision::not_traversable: return kExitNotTraversable;
        case gate::Decision::error: return kExitGateError;
    }
    return kExitGateError;
}

/// Answers a query without a usable map: the verdict is ERROR, with the reason in words.
int refuse(const GateOptions& options, std::uint8_t command, const Error& error) {
    log_error(error.message);
    gate::Verdict verdict;
    verdict.command = command;
    if (options.common.json) print_answer(verdict_json(verdict, error.message, {}));
    return kExitGateError;
}

/// Adds the verdict to an audit log, as the gate process does.
Status write_audit(const std::string& folder,
                   const Machine& machine,
                   const gate::Query& query,
                   const grid::MapSnapshot& map,
                   const gate::Verdict& verdict) {
    wire::AuditConfig config;
    config.files.run_id = wire::new_run_id();
    wire::AuditLog log(machine, wire::make_folder_disk(folder), config);
    if (auto status = log.start(); !status) return status;
    const OfflineMoment moment = moment_of(map);
    log.push({query, moment.health, moment.now_ns, map, verdict});
    log.stop();
    const wire::AuditReport done = log.report();
    if (done.written == 1 && !done.failing) return {};
    return output_error("the verdict is not in the audit log: " + done.last_error);
}

/// The configured movements of a machine as text, for example "9 N, 25 left".
std::string movements_of(const Machine& machine) {
    std::string text;
    for (std::size_t code = 0; code < machine.movements.size(); ++code) {
        const Movement& movement = machine.movements[code];
        if (!movement.configured) continue;
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", code, movement.name.data());
    }
    return text;
}

Result<std::uint8_t> parse_command(const std::string& text, const Machine& machine) {
    const auto code = io::parse_int64(text);
    if (code && *code >= 0 && *code <= 255) return static_cast<std::uint8_t>(*code);
    return usage_error(
        fmt::format("--command '{}': a whole number from 0 to 255 is needed, the code of a "
                    "joystick sector (1-24) or turn; this machine has {}",
                    text,
                    movements_of(machine)));
}

}  // namespace

int gate(const GateOptions& options) {
    const auto pose = parse_three_numbers("--pose", options.pose, "x,y,yaw (m, m, rad)");
    if (!pose) return report(pose.error());
    const auto machine = load_machine(options.machine);
    if (!machine) return report(machine.error());
    if (!*machine) return report(usage_error("--machine: a machine file or name is needed"));
    const auto command = parse_command(options.command, machine->value().machine);
    if (!command) return report(command.error());
    auto map = load_offline_map(options.map_dir);
    if (!map) return refuse(options, *command, map.error());

    gate::Query query = gate::make_query(
        *command, (*pose)[0], (*pose)[1], std::cos((*pose)[2]), std::sin((*pose)[2]));
    std::vector<std::string> assumed = map->assumed;
    assumed.push_back("frame and pose are as fresh as when the map was written");
    assumed.push_back("perception was ready");
    for (const io::Deviation& deviation : machine->value().deviations)
        assumed.push_back("the machine file goes beyond a rated limit: " + io::text_of(deviation));
    if (options.vouch_radius_m != 0.0) {
        const auto vouched = vouch_for_start(
            machine->value().machine, query, *map->snapshot, options.vouch_radius_m, assumed);
        if (!vouched) return report(vouched.error());
        query.vouched = *vouched;
    }
    const Machine& m = machine->value().machine;
    const gate::Verdict verdict = decide_offline(m, query, *map->snapshot);
    const std::string text = gate::text_of(verdict, query, m);

    if (options.common.json) {
        print_answer(verdict_json(verdict, text, assumed));
    } else {
        fmt::print("{}: {}\n", to_string(verdict.decision), text);
    }
    if (!options.explain_file.empty()) {
        const auto status =
            write_explanation(options.explain_file, m, query, *map->snapshot, verdict, text);
        if (!status)
            log_error(status.error().message);  // a missing picture does not change the verdict
    }
    if (!options.audit_dir.empty()) {
        const auto status = write_audit(options.audit_dir, m, query, *map->snapshot, verdict);
        if (!status) log_error(status.error().message);  // nor does a failed log
    }
    return exit_code_of(verdict.decision);
}

}  // namespace surefoot::app

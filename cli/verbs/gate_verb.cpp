// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "cli/json/verdict_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/numbers.hpp"
#include "service/console/source.hpp"
#include "service/gate_process/audit/audit_log.hpp"
#include "service/live/explain.hpp"
#include "studies/runs/offline_map.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/gate/verdict_text.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::app {
namespace {

constexpr const char* kUsualMachine = "rex";

struct GateOptions {
    CommonOptions common;
    std::string map_dir;
    std::string pose;     ///< pose of base_link in odom: "x,y,yaw" [m, m, rad]
    std::string command;  ///< a joystick code
    std::string machine;  ///< empty = rex; the answer then lists this as an assumption
    std::string explain_file;
    /// Radius of the attested area around base_link; negative = as far as the standing feet reach.
    double attestation_radius_m = -1.0;
    std::string audit_dir;  ///< audit log to which the verdict is added; empty = no log
};

int exit_code_of(gate::Decision decision) {
    switch (decision) {
        case gate::Decision::ok: return kExitOk;
        case gate::Decision::not_traversable: return kExitNotTraversable;
        case gate::Decision::error: return kExitGateError;
    }
    return kExitGateError;
}

/// Answers a query without a usable map: the verdict is ERROR, and its text is the reason.
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
    gate_process::AuditConfig config;
    config.files.run_id = gate_process::new_run_id();
    gate_process::AuditLog log(machine, gate_process::make_folder_disk(folder), config);
    if (auto status = log.start(); !status) return status;
    const OfflineMoment moment = moment_of(map);
    log.push({query, moment.health, moment.now_ns, map, verdict});
    log.stop();
    const gate_process::AuditReport done = log.report();
    if (done.written == 1 && !done.failing) return {};
    return output_error("the verdict was not written to the audit log: " + done.last_error);
}

/// Returns the configured movements of a machine as text, for example "9 N, 25 left".
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
    return usage_error(fmt::format(
        "--command '{}' is not a movement code; give a whole number from 0 to 255. Codes 1-24 are "
        "joystick sectors, 25 is turn left, 26 is turn right. This machine has the movements {}",
        text,
        movements_of(machine)));
}

/// `surefoot gate`: asks the gate about one movement on a saved map. The exit code is the verdict.
int gate(const GateOptions& options) {
    const auto pose = parse_three_numbers("--pose", options.pose, "x,y,yaw (m, m, rad)");
    if (!pose) return report(pose.error());
    const auto machine = load_machine(options.machine.empty() ? kUsualMachine : options.machine);
    if (!machine) return report(machine.error());
    if (!*machine)
        return report(
            usage_error("--machine is empty: give a machine file, or the name of a built-in "
                        "machine, for example rex"));
    const auto command = parse_command(options.command, machine->value().machine);
    if (!command) return report(command.error());
    auto map = load_offline_map(options.map_dir);
    if (!map) return refuse(options, *command, map.error());

    gate::Query query = gate::make_query(
        *command, (*pose)[0], (*pose)[1], std::cos((*pose)[2]), std::sin((*pose)[2]));
    std::vector<std::string> assumed = map->assumed;
    assumed.push_back("the frame and the pose have the age that they had when the map was written");
    assumed.push_back("perception was ready");
    if (options.machine.empty())
        assumed.push_back(
            fmt::format("the machine is {}, because --machine was not given", kUsualMachine));
    for (const io::Deviation& deviation : machine->value().deviations)
        assumed.push_back("the machine file exceeds a rated limit: " + io::text_of(deviation));
    if (options.attestation_radius_m != 0.0) {
        const auto attested = attest_start(
            machine->value().machine, query, *map->snapshot, options.attestation_radius_m, assumed);
        if (!attested) return report(attested.error());
        query.attested = *attested;
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
        if (!status) log_error(status.error().message);  // a failed log does not change the verdict
    }
    return exit_code_of(verdict.decision);
}

}  // namespace

void add_gate(VerbGroup verbs) {
    auto [verb, o] = verbs.add<GateOptions>(
        "gate",
        "give one verdict: may the machine take this step? Exit codes: 0 OK, 3 NOT_TRAVERSABLE, 4 "
        "ERROR, 2 wrong call, 1 internal error. Only 0 is a permission",
        "surefoot gate --map out/floor --pose 0,0,0 --command 9\n"
        "  surefoot gate --map out/floor --pose 0,0,0 --command 25 --audit out/audit",
        gate,
        Reads::no_settings);
    verb.option("--map", o.map_dir, "folder of the map: the output folder of 'surefoot run'")
        .required()
        .value("DIR");
    verb.option("--pose", o.pose, "pose of base_link in the frame odom: x in m, y in m, yaw in rad")
        .required()
        .value("X,Y,YAW");
    verb.option("--command",
                o.command,
                "code of the movement: joystick sector 1-24, 25 = turn left, 26 = turn right")
        .required()
        .value("N");
    verb.option("--machine",
                o.machine,
                "machine that takes the step: a machine file, or the name of a built-in machine "
                "(default rex)")
        .value("FILE|NAME");
    verb.option("--explain",
                o.explain_file,
                "file for a picture that explains the verdict: the feet now, the feet and the body "
                "after the step, and the deciding cell")
        .value("F.png");
    verb.option(
            "--attest",
            o.attestation_radius_m,
            "operator attestation: radius around base_link, in m, within which ground that was not "
            "measured counts as level. At most attestation_radius_m of the machine file (1.0 m for "
            "rex); "
            "0 = no attestation. Without this option the gate assumes a disc that reaches to the "
            "ends of the feet at the pose, and --json lists this assumption in 'assumed'")
        .value("M")
        .not_negative();
    verb.option("--audit",
                o.audit_dir,
                "folder of an audit log; the verb adds the verdict and all inputs of the verdict "
                "to this log")
        .value("DIR");
}

}  // namespace surefoot::app

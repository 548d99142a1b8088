// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <utility>
#include <vector>

#include "cli/audit_replay.hpp"
#include "cli/json/audit_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/gate_process/audit/audit_reader.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::app {
namespace {

struct AuditOptions {
    CommonOptions common;
    std::string path;  ///< folder of a log, or one file of the log
};

void say_what_is_missing(const gate_process::AuditSummary& summary) {
    for (const std::string& sentence : summary.unfinished) log_warning(sentence);
    if (summary.gaps > 0)
        log_warning(
            fmt::format("{} verdicts and acts are missing in {} gaps of the log, because the disk "
                        "accepted no data; check the free space of the disk",
                        summary.lost,
                        summary.gaps));
    if (summary.damage) log_error(summary.damage->text());
}

std::string text_of(const gate_process::AuditSummary& summary) {
    return fmt::format("{} verdicts and {} acts of {} runs in {} files ({} bytes)",
                       summary.verdicts,
                       summary.acts,
                       summary.runs,
                       summary.files,
                       summary.bytes);
}

void print_difference(const AuditDifference& first) {
    fmt::print("first difference in {}, at byte {}, in frame {} of the log\n",
               first.file,
               first.offset,
               first.sequence);
    for (const gate_process::FieldDifference& d : first.fields)
        fmt::print("  {}: recorded {}, now {}\n", d.field, d.recorded, d.replayed);
}

void print_act(const gate_process::Act& act) {
    fmt::print("{:.3f} s  {} {}: {}",
               seconds_from_ns(act.time_ns),
               to_string(act.role),
               to_string(act.kind),
               to_string(act.outcome));
    if (act.connection != 0) fmt::print(", connection {}", act.connection);
    if (act.kind == gate_process::ActKind::attest)
        fmt::print(", {:.4f} m", act.radius_tenth_mm * 1e-4);
    if (!act.text.empty()) fmt::print(", {}", act.text);
    if (act.left_out > 0) fmt::print(" ({} earlier refused acts are not in the log)", act.left_out);
    fmt::print("\n");
}

/// `surefoot audit acts`: lists the attestations, the re-armings, the shown tokens and the refused
/// requests of the log.
int audit_acts(const AuditOptions& options) {
    std::vector<gate_process::Act> acts;
    const auto summary = gate_process::read_audit(
        options.path, {}, [&](const gate_process::Act& act) { acts.push_back(act); });
    if (!summary) return report(summary.error());
    say_what_is_missing(*summary);
    if (options.common.json) {
        print_answer(audit_acts_json(*summary, acts));
    } else {
        for (const gate_process::Act& act : acts) print_act(act);
    }
    return summary->damage ? kExitFailed : kExitOk;
}

/// `surefoot audit verify`: checks the checksums, the chain and the gaps of an audit log.
int audit_verify(const AuditOptions& options) {
    const auto summary = gate_process::read_audit(options.path, {});
    if (!summary) return report(summary.error());
    say_what_is_missing(*summary);
    if (options.common.json) {
        print_answer(audit_json(*summary));
    } else {
        fmt::print("{}: {}\n", text_of(*summary), summary->damage ? "DAMAGED" : "intact");
    }
    return summary->damage ? kExitFailed : kExitOk;
}

/// `surefoot audit replay`: checks that the gate reproduces every verdict of the log.
int audit_replay(const AuditOptions& options) {
    AuditReplay replay;
    const auto summary =
        gate_process::read_audit(options.path, [&](const gate_process::AuditedAt& at) {
            auto fields = gate_process::differences(at.record.verdict,
                                                    gate_process::replay(at.machine, at.record));
            if (fields.empty()) {
                ++replay.equal;
                return;
            }
            ++replay.different;
            if (!replay.first)
                replay.first = AuditDifference{at.file, at.offset, at.sequence, std::move(fields)};
        });
    if (!summary) return report(summary.error());
    say_what_is_missing(*summary);
    if (options.common.json) {
        print_answer(audit_replay_json(*summary, replay));
    } else {
        fmt::print("{}: {} equal, {} different{}\n",
                   text_of(*summary),
                   replay.equal,
                   replay.different,
                   summary->damage ? ", DAMAGED" : "");
        if (replay.first) print_difference(*replay.first);
    }
    if (replay.different > 0)
        log_error(
            "the gate of this version decides at least one query of the log differently; compare "
            "the recorded and the new value of each field in the first difference");
    return summary->damage || replay.different > 0 ? kExitFailed : kExitOk;
}

}  // namespace

void add_audit(VerbGroup verbs) {
    const auto add = [&](const char* name,
                         const char* what,
                         const char* example,
                         int (*handler)(const AuditOptions&)) {
        auto [verb, o] = verbs.add(name, what, example, handler, Reads::no_settings);
        verb.option("path", o.path, "folder of an audit log, or one file of the log")
            .required()
            .value("PATH");
    };
    add("verify",
        "check the checksums, the hash chain and the gaps of an audit log; exit code 1 = the log "
        "is damaged",
        "surefoot audit verify out/audit --json",
        audit_verify);
    add("acts",
        "list the acts of an audit log, each with the role of its client: attestations of the "
        "ground, re-arming of the gate, shown tokens and refused requests",
        "surefoot audit acts out/audit",
        audit_acts);
    add("replay",
        "let the gate decide every query of an audit log again; exit code 0 = all verdicts equal "
        "the logged verdicts bit for bit",
        "surefoot audit replay out/audit",
        audit_replay);
}

}  // namespace surefoot::app

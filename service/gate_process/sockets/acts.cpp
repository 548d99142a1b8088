// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/sockets/acts.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::gate_process {
namespace {

/// A client may send any number as the radius.
std::int32_t tenth_mm(double length_m) noexcept {
    constexpr double kMost_m = 100.0;
    if (std::isnan(length_m)) return 0;
    // in range: 100 m are 1e6 units of 0.1 mm
    return static_cast<std::int32_t>(std::lround(std::clamp(length_m, -kMost_m, kMost_m) * 1e4));
}

}  // namespace

const char* to_string(ActKind kind) noexcept {
    switch (kind) {
        case ActKind::connect: return "connect";
        case ActKind::authenticate: return "authenticate";
        case ActKind::ask: return "ask";
        case ActKind::attest: return "attest";
        case ActKind::rearm: return "re-arm";
    }
    return "?";
}

const char* to_string(ActOutcome outcome) noexcept {
    switch (outcome) {
        case ActOutcome::done: return "done";
        case ActOutcome::failed: return "failed";
        case ActOutcome::no_right: return "no right";
    }
    return "?";
}

Act act_of(ActKind kind,
           Role role,
           std::uint64_t connection,
           const Status& done,
           std::int64_t time_ns,
           double radius_m) {
    return {kind,
            done ? ActOutcome::done : ActOutcome::failed,
            role,
            connection,
            time_ns,
            tenth_mm(radius_m),
            0,
            done ? "" : done.error().message};
}

}  // namespace surefoot::gate_process

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "service/gate_process/sockets/access.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::gate_process {

// The numbers stand in audit logs (docs/reference/audit_format.md): never give one a new meaning.
enum class ActKind : std::uint8_t { connect = 1, authenticate, ask, attest, rearm };
enum class ActOutcome : std::uint8_t {
    done = 1,
    failed,   ///< whoever did it may do it, but the gate could not
    no_right  ///< the role may not do it, or the token is unknown
};
/// "connect", "done": for people.
[[nodiscard]] const char* to_string(ActKind kind) noexcept;
[[nodiscard]] const char* to_string(ActOutcome outcome) noexcept;

/// What somebody did at the service, or was refused. Verdicts have records of their own.
struct Act {
    ActKind kind = ActKind::connect;
    ActOutcome outcome = ActOutcome::no_right;
    Role role = Role::none;            ///< that the client had when it acted
    std::uint64_t connection = 0;      ///< 0: whoever started the process, or a client at the door
    std::int64_t time_ns = 0;          ///< steady
    std::int32_t radius_tenth_mm = 0;  ///< of an attestation
    std::uint32_t left_out = 0;        ///< refused acts before this one that are not in the log
    std::string text;                  ///< why not, and from which computer
};

/// An act that the role may do, and what became of it.
[[nodiscard]] Act act_of(ActKind kind,
                         Role role,
                         std::uint64_t connection,
                         const Status& done,
                         std::int64_t time_ns,
                         double radius_m = 0.0);

/// Longer texts are cut in the log.
inline constexpr std::size_t kMaxActText_bytes = 200;

}  // namespace surefoot::gate_process

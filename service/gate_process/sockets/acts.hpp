// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "service/gate_process/sockets/access.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::gate_process {

// The numbers are stored in audit logs (docs/reference/audit_format.md): never change them.
enum class ActKind : std::uint8_t { connect = 1, authenticate, ask, attest, rearm };
enum class ActOutcome : std::uint8_t {
    done = 1,
    failed,   ///< the role may do it, but the gate refused or failed
    no_right  ///< the role may not do it, or the token is unknown
};
/// Returns the name for people, for example "connect" or "done".
[[nodiscard]] const char* to_string(ActKind kind) noexcept;
[[nodiscard]] const char* to_string(ActOutcome outcome) noexcept;

/// An action of a client at the service, done or refused. Verdicts have their own records.
struct Act {
    ActKind kind = ActKind::connect;
    ActOutcome outcome = ActOutcome::no_right;
    Role role = Role::none;            ///< role of the client at that time
    std::uint64_t connection = 0;      ///< 0: from the starter of the process, or not yet admitted
    std::int64_t time_ns = 0;          ///< steady clock
    std::int32_t radius_tenth_mm = 0;  ///< radius of an attestation
    std::uint32_t left_out = 0;        ///< number of earlier refused acts that are not in the log
    std::string text;                  ///< cause of a refusal, and the client's computer
};

/// Makes an act for which the role has the right, with its outcome.
[[nodiscard]] Act act_of(ActKind kind,
                         Role role,
                         std::uint64_t connection,
                         const Status& done,
                         std::int64_t time_ns,
                         double radius_m = 0.0);

/// Largest length of the text of an act; the log truncates longer texts.
inline constexpr std::size_t kMaxActText_bytes = 200;

}  // namespace surefoot::gate_process

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"

/// Roles at the sockets of the gate and of the page. The reasons are in SECURITY.md.
namespace surefoot::gate_process {

/// Role of a client. Each role includes the permissions of all roles before it.
enum class Role : std::uint8_t {
    none,      ///< may do nothing
    observer,  ///< may read topics, health and the catalogue
    rider,     ///< may ask about steps and goals
    operator_  ///< may attest the ground around the machine and re-arm the gate
};
/// Returns the name: "none", "observer", "rider" or "operator".
[[nodiscard]] const char* to_string(Role role) noexcept;
/// Returns the role of a name; empty for any other name.
[[nodiscard]] std::optional<Role> role_named(std::string_view name) noexcept;

/// The tokens of a service, and the role of clients without a token. An empty token is not in use.
struct Access {
    std::string observer;
    std::string rider;
    std::string operator_;
    /// Role of a client without a token. `none`: a token is required. Never `operator_`.
    Role guest = Role::rider;

    /// Returns the role of a token; empty for an unknown token. Compares with all tokens in a time
    /// that depends only on their lengths.
    [[nodiscard]] std::optional<Role> role_of(std::string_view token) const noexcept;
    [[nodiscard]] const std::string& token_of(Role role) const noexcept;
    [[nodiscard]] bool has_tokens() const noexcept;
    /// Returns the first problem as a message: a token that is too short, too long or invalid in a
    /// URL, two equal tokens, or guests with operator rights.
    [[nodiscard]] std::optional<std::string> problem() const;
    bool operator==(const Access&) const = default;
};

/// Parses a token file: one line "ROLE TOKEN" per role; empty lines and lines that begin with '#'
/// are ignored. An error names `file`, the line and the mistake.
[[nodiscard]] Result<Access> parse_tokens(std::string_view text, const std::string& file);
/// Returns the text of a token file, which `parse_tokens` reads.
[[nodiscard]] std::string format_tokens(const Access& access);

/// Compares all bytes of `expected`, so that the duration reveals only the length.
[[nodiscard]] bool equal_in_constant_time(std::string_view given,
                                          std::string_view expected) noexcept;

}  // namespace surefoot::gate_process

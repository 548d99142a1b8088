// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"

/// Who may do what at the sockets of the gate and of the page. SECURITY.md has the reasons.
namespace surefoot::gate_process {

/// Each role may do everything that the roles before it may do.
enum class Role : std::uint8_t {
    none,      ///< nothing
    observer,  ///< reads topics, health and the catalogue
    rider,     ///< asks about steps and goals
    operator_  ///< attests the ground around the machine, and re-arms the gate
};
/// "none", "observer", "rider", "operator".
[[nodiscard]] const char* to_string(Role role) noexcept;
/// Nothing for every other name.
[[nodiscard]] std::optional<Role> role_named(std::string_view name) noexcept;

/// The tokens of a service and what a client without a token may do. An empty token is nobody's.
struct Access {
    std::string observer;
    std::string rider;
    std::string operator_;
    /// Of a client that shows no token. `none`: everybody needs a token. Never `operator_`.
    Role guest = Role::rider;

    /// The role of a token; nothing for a token that is not one of these. Compares with all tokens
    /// in a time that depends on their lengths alone.
    [[nodiscard]] std::optional<Role> role_of(std::string_view token) const noexcept;
    [[nodiscard]] const std::string& token_of(Role role) const noexcept;
    [[nodiscard]] bool has_tokens() const noexcept;
    /// The first problem in words: a token that is too short, too long or not fit for a URL, two
    /// equal tokens, guests with the operator's rights.
    [[nodiscard]] std::optional<std::string> problem() const;
    bool operator==(const Access&) const = default;
};

/// Reads the text of a token file: a line "ROLE TOKEN" for each role, empty lines, and comments
/// that begin with '#'. An error names `file`, the line, and the mistake.
[[nodiscard]] Result<Access> parse_tokens(std::string_view text, const std::string& file);
/// The text that `parse_tokens` reads.
[[nodiscard]] std::string format_tokens(const Access& access);

/// Compares all of `expected` whatever differs, so that the time tells nothing but the length.
[[nodiscard]] bool equal_in_constant_time(std::string_view given,
                                          std::string_view expected) noexcept;

}  // namespace surefoot::gate_process

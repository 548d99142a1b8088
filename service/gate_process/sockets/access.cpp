// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/sockets/access.hpp"

#include <algorithm>
#include <array>

namespace surefoot::gate_process {
namespace {

constexpr std::array<Role, 3> kTokenRoles{Role::observer, Role::rider, Role::operator_};

/// True for a character that needs no escape in a URL.
bool is_plain(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.' || c == '~';
}

std::optional<std::string> problem_of_token(Role role, const std::string& token) {
    constexpr std::size_t kShortest = 16;
    constexpr std::size_t kLongest = 128;
    if (token.size() < kShortest || token.size() > kLongest) {
        return std::string("token of the ") + to_string(role) + ": it has " +
               std::to_string(token.size()) + " characters, " + std::to_string(kShortest) + " to " +
               std::to_string(kLongest) + " are needed";
    }
    if (!std::all_of(token.begin(), token.end(), is_plain))
        return std::string("token of the ") + to_string(role) +
               ": use only letters, digits and - _ . ~, because the token is part of a URL";
    return std::nullopt;
}

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kBlank = " \t\r";
    const std::size_t first = text.find_first_not_of(kBlank);
    if (first == text.npos) return {};
    return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::string& token_in(Access& access, Role role) {
    if (role == Role::observer) return access.observer;
    return role == Role::rider ? access.rider : access.operator_;
}

/// Reads one line that is neither empty nor a comment. Returns the mistake as a message.
std::optional<std::string> read_line(std::string_view line, Access& access) {
    const std::size_t blank = line.find_first_of(" \t");
    const auto role = role_named(line.substr(0, blank));
    const std::string_view token = blank == line.npos ? "" : trimmed(line.substr(blank));
    if (!role || *role == Role::none || token.empty())
        return "a line must be 'ROLE TOKEN'; ROLE is observer, rider or operator";
    std::string& kept = token_in(access, *role);
    if (!kept.empty())
        return std::string("the ") + to_string(*role) + " has a token already: delete one line";
    kept = token;
    return std::nullopt;
}

}  // namespace

const char* to_string(Role role) noexcept {
    switch (role) {
        case Role::none: return "none";
        case Role::observer: return "observer";
        case Role::rider: return "rider";
        case Role::operator_: return "operator";
    }
    return "none";
}

std::optional<Role> role_named(std::string_view name) noexcept {
    for (const Role role : {Role::none, Role::observer, Role::rider, Role::operator_}) {
        if (name == to_string(role)) return role;
    }
    return std::nullopt;
}

bool equal_in_constant_time(std::string_view given, std::string_view expected) noexcept {
    unsigned difference = given.size() == expected.size() ? 0U : 1U;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const char c = given.empty() ? '\0' : given[i % given.size()];
        difference |= static_cast<unsigned>(c ^ expected[i]);
    }
    return difference == 0U;
}

const std::string& Access::token_of(Role role) const noexcept {
    static const std::string nobody;
    switch (role) {
        case Role::observer: return observer;
        case Role::rider: return rider;
        case Role::operator_: return operator_;
        case Role::none: break;
    }
    return nobody;
}

std::optional<Role> Access::role_of(std::string_view token) const noexcept {
    std::optional<Role> found;
    for (const Role role : kTokenRoles) {
        const std::string& expected = token_of(role);
        const bool equal = equal_in_constant_time(token, expected);
        if (equal && !expected.empty()) found = role;
    }
    return found;
}

bool Access::has_tokens() const noexcept {
    return !observer.empty() || !rider.empty() || !operator_.empty();
}

std::optional<std::string> Access::problem() const {
    if (guest == Role::operator_)
        return "a client without a token cannot be the operator: give --guests none, observer or "
               "rider";
    for (const Role role : kTokenRoles) {
        if (token_of(role).empty()) continue;
        if (auto problem = problem_of_token(role, token_of(role))) return problem;
        for (const Role other : kTokenRoles) {
            if (other != role && token_of(other) == token_of(role))
                return std::string("the ") + to_string(role) + " and the " + to_string(other) +
                       " have the same token: give each role a token of its own";
        }
    }
    return std::nullopt;
}

Result<Access> parse_tokens(std::string_view text, const std::string& file) {
    Access access;
    for (int number = 1; !text.empty(); ++number) {
        const std::string_view whole = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(text.size(), whole.size() + 1));
        const std::string_view line = trimmed(whole);
        if (line.empty() || line.front() == '#') continue;
        if (const auto problem = read_line(line, access))
            return usage_error(file + " line " + std::to_string(number) + ": " + *problem);
    }
    if (!access.has_tokens())
        return usage_error(
            file + ": the file has no token; delete it and restart the service to make new tokens");
    if (const auto problem = access.problem()) return usage_error(file + ": " + *problem);
    return access;
}

std::string format_tokens(const Access& access) {
    std::string text =
        "# Tokens of the Surefoot service, one role a line. Keep this file private (rights 0600).\n"
        "# Delete the file and restart the service to make new tokens.\n";
    for (const Role role : kTokenRoles) {
        if (!access.token_of(role).empty())
            text += std::string(to_string(role)) + " " + access.token_of(role) + "\n";
    }
    return text;
}

}  // namespace surefoot::gate_process

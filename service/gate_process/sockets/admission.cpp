// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/sockets/admission.hpp"

#include <algorithm>

namespace surefoot::gate_process {

std::string_view path_of(std::string_view target) noexcept {
    return target.substr(0, target.find('?'));
}

std::string_view query_value(std::string_view target, std::string_view name) noexcept {
    const std::size_t mark = target.find('?');
    std::string_view rest = mark == std::string_view::npos ? "" : target.substr(mark + 1);
    while (!rest.empty()) {
        const std::string_view pair = rest.substr(0, rest.find('&'));
        rest.remove_prefix(std::min(rest.size(), pair.size() + 1));
        const std::size_t equals = pair.find('=');
        if (equals != std::string_view::npos && pair.substr(0, equals) == name)
            return pair.substr(equals + 1);
    }
    return {};
}

bool is_loopback_origin(std::string_view origin) noexcept {
    for (const std::string_view scheme : {"http://", "https://"}) {
        for (const std::string_view host : {"localhost", "127.0.0.1", "[::1]"}) {
            if (!origin.starts_with(scheme) || !origin.substr(scheme.size()).starts_with(host))
                continue;
            const std::string_view port = origin.substr(scheme.size() + host.size());
            if (port.empty()) return true;
            if (port.front() == ':' && port.size() > 1 &&
                port.find_first_not_of("0123456789", 1) == std::string_view::npos)
                return true;
        }
    }
    return false;
}

namespace {

bool is_welcome_origin(std::optional<std::string_view> origin,
                       const std::vector<std::string>& origins) {
    return !origin || is_loopback_origin(*origin) ||
           std::find(origins.begin(), origins.end(), *origin) != origins.end();
}

/// Returns the token of the request, or nothing if there is no token.
std::optional<std::string_view> token_of(const Knock& knock) {
    constexpr std::string_view kScheme = "Bearer ";
    if (knock.authorization && knock.authorization->starts_with(kScheme))
        return knock.authorization->substr(kScheme.size());
    const std::string_view token = query_value(knock.target, "token");
    return token.empty() ? std::nullopt : std::optional(token);
}

/// Returns an Origin in a form that can safely be repeated to the client.
std::string printable(std::string_view text) {
    constexpr std::size_t kMost = 100;
    std::string out(text.substr(0, kMost));
    std::replace_if(
        out.begin(), out.end(), [](char c) { return c < 0x20 || c > 0x7e; }, '?');
    return out;
}

}  // namespace

Entrance admit(const Access& access, const std::vector<std::string>& origins, const Knock& knock) {
    const auto token = token_of(knock);
    Entrance entrance{Admission::wrong_origin, Role::none, token.has_value()};
    if (!is_welcome_origin(knock.origin, origins)) return entrance;
    const Role role = token ? access.role_of(*token).value_or(Role::none) : access.guest;
    entrance.admission = role == Role::none ? Admission::wrong_token : Admission::welcome;
    entrance.role = role;
    return entrance;
}

std::string refusal_text(const Entrance& entrance, const Knock& knock) {
    if (entrance.admission == Admission::wrong_origin) {
        const std::string origin = printable(knock.origin.value_or(""));
        return "a web page of the origin '" + origin +
               "' may not connect. To allow it, restart the service with --origin '" + origin +
               "' (a page from a file has the origin 'null' or 'file://')";
    }
    if (entrance.has_token)
        return "this token is not known here. Take a token from the service's token file";
    return "a token is needed: add ?token=TOKEN to the address, or send the header 'Authorization: "
           "Bearer TOKEN'. The token is in the service's token file";
}

Admission admit(const std::string& token,
                const std::vector<std::string>& origins,
                std::string_view target,
                std::optional<std::string_view> origin) {
    if (!is_welcome_origin(origin, origins)) return Admission::wrong_origin;
    if (!token.empty() && !equal_in_constant_time(query_value(target, "token"), token))
        return Admission::wrong_token;
    return Admission::welcome;
}

}  // namespace surefoot::gate_process

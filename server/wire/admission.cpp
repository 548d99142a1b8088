// SPDX-License-Identifier: Apache-2.0
#include "server/wire/admission.hpp"

#include <algorithm>

namespace surefoot::wire {

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

bool equal_in_constant_time(std::string_view given, std::string_view expected) noexcept {
    unsigned difference = given.size() == expected.size() ? 0U : 1U;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const char c = given.empty() ? '\0' : given[i % given.size()];
        difference |= static_cast<unsigned>(c ^ expected[i]);
    }
    return difference == 0U;
}

Admission admit(const std::string& token,
                const std::vector<std::string>& origins,
                std::string_view target,
                std::optional<std::string_view> origin) {
    if (origin && !is_loopback_origin(*origin) &&
        std::find(origins.begin(), origins.end(), *origin) == origins.end())
        return Admission::wrong_origin;
    if (!token.empty() && !equal_in_constant_time(query_value(target, "token"), token))
        return Admission::wrong_token;
    return Admission::welcome;
}

}  // namespace surefoot::wire

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "service/gate_process/sockets/access.hpp"

namespace surefoot::gate_process {

enum class Admission : std::uint8_t { welcome, wrong_token, wrong_origin };

/// The parts of a client's HTTP request that decide whether the client may connect.
struct Knock {
    std::string_view target;                        ///< "/?token=..."
    std::optional<std::string_view> origin;         ///< origin of the requesting web page
    std::optional<std::string_view> authorization;  ///< "Bearer ..."
};
struct Entrance {
    Admission admission = Admission::wrong_token;
    Role role = Role::none;  ///< valid if `admission` is `welcome`
    bool has_token = false;  ///< the client sent a token, right or wrong
};

/// Decides whether a client may connect, and its role. A browser sends the Origin of the requesting
/// page. Pages of this machine and of the list are accepted; all other pages are refused. Native
/// clients send no Origin. The token is in the URL query or in the header Authorization. A client
/// without a token is a guest; a wrong token is always refused.
[[nodiscard]] Entrance admit(const Access& access,
                             const std::vector<std::string>& origins,
                             const Knock& knock);
/// Returns the message to a refused client: the cause, and the correction.
[[nodiscard]] std::string refusal_text(const Entrance& entrance, const Knock& knock);

/// Decides the admission to a service with one shared token. Empty token: no check of the token.
[[nodiscard]] Admission admit(const std::string& token,
                              const std::vector<std::string>& origins,
                              std::string_view target,
                              std::optional<std::string_view> origin);

/// Returns the path of a target, for example "/health" of "/health?token=x".
[[nodiscard]] std::string_view path_of(std::string_view target) noexcept;
/// Returns the value of a name in the query, without unescaping; empty if it is missing.
[[nodiscard]] std::string_view query_value(std::string_view target, std::string_view name) noexcept;
/// True for http or https with localhost, 127.0.0.1 or [::1], at any port.
[[nodiscard]] bool is_loopback_origin(std::string_view origin) noexcept;
}  // namespace surefoot::gate_process

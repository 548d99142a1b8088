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

/// What the HTTP request of a client says about the client.
struct Knock {
    std::string_view target;                        ///< "/?token=..."
    std::optional<std::string_view> origin;         ///< of the web page that asks
    std::optional<std::string_view> authorization;  ///< "Bearer ..."
};
struct Entrance {
    Admission admission = Admission::wrong_token;
    Role role = Role::none;  ///< where welcome
    bool has_token = false;  ///< a token was shown, right or wrong
};

/// Who may connect, and as what. A browser sends the Origin of the page that asks: pages of this
/// machine and of the list are welcome, any other page that the user has open is not. A native
/// client sends no Origin. The token stands in the query of the URL or in the header Authorization.
/// A client without a token is a guest; a wrong token is refused even where guests are welcome.
[[nodiscard]] Entrance admit(const Access& access,
                             const std::vector<std::string>& origins,
                             const Knock& knock);
/// A sentence for a client that is refused: what is wrong, and what to do now.
[[nodiscard]] std::string refusal_text(const Entrance& entrance, const Knock& knock);

/// The same for a service with one token for everybody; with an empty one no token is needed.
[[nodiscard]] Admission admit(const std::string& token,
                              const std::vector<std::string>& origins,
                              std::string_view target,
                              std::optional<std::string_view> origin);

/// "/health" of "/health?token=x".
[[nodiscard]] std::string_view path_of(std::string_view target) noexcept;
/// The value of a name in the query, not unescaped; empty where it is missing.
[[nodiscard]] std::string_view query_value(std::string_view target, std::string_view name) noexcept;
/// http://localhost, 127.0.0.1 or [::1], at any port, or https.
[[nodiscard]] bool is_loopback_origin(std::string_view origin) noexcept;
}  // namespace surefoot::gate_process

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace surefoot::wire {

enum class Admission : std::uint8_t { welcome, wrong_token, wrong_origin };

/// Who may connect. A browser sends the Origin of the page that asks: those of this machine and of
/// the list are welcome, any other page that the user has open is not. A native client sends none.
/// Where a token is configured everybody needs it, in the query of the URL.
/// `target` is that of the HTTP request: "/?token=...".
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
/// Compares all of `expected` whatever differs, so that the time tells nothing but the length.
[[nodiscard]] bool equal_in_constant_time(std::string_view given,
                                          std::string_view expected) noexcept;

}  // namespace surefoot::wire

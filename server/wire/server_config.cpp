// SPDX-License-Identifier: Apache-2.0
#include "server/wire/server_config.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>

#include "server/wire/arguments.hpp"

namespace surefoot::wire {
namespace {

bool is_address(const std::string& address) {
    in_addr v4{};
    in6_addr v6{};
    return inet_pton(AF_INET, address.c_str(), &v4) == 1 ||
           inet_pton(AF_INET6, address.c_str(), &v6) == 1;
}

/// Characters that need no escape in a URL.
bool is_plain(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.' || c == '~';
}

std::optional<std::string> problem_of_token(const std::string& token) {
    constexpr std::size_t kShortest = 16;
    constexpr std::size_t kLongest = 128;
    if (token.size() < kShortest || token.size() > kLongest) {
        return "token: " + std::to_string(kShortest) + " to " + std::to_string(kLongest) +
               " characters are needed";
    }
    if (!std::all_of(token.begin(), token.end(), is_plain))
        return "token: letters, digits and - _ . ~ alone, because it stands in a URL";
    return std::nullopt;
}

bool positive(RateLimit limit) {
    constexpr std::int64_t kMost = 1'000'000;
    return limit.per_s > 0 && limit.per_s <= kMost && limit.burst > 0 && limit.burst <= kMost;
}

}  // namespace

bool is_loopback_address(const std::string& address) {
    constexpr std::uint8_t kNet = 127;
    std::array<std::uint8_t, sizeof(in6_addr)> bytes{};
    if (inet_pton(AF_INET, address.c_str(), bytes.data()) == 1) return bytes[0] == kNet;
    constexpr std::array<std::uint8_t, sizeof(in6_addr)> kOne{
        0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    return inet_pton(AF_INET6, address.c_str(), bytes.data()) == 1 && bytes == kOne;
}

std::optional<std::string> ServerConfig::problem() const {
    if (!is_address(bind_address))
        return "bind_address '" + bind_address + "': an IP address is needed, as 127.0.0.1 or ::1";
    if (token.empty() && !is_loopback_address(bind_address))
        return "bind_address " + bind_address + " is reached from outside: a token is needed";
    if (!token.empty()) {
        if (auto token_problem = problem_of_token(token)) return token_problem;
    }
    if (first_connection == 0 || first_connection > kMaxExact / 2)
        return "first_connection: from 1 to 2^52";
    if (max_clients == 0 || max_handshakes == 0 || accepts_per_tick <= 0)
        return "max_clients, max_handshakes, accepts_per_tick: above 0";
    if (tick_ms <= 0 || handshake_ms <= 0 || idle_ms <= 0 || message_ms <= 0 || write_ms <= 0)
        return "times: above 0 ms; none of them can be switched off";
    if (max_queue_bytes == 0 || max_read_bytes_per_s == 0)
        return "max_queue_bytes, max_read_bytes_per_s: above 0";
    if (!positive(control_frames) || !positive(session.messages) || !positive(session.refusals) ||
        !positive(session.faults))
        return "rates and bursts: from 1 to 1000000";
    return std::nullopt;
}

}  // namespace surefoot::wire

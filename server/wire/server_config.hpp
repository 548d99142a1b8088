// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/wire/rosbridge_session.hpp"

namespace surefoot::wire {

/// Where the service listens, to whom, and what it lets them do.
struct ServerConfig {
    std::string bind_address = "127.0.0.1";  ///< an IP address; another than loopback needs a token
    std::uint16_t port = 9090;               ///< rosbridge's; 0 = any free one
    std::string token;                       ///< in the URL as ?token=; empty: none is asked for
    std::vector<std::string> origins;        ///< of web pages, besides those of this machine
    std::uint64_t first_connection = 1;      ///< number of the first client; never 0

    std::size_t max_clients = 64;
    std::size_t max_handshakes = 32;        ///< beyond it the oldest one gives way
    int accepts_per_tick = 8;               ///< so that a crowd at the door disturbs nobody inside
    int tick_ms = 5;                        ///< the owner's hook, topics and deadlines
    int handshake_ms = 2000;                ///< to ask for the WebSocket, wholly
    int idle_ms = 10000;                    ///< without a sign of life; asked by a ping at half
    int message_ms = 2000;                  ///< from the first byte of a message to its last
    int write_ms = 2000;                    ///< for one text to leave
    std::size_t max_queue_bytes = 1 << 20;  ///< waiting for a client that does not read
    std::size_t max_read_bytes_per_s = 1 << 20;
    RateLimit control_frames{20, 40};  ///< pings and pongs of a client, before it is dropped
    SessionLimits session;

    /// The first problem in words.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// An IP address that nothing outside of this machine reaches.
[[nodiscard]] bool is_loopback_address(const std::string& address);

}  // namespace surefoot::wire

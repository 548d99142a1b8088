// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "service/gate_process/protocol/rosbridge_session.hpp"
#include "service/gate_process/sockets/access.hpp"
#include "service/gate_process/sockets/slots.hpp"
#include "service/gate_process/sockets/tls_door.hpp"

namespace surefoot::gate_process {

/// Whoever serves a network without TLS must give this sentence word by word.
inline constexpr const char* kInsecureSentence =
    "I understand that everybody on this network can read and change what is sent";

/// Where the service listens, to whom, and what it lets them do.
struct ServerConfig {
    /// An IP address. Another than loopback needs tokens for everybody, and TLS.
    std::string bind_address = "127.0.0.1";
    std::uint16_t port = 9090;           ///< rosbridge's; 0 = any free one
    Access access;                       ///< tokens and roles
    TlsFiles tls;                        ///< empty: no TLS
    std::string insecure;                ///< kInsecureSentence: no TLS beyond loopback
    std::vector<std::string> origins;    ///< of web pages, besides those of this machine
    std::uint64_t first_connection = 1;  ///< number of the first client; never 0

    SlotLimits slots;
    int accepts_per_tick = 16;  ///< so that a crowd at the door disturbs nobody inside
    int tick_ms = 5;            ///< the owner's hook, topics and deadlines
    /// Processor time between two ticks for all clients without the token of a rider or an operator
    /// together, new WebSockets included; those who have used least come first, and what is left
    /// of their messages waits.
    int guest_work_us = 1500;
    int door_work_us = 750;                 ///< the same for accepting and reading a request
    int handshake_ms = 2000;                ///< to ask for the WebSocket, wholly
    int idle_ms = 10000;                    ///< without a sign of life; asked by a ping at half
    int message_ms = 2000;                  ///< from the first byte of a message to its last
    int write_ms = 2000;                    ///< for one text to leave
    std::size_t max_queue_bytes = 1 << 20;  ///< waiting for a client that does not read
    std::size_t max_read_bytes_per_s = 1 << 20;
    RateLimit control_frames{5, 10};  ///< pings and pongs of a client, before it is dropped
    SessionLimits session;

    /// The first problem in words.
    [[nodiscard]] std::optional<std::string> problem() const;

  private:
    [[nodiscard]] std::optional<std::string> problem_of_address() const;
};

/// What is missing for serving at an address, in words: a service of this machine needs nothing,
/// any other needs a token from everybody, and TLS or the sentence above. For gate and page.
[[nodiscard]] std::optional<std::string> problem_of_exposure(const std::string& bind_address,
                                                             const Access& access,
                                                             bool has_tls,
                                                             const std::string& insecure);

/// An IP address that nothing outside of this machine reaches.
[[nodiscard]] bool is_loopback_address(const std::string& address);

}  // namespace surefoot::gate_process

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

/// The sentence that the user must give to serve a network without TLS.
inline constexpr const char* kInsecureSentence =
    "I understand that everybody on this network can read and change what is sent";

/// Address, permissions and limits of the service.
struct ServerConfig {
    /// An IP address. Except on loopback, clients need a token, and TLS or `insecure` must be set.
    std::string bind_address = "127.0.0.1";
    std::uint16_t port = 9090;           ///< the rosbridge port; 0 = any free port
    Access access;                       ///< tokens and roles
    TlsFiles tls;                        ///< files for TLS; empty = no TLS
    std::string insecure;                ///< kInsecureSentence permits other computers without TLS
    std::vector<std::string> origins;    ///< allowed web pages, in addition to this machine's pages
    std::uint64_t first_connection = 1;  ///< number of the first client; never 0

    SlotLimits slots;
    int accepts_per_tick = 16;  ///< most new connections per tick; limits the delay that they cause
    int tick_ms = 5;            ///< period [ms] of the owner's hook, topics and deadlines
    /// Processor time between two ticks for all clients without the token of a rider or operator,
    /// including new WebSockets. The client with the least use is served first. Messages beyond the
    /// limit wait.
    int guest_work_us = 1500;
    int door_work_us = 750;                 ///< most time per tick to accept and read requests
    int handshake_ms = 2000;                ///< time limit for the complete WebSocket handshake
    int idle_ms = 10000;                    ///< longest time without data; ping at half this time
    int message_ms = 2000;                  ///< time limit for receiving one message
    int write_ms = 2000;                    ///< time limit for sending one text
    std::size_t max_queue_bytes = 1 << 20;  ///< limit of waiting texts if a client does not read
    std::size_t max_read_bytes_per_s = 1 << 20;
    RateLimit control_frames{5, 10};  ///< at a larger rate, the client is disconnected
    SessionLimits session;

    /// Returns the first problem as a message.
    [[nodiscard]] std::optional<std::string> problem() const;

  private:
    [[nodiscard]] std::optional<std::string> problem_of_address() const;
};

/// Returns the requirement that is missing to serve at an address, as a message. Loopback needs
/// nothing. Other addresses need a token from every client, and TLS or kInsecureSentence.
[[nodiscard]] std::optional<std::string> problem_of_exposure(const std::string& bind_address,
                                                             const Access& access,
                                                             bool has_tls,
                                                             const std::string& insecure);

/// True for an IP address that only this computer can reach.
[[nodiscard]] bool is_loopback_address(const std::string& address);

}  // namespace surefoot::gate_process

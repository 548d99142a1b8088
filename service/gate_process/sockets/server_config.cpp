// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/sockets/server_config.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>

#include "service/gate_process/protocol/arguments.hpp"

namespace surefoot::gate_process {
namespace {

using AddressBytes = std::array<std::uint8_t, sizeof(in6_addr)>;

/// Parses an address of the family. Rejects text after a NUL, which inet_pton would ignore.
bool parse_address(int family, const std::string& text, AddressBytes& bytes) {
    return text.find('\0') == std::string::npos &&
           inet_pton(family, text.c_str(), bytes.data()) == 1;
}

bool is_address(const std::string& address) {
    AddressBytes bytes{};
    return parse_address(AF_INET, address, bytes) || parse_address(AF_INET6, address, bytes);
}

bool positive(RateLimit limit) {
    constexpr std::int64_t kMost = 1'000'000;
    return limit.per_s > 0 && limit.per_s <= kMost && limit.burst > 0 && limit.burst <= kMost;
}

}  // namespace

bool is_loopback_address(const std::string& address) {
    constexpr std::uint8_t kNet = 127;
    constexpr AddressBytes kOne{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    AddressBytes bytes{};
    if (parse_address(AF_INET, address, bytes)) return bytes[0] == kNet;
    return parse_address(AF_INET6, address, bytes) && bytes == kOne;
}

std::optional<std::string> problem_of_exposure(const std::string& bind_address,
                                               const Access& access,
                                               bool has_tls,
                                               const std::string& insecure) {
    if (!insecure.empty() && insecure != kInsecureSentence)
        return std::string("--insecure: the sentence must be \"") + kInsecureSentence + '"';
    if (is_loopback_address(bind_address)) return std::nullopt;
    const std::string reached =
        "bind_address " + bind_address + " can be reached from other computers: ";
    if (!access.has_tokens() || access.guest != Role::none)
        return reached + "every client needs a token; give --token-file FILE and --guests none";
    if (!has_tls && insecure.empty())
        return reached +
               "TLS is needed; give --certificate FILE and --key FILE. To run without TLS, give " +
               "--insecure \"" + kInsecureSentence + '"';
    return std::nullopt;
}

std::optional<std::string> ServerConfig::problem_of_address() const {
    if (!is_address(bind_address))
        return "bind_address '" + bind_address +
               "': give an IP address, for example 127.0.0.1 or ::1";
    if (auto problem = access.problem()) return problem;
    if (tls.certificate_file.empty() != tls.key_file.empty())
        return "TLS needs both files: --certificate FILE and --key FILE";
    return problem_of_exposure(bind_address, access, !tls.empty(), insecure);
}

std::optional<std::string> ServerConfig::problem() const {
    if (auto problem = problem_of_address()) return problem;
    if (first_connection == 0 || first_connection > kMaxExact / 2)
        return "first_connection must be from 1 to 2^52";
    if (const char* slots_problem = slots.problem()) return slots_problem;
    if (accepts_per_tick <= 0 || guest_work_us <= 0 || door_work_us <= 0)
        return "accepts_per_tick, guest_work_us and door_work_us must be above 0";
    if (tick_ms <= 0 || handshake_ms <= 0 || idle_ms <= 0 || message_ms <= 0 || write_ms <= 0)
        return "tick_ms, handshake_ms, idle_ms, message_ms and write_ms must be above 0";
    if (max_queue_bytes == 0 || max_read_bytes_per_s == 0)
        return "max_queue_bytes and max_read_bytes_per_s must be above 0";
    if (!positive(control_frames) || !positive(session.messages) || !positive(session.refusals) ||
        !positive(session.faults))
        return "rates and bursts must be from 1 to 1000000";
    return std::nullopt;
}

}  // namespace surefoot::gate_process

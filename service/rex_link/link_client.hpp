// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "service/rex_link/rex_link.hpp"
#include "surefoot/core/result.hpp"

/// Runs the REX link over a WebSocket, in real time.
namespace surefoot::rex_link {

/// The address of the gate. It is numeric because a name lookup may take seconds.
struct GateAddress {
    std::string address;  ///< IPv4 or IPv6 address in digits
    std::uint16_t port = 9090;
    std::string target = "/";  ///< path and query; the query may hold a token
    /// Adds ?token=... to the target; an empty token adds nothing.
    void show_token(const std::string& token);
};
/// Parses ws://ADDRESS[:PORT][/TARGET]. ADDRESS is numeric (IPv6 in brackets) or localhost. The
/// default port is 9090.
[[nodiscard]] Result<GateAddress> parse_gate_url(std::string_view url);

struct LinkClientConfig {
    GateAddress gate;
    RexLinkConfig link;
    std::int64_t reconnect_pause_ns = 500'000'000;
};

enum class LinkEventKind : std::uint8_t {
    connected,
    disconnected,
    joystick,
    question,
    answer,
    damaged,  ///< received bytes that are not a valid answer
    inhibited,
    tone,
    motion,
};
/// Returns the name of the kind, for example "connected".
[[nodiscard]] const char* to_string(LinkEventKind kind) noexcept;

/// One event of a run. Only the members that belong to the kind are set.
struct LinkEvent {
    LinkEventKind kind = LinkEventKind::connected;
    std::int64_t time_ns = 0;    ///< time since the start of the run [ns]
    std::uint64_t sequence = 0;  ///< question, answer
    std::uint8_t command = 0;    ///< for joystick, question, answer, motion
    AnswerVerdict verdict = AnswerVerdict::error;
    Tone tone = Tone::cannot_judge;
    Inhibit inhibit = Inhibit::gate_error;
    std::int64_t duration_ns = 0;  ///< motion
    std::string text;  ///< for an answer: its sentence; for damaged and disconnected: the cause
};

/// Returns the joystick's code (0 = at rest) at a time since the start of the run. Returns nothing
/// to end the run. Called about every 2 ms; must not block.
using Joystick = std::function<std::optional<std::uint8_t>(std::int64_t elapsed_ns)>;
/// Receives every event, on the thread of run_link(); must not block.
using LinkEventSink = std::function<void(const LinkEvent&)>;

/// Acts as the REX master unit until `joystick` returns nothing. Runs on the calling thread and
/// reads the steady clock. If an attempt to connect fails or the connection ends, the link connects
/// again after `reconnect_pause_ns`. The end of a connection is also an event.
void run_link(const LinkClientConfig& config, const Joystick& joystick, const LinkEventSink& sink);

}  // namespace surefoot::rex_link

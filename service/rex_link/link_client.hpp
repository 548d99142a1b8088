// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "service/rex_link/rex_link.hpp"
#include "surefoot/core/result.hpp"

/// The REX link over a WebSocket, in real time.
namespace surefoot::rex_link {

/// Where the gate listens. No name service is asked: that may take seconds.
struct GateAddress {
    std::string address;  ///< IPv4 or IPv6, in numbers
    std::uint16_t port = 9090;
    std::string target = "/";  ///< path and query; a token goes here
    /// Adds a token to the query; an empty one adds nothing.
    void show_token(const std::string& token);
};
/// ws://ADDRESS[:PORT][/TARGET]; ADDRESS in numbers, IPv6 in brackets, or localhost.
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
    damaged,  ///< bytes that are no answer
    inhibited,
    tone,
    motion,
};
/// "connected".
[[nodiscard]] const char* to_string(LinkEventKind kind) noexcept;

/// One line of what happened. Only what the kind has is filled in.
struct LinkEvent {
    LinkEventKind kind = LinkEventKind::connected;
    std::int64_t time_ns = 0;    ///< since the beginning of the run
    std::uint64_t sequence = 0;  ///< question, answer
    std::uint8_t command = 0;    ///< joystick, question, answer, motion
    AnswerVerdict verdict = AnswerVerdict::error;
    Tone tone = Tone::cannot_judge;
    Inhibit inhibit = Inhibit::gate_error;
    std::int64_t duration_ns = 0;  ///< motion
    std::string text;              ///< answer: its sentence; damaged, disconnected: why
};

/// The joystick's code at a time since the beginning, or nothing once the user has finished. Asked
/// every 2 ms; must not wait.
using Joystick = std::function<std::optional<std::uint8_t>(std::int64_t elapsed_ns)>;
/// Told of every event; must not wait.
using LinkEventSink = std::function<void(const LinkEvent&)>;

/// Plays the REX master unit until the user has finished, on the calling thread. A connection that
/// cannot be made or breaks is an event and is tried again. Reads the steady clock.
void run_link(const LinkClientConfig& config, const Joystick& joystick, const LinkEventSink& sink);

}  // namespace surefoot::rex_link

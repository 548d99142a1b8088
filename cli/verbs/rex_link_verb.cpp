// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "cli/json/service_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/interrupt.hpp"
#include "service/console/log.hpp"
#include "service/gate_process/sockets/token_file.hpp"
#include "service/live/joystick_script.hpp"
#include "service/live/keyboard_joystick.hpp"
#include "service/live/tone_player.hpp"
#include "service/rex_link/link_client.hpp"
#include "service/rex_link/rex_link.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {
namespace {

struct RexLinkOptions {
    CommonOptions common;
    std::string url = "ws://127.0.0.1:9090";
    std::string token_file;  ///< file with the rider's token; empty = connect without a token
    std::string script_file;
    bool keys = false;
    std::string tones_dir;  ///< folder of the tones; empty = no sound
    double step_s = 10.0;   ///< duration of a movement
};

using rex_link::LinkEvent;
using rex_link::LinkEventKind;

constexpr int kNameWidth = 13;  // width of the longest name of an event kind, plus a space

/// Returns the text of an event for the terminal, without the name of the event.
std::string words_of(const LinkEvent& event, const std::string& tone_file) {
    switch (event.kind) {
        case LinkEventKind::connected: return "";
        case LinkEventKind::disconnected:
        case LinkEventKind::damaged: return event.text;
        case LinkEventKind::joystick: return fmt::format("{}", event.command);
        case LinkEventKind::question:
            return fmt::format(
                "{}: may the machine make movement {}?", event.sequence, event.command);
        case LinkEventKind::answer:
            return fmt::format("{}: {}: {}", event.sequence, to_string(event.verdict), event.text);
        case LinkEventKind::inhibited: return to_string(event.inhibit);
        case LinkEventKind::tone:
            return fmt::format(
                "{}{}{}", to_string(event.tone), tone_file.empty() ? "" : " ", tone_file);
        case LinkEventKind::motion:
            return fmt::format(
                "{} for {:.1f} s", event.command, seconds_from_ns(event.duration_ns));
    }
    return "";
}

/// Returns a joystick that reads the script or the keyboard. The joystick returns an empty optional
/// when the script has ended or the user pressed Ctrl-C.
Result<rex_link::Joystick> make_joystick(const RexLinkOptions& options) {
    if (options.keys) {
        return rex_link::Joystick([keyboard = std::make_shared<KeyboardJoystick>()](std::int64_t) {
            return interrupted() ? std::nullopt : keyboard->poll();
        });
    }
    const auto text = io::read_file(options.script_file, io::limits::kSettingsBytes);
    if (!text) return text.error();
    auto script = parse_joystick_script(*text, options.script_file);
    if (!script) return script.error();
    return rex_link::Joystick(
        [lines = std::move(*script)](std::int64_t elapsed_ns) -> std::optional<std::uint8_t> {
            const bool over = lines.empty() || elapsed_ns > lines.back().time_ns;
            if (over || interrupted()) return std::nullopt;
            return code_at(lines, elapsed_ns);
        });
}

/// Returns true if the user requested a movement but no gate was ever connected.
bool nobody_to_ask(const std::vector<RexLinkRow>& rows) {
    const auto has = [&rows](LinkEventKind kind) {
        return std::any_of(rows.begin(), rows.end(), [kind](const RexLinkRow& row) {
            return row.event.kind == kind;
        });
    };
    return has(LinkEventKind::inhibited) && !has(LinkEventKind::connected);
}

/// `surefoot rex-link`: plays the REX side of the link to the gate. The name of the function ends
/// with _verb, because a namespace has the name rex_link.
int rex_link_verb(const RexLinkOptions& options) {
    if (options.keys == !options.script_file.empty())
        return report(
            usage_error("rex-link: give either --script FILE or --keys, and not both options"));
    const auto gate = rex_link::parse_gate_url(options.url);
    if (!gate) return report(usage_error("--url: " + gate.error().message));
    auto tones = TonePlayer::open(options.tones_dir);
    if (!tones) return report(tones.error());
    rex_link::LinkClientConfig config;
    config.gate = *gate;
    if (!options.token_file.empty()) {
        const auto access = gate_process::read_tokens(options.token_file);
        if (!access) return report(access.error());
        if (access->rider.empty())
            return report(usage_error(options.token_file +
                                      ": the file has no line with the token of the rider; give "
                                      "the token file that surefoot serve uses"));
        config.gate.show_token(access->rider);
    }
    config.link.step_duration_ns = ns_from_seconds(options.step_s);
    if (const auto problem = config.link.problem()) return report(usage_error(*problem));
    watch_for_interrupts();
    const auto joystick = make_joystick(options);
    if (!joystick) return report(joystick.error());

    std::vector<RexLinkRow> rows;
    rex_link::run_link(config, *joystick, [&](const LinkEvent& event) {
        const bool is_tone = event.kind == LinkEventKind::tone;
        rows.push_back({event, is_tone ? tones->file_of(event.tone) : ""});
        if (!options.common.json) {
            const std::string words = words_of(event, rows.back().tone_file);
            fmt::print("{:9.3f} s  {:<{}}{}\n",
                       seconds_from_ns(event.time_ns),
                       to_string(event.kind),
                       words.empty() ? 0 : kNameWidth,
                       words);
            std::fflush(stdout);
        }
        if (is_tone) tones->play(event.tone);
    });
    if (options.common.json) print_answer(rex_link_json(options.url, rows));
    if (nobody_to_ask(rows)) {
        log_error(
            fmt::format("no gate answered at {}, so the link allowed no movement; start surefoot "
                        "serve or surefoot-gate, or correct --url",
                        options.url));
        return kExitFailed;
    }
    return kExitOk;
}

}  // namespace

void add_rex_link(VerbGroup verbs) {
    auto [verb, o] = verbs.add<RexLinkOptions>(
        "rex-link",
        "act as the controller of a REX: ask the gate twice about each movement of the joystick, "
        "and move after the second OK; exit code 1 = a movement was asked for, but no gate "
        "answered",
        "surefoot rex-link --url ws://127.0.0.1:9090 --script "
        "service/rex_link/example_joystick.txt --tones service/rex_link/tones",
        rex_link_verb,
        Reads::no_settings);
    verb.option("--url",
                o.url,
                "WebSocket address of the gate, as an IP address or localhost (default "
                "ws://127.0.0.1:9090)")
        .value("ws://ADDRESS[:PORT][/PATH]");
    verb.option("--token-file",
                o.token_file,
                "token file that surefoot serve uses. With the token of the rider in this file, "
                "the gate keeps a connection slot for the link")
        .value("FILE");
    const Option script = verb.option("--script",
                                      o.script_file,
                                      "file of joystick codes: lines 'time_s code', or "
                                      "joystick.csv of a recording by 'surefoot sim'");
    script.value("FILE");
    verb.flag("--keys",
              o.keys,
              "steer with the keyboard: arrow keys or w a s d = step, q = turn left, e = turn "
              "right, space bar = rest, x = end")
        .excludes(script);
    verb.option("--tones",
                o.tones_dir,
                "folder of the tone files, which tools/tones makes. The verb plays them with the "
                "program aplay, if aplay is installed")
        .value("DIR");
    verb.option("--step-time", o.step_s, "duration of one movement of the REX, in s (default 10)")
        .value("S")
        .in(0.01, 60.0);
}

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#include "service/live/steered_walk.hpp"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <utility>

#include "service/console/option_settings.hpp"

namespace surefoot::app {
namespace {

constexpr std::int64_t kRest_ns = 400'000'000;  ///< pause between two movements
/// Pause before the next question, if the gate could not judge.
constexpr std::int64_t kRetry_ns = 500'000'000;
/// Longest time without a decision. Only an operator can re-arm a gate in state FAULT; a script
/// cannot.
constexpr std::int64_t kPatience_ns = 120'000'000'000;
/// The machine must stand still for this time before the next request, because the simulated body
/// still vibrates after a step.
constexpr double kSettled_s = 1.0;

class ScriptedWalker final : public Walker {
  public:
    explicit ScriptedWalker(std::vector<std::uint8_t> codes) : codes_(std::move(codes)) {}

    [[nodiscard]] std::optional<std::uint8_t> joystick(std::int64_t elapsed_ns) override {
        if (elapsed_ns < rest_until_ns_) return std::uint8_t{0};
        if (next_ == codes_.size()) return std::nullopt;
        return codes_[next_];
    }
    bool answered(const AskedStep& step, bool judged, std::int64_t elapsed_ns) override {
        const bool is_over = step.moved || judged;
        rest_until_ns_ = elapsed_ns + (is_over ? kRest_ns : kRetry_ns);
        if (is_over) {
            ++next_;
            unjudged_since_ns_.reset();
            return true;
        }
        if (!unjudged_since_ns_) unjudged_since_ns_ = elapsed_ns;
        if (elapsed_ns - *unjudged_since_ns_ < kPatience_ns) return false;
        next_ = codes_.size();
        return true;
    }

  private:
    std::vector<std::uint8_t> codes_;
    std::size_t next_ = 0;
    std::int64_t rest_until_ns_ = 0;
    std::optional<std::int64_t> unjudged_since_ns_;
};

/// Takes requests from a page. The user of the page decides whether to ask again.
class PageWalker final : public Walker {
  public:
    explicit PageWalker(page::Steering& steering) : steering_(steering) {}

    [[nodiscard]] std::optional<std::uint8_t> joystick(std::int64_t /*elapsed_ns*/) override {
        return steering_.command(steady_now_ns());
    }
    bool answered(const AskedStep& step, bool /*judged*/, std::int64_t /*elapsed_ns*/) override {
        steering_.tell({0, step.command, step.verdict, step.moved, step.text});
        return true;
    }

  private:
    page::Steering& steering_;
};

}  // namespace

std::unique_ptr<Walker> scripted_walker(std::vector<std::uint8_t> codes) {
    return std::make_unique<ScriptedWalker>(std::move(codes));
}

std::unique_ptr<Walker> page_walker(page::Steering& steering) {
    return std::make_unique<PageWalker>(steering);
}

Result<std::vector<std::uint8_t>> parse_walk(const std::string& text) {
    std::vector<std::uint8_t> codes;
    const char* at = text.data();
    const char* const end = at + text.size();
    const auto wrong = [&] {
        return usage_error(
            fmt::format("--walk {} is not a list of joystick codes; give codes from 0 to 255, for "
                        "example 9,9,17,25*12 (25*12 repeats code 25 twelve times)",
                        text));
    };
    while (at != end) {
        unsigned code = 0;
        unsigned times = 1;
        auto parsed = std::from_chars(at, end, code);
        if (parsed.ec != std::errc{} || code > 255) return wrong();
        if (parsed.ptr != end && *parsed.ptr == '*') {
            parsed = std::from_chars(parsed.ptr + 1, end, times);
            if (parsed.ec != std::errc{} || times == 0 || times > 1000) return wrong();
        }
        codes.insert(codes.end(), times, static_cast<std::uint8_t>(code));
        at = parsed.ptr;
        if (at == end) break;
        if (*at != ',' || ++at == end) return wrong();
    }
    if (codes.empty()) return wrong();
    return codes;
}

SteeredWalk::SteeredWalk(std::unique_ptr<Walker> walker,
                         std::uint16_t gate_port,
                         const std::string& rider_token,
                         std::shared_ptr<sim::CommandedMotion> motion)
    : walker_(std::move(walker)), motion_(std::move(motion)) {
    rex_link::LinkClientConfig config;
    config.gate.address = "127.0.0.1";
    config.gate.port = gate_port;
    config.gate.show_token(rider_token);
    // The simulator decides when a step has ended, because simulated time may run faster or slower
    // than real time.
    config.link.step_duration_ns = kRest_ns;
    thread_ = std::thread([this, config] {
        rex_link::run_link(
            config,
            [this](std::int64_t elapsed_ns) { return joystick(elapsed_ns); },
            [this](const rex_link::LinkEvent& event) { on_event(event); });
        over_ = true;
    });
}

SteeredWalk::~SteeredWalk() {
    stopped_ = true;
    thread_.join();
}

std::vector<AskedStep> SteeredWalk::news() {
    const std::lock_guard lock(mutex_);
    return std::exchange(news_, {});
}

bool SteeredWalk::is_walking() const {
    const double free_s = motion_->duration_s();
    return free_s > 0.0 && steer_from_s_ < free_s + kSettled_s;
}

std::optional<std::uint8_t> SteeredWalk::joystick(std::int64_t elapsed_ns) {
    elapsed_ns_ = elapsed_ns;
    if (stopped_) return std::nullopt;
    const auto code = is_walking() ? std::uint8_t{0} : walker_->joystick(elapsed_ns);
    if (!code) return std::nullopt;
    if (*code != asked_.command) asked_ = {*code, false, "-", ""};
    return code;
}

void SteeredWalk::on_event(const rex_link::LinkEvent& event) {
    switch (event.kind) {
        case rex_link::LinkEventKind::answer:
            asked_.verdict = to_string(event.verdict);
            asked_.text = event.text;
            break;
        case rex_link::LinkEventKind::inhibited:
            finish(false, event.inhibit == rex_link::Inhibit::not_traversable);
            break;
        case rex_link::LinkEventKind::motion: {
            const auto step = motion_->step(event.command, steer_from_s_);
            if (!step) asked_.text = step.error().message;
            finish(step.ok(), true);
            break;
        }
        default: break;
    }
}

void SteeredWalk::finish(bool moved, bool judged) {
    if (asked_.command == 0) return;
    asked_.moved = moved;
    if (walker_->answered(asked_, judged, elapsed_ns_)) {
        const std::lock_guard lock(mutex_);
        news_.push_back(asked_);
    }
}

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#include "apps/surefoot/steered_walk.hpp"

#include <fmt/format.h>

#include <charconv>
#include <utility>

namespace surefoot::app {
namespace {

constexpr std::int64_t kRest_ns = 400'000'000;   ///< between two movements
constexpr std::int64_t kRetry_ns = 500'000'000;  ///< where the gate cannot judge
/// The machine has stood still for so long before the next movement is asked for: the simulator's
/// frame rings after a step.
constexpr double kSettled_s = 1.0;

}  // namespace

Result<std::vector<std::uint8_t>> parse_walk(const std::string& text) {
    std::vector<std::uint8_t> codes;
    const char* at = text.data();
    const char* const end = at + text.size();
    const auto wrong = [&] {
        return usage_error(
            fmt::format("--walk {}: wanted are joystick codes like 9,9,17,25*12 (n times)", text));
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

SteeredWalk::SteeredWalk(std::vector<std::uint8_t> codes,
                         std::uint16_t gate_port,
                         std::shared_ptr<sim::CommandedMotion> motion)
    : codes_(std::move(codes)), motion_(std::move(motion)) {
    rex_link::LinkClientConfig config;
    config.gate.address = "127.0.0.1";
    config.gate.port = gate_port;
    // The simulator says when a step has ended: its time need not run as ours does.
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
    if (elapsed_ns < rest_until_ns_ || is_walking()) return std::uint8_t{0};
    if (next_ == codes_.size()) return std::nullopt;
    if (!asking_) {
        asking_ = true;
        asked_ = {codes_[next_], false, "-", ""};
    }
    return codes_[next_];
}

void SteeredWalk::on_event(const rex_link::LinkEvent& event) {
    switch (event.kind) {
        case rex_link::LinkEventKind::answer:
            asked_.verdict = to_string(event.verdict);
            asked_.text = event.text;
            break;
        case rex_link::LinkEventKind::inhibited:
            if (!asking_) break;
            if (event.inhibit == rex_link::Inhibit::not_traversable) {
                finish(false);
            } else {  // nothing was decided about the ground: ask again
                asking_ = false;
                rest_until_ns_ = elapsed_ns_ + kRetry_ns;
            }
            break;
        case rex_link::LinkEventKind::motion: {
            const auto step = motion_->step(event.command, steer_from_s_);
            if (!step) asked_.text = step.error().message;
            finish(step.ok());
            break;
        }
        default: break;
    }
}

void SteeredWalk::finish(bool moved) {
    asked_.moved = moved;
    asking_ = false;
    ++next_;
    rest_until_ns_ = elapsed_ns_ + kRest_ns;
    const std::lock_guard lock(mutex_);
    news_.push_back(asked_);
}

}  // namespace surefoot::app

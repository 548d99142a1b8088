// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "service/page/steering.hpp"
#include "service/rex_link/link_client.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/sim/motion/commanded_motion.hpp"

namespace surefoot::app {

/// Outcome of one requested movement.
struct AskedStep {
    std::uint8_t command = 0;
    bool moved = false;
    std::string verdict;  ///< verdict of the last answer; "-" = no answer came
    std::string text;
};

/// Source of movement requests. Only the thread of the walk calls it.
class Walker {
  public:
    virtual ~Walker() = default;
    /// Returns the joystick code; 0 = at rest; empty = no more requests. Called while the machine
    /// stands. `elapsed_ns`: time since the walk began.
    [[nodiscard]] virtual std::optional<std::uint8_t> joystick(std::int64_t elapsed_ns) = 0;
    /// Reports the outcome of a request. `judged`: the gate decided about the ground, with yes or
    /// no. Returns true if SteeredWalk::news() shall contain this outcome.
    virtual bool answered(const AskedStep& step, bool judged, std::int64_t elapsed_ns) = 0;
};

/// Returns a walker that requests the movements in order. If the gate cannot judge, for example
/// while it warms up, the walker waits and asks again. After a refusal it continues with the next
/// movement. After two minutes without a decision it stops.
[[nodiscard]] std::unique_ptr<Walker> scripted_walker(std::vector<std::uint8_t> codes);
/// Returns a walker that takes its requests from the joystick of a web page.
[[nodiscard]] std::unique_ptr<Walker> page_walker(page::Steering& steering);

/// Reads a list of joystick codes such as "9,9,17,25*12"; x*n repeats code x n times.
[[nodiscard]] Result<std::vector<std::uint8_t>> parse_walk(const std::string& text);

/// Connects a walker, a REX link that asks the gate, and a simulated REX that moves when the link
/// allows it. Runs on its own thread.
class SteeredWalk {
  public:
    SteeredWalk(std::unique_ptr<Walker> walker,
                std::uint16_t gate_port,
                const std::string& rider_token,
                std::shared_ptr<sim::CommandedMotion> motion);
    SteeredWalk(const SteeredWalk&) = delete;
    SteeredWalk& operator=(const SteeredWalk&) = delete;
    /// Stops the walk and waits for the end of its thread.
    ~SteeredWalk();

    /// Call before the next frame is exposed. Movements start at `time_s` of the motion or later.
    void next_frame_begins(double time_s) noexcept { steer_from_s_ = time_s; }
    /// Returns true after the last request, when the machine stands. Thread-safe.
    [[nodiscard]] bool is_over() const noexcept { return over_; }
    /// Returns and clears the outcomes since the last call. Thread-safe.
    [[nodiscard]] std::vector<AskedStep> news();

  private:
    [[nodiscard]] std::optional<std::uint8_t> joystick(std::int64_t elapsed_ns);
    void on_event(const rex_link::LinkEvent& event);
    void finish(bool moved, bool judged);
    [[nodiscard]] bool is_walking() const;

    std::unique_ptr<Walker> walker_;
    std::shared_ptr<sim::CommandedMotion> motion_;
    std::atomic<double> steer_from_s_{0.0};
    std::atomic<bool> stopped_{false};
    std::atomic<bool> over_{false};

    // Only the thread of the walk uses these members.
    std::int64_t elapsed_ns_ = 0;
    AskedStep asked_;  ///< command 0 = no request

    std::mutex mutex_;
    std::vector<AskedStep> news_;
    std::thread thread_;
};

}  // namespace surefoot::app

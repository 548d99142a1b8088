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

/// What became of one movement that the user asked for.
struct AskedStep {
    std::uint8_t command = 0;
    bool moved = false;
    std::string verdict;  ///< of the last answer; "-" where none came
    std::string text;
};

/// Who asks for movements. Called by the walk's thread alone.
class Walker {
  public:
    virtual ~Walker() = default;
    /// What the joystick says, 0 = at rest; nothing when no more will be asked. Asked while the
    /// machine stands. `elapsed_ns`: since the walk began.
    [[nodiscard]] virtual std::optional<std::uint8_t> joystick(std::int64_t elapsed_ns) = 0;
    /// The movement was made or not; `judged`: the gate said yes or no to the ground. True where
    /// that is news to tell.
    virtual bool answered(const AskedStep& step, bool judged, std::int64_t elapsed_ns) = 0;
};

/// One movement after the other: where the gate cannot judge (it warms up), waits and asks again;
/// where it says no, goes on with the next. Where it could not judge for two minutes, gives up: the
/// last answer is told, and no more is asked.
[[nodiscard]] std::unique_ptr<Walker> scripted_walker(std::vector<std::uint8_t> codes);
/// Whoever holds the joystick on a page.
[[nodiscard]] std::unique_ptr<Walker> page_walker(page::Steering& steering);

/// "9,9,17,25*12" -> joystick codes in turn, x*n = n times.
[[nodiscard]] Result<std::vector<std::uint8_t>> parse_walk(const std::string& text);

/// A user who asks for movements, a REX link that asks the gate, and the simulated REX that moves
/// when the link says so. Runs on a thread of its own.
class SteeredWalk {
  public:
    SteeredWalk(std::unique_ptr<Walker> walker,
                std::uint16_t gate_port,
                const std::string& rider_token,
                std::shared_ptr<sim::CommandedMotion> motion);
    SteeredWalk(const SteeredWalk&) = delete;
    SteeredWalk& operator=(const SteeredWalk&) = delete;
    /// Ends the thread.
    ~SteeredWalk();

    /// Before the next frame is exposed: a step may begin at `time_s` of the motion or later.
    void next_frame_begins(double time_s) noexcept { steer_from_s_ = time_s; }
    /// All was asked, and the machine stands.
    [[nodiscard]] bool is_over() const noexcept { return over_; }
    /// What was asked and answered since the last call.
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

    // Of the thread.
    std::int64_t elapsed_ns_ = 0;
    AskedStep asked_;  ///< command 0: nothing is asked for

    std::mutex mutex_;
    std::vector<AskedStep> news_;
    std::thread thread_;
};

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "service/gate_process/gatekeeper.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/io/settings/machine_file.hpp"

namespace surefoot::experiments {

inline constexpr std::int64_t kMs = 1'000'000;
inline constexpr std::int64_t kNever_ns = std::numeric_limits<std::int64_t>::max();
inline constexpr std::int64_t kFramePeriod_ns = 1'000'000'000 / 15;

/// A gate that is ready after half a second: most faults come later, and the warm-up of 2 s would
/// be most of a run. Faults of the warm-up itself get the real one.
[[nodiscard]] gate::ReadinessLimits fast_warm_up();

/// What one injection gave. All times are simulated.
struct Outcome {
    std::string variant;     ///< what was drawn, in words
    int asked_before = 0;    ///< while all was well
    int allowed_before = 0;  ///< all of them, or the injection does not count
    int asked_after = 0;     ///< while the fault lasted
    int allowed_late = 0;    ///< of these OK after the deadline, or after the first inhibit
    std::int64_t last_allowed_ns = -1;         ///< the last OK, since the fault; -1 = none
    std::optional<std::int64_t> latency_ns;    ///< from the fault to the first inhibit
    gate::Reason reason = gate::Reason::none;  ///< first one of that, but for NOT_READY
};

/// The gate process in simulated time: the gatekeeper, polled every 10 ms, and a client that asks
/// as often. Snapshots come through the channel that perception uses. As soon as the gate is ready
/// an operator vouches (if wanted), a movement that is allowed is chosen, and the moment of the
/// fault is drawn; then every answer is counted.
class GateBench {
  public:
    struct Plan {
        /// ERROR must come so soon after the fault; 0 = at once.
        std::int64_t deadline_ns = 250 * kMs;
        std::int64_t lasts_ns = 500 * kMs;  ///< the run ends so long after the fault
        std::int64_t watched_on_ns = 0;     ///< or so long after the first inhibit; 0 = not sooner
        bool faulty = true;                 ///< false: a control run, nothing happens
        bool from_the_start = false;        ///< the fault is there before anything else
        double vouch_radius_m = 0.0;        ///< 0 = nobody vouches
        /// All movements of the machine are right, or only the short ones that stay on ground
        /// that was vouched for, or only those ahead.
        bool any_movement = true;
        bool forward_only = false;
        std::int64_t fault_ns_since_start = 0;  ///< 0 = drawn when the gate is ready
    };
    struct Heard {
        bool allowed = false;
        gate::Reason reason = gate::Reason::internal;
    };
    /// Asks the gate; `faulty` tells whether the fault is there.
    using Ask = std::function<Heard(std::int64_t now_ns, bool faulty)>;

    GateBench(const Machine& machine,
              const gate::ReadinessLimits& limits,
              const Plan& plan,
              std::uint64_t seed);
    ~GateBench();
    GateBench(const GateBench&) = delete;
    GateBench& operator=(const GateBench&) = delete;

    /// Instead of asking for a step by `ask_step`.
    void set_ask(Ask ask) { ask_ = std::move(ask); }
    /// Called once, at the first poll of the fault.
    void set_begin(std::function<void()> begin) { begin_ = std::move(begin); }

    /// Lets time pass. Does nothing for a time that is over.
    void pass_until(std::int64_t time_ns);
    [[nodiscard]] std::int64_t now_ns() const noexcept { return now_ns_; }
    [[nodiscard]] bool is_over() const noexcept { return now_ns_ >= end_ns_; }
    [[nodiscard]] std::int64_t fault_ns() const noexcept { return fault_ns_; }
    [[nodiscard]] bool is_faulty(std::int64_t time_ns) const noexcept {
        return time_ns >= fault_ns_;
    }

    /// The gate process is started anew; its client asks on.
    void restart_gate();
    /// The clocks that the gate reads: steady time jumps, and the computer slept.
    void step_clock(std::int64_t by_ns) noexcept { clock_step_ns_ += by_ns; }
    void sleep(std::int64_t by_ns) noexcept { slept_ns_ += by_ns; }

    [[nodiscard]] Heard ask_step(std::int64_t now_ns);
    [[nodiscard]] Heard ask_step(std::uint64_t sequence, std::uint8_t command, std::int64_t now_ns);
    [[nodiscard]] std::uint64_t sequence() const noexcept { return sequence_; }
    [[nodiscard]] wire::Gatekeeper& keeper() noexcept { return *keeper_; }
    [[nodiscard]] wire::SnapshotWriter& writer() noexcept { return *writer_; }
    [[nodiscard]] std::uint8_t command() const noexcept { return command_; }
    /// Is told every verdict.
    void set_audit(wire::Gatekeeper::Audit audit) { audit_ = std::move(audit); }

    /// Movements that are asked about; a bench that has no gate yet can be told.
    void set_command(std::uint8_t command) noexcept { command_ = command; }
    [[nodiscard]] Outcome& outcome() noexcept { return outcome_; }

  private:
    void start_gate();
    void tick();
    void begin_watching();
    void count(const Heard& heard);

    Machine machine_;
    gate::ReadinessLimits limits_;
    Plan plan_;
    Rng rng_;
    std::string path_;
    std::optional<wire::SnapshotWriter> writer_;
    wire::Gatekeeper::Audit audit_;
    std::unique_ptr<wire::Gatekeeper> keeper_;
    Ask ask_;
    std::function<void()> begin_;
    std::int64_t now_ns_;
    std::int64_t next_tick_ns_;
    std::int64_t end_ns_;
    std::int64_t fault_ns_ = kNever_ns;
    std::int64_t clock_step_ns_ = 0;
    std::int64_t slept_ns_ = 0;
    std::uint64_t sequence_ = 0;
    std::uint8_t command_ = 0;
    bool watching_ = false;
    bool begun_ = false;
    Outcome outcome_;
};

/// What is injected, and where.
struct Injection {
    std::string hazard;    ///< number in the hazard table: "H1"
    std::string cause;     ///< in words
    std::string level;     ///< where it comes in
    bool is_error = true;  ///< ERROR is due; else NOT_TRAVERSABLE
    std::string drawn;     ///< what is drawn
    /// One run; not `faulty`: its control. Errors are those of scenes and files.
    std::function<Result<Outcome>(std::uint64_t seed, bool faulty)> run;
    /// The fault is there before the gate starts: only the control runs show that it would say OK.
    bool from_the_start = false;
};

/// At the channel, the clock, the configuration and the client of the gate.
[[nodiscard]] std::vector<Injection> gate_injections(const io::MachineFile& file);
/// At the frames of a camera, through the whole of perception, as `surefoot serve` drives it.
/// `scenes`: how many different recordings they are spread over.
[[nodiscard]] std::vector<Injection> frame_injections(const io::MachineFile& file, int scenes);

}  // namespace surefoot::experiments

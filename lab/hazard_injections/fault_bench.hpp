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

/// Limits of a gate that is ready after 0.5 s and 5 frames. The default warm-up of 2 s would take
/// most of a run. Injections into the warm-up itself use the default limits.
[[nodiscard]] gate::ReadinessLimits fast_warm_up();

/// Result of one run. All times are simulated.
struct Outcome {
    std::string variant;     ///< description of the drawn fault
    int asked_before = 0;    ///< number of queries before the fault
    int allowed_before = 0;  ///< number of OKs before the fault; the run counts only if all were OK
    int asked_after = 0;     ///< number of queries after the fault began
    int allowed_late = 0;    ///< number of OKs after the deadline or the first inhibit
    std::int64_t last_allowed_ns = -1;  ///< time from the fault to the last OK; -1 = none after it
    std::optional<std::int64_t> latency_ns;    ///< time from the fault to the first inhibit
    gate::Reason reason = gate::Reason::none;  ///< most specific reason of the first inhibit
};

/// The gate process in simulated time: a gatekeeper that is polled every 10 ms, and a client that
/// asks at the same rate. Snapshots pass through the channel of perception. When the gate is ready,
/// the bench makes the operator attestation of the plan, if any. Then it chooses an allowed
/// movement, draws the time of the fault, and counts every answer.
///
/// Not thread-safe. The channel is a file in /dev/shm that the destructor removes; the program
/// exits with a message if the file cannot be created.
class GateBench {
  public:
    struct Plan {
        /// Time from the fault after which every answer must be an inhibit; 0 = at once.
        std::int64_t deadline_ns = 250 * kMs;
        std::int64_t lasts_ns = 500 * kMs;  ///< time from the fault to the end of the run
        std::int64_t watched_on_ns = 0;     ///< run time after the first inhibit; 0 = no early end
        bool faulty = true;                 ///< false: a control run without a fault
        bool from_the_start = false;        ///< true: the fault exists before the gate starts
        double attestation_radius_m = 0.0;  ///< radius of the attested area; 0 = no attestation
        /// false: choose only among movements of at most 0.2 m, which stay on attested ground.
        bool any_movement = true;
        bool forward_only = false;              ///< true: use only movements of over 0.19 m ahead
        std::int64_t fault_ns_since_start = 0;  ///< 0 = at random after the gate became ready
    };
    /// The gate's answer as the client receives it.
    struct Heard {
        bool allowed = false;
        gate::Reason reason = gate::Reason::internal;
    };
    /// Asks the gate at the time `now_ns` of its clock. `faulty`: the fault has begun.
    using Ask = std::function<Heard(std::int64_t now_ns, bool faulty)>;

    GateBench(const Machine& machine,
              const gate::ReadinessLimits& limits,
              const Plan& plan,
              std::uint64_t seed);
    ~GateBench();
    GateBench(const GateBench&) = delete;
    GateBench& operator=(const GateBench&) = delete;

    /// Replaces the client's question, which is `ask_step` by default.
    void set_ask(Ask ask) { ask_ = std::move(ask); }
    /// Sets the function that is called once, at the first poll after the fault began.
    void set_begin(std::function<void()> begin) { begin_ = std::move(begin); }

    /// Advances simulated time to `time_ns`, or to the end of the run if that is earlier. Does
    /// nothing if `time_ns` is in the past.
    void pass_until(std::int64_t time_ns);
    [[nodiscard]] std::int64_t now_ns() const noexcept { return now_ns_; }
    [[nodiscard]] bool is_over() const noexcept { return now_ns_ >= end_ns_; }
    [[nodiscard]] std::int64_t fault_ns() const noexcept { return fault_ns_; }
    [[nodiscard]] bool is_faulty(std::int64_t time_ns) const noexcept {
        return time_ns >= fault_ns_;
    }

    /// Restarts the gate process; the client continues to ask.
    void restart_gate();
    /// Shift the clocks that the gate reads. `step_clock` shifts the steady and the boot clock.
    /// `sleep` shifts only the boot clock, as when the computer was suspended.
    void step_clock(std::int64_t by_ns) noexcept { clock_step_ns_ += by_ns; }
    void sleep(std::int64_t by_ns) noexcept { slept_ns_ += by_ns; }

    [[nodiscard]] Heard ask_step(std::int64_t now_ns);
    [[nodiscard]] Heard ask_step(std::uint64_t sequence, std::uint8_t command, std::int64_t now_ns);
    [[nodiscard]] std::uint64_t sequence() const noexcept { return sequence_; }
    [[nodiscard]] gate_process::Gatekeeper& keeper() noexcept { return *keeper_; }
    [[nodiscard]] gate_process::SnapshotWriter& writer() noexcept { return *writer_; }
    [[nodiscard]] std::uint8_t command() const noexcept { return command_; }
    /// Sets the function that receives every verdict.
    void set_audit(gate_process::Gatekeeper::Audit audit) { audit_ = std::move(audit); }

    /// Sets the movement that the client asks for. Needed if the fault exists from the start.
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
    std::optional<gate_process::SnapshotWriter> writer_;
    gate_process::Gatekeeper::Audit audit_;
    std::unique_ptr<gate_process::Gatekeeper> keeper_;
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

/// One kind of fault and the function that runs it.
struct Injection {
    std::string hazard;    ///< hazard id such as "H1"; see docs/reference/hazards.md
    std::string cause;     ///< cause of the fault in one line of text
    std::string level;     ///< interface where the fault is injected
    bool is_error = true;  ///< expected decision: true = ERROR; false = NOT_TRAVERSABLE
    std::string drawn;     ///< quantities that the seed draws
    /// Makes one run; `faulty` = false makes its control run. Error: a scene or file cannot be
    /// read.
    std::function<Result<Outcome>(std::uint64_t seed, bool faulty)> run;
    /// The fault exists before the gate starts. Only the control runs then show that the gate would
    /// answer OK without it.
    bool from_the_start = false;
};

/// Faults at the channel, the clock, the configuration and the client of the gate.
[[nodiscard]] std::vector<Injection> gate_injections(const io::MachineFile& file);
/// Faults in camera frames. They pass through the whole perception pipeline, which runs as in
/// `surefoot serve`. `scenes`: number of different recordings to use.
[[nodiscard]] std::vector<Injection> frame_injections(const io::MachineFile& file, int scenes);

}  // namespace surefoot::experiments

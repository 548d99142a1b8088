// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/machine.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/grid/map_snapshot.hpp"
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"
#include "surefoot/sim/scenes/truth.hpp"

namespace surefoot::app {

/// The part of a movement's ground that both cameras saw on the way (sim::SeenGround).
enum class InView : std::uint8_t {
    none,
    zone,      ///< feet, ways and drop bands
    with_body  ///< these, and the ground below the space that the body enters
};

/// Compares the gate's verdicts with the truth. A question is borderline if its truth changes
/// within the margin of a good map (see sim::SafetyMargin). Borderline questions are counted
/// separately, because the gate may be more careful there.
struct VerdictCounts {
    int safe = 0;               ///< clear-cut questions whose true answer is "safe"
    int safe_ok = 0;            ///< clear-cut safe questions with the answer OK
    int seen = 0;               ///< clear-cut safe questions whose zone was in view on the way
    int seen_ok = 0;            ///< such questions with the answer OK
    int body_seen = 0;          ///< of `seen`: also the ground below the body was in view
    int body_seen_ok = 0;       ///< such questions with the answer OK
    int unsafe = 0;             ///< clear-cut questions that are truly dangerous
    int unsafe_ok = 0;          ///< clear-cut dangerous questions with OK: the missed hazards
    int borderline = 0;         ///< borderline questions (not clear-cut)
    int borderline_ok = 0;      ///< borderline questions with the answer OK
    int borderline_missed = 0;  ///< borderline questions with OK although truly dangerous

    /// Counts one question.
    void add(bool truly_safe, bool clear_cut, InView in_view, bool allowed);
};

/// Kind of name by which wrong verdicts are counted.
enum class TallyKey : std::uint8_t {
    reason,  ///< refused clear-cut safe movements, by the reasons of the gate
    proof,   ///< refused clear-cut safe movements, by the proofs that failed
    danger,  ///< missed hazards, by the true danger
    seen,    ///< like `reason`, for movements whose zone was in view on the way (sim::SeenGround)
};
inline constexpr const char* kTallyKeyNames[] = {"reason", "proof", "danger", "seen_reason"};

/// Numbers of wrong verdicts with one name.
struct VerdictTally {
    TallyKey by = TallyKey::reason;
    std::string name;
    int named = 0;  ///< number of verdicts with this name
    int alone = 0;  ///< number of verdicts with only this name: this name alone made them wrong

    friend bool operator==(const VerdictTally&, const VerdictTally&) = default;
};

/// Sums of tallies with equal key and name, sorted by key and name.
class VerdictTallies {
  public:
    /// Counts one wrong verdict under each of its names.
    void add(TallyKey by, std::span<const std::string_view> words);
    void add(const VerdictTally& tally);
    /// Counts a refusal under its reasons and under the proofs that failed.
    void add_refusal(const gate::Verdict& verdict, bool seen);
    [[nodiscard]] const std::vector<VerdictTally>& all() const noexcept { return all_; }

  private:
    [[nodiscard]] VerdictTally& of(TallyKey by, std::string_view name);

    std::vector<VerdictTally> all_;
};

/// Returns the names of the dangers, most important first.
[[nodiscard]] std::vector<std::string_view> names_of(const sim::SafetyAnswer& answer);

/// A question to the gate, and its true answer.
struct GateQuestion {
    gate::Query query;              ///< with an attestation for the ground under the standing feet
    Pose T_world_body;              ///< true pose of base_link
    InView in_view = InView::none;  ///< none if the movement is dangerous
    sim::SafetyAnswer truth;
};
/// Returns a question for every movement of the machine at its present pose and at poses around it,
/// where the machine can stand: 0.2 m apart, within `reach_m`, with the present yaw. An operator
/// attestation covers unmeasured ground under the standing feet, as in attest_start(). `here`: true
/// pose of the machine at the last frame of the map.
[[nodiscard]] std::vector<GateQuestion> questions_around(const sim::SceneTruth& truth,
                                                         const StampedPose& here,
                                                         const Machine& machine,
                                                         const grid::MapSnapshot& map,
                                                         double reach_m);

/// The gate's answers to all questions around one pose.
struct AroundAnswers {
    VerdictCounts counts;
    VerdictTallies tallies;
    std::vector<std::string> missed;  ///< one sentence for each clear-cut missed hazard
};
/// Asks the gate questions_around() the pose `here`.
[[nodiscard]] AroundAnswers compare_verdicts(const sim::SceneTruth& truth,
                                             const StampedPose& here,
                                             const Machine& machine,
                                             const grid::MapSnapshot& map,
                                             double reach_m);

}  // namespace surefoot::app

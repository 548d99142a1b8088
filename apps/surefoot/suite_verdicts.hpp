// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/machine.hpp"
#include "surefoot/gate/verdict.hpp"
#include "surefoot/grid/map_snapshot.hpp"
#include "surefoot/sim/scenes/truth.hpp"

namespace surefoot::app {

/// Verdicts of the gate beside what is true. Questions whose truth changes within the margin of a
/// good map (see sim::SafetyMargin) are counted apart: there the gate may be more careful.
struct VerdictCounts {
    int safe = 0;               ///< clear-cut questions whose true answer is "safe" ...
    int safe_ok = 0;            ///< ... and the gate said OK
    int unsafe = 0;             ///< clear-cut and truly dangerous ...
    int unsafe_ok = 0;          ///< ... and the gate said OK: a missed hazard
    int borderline = 0;         ///< not clear-cut
    int borderline_ok = 0;      ///< of these OK
    int borderline_missed = 0;  ///< OK although the exact truth says dangerous

    /// Counts one question.
    void add(bool truly_safe, bool clear_cut, bool allowed);
};

/// What the wrong answers of a case are counted by.
enum class TallyKey : std::uint8_t {
    reason,  ///< clearly safe movements refused, by the gate's reasons
    proof,   ///< the same, by the proofs that did not hold: where it looked in vain
    danger,  ///< missed hazards, by what is truly dangerous
};
inline constexpr const char* kTallyKeyNames[] = {"reason", "proof", "danger"};

/// How often one word came up among the wrong answers of one key.
struct VerdictTally {
    TallyKey by = TallyKey::reason;
    std::string name;
    int named = 0;  ///< with or without others
    int alone = 0;  ///< and no other word: the answer would have been right but for this one

    friend bool operator==(const VerdictTally&, const VerdictTally&) = default;
};

/// Adds up by key and name; in the order of key and name.
class VerdictTallies {
  public:
    /// Counts one answer by all its words.
    void add(TallyKey by, std::span<const std::string_view> words);
    void add(const VerdictTally& tally);
    /// Counts a refusal by its reasons and by what it could not prove.
    void add_refusal(const gate::Verdict& verdict);
    [[nodiscard]] const std::vector<VerdictTally>& all() const noexcept { return all_; }

  private:
    [[nodiscard]] VerdictTally& of(TallyKey by, std::string_view name);

    std::vector<VerdictTally> all_;
};

struct AroundAnswers {
    VerdictCounts counts;
    VerdictTallies tallies;
    std::vector<std::string> missed;  ///< a sentence for each hazard that was clear and allowed
};

/// Asks the gate for every movement of the machine at where it stands, and at places around it
/// that it could have walked to: 0.2 m apart, within `reach_m`, with the yaw of the present pose.
/// Ground under the standing feet is vouched for where nothing was measured, as offline.
[[nodiscard]] AroundAnswers compare_verdicts(const sim::SceneTruth& truth,
                                             const Pose& T_world_body_true,
                                             const Machine& machine,
                                             const grid::MapSnapshot& map,
                                             double reach_m);

}  // namespace surefoot::app

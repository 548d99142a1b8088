// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "studies/suite/suite_verdicts.hpp"
#include "surefoot/core/machine.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/grid/map_snapshot.hpp"
#include "surefoot/sim/scenes/truth.hpp"

namespace surefoot::app {

/// A step that the user of a walking machine requested. Holds the truth, and the verdict that the
/// gate gave with the map and the pose of that moment.
struct SuiteStep {
    int number = 0;  ///< number of the step on the path, from 1
    double time_s = 0.0;
    int command = 0;
    bool safe = false;       ///< true = the step is truly safe
    bool clear_cut = false;  ///< the truth holds by more than sim::SafetyMargin
    bool seen = false;       ///< safe, and its zone was in view on the way (sim::SeenGround)
    std::string dangers;     ///< dangers of the step, joined by '|'; empty if safe
    std::string decision;    ///< "OK", "NOT_TRAVERSABLE" or "ERROR"
    std::string reasons;     ///< reasons of the gate, joined by '|'; empty for OK

    [[nodiscard]] bool allowed() const { return decision == "OK"; }
    friend bool operator==(const SuiteStep&, const SuiteStep&) = default;
};

[[nodiscard]] VerdictCounts count_verdicts(std::span<const SuiteStep> steps);

/// Asks the gate and the safety oracle before each step of a walking machine. An operator
/// attestation covers the largest disc around the start that is truly level (within 10 mm), up to
/// the limit of the machine file. It ends for good when the machine leaves that disc.
class StepQuestions {
  public:
    /// `truth` and `machine` must outlive this object.
    StepQuestions(const sim::SceneTruth& truth, const Machine& machine)
        : truth_(truth), machine_(machine) {}

    /// Returns true if the next step begins before the frame that follows the one at `frame_ns`.
    [[nodiscard]] bool due(std::int64_t frame_ns) const;
    /// Asks about the next step with the current map.
    void ask(const grid::MapSnapshot& map);

    [[nodiscard]] const std::vector<SuiteStep>& steps() const noexcept { return steps_; }

  private:
    [[nodiscard]] gate::Query query_of(const sim::StepEvent& step, const grid::MapSnapshot& map);
    [[nodiscard]] bool is_seen(const sim::StepEvent& step, const gate::Query& query) const;

    const sim::SceneTruth& truth_;
    const Machine& machine_;
    std::optional<gate::AttestedArea> attested_;
    std::vector<SuiteStep> steps_;
};

}  // namespace surefoot::app

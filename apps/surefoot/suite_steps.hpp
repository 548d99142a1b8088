// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/surefoot/suite_verdicts.hpp"
#include "surefoot/core/machine.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/grid/map_snapshot.hpp"
#include "surefoot/sim/scenes/truth.hpp"

namespace surefoot::app {

/// A step that the user of a walking machine asked for: what is true about it, and what the gate
/// said with the map and the pose of that moment.
struct SuiteStep {
    int number = 0;  ///< 1 = the first of the way
    double time_s = 0.0;
    int command = 0;
    bool safe = false;       ///< truly
    bool clear_cut = false;  ///< and by more than the margin (see sim::SafetyMargin)
    std::string dangers;     ///< joined by '|'; empty when safe
    std::string decision;    ///< "OK", "NOT_TRAVERSABLE", "ERROR"
    std::string reasons;     ///< of the gate, joined by '|'; empty for OK

    [[nodiscard]] bool allowed() const { return decision == "OK"; }
    friend bool operator==(const SuiteStep&, const SuiteStep&) = default;
};

[[nodiscard]] VerdictCounts count_verdicts(std::span<const SuiteStep> steps);

/// Asks the gate, and the oracle beside it, before each step of a walking machine. An operator
/// answers for the start: for the largest area around it that is truly level (within 10 mm) and
/// that the machine file allows. Outside of it the word is forgotten for good.
class StepQuestions {
  public:
    /// Both must outlive this.
    StepQuestions(const sim::SceneTruth& truth, const Machine& machine)
        : truth_(truth), machine_(machine) {}

    /// Does the next step begin before another frame than that of `frame_ns` could be seen?
    [[nodiscard]] bool due(std::int64_t frame_ns) const;
    /// Asks for that step with the map as of now.
    void ask(const grid::MapSnapshot& map);

    [[nodiscard]] const std::vector<SuiteStep>& steps() const noexcept { return steps_; }

  private:
    [[nodiscard]] gate::Query query_of(const sim::StepEvent& step, const grid::MapSnapshot& map);

    const sim::SceneTruth& truth_;
    const Machine& machine_;
    std::optional<gate::VouchedArea> vouched_;
    std::vector<SuiteStep> steps_;
};

}  // namespace surefoot::app

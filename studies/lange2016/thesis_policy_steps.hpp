// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "studies/lange2016/thesis_figures.hpp"
#include "studies/suite/suite_steps.hpp"
#include "surefoot/pipeline/pipeline.hpp"

namespace surefoot::app {

/// Returns true if the reference thesis (Lange 2016; surefoot/eval/maps/thesis_policy) allows a
/// movement of the machine at a pose in the frame of the map.
[[nodiscard]] bool thesis_allows(const Machine& machine,
                                 const grid::GridGeometry& geometry,
                                 ImageView<const float> rating,
                                 const Pose& T_odom_body,
                                 int command);

/// Collects the verdicts of the gate and of the thesis query, for each step of a walk and for every
/// movement at its end.
class PolicySteps {
  public:
    /// `truth` and `machine` must outlive this object.
    PolicySteps(const sim::SceneTruth& truth, const Machine& machine)
        : truth_(truth), machine_(machine), steps_(truth, machine) {}

    /// Returns true if the next step begins before the frame that follows the one at `frame_ns`.
    [[nodiscard]] bool due(std::int64_t frame_ns) const { return steps_.due(frame_ns); }
    /// Asks about the next step with the current map.
    void ask(const pipeline::Pipeline& pipeline, const grid::MapSnapshot& map);
    /// Asks about every movement at the end of the path. `frame`: index of the last
    /// processed frame in the truth.
    void ask_all(std::size_t frame,
                 const pipeline::Pipeline& pipeline,
                 const grid::MapSnapshot& map);
    /// Sets steps, steps_allowed (share of the truly safe steps), dangers and dangers_allowed.
    /// `gate`: true = verdicts of the gate, false = verdicts of the thesis query. Borderline
    /// questions count only in `steps`.
    void add_to(bool gate, ThesisFigures& figures) const;

  private:
    struct Answer {
        bool safe = false;
        bool clear_cut = false;
        bool of_way = false;
        bool gate = false;
        bool thesis = false;
    };

    const sim::SceneTruth& truth_;
    const Machine& machine_;
    StepQuestions steps_;
    std::vector<Answer> answers_;
};

}  // namespace surefoot::app

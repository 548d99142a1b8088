// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/surefoot/suite_steps.hpp"
#include "apps/surefoot/thesis_figures.hpp"
#include "surefoot/pipeline/pipeline.hpp"

namespace surefoot::app {

/// The step query of the thesis (surefoot/eval/maps/thesis_policy) for a movement of the machine
/// that stands at a pose in the frame of the map.
[[nodiscard]] bool thesis_allows(const Machine& machine,
                                 const grid::GridGeometry& geometry,
                                 ImageView<const float> rating,
                                 const Pose& T_odom_body,
                                 int command);

/// What the gate, and the query of the thesis beside it, say to each step of a walk and to every
/// movement at its end.
class PolicySteps {
  public:
    /// Both must outlive this.
    PolicySteps(const sim::SceneTruth& truth, const Machine& machine)
        : truth_(truth), machine_(machine), steps_(truth, machine) {}

    [[nodiscard]] bool due(std::int64_t frame_ns) const { return steps_.due(frame_ns); }
    /// Asks for the next step with the map as of now.
    void ask(const pipeline::Pipeline& pipeline, const grid::MapSnapshot& map);
    /// At the end of the way, for every movement; `frames`: how many there were.
    void ask_all(std::size_t frames,
                 const pipeline::Pipeline& pipeline,
                 const grid::MapSnapshot& map);
    /// steps, steps_allowed (share of the truly safe ones), dangers, dangers_allowed, by the gate
    /// or by the query of the thesis. Questions near to the border of what is safe are left out.
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

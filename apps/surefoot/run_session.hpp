// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/surefoot/eyes_check.hpp"
#include "apps/surefoot/place_session.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/sim_truth.hpp"
#include "surefoot/camera/frame_source.hpp"
#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/pipeline/pipeline.hpp"

namespace surefoot::app {

/// What a run did, frame by frame, and how it ended.
struct RunRecord {
    camera::SourceInfo source;
    camera::StereoRig rig;
    std::vector<FrameReport> frames;
    FusionCounts fusion;         ///< summed over all frames
    ArrivalCounts arrivals;      ///< likewise
    int waited_frames = 0;       ///< before the first of `frames`, see pipeline/start.hpp
    std::optional<Error> error;  ///< why it ended early
    GreyImage last_left;         ///< rectified, for the report
    camera::DepthImage last_depth;
    std::optional<TruthFigures> truth;  ///< simulated sources only
    std::optional<PlaceRecord> place;   ///< `run --place` only
    double wall_s = 0.0;

    [[nodiscard]] bool complete() const noexcept { return !error.has_value(); }
};

/// Poses of a frame that is fixed to the body, in odom; base_link itself by default.
[[nodiscard]] Trajectory trajectory_of(std::span<const FrameReport> frames,
                                       const Pose& T_body_fixed = Pose{});

/// Drives a pipeline over a source: buffers the first frames for the alignment, then processes
/// every frame. Stops at the first error of the source, when its eyes are exchanged, or when the
/// user interrupts; what was computed before stays in `record` and in the pipeline's map.
class RunSession {
  public:
    /// `rig`: the source's with its mount, as the pipeline uses it.
    RunSession(pipeline::Pipeline& pipeline,
               camera::FrameSource& source,
               const camera::StereoRig& rig,
               int depth_every,
               const eval::EvalMapsConfig& maps);
    /// Called after every processed frame, while the pipeline is as that frame left it.
    using AfterFrame = std::function<void(const FrameReport&)>;
    /// Returns when the source ends, fails or is interrupted. Progress is shown under `label`; an
    /// empty one shows none.
    void drive(const std::string& label = "run", const AfterFrame& after_frame = {});
    [[nodiscard]] RunRecord& record() noexcept { return record_; }

  private:
    [[nodiscard]] std::optional<StereoFrame> next_frame();
    void process_all(const std::string& label, const AfterFrame& after_frame);
    void process(const StereoFrame& frame, const AfterFrame& after_frame);

    pipeline::Pipeline& pipeline_;
    camera::FrameSource& source_;
    int depth_every_;
    eval::EvalMapsConfig maps_;
    EyesCheck eyes_;
    bool quiet_ = false;
    SimTruth truth_;
    RunRecord record_;
};

}  // namespace surefoot::app

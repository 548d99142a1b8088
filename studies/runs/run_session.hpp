// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "service/console/option_settings.hpp"
#include "service/live/camera_order_check.hpp"
#include "studies/runs/place_session.hpp"
#include "studies/runs/sim_truth.hpp"
#include "surefoot/camera/frame_source.hpp"
#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/pipeline/pipeline.hpp"

namespace surefoot::app {

/// Frame reports of a run and its outcome.
struct RunRecord {
    camera::SourceInfo source;
    camera::StereoRig rig;
    std::vector<FrameReport> frames;
    FusionCounts fusion;             ///< sums over all frames
    FrameStatusCounts frame_status;  ///< sums over all frames
    /// Number of frames skipped before the first of `frames`, see pipeline/start.hpp.
    int waited_frames = 0;
    std::optional<Error> error;         ///< reason why the run ended early
    std::optional<TruthFigures> truth;  ///< set only for simulated sources
    std::optional<PlaceRecord> place;   ///< set only with `run --place`
    double wall_s = 0.0;

    [[nodiscard]] bool complete() const noexcept { return !error.has_value(); }
};

/// Returns the poses in odom of a frame fixed to the body, by default of base_link itself.
[[nodiscard]] Trajectory trajectory_of(std::span<const FrameReport> frames,
                                       const Pose& T_body_fixed = Pose{});

/// Runs a pipeline on a source. Buffers the first frames for the alignment, then processes every
/// frame. Stops at the first error of the source, when the cameras are swapped, or when the user
/// interrupts. Earlier results stay in `record()` and in the map of the pipeline.
class RunSession {
  public:
    /// `rig`: the rig of the source with its mount, as the pipeline uses it. `depth_every`: depth
    /// and map are updated on every n-th frame. Pipeline and source must outlive this object.
    RunSession(pipeline::Pipeline& pipeline,
               camera::FrameSource& source,
               const camera::StereoRig& rig,
               int depth_every,
               const eval::EvalMapsConfig& maps);
    /// Function that is called after every processed frame, before the pipeline sees the next one.
    using AfterFrame = std::function<void(const FrameReport&)>;
    /// Processes frames until the source ends or fails, or the user interrupts. Shows progress
    /// under `label`; an empty label shows nothing.
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
    CameraOrderCheck cameras_;
    bool quiet_ = false;
    SimTruth truth_;
    RunRecord record_;
};

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/camera/frame_integrity_check.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/pipeline/pipeline.hpp"

namespace surefoot::pipeline {

/// Returns the next frame of a source in time order, or nothing at its end.
using NextFrame = std::function<std::optional<StereoFrame>()>;

struct Start {
    std::vector<StereoFrame> frames;  ///< frames of the alignment, still to be processed
    int waited_frames = 0;            ///< number of earlier frames, which have no pose
};

/// Collects frames until odom can be placed, and aligns the pipeline with them. The reference
/// thesis (Lange 2016) took its ground plane from the first seconds. The sun over-exposed these
/// frames, and whole recordings were lost. So the content of the images counts here, not the
/// time since the camera started:
/// * Frames too bright or too dark are skipped, for `mount.wait_for_exposure_s` at most.
/// * If neither ground nor accelerometer gives the vertical, the gate could never answer OK.
///   If the height of base_link over its ground is known, the search goes on, five frames
///   later each time, for `mount.wait_for_ground_s` at most.
/// * If the mounting is unknown, a person may still be lifting the camera. The search goes on
///   in the same way, for `mount.wait_for_search_s` at most. The frames are kept, because a
///   recording may show no ground at all. In that case the first kept frames place odom.
/// Otherwise, at the end of the source or of the wait, the last frames place odom in any case.
/// Holds `Pipeline::kAlignmentFrames` frames at a time, plus the kept frames. Not thread-safe.
///
/// Order of calls: `add` each frame in time order until `add` returns true. If the source ends
/// before, call `end`. Then call `take`.
class StartUp {
  public:
    /// `pipeline`: also pass it to `add` and `end`. `T_odom_first_body`: see Pipeline::align.
    explicit StartUp(const Pipeline& pipeline, const std::optional<Pose>& T_odom_first_body = {});
    /// Adds a frame. Returns true once the pipeline is aligned.
    [[nodiscard]] bool add(Pipeline& pipeline, StereoFrame frame);
    /// Aligns the pipeline with the frames so far, if any. Call this if no frame follows.
    void end(Pipeline& pipeline);
    /// Returns the frames to be processed. The object is empty afterwards.
    [[nodiscard]] Start take();

  private:
    [[nodiscard]] bool is_full() const;
    [[nodiscard]] bool try_alignment(Pipeline& pipeline, bool more);
    [[nodiscard]] std::span<const StereoFrame> window() const;
    [[nodiscard]] double waited_s() const;
    void let_go(std::size_t count);
    void drop();

    AlignmentConfig config_;
    bool ground_is_there_;
    bool searches_;
    std::optional<Pose> T_odom_first_body_;
    camera::FrameIntegrityCheck watch_;
    std::vector<StereoFrame> frames_;
    std::size_t kept_ = 0;  ///< number of `frames_` before the window
    bool keeps_ = false;    ///< true: frames before the window are kept
    std::size_t lit_in_a_row_ = 0;
    std::optional<std::int64_t> first_ns_;
    std::int64_t last_ns_ = 0;
    int waited_frames_ = 0;
    std::optional<double> search_began_s_;  ///< start of the search [s]; empty before it
};

/// Drives a StartUp with the frames of a source.
[[nodiscard]] Start align_when_ready(Pipeline& pipeline,
                                     const NextFrame& next,
                                     const std::optional<Pose>& T_odom_first_body = {});

}  // namespace surefoot::pipeline

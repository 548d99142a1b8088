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

/// The next frame of a source in time order, nothing at its end.
using NextFrame = std::function<std::optional<StereoFrame>()>;

struct Start {
    std::vector<StereoFrame> frames;  ///< the pipeline is aligned by them; they are to be processed
    int waited_frames = 0;            ///< came before them and have no pose
};

/// Collects frames until odom can be placed, and aligns the pipeline by them. The reference thesis
/// (Lange 2016) took its ground plane from the first, over-exposed seconds in the sun and lost
/// whole recordings by that. So the content of the images counts, not the time since the camera
/// started:
/// * Frames too bright or too dark are skipped, for `mount.wait_for_exposure_s` at most.
/// * Where neither ground nor accelerometer gave the vertical, the gate could never say OK. If the
///   height of base_link over its ground is known, ground exists: the search goes on, five frames
///   later each time, for `mount.wait_for_ground_s` at most.
/// * Where nobody says how the camera is mounted, a hand may still be lifting it: the search goes
///   on likewise, for `mount.wait_for_search_s` at most. A recording may show no ground at all, so
///   the frames are kept, and the first of them place odom when no ground was found.
/// Otherwise, when the source ends or the wait is over, the last frames place odom, whatever they
/// show. Holds `Pipeline::kAlignmentFrames` frames at a time, and those that are kept.
///
/// Order of calls: `add` each frame in time order until it returns true, or `end` when the source
/// ends before; then `take`. One thread at a time.
class StartUp {
  public:
    /// `pipeline`: the one that `add` and `end` get. `T_odom_first_body`: see Pipeline::align.
    explicit StartUp(const Pipeline& pipeline, const std::optional<Pose>& T_odom_first_body = {});
    /// True once the pipeline is aligned.
    [[nodiscard]] bool add(Pipeline& pipeline, StereoFrame frame);
    /// No further frame will come: aligns the pipeline by the frames so far, if there are any.
    void end(Pipeline& pipeline);
    /// The frames to be processed. The object is empty afterwards.
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
    bool keeps_ = false;    ///< frames before the window stay, so that it can go back
    std::size_t lit_in_a_row_ = 0;
    std::optional<std::int64_t> first_ns_;
    std::int64_t last_ns_ = 0;
    int waited_frames_ = 0;
    std::optional<double> search_began_s_;  ///< none before the first alignment
};

/// Drives a StartUp with the frames of a source.
[[nodiscard]] Start align_when_ready(Pipeline& pipeline,
                                     const NextFrame& next,
                                     const std::optional<Pose>& T_odom_first_body = {});

}  // namespace surefoot::pipeline

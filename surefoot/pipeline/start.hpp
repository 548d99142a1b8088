// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

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

/// Reads frames until odom can be placed, and aligns the pipeline by them. The thesis took its
/// ground plane from the first, over-exposed seconds in the sun, and whole recordings were lost by
/// it; so what counts is what the images show, not how long the camera is on:
/// * frames too bright or too dark are waited out, `mount.wait_for_light_s` at most;
/// * where neither ground nor accelerometer told which way is up, the gate could never say OK. If
///   the height of base_link over its ground is known there is a ground to be found: it is looked
///   for five frames later each time, `mount.wait_for_ground_s` at most;
/// * where nobody says how the camera is mounted, a hand may still be lifting it: ground is looked
///   for likewise, `mount.wait_for_search_s` at most. A recording may show none at all, so that the
///   frames are kept, and odom is placed by the first ones when none was found.
/// Otherwise, when the source ends or the wait is over, odom is placed by the last frames, whatever
/// they show. Holds `Pipeline::kAlignmentFrames` frames at a time, and those that are kept.
[[nodiscard]] Start align_when_ready(Pipeline& pipeline,
                                     const NextFrame& next,
                                     const std::optional<Pose>& T_odom_first_body = {});

}  // namespace surefoot::pipeline

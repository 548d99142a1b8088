// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/config.hpp"
#include "surefoot/core/depth_image.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/elevation/visibility/viewpoint_history.hpp"
#include "surefoot/stereo/matcher.hpp"

namespace surefoot::pipeline {

/// Two rates: every frame is matched at a coarse size. The ground in front of the feet is also
/// matched at the full size of the images, less often.
struct FineConfig {
    /// Full size divided by the coarse size; 0 = chosen by the size of the images, 1 = every frame
    /// is matched at full size.
    int scale = 0;
    double every_s = 0.5;  ///< time between two fine observations; 0 = with every frame
    // The fine region: a box in front of base_link, in its heading, on the level of its ground.
    double from_m = 0.4;
    double to_m = 2.5;
    double half_width_m = 0.6;
    double depth_m = 0.2;   ///< how far it reaches below the ground: steps down
    double height_m = 0.2;  ///< how far it reaches above the ground
    /// After this time without motion the region is matched at once, even before `every_s`.
    double still_s = 0.2;

    void describe(ConfigVisitor& visitor);
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// Returns the scale for images of this size: `config.scale`, or the whole number that brings the
/// number of pixels nearest to that of a ZED in VGA mode (672 x 376), for which odometry and
/// matching are tuned.
[[nodiscard]] int fine_scale(const FineConfig& config, int width, int height) noexcept;

/// Returns the settings of the matcher of images that are `scale` times as large as those of
/// `coarse`: the search range is as many times longer, up to the longest range of the algorithm.
[[nodiscard]] stereo::MatcherConfig at_scale(stereo::MatcherConfig coarse, int scale) noexcept;

/// Returns the part of the rectified image that shows the fine region, with `left_px` more columns
/// at its left side, where the matches of its pixels lie in the right image. A corner behind the
/// camera moves to the plane 0.1 m in front of it. The box is empty if the image does not show the
/// region. `ground_height_m`: height of base_link above the ground.
[[nodiscard]] camera::PixelBox fine_region(const FineConfig& config,
                                           const camera::RectifiedRig& rig,
                                           const Pose& T_odom_body,
                                           double ground_height_m,
                                           int left_px);

/// Decides when a frame is observed finely: after `every_s`, and when the machine has come to rest:
/// when it moves less than from one viewpoint of the map to another. Depends only on stamps and
/// poses.
class FineSchedule {
  public:
    FineSchedule(const FineConfig& config, const elevation::ViewpointConfig& viewpoint)
        : config_(config), viewpoint_(viewpoint) {}
    /// Call for every frame whose depth is measured.
    [[nodiscard]] bool is_due(std::int64_t time_ns, const Pose& T_odom_body);
    /// Notes that the frame of the last `is_due` was observed finely.
    void observed() noexcept;

  private:
    FineConfig config_;
    elevation::ViewpointConfig viewpoint_;
    std::optional<std::int64_t> observed_ns_;
    std::int64_t time_ns_ = 0;
    Pose T_odom_still_;  ///< pose at which the machine last moved
    std::int64_t still_since_ns_ = 0;
    bool is_still_observed_ = false;
    bool has_pose_ = false;
};

/// Matches the fine region at the full size of the images. Not thread-safe. After the largest
/// region nothing is allocated.
class FineDepth {
  public:
    /// Rectifier and matcher of the full images; neither may be null.
    FineDepth(std::unique_ptr<camera::Rectifier> rectifier,
              std::unique_ptr<stereo::Matcher> matcher)
        : rectifier_(std::move(rectifier)), matcher_(std::move(matcher)) {}

    /// Measures the depth in the part `box` of the rectified image, which must not be empty.
    void measure(const StereoFrame& frame, const camera::PixelBox& box, Executor& executor);

    /// The whole rectified image at full size.
    [[nodiscard]] const camera::RectifiedRig& whole_rig() const noexcept {
        return rectifier_->rig();
    }
    /// Camera and result of the last `measure`.
    [[nodiscard]] const camera::RectifiedRig& rig() const noexcept { return rig_; }
    [[nodiscard]] const DepthImage& depth() const noexcept { return depth_; }

  private:
    std::unique_ptr<camera::Rectifier> rectifier_;
    std::unique_ptr<stereo::Matcher> matcher_;
    camera::RectifiedPair pair_;
    camera::RectifiedRig rig_;
    DepthImage depth_;
};

}  // namespace surefoot::pipeline

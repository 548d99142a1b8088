// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "surefoot/core/camera_state.hpp"
#include "surefoot/core/frame.hpp"

namespace surefoot {

/// Part of the pipeline that runs for a frame: odometry alone, or also depth and map.
enum class Work : std::uint8_t { odometry, full };

enum class Stage : std::uint8_t { rectify, odometry, stereo, ground, fuse, traversability, stairs };
inline constexpr int kStageCount = 7;
[[nodiscard]] const char* to_string(Stage stage) noexcept;

/// Number of points and cells at each stage from the depth image of one frame to the map.
struct FusionCounts {
    std::int64_t points = 0;            ///< valid depth values of the frame
    std::int64_t gated_range = 0;       ///< points rejected: too near or too far
    std::int64_t gated_height = 0;      ///< points rejected: above or below the height limits
    std::int64_t gated_confidence = 0;  ///< rejected: disparity jump, grazing ray or likely outlier
    std::int64_t gated_density = 0;     ///< points rejected by radius outlier removal
    std::int64_t gated_border = 0;      ///< points rejected: few in a cell partly outside the image
    std::int64_t outside = 0;           ///< points outside the map
    std::int64_t cells_measured = 0;    ///< cells that received a measurement
    std::int64_t cells_new = 0;         ///< measured cells that were unknown before
    std::int64_t cells_fused = 0;       ///< measured cells that passed the Mahalanobis gate
    std::int64_t cells_inflated = 0;    ///< measured cells that disagreed with their known height
    std::int64_t cells_cleared = 0;     ///< cells cleared: rays pass through their old height
    FusionCounts& operator+=(const FusionCounts& other) noexcept;
};

/// Counts of all frames of a run by their delivery; see FrameStatus.
struct FrameStatusCounts {
    std::int64_t repeated_frames = 0;        ///< frames whose image is not new
    std::int64_t longest_freeze_frames = 0;  ///< longest sequence of repeated frames
    std::int64_t torn_frames = 0;
    std::int64_t dropped_frames = 0;
    std::int64_t skipped_frames = 0;
    std::int64_t damaged_frames = 0;
    std::int64_t reconnections = 0;
    FrameStatusCounts& operator+=(const FrameStatus& frame) noexcept;
};

/// Ground plane of one frame. The producer names the coordinate frame and the point of `height_m`.
struct GroundObservation {
    bool accepted = false;
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, points to the sensor
    double height_m = 0.0;                              ///< height of this point above the plane
    double inlier_ratio = 0.0;
    double rms_m = 0.0;  ///< rms distance of the inliers from the plane
};

/// All values of one frame that a dashboard, a log or a benchmark shows.
struct FrameReport {
    std::int64_t time_ns = 0;
    int index = 0;
    Work work = Work::odometry;
    FrameStatus frame_status;
    CameraState camera = CameraState::unknown;  ///< state from all frames up to this frame
    /// For a repeated or torn frame: the last pose, health lost, and the covariance of unobserved
    /// motion.
    MotionEstimate motion;
    std::int64_t depth_pixels = 0;  ///< pixels with a disparity
    std::int64_t image_pixels = 0;
    /// Pixels of the fine region with a disparity; 0 if the frame was not matched at full size.
    std::int64_t fine_pixels = 0;
    GroundObservation ground;  ///< ground plane in the body frame
    FusionCounts fusion;
    std::int64_t known_cells = 0;  ///< known map cells after this frame
    /// Wall time per stage [ms]. Only these values differ between equal runs.
    std::array<double, kStageCount> stage_ms{};
};

}  // namespace surefoot

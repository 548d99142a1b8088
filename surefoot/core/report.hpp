// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "surefoot/core/camera_state.hpp"
#include "surefoot/core/frame.hpp"

namespace surefoot {

/// How much of the chain to run for a frame: odometry alone, or depth and map too.
enum class Work : std::uint8_t { odometry, full };

enum class Stage : std::uint8_t { rectify, odometry, stereo, ground, fuse, traversability, stairs };
inline constexpr int kStageCount = 7;
[[nodiscard]] const char* to_string(Stage stage) noexcept;

/// What happened to the points of one frame on their way into the map.
struct FusionCounts {
    std::int64_t points = 0;            ///< valid depth values offered
    std::int64_t gated_range = 0;       ///< too near or too far
    std::int64_t gated_height = 0;      ///< above or below the height cut
    std::int64_t gated_confidence = 0;  ///< disparity jump, grazing incidence or likely outlier
    std::int64_t gated_density = 0;     ///< radius outlier removal
    std::int64_t gated_border = 0;      ///< in cells that reach beyond the image
    std::int64_t outside = 0;           ///< beyond the map
    std::int64_t cells_measured = 0;    ///< cells that received a measurement
    std::int64_t cells_new = 0;         ///< of these, unknown before
    std::int64_t cells_fused = 0;       ///< of these, agreed with the cell (Mahalanobis gate)
    std::int64_t cells_inflated = 0;    ///< of these, disagreed: variance grew instead
    std::int64_t cells_cleared = 0;     ///< remembered, but lines of sight pass through: forgotten
    FusionCounts& operator+=(const FusionCounts& other) noexcept;
};

/// How the frames of a run came in; see FrameStatus.
struct FrameStatusCounts {
    std::int64_t repeated_frames = 0;        ///< their image had been there before
    std::int64_t longest_freeze_frames = 0;  ///< most of these in a row
    std::int64_t torn_frames = 0;
    std::int64_t dropped_frames = 0;
    std::int64_t skipped_frames = 0;
    std::int64_t damaged_frames = 0;
    std::int64_t reconnections = 0;
    FrameStatusCounts& operator+=(const FrameStatus& frame) noexcept;
};

/// The ground plane as seen in one frame, in the frame named by its producer.
struct GroundObservation {
    bool accepted = false;
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, toward the sensor
    double height_m = 0.0;                              ///< distance of the sensor from the plane
    double inlier_ratio = 0.0;
    double rms_m = 0.0;  ///< of the inliers
};

/// Everything that a dashboard, a log or a benchmark shows about one frame.
struct FrameReport {
    std::int64_t time_ns = 0;
    int index = 0;
    Work work = Work::odometry;
    FrameStatus frame_status;
    CameraState camera = CameraState::unknown;  ///< what the arrivals up to this one say
    /// Of a repeated or torn frame: the last pose again, lost, with the covariance of unseen
    /// motion.
    MotionEstimate motion;
    std::int64_t depth_pixels = 0;  ///< pixels with a disparity
    std::int64_t image_pixels = 0;
    GroundObservation ground;  ///< in the body frame
    FusionCounts fusion;
    std::int64_t known_cells = 0;  ///< after this frame
    /// Wall time per stage [ms]; exempt from determinism.
    std::array<double, kStageCount> stage_ms{};
};

}  // namespace surefoot

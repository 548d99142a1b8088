// SPDX-License-Identifier: Apache-2.0
#include "surefoot/core/report.hpp"

#include <algorithm>

namespace surefoot {

const char* to_string(Health health) noexcept {
    switch (health) {
        case Health::ok: return "OK";
        case Health::degraded: return "DEGRADED";
        case Health::lost: return "LOST";
    }
    return "LOST";
}

const char* to_string(HealthReason reason) noexcept {
    switch (reason) {
        case HealthReason::none: return "none";
        case HealthReason::first_frame: return "first_frame";
        case HealthReason::few_tracks: return "few_tracks";
        case HealthReason::poor_geometry: return "poor_geometry";
        case HealthReason::blur: return "blur";
        case HealthReason::large_residual: return "large_residual";
        case HealthReason::time_gap: return "time_gap";
        case HealthReason::repeated_image: return "repeated_image";
        case HealthReason::torn_image: return "torn_image";
        case HealthReason::cameras_swapped: return "cameras_swapped";
        case HealthReason::imu_disagreement: return "imu_disagreement";
        case HealthReason::machine_disagreement: return "machine_disagreement";
        case HealthReason::beyond_machine: return "beyond_machine";
        case HealthReason::moving_scene: return "moving_scene";
        case HealthReason::recovered: return "recovered";
        case HealthReason::imu_gap: return "imu_gap";
    }
    return "unknown";
}

const char* to_string(CameraState state) noexcept {
    switch (state) {
        case CameraState::unknown: return "UNKNOWN";
        case CameraState::frozen: return "FROZEN";
        case CameraState::corrupt: return "CORRUPT";
        case CameraState::ok: return "OK";
        case CameraState::overexposed: return "OVEREXPOSED";
        case CameraState::dark: return "DARK";
        case CameraState::moved: return "MOVED";
        case CameraState::leaning: return "LEANING";
    }
    return "UNKNOWN";
}

const char* to_string(Stage stage) noexcept {
    switch (stage) {
        case Stage::rectify: return "rectify";
        case Stage::odometry: return "odometry";
        case Stage::stereo: return "stereo";
        case Stage::ground: return "ground";
        case Stage::fuse: return "fuse";
        case Stage::traversability: return "traversability";
        case Stage::stairs: return "stairs";
    }
    return "unknown";
}

FusionCounts& FusionCounts::operator+=(const FusionCounts& other) noexcept {
    points += other.points;
    gated_range += other.gated_range;
    gated_height += other.gated_height;
    gated_confidence += other.gated_confidence;
    gated_density += other.gated_density;
    gated_border += other.gated_border;
    outside += other.outside;
    cells_measured += other.cells_measured;
    cells_new += other.cells_new;
    cells_fused += other.cells_fused;
    cells_inflated += other.cells_inflated;
    cells_cleared += other.cells_cleared;
    return *this;
}

FrameStatusCounts& FrameStatusCounts::operator+=(const FrameStatus& frame) noexcept {
    dropped_frames += frame.dropped;
    skipped_frames += frame.skipped;
    damaged_frames += frame.damaged;
    reconnections += frame.reconnected;
    repeated_frames += frame.repeated > 0 ? 1 : 0;
    longest_freeze_frames = std::max(longest_freeze_frames, std::int64_t{frame.repeated});
    torn_frames += frame.torn ? 1 : 0;
    return *this;
}

}  // namespace surefoot

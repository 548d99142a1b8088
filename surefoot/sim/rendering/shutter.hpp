// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/sim/motion/motion.hpp"

namespace surefoot::sim {

/// How long and in which order pixels collect light. The exposure time is that of ExposureConfig.
struct ShutterConfig {
    int blur_samples = 0;  ///< instants that an exposure is averaged over; 0 or 1 = a sharp image
    bool rolling = true;   ///< one row after the other, where the rig has a read-out time

    void describe(ConfigVisitor& visitor);
};

/// Middle of the exposure of a row, seconds after the stamp of its image. The stamp is the middle
/// of the exposure of the middle of the image: half of the rows are exposed before it, half after,
/// so that the pose at the stamp is the best single pose of a rolling image.
[[nodiscard]] double row_offset_s(int row, int height, double readout_s) noexcept;

/// A camera at one instant.
struct CameraView {
    Eigen::Matrix3d R_world_camera = Eigen::Matrix3d::Identity();
    Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  ///< centre of projection, world

    friend bool operator==(const CameraView&, const CameraView&) = default;
};

/// Where a camera is when each of its rows is exposed; a single view where all rows share it.
class ImageViews {
  public:
    explicit ImageViews(const Pose& T_world_camera);
    /// Views at `instant_s` plus the offset of each row.
    ImageViews(const Motion& motion,
               const Pose& T_body_camera,
               double instant_s,
               double readout_s,
               int height);

    [[nodiscard]] const CameraView& row(int v) const noexcept {
        return views_[views_.size() == 1 ? 0 : static_cast<std::size_t>(v)];
    }
    [[nodiscard]] bool single() const noexcept { return views_.size() == 1; }
    friend bool operator==(const ImageViews&, const ImageViews&) = default;

  private:
    std::vector<CameraView> views_;
};

/// Middles of `samples` equal parts of an exposure, seconds from its middle.
[[nodiscard]] std::vector<double> blur_offsets_s(double exposure_s, int samples);

}  // namespace surefoot::sim

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/sim/motion/motion.hpp"

namespace surefoot::sim {

/// Motion blur and rolling shutter of a camera. ExposureConfig holds the exposure time.
struct ShutterConfig {
    int blur_samples = 0;  ///< number of images averaged over an exposure; 0 or 1 = a sharp image
    bool rolling = true;   ///< true: rows are exposed in turn if the rig has a read-out time

    void describe(ConfigVisitor& visitor);
};

/// Middle of the exposure of a row, in seconds relative to the image stamp. The stamp is the middle
/// of the exposure of the middle row: half of the rows are exposed before it, half after it. The
/// pose at the stamp is then the best single pose of a rolling-shutter image.
[[nodiscard]] double row_offset_s(int row, int height, double readout_s) noexcept;

/// Pose of a camera at one instant.
struct CameraView {
    Eigen::Matrix3d R_world_camera = Eigen::Matrix3d::Identity();
    Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  ///< centre of projection in the world

    friend bool operator==(const CameraView&, const CameraView&) = default;
};

/// Camera pose at the exposure of each row; a single pose if all rows share it.
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

/// Midpoints of `samples` equal parts of an exposure, in seconds from its middle.
[[nodiscard]] std::vector<double> blur_offsets_s(double exposure_s, int samples);

}  // namespace surefoot::sim

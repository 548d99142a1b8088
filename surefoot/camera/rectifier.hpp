// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "surefoot/camera/rectification.hpp"
#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::camera {

enum class Side : std::uint8_t { left, right };

/// Rectified pair of one frame; `right` is empty for RGB-D.
struct RectifiedPair {
    GreyImage left;
    GreyImage right;
};

/// Turns raw images and raw points of a rig into those of its RectifiedRig. Works for any mix of
/// lens models (the half rotations are our own, not cv::fisheye::stereoRectify, which fails on real
/// rigs). Thread-compatible: const calls may run at the same time.
///
/// Both cameras are turned by half of their relative rotation each, then together until x runs
/// along the baseline (after Bouguet). The common focal length is that of the configuration, or the
/// smallest that leaves no rectified pixel without a source and shows no more than the widest view.
class Rectifier {
  public:
    /// RGB-D depth is turned into the disparity of a pair with this baseline.
    static constexpr double kVirtualBaseline_m = 0.08;

    /// Fails with the rig's or the configuration's problem in words.
    [[nodiscard]] static Result<Rectifier> make(const StereoRig& rig,
                                                const RectificationConfig& config = {});

    ~Rectifier();
    Rectifier(Rectifier&&) noexcept;
    Rectifier& operator=(Rectifier&&) noexcept;

    [[nodiscard]] const RectifiedRig& rig() const noexcept;
    /// Remaps both images bilinearly (`RemapTable`); copies when the rig is rectified already. The
    /// images must have the size of the rig (its source checks that). Pixels without a source
    /// become 0.
    void rectify(const StereoFrame& frame, RectifiedPair& out) const;
    /// RGB-D: depth along z [m] of every rectified pixel, from the nearest raw pixel; NaN =
    /// unknown.
    void rectify_depth(const Image<float>& raw_depth_m, Image<float>& out) const;
    /// Whether images pass through unchanged.
    [[nodiscard]] bool is_identity() const noexcept;
    /// Rectified pixel of a raw pixel; nothing where the lens model has no ray.
    [[nodiscard]] std::optional<Eigen::Vector2d> rectified_from_raw(
        Side side, const Eigen::Vector2d& raw) const;
    /// Raw pixel of a point in the *rectified left* optical frame, as `side` sees it.
    [[nodiscard]] std::optional<Eigen::Vector2d> raw_from_point(
        Side side, const Eigen::Vector3d& p_camera) const;

    /// When a row of the raw images is exposed, seconds after the stamp; 0 for a global shutter.
    [[nodiscard]] double row_offset_s(double v_raw_px) const noexcept;

  private:
    struct Impl;
    explicit Rectifier(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace surefoot::camera

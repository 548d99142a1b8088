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

/// A rectangle of pixels of an image. (u, v): its upper left pixel.
struct PixelBox {
    int u = 0;
    int v = 0;
    int width = 0;
    int height = 0;
    friend bool operator==(const PixelBox&, const PixelBox&) = default;
};

/// Returns the rig of a part of its rectified images.
[[nodiscard]] RectifiedRig part_of(const RectifiedRig& rig, const PixelBox& box);

/// Maps raw images and raw points of a rig to those of its RectifiedRig. Works for every mix of
/// lens models: it computes the half rotations itself, because cv::fisheye::stereoRectify fails on
/// real rigs. Thread-compatible: const calls may run at the same time.
///
/// Each camera rotates by half of their relative rotation; then both rotate until x runs along the
/// baseline (after Bouguet). The common focal length is the configured one, or the smallest one
/// without black pixels and with a view of at most `max_view_deg`.
class Rectifier {
  public:
    /// Baseline that converts RGB-D depth to disparity.
    static constexpr double kVirtualBaseline_m = 0.08;

    /// Makes a rectifier. Returns an error if the rig or the configuration has a problem.
    [[nodiscard]] static Result<Rectifier> make(const StereoRig& rig,
                                                const RectificationConfig& config = {});

    ~Rectifier();
    Rectifier(Rectifier&&) noexcept;
    Rectifier& operator=(Rectifier&&) noexcept;

    [[nodiscard]] const RectifiedRig& rig() const noexcept;
    /// Remaps both images bilinearly (`RemapTable`); copies the images of a rectified rig.
    /// Images must have the size of the rig; the source checks that. Pixels without a source
    /// become 0.
    void rectify(const StereoFrame& frame, RectifiedPair& out) const;
    /// As `rectify`, but only a part of the rectified images. `box` must lie in the image.
    void rectify_part(const StereoFrame& frame, const PixelBox& box, RectifiedPair& out) const;
    /// Computes the depth along z [m] of every rectified pixel of an RGB-D frame, from the nearest
    /// raw pixel; NaN = unknown depth.
    void rectify_depth(const Image<float>& raw_depth_m, Image<float>& out) const;
    /// True if rectification leaves the images unchanged.
    [[nodiscard]] bool is_identity() const noexcept;
    /// Rectified pixel of a raw pixel; nullopt if it has no ray or its ray points back.
    [[nodiscard]] std::optional<Eigen::Vector2d> rectified_from_raw(
        Side side, const Eigen::Vector2d& raw) const;
    /// Raw pixel, in the camera `side`, of a point in the *rectified left* optical frame.
    [[nodiscard]] std::optional<Eigen::Vector2d> raw_from_point(
        Side side, const Eigen::Vector3d& p_camera) const;

    /// Returns the time from the stamp to the exposure of a raw row [s]; 0 for a global shutter.
    [[nodiscard]] double row_offset_s(double v_raw_px) const noexcept;

  private:
    struct Impl;
    explicit Rectifier(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace surefoot::camera

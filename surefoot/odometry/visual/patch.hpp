// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "surefoot/core/views.hpp"

namespace surefoot::odometry {

/// Image patch around a point, cut from one image (the host). The patch alone suffices to find the
/// point again.
struct HostPatch {
    static constexpr int kRadius = 13;
    static constexpr int kSize = 2 * kRadius + 1;
    std::array<std::uint8_t, kSize * kSize> pixels{};
    Eigen::Vector2f centre = Eigen::Vector2f::Zero();  ///< position of the point, in patch pixels
};

/// Copies the patch around `raw_px`. Returns nothing if the patch leaves the image.
[[nodiscard]] std::optional<HostPatch> cut_patch(ImageView<const std::uint8_t> image,
                                                 const Eigen::Vector2d& raw_px);

/// A host patch, warped to its expected appearance in another view and ready for alignment.
struct PatchTemplate {
    static constexpr int kRadius = 4;
    static constexpr int kSize = 2 * kRadius + 1;
    static constexpr int kCount = kSize * kSize;
    std::array<float, kCount> value;   ///< mean removed
    std::array<float, kCount> step_u;  ///< pseudo-inverse: turns grey differences into a shift [px]
    std::array<float, kCount> step_v;
    float norm = 0.0F;  ///< norm of `value`
};

/// Warps a patch. `host_from_view` maps pixel offsets of the view to offsets of the host image.
/// Returns nothing if the warp leaves the patch or a direction of the template has no texture.
[[nodiscard]] std::optional<PatchTemplate> warp_patch(const HostPatch& host,
                                                      const Eigen::Matrix2d& host_from_view);

struct Alignment {
    Eigen::Vector2d raw_px = Eigen::Vector2d::Zero();
    double correlation = 0.0;  ///< normalised cross-correlation at the result, [-1, 1]
};

/// Moves `start_px` to the best match of the template in the image, up to gain and offset. Method:
/// inverse-compositional Gauss-Newton (Baker and Matthews 2004); gain and offset are projected out.
/// Returns nothing if the patch leaves the image or moves farther than `max_shift_px`.
[[nodiscard]] std::optional<Alignment> align_patch(const PatchTemplate& patch,
                                                   ImageView<const std::uint8_t> image,
                                                   const Eigen::Vector2d& start_px,
                                                   double max_shift_px);

}  // namespace surefoot::odometry

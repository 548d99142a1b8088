// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/calibration/lenses/lens.hpp"
#include "surefoot/camera/rectification.hpp"

namespace surefoot::calibration {

/// Direction of a raw pixel on the plane z = 1 of the rectified frame; nothing outside the lens.
[[nodiscard]] std::optional<Eigen::Vector2d> rectified_direction(
    const camera::RectifiedCamera& camera, const Eigen::Vector2d& raw);

/// Calls f(id, left pixel, right pixel) for the points that both views show. Ids ascend in a view.
template <typename F>
void for_each_common_point(const BoardView& left, const BoardView& right, const F& f) {
    for (std::size_t i = 0, k = 0; i < left.ids.size() && k < right.ids.size();) {
        if (left.ids[i] != right.ids[k]) {
            ++(left.ids[i] < right.ids[k] ? i : k);
            continue;
        }
        f(left.ids[i], left.pixels[i], right.pixels[k]);
        ++i;
        ++k;
    }
}

/// Root of the mean squared row difference of the points that both views of a pair show, after
/// rectification [px of an image of the focal length `focal_px`]. Points without a rectified place
/// do not count; NaN when none is left.
[[nodiscard]] double row_rms_px(const camera::Rectification& plan,
                                std::span<const std::pair<BoardView, BoardView>> pairs,
                                double focal_px);

/// A stereo calibration as one vector: left lens, right lens, and where T_left_right is.
struct StereoParameters {
    LensKind kind = LensKind::pinhole5;
    ImageSize size;
    Eigen::VectorXd left;
    Eigen::VectorXd right;
    Pose T_left_right;
};
[[nodiscard]] camera::StereoRig rig_of(const StereoParameters& parameters);

/// Standard deviation of the depth of points on the axis of the rectified left camera, from the
/// covariance of the parameters alone (left, right, T_left_right by right perturbation): the two
/// raw pixels of a point stay, the calibration moves. First order, one value per distance. NaN
/// where an image does not show the point.
[[nodiscard]] std::vector<double> depth_sigmas_m(const StereoParameters& parameters,
                                                 const Eigen::MatrixXd& covariance,
                                                 std::span<const double> distances_m);

}  // namespace surefoot::calibration

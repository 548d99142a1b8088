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

/// Returns where a raw pixel lies on the plane z = 1 of the rectified frame; nullopt if nowhere.
[[nodiscard]] std::optional<Eigen::Vector2d> rectified_direction(
    const camera::RectifiedCamera& camera, const Eigen::Vector2d& raw);

/// Calls f(id, left pixel, right pixel) for the common points of both views. Ids ascend in a view.
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

/// Root mean square row difference of the common points of each pair after rectification, in pixels
/// of an image with the focal length `focal_px`. Points without a rectified position do not count;
/// NaN if no point counts.
[[nodiscard]] double row_rms_px(const camera::Rectification& plan,
                                std::span<const std::pair<BoardView, BoardView>> pairs,
                                double focal_px);

/// Parameters of a stereo calibration, in the order of their covariance.
struct StereoParameters {
    LensKind kind = LensKind::pinhole5;
    ImageSize size;
    Eigen::VectorXd left;
    Eigen::VectorXd right;
    Pose T_left_right;
};
[[nodiscard]] camera::StereoRig rig_of(const StereoParameters& parameters);

/// Returns the depth standard deviation of points on the axis of the rectified left camera, one
/// value per distance. The values come from the parameter covariance alone (left, right,
/// T_left_right by right perturbation), to first order. The two raw pixels of a point stay fixed
/// while the calibration varies. NaN if an image does not show the point.
[[nodiscard]] std::vector<double> depth_sigmas_m(const StereoParameters& parameters,
                                                 const Eigen::MatrixXd& covariance,
                                                 std::span<const double> distances_m);

}  // namespace surefoot::calibration

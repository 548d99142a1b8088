// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "surefoot/calibration/lenses/lens.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::calibration {

/// One board point in one image.
struct Sight {
    int camera = 0;  ///< 0 = left or only camera, 1 = right
    int view = 0;    ///< index into BoardBundle::T_left_board
    int id = 0;      ///< of the point on its board
    Eigen::Vector3d point_board_m = Eigen::Vector3d::Zero();
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

/// Everything that a calibration estimates, with what was measured: one camera or two that are
/// fixed to each other, looking at a flat board in several poses.
struct BoardBundle {
    LensKind kind = LensKind::pinhole5;
    ImageSize size;
    std::vector<Eigen::VectorXd> lenses;  ///< one or two, order of parameter_names
    Pose T_left_right;                    ///< with two lenses
    std::vector<Pose> T_left_board;       ///< one per view
    std::vector<Sight> sights;
    /// 0: sights are images of points; otherwise centres of gravity of images of discs.
    double disc_radius_m = 0.0;
};

/// What of a lens may move; board poses and T_left_right always do.
enum class Freedom : std::uint8_t {
    poses,       ///< nothing of the lens
    focal,       ///< fx and fy
    low_order,   ///< fx fy cx cy k1 k2
    everything,  ///< the whole model
};

struct BundleOptions {
    Freedom freedom = Freedom::everything;
    double huber_px = 0.0;  ///< residuals beyond it count linearly; 0 = least squares
    int max_iterations = 100;
    /// Relative change of the cost that ends it; on the way to other decisions less will do.
    double tolerance = 1e-12;
    /// A lens whose image would turn back before the corners is held to growing
    /// (growing_image.hpp), unless the sights object.
    bool hold_growth = false;
};

/// Minimises the reprojection error with Ceres, one thread, fixed order of summation: the same
/// input gives the same bytes. Half the sum of (robust) squared pixel errors; nothing where no step
/// could be computed.
[[nodiscard]] std::optional<double> solve(BoardBundle& bundle, const BundleOptions& options);

/// Measured minus predicted [px], one per sight; NaN where the model has no image of a point.
[[nodiscard]] std::vector<Eigen::Vector2d> residuals_px(const BoardBundle& bundle);

/// Covariance of all lens parameters (one lens after the other) and, with two lenses, of
/// T_left_right (translation, rotation; right perturbation) for pixel noise of `sigma_px` per
/// coordinate; board poses are marginalised. That an image grows does not count: a limit says on
/// which side of it the truth lies, not how far. Nothing when the views do not determine them.
[[nodiscard]] std::optional<Eigen::MatrixXd> covariance(const BoardBundle& bundle, double sigma_px);

}  // namespace surefoot::calibration

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "surefoot/calibration/lenses/lens.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::calibration {

/// An observation of one board point in one image.
struct Sight {
    int camera = 0;  ///< 0 = left or only camera, 1 = right
    int view = 0;    ///< index into BoardBundle::T_left_board
    int id = 0;      ///< id of the point on its board
    Eigen::Vector3d point_board_m = Eigen::Vector3d::Zero();
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

/// All estimated values of a calibration, and the observations: one camera, or two rigidly
/// connected cameras, and a flat board in several poses.
struct BoardBundle {
    LensKind kind = LensKind::pinhole5;
    ImageSize size;
    std::vector<Eigen::VectorXd> lenses;  ///< one per camera, ordered as parameter_names
    Pose T_left_right;                    ///< used with two cameras only
    std::vector<Pose> T_left_board;       ///< one per view
    std::vector<Sight> sights;
    /// If 0, sights are images of points; otherwise centres of gravity of disc images.
    double disc_radius_m = 0.0;
};

/// Free parameters of a lens. Board poses and T_left_right are always free.
enum class Freedom : std::uint8_t {
    poses,       ///< no lens parameter
    focal,       ///< fx and fy
    low_order,   ///< fx fy cx cy k1 k2
    everything,  ///< all parameters of the model
};

struct BundleOptions {
    Freedom freedom = Freedom::everything;
    double huber_px = 0.0;  ///< larger residuals count linearly [px]; 0 = least squares
    int max_iterations = 100;
    /// The solver stops below this relative change of cost or parameters.
    double tolerance = 1e-12;
    /// True: prevents a lens image from folding back before the image corners (growing_image.hpp),
    /// unless the sights contradict this.
    bool hold_growth = false;
};

/// Minimises the reprojection error with Ceres, in one thread and a fixed order of summation: equal
/// input gives equal bytes. Returns the cost: half the sum of (robust) squared pixel errors, plus
/// the costs of the rational prior and the growth limit. Returns nullopt if the solver fails.
[[nodiscard]] std::optional<double> solve(BoardBundle& bundle, const BundleOptions& options);

/// Returns measured minus predicted pixels, one per sight; NaN if a point has no image.
[[nodiscard]] std::vector<Eigen::Vector2d> residuals_px(const BoardBundle& bundle);

/// Returns the covariance of all lens parameters, one lens after the other, for pixel noise of
/// `sigma_px` per coordinate. With two lenses T_left_right follows (translation, rotation; right
/// perturbation). Board poses are marginalised. Leaves out the growth limit: the limit bounds the
/// truth on one side only. Returns nullopt if the views do not determine the parameters.
[[nodiscard]] std::optional<Eigen::MatrixXd> covariance(const BoardBundle& bundle, double sigma_px);

}  // namespace surefoot::calibration

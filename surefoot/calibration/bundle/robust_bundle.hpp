// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "surefoot/calibration/bundle/board_bundle.hpp"

namespace surefoot::calibration {

/// When a view or a point no longer counts as the same camera with noise.
struct RobustLimits {
    int least_views = 3;
    /// A view goes when its rms exceeds this many medians of the views' rms and, at the same time,
    /// the median by `view_sigmas` of their robust scatter.
    double view_factor = 2.0;
    double view_sigmas = 4.0;
    /// But no view goes for less [px]. Detectors err by amounts that differ from view to view, as
    /// the sizes of squares, blur, noise and the slants of edges do (rendered chessboards: 0.015 to
    /// 0.03 px rms where the median is 0.02, in dim light and noise 0.06 to 0.08 px, single corners
    /// 0.1 px): the better they are, the less a ratio says.
    double least_px = 0.1;
    /// Where each view has a limit of its own, it takes the place of the two above [px].
    std::vector<double> view_limits_px;
    /// A point goes beyond this many robust standard deviations of a coordinate: of 3000 points
    /// with normal noise one in 20 000 sets loses one.
    double point_sigmas = 6.0;
};

struct DroppedView {
    int view = 0;
    double rms_px = 0.0;
    double limit_px = 0.0;
};

struct RobustFit {
    std::vector<DroppedView> dropped;  ///< in the order in which they went
    std::vector<Sight> outliers;       ///< single points of views that stay
    /// A view that contradicts the others but could not go without falling below `least_views`.
    std::optional<DroppedView> contradiction;
    double sigma_px = 0.0;  ///< standard deviation of a coordinate, unbiased
};

/// Root of the mean squared distance over the sights of each view; NaN without sights. Distances
/// beyond `clip_px` count as that long.
[[nodiscard]] std::vector<double> view_rms_px(
    const BoardBundle& bundle, double clip_px = std::numeric_limits<double>::infinity());
/// The same over all sights, as OpenCV defines it.
[[nodiscard]] double rms_px(const BoardBundle& bundle);

void drop_view(BoardBundle& bundle, int view);
[[nodiscard]] int views_left(const BoardBundle& bundle);

/// Huber's loss while views and points that do not belong leave, the worst view first; then plain
/// least squares over what is left, which is the most accurate estimate for normal noise. The
/// sights that went are no longer in the bundle. Nothing where the solver fails.
[[nodiscard]] std::optional<RobustFit> solve_robustly(BoardBundle& bundle,
                                                      const RobustLimits& limits);

}  // namespace surefoot::calibration

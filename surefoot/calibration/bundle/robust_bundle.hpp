// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "surefoot/calibration/bundle/board_bundle.hpp"

namespace surefoot::calibration {

/// Limits of errors. A view or point whose error exceeds a limit contradicts the other views.
struct RobustLimits {
    int least_views = 3;
    /// Removes a view if its rms exceeds `view_factor` times the median rms of all views. The rms
    /// must also exceed the median by `view_sigmas` times the robust scatter of the rms values.
    double view_factor = 2.0;
    double view_sigmas = 4.0;
    /// Views with an rms below this [px] always stay. The detector error of a view depends on the
    /// size of squares, blur, noise and slant. On rendered chessboards the rms of a view was 0.015
    /// to 0.03 px (median 0.02 px), with noise and little light 0.06 to 0.08 px. Single corners had
    /// errors of 0.1 px. The ratio of such small rms values says little about a view.
    double least_px = 0.1;
    /// Limit per view [px]; empty = none. Replaces view_factor and view_sigmas, but not least_px.
    std::vector<double> view_limits_px;
    /// A point is removed if its residual exceeds this many robust sigmas of a coordinate. In sets
    /// of 3000 points with normal noise, one set in 20 000 loses a point.
    double point_sigmas = 6.0;
};

struct DroppedView {
    int view = 0;
    double rms_px = 0.0;
    double limit_px = 0.0;
};

struct RobustFit {
    std::vector<DroppedView> dropped;  ///< in order of removal
    std::vector<Sight> outliers;       ///< removed single points of the remaining views
    /// A view that contradicts the others but stays, because `least_views` must remain.
    std::optional<DroppedView> contradiction;
    double sigma_px = 0.0;  ///< standard deviation of a coordinate, unbiased
};

/// Rms distance of measured from predicted pixels for each view; NaN for a view without sights.
/// Each distance is limited to `clip_px`.
[[nodiscard]] std::vector<double> view_rms_px(
    const BoardBundle& bundle, double clip_px = std::numeric_limits<double>::infinity());
/// Rms distance of measured from predicted pixels over all sights, as in OpenCV.
[[nodiscard]] double rms_px(const BoardBundle& bundle);

void drop_view(BoardBundle& bundle, int view);
[[nodiscard]] int views_left(const BoardBundle& bundle);

/// Minimises Huber's loss and removes views and points that do not fit, the worst view first. Ends
/// with plain least squares over the rest, the most accurate estimate for normal noise. Removed
/// sights leave the bundle. Returns nullopt if the solver fails.
[[nodiscard]] std::optional<RobustFit> solve_robustly(BoardBundle& bundle,
                                                      const RobustLimits& limits);

}  // namespace surefoot::calibration

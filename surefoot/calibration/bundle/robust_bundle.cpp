// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/bundle/robust_bundle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/calibration/bundle/view_check.hpp"

namespace surefoot::calibration {
namespace {

constexpr double kHuberSigmas = 2.5;
/// Limit of the error of a single corner [sigma] in the rms of its view. A corner beyond the limit
/// can be removed alone, without its view.
constexpr double kClipSigmas = 10.0;
/// Tolerance of the solver while views are removed: the rms of each view is then known to a
/// thousandth.
constexpr double kRoughTolerance = 1e-5;
/// Least sigma [px]: noiseless input must not shrink the loss to zero.
constexpr double kLeastSigma_px = 1e-3;
/// Median length of a two-dimensional normal error, in standard deviations: sqrt(2 ln 2).
constexpr double kMedianLength = 1.17741;
constexpr double kMadToSigma = 1.4826;  ///< median absolute deviation to sigma, for normal values

/// Returns the standard deviation of a coordinate [px], robust against a minority of outliers.
double robust_sigma_px(const BoardBundle& bundle) {
    std::vector<double> lengths;
    for (const Eigen::Vector2d& r : residuals_px(bundle)) lengths.push_back(r.norm());
    return std::max(median(lengths) / kMedianLength, kLeastSigma_px);
}

/// Returns the largest accepted rms of a view [px], from the rms values of all views.
double common_limit_px(const std::vector<double>& all, const RobustLimits& limits) {
    std::vector<double> known;
    for (const double rms : all)
        if (!std::isnan(rms)) known.push_back(rms);
    const double middle = median(known);
    for (double& rms : known) rms = std::abs(rms - middle);
    return std::max({limits.view_factor * middle,
                     middle + limits.view_sigmas * kMadToSigma * median(known),
                     limits.least_px});
}

/// Finds the view with the largest ratio of rms to limit.
DroppedView worst_view(const BoardBundle& bundle, const RobustLimits& limits, double sigma_px) {
    const std::vector<double> all = view_rms_px(bundle, kClipSigmas * sigma_px);
    const double common_px = common_limit_px(all, limits);
    DroppedView worst{-1, 0.0, common_px};
    for (std::size_t i = 0; i < all.size(); ++i) {
        const double limit_px = limits.view_limits_px.empty()
                                    ? common_px
                                    : std::max(limits.view_limits_px[i], limits.least_px);
        if (all[i] / limit_px > worst.rms_px / worst.limit_px)
            worst = {static_cast<int>(i), all[i], limit_px};
    }
    return worst;
}

std::vector<Sight> take_outliers(BoardBundle& bundle, double limit_px) {
    const std::vector<Eigen::Vector2d> residuals = residuals_px(bundle);
    std::vector<Sight> kept;
    std::vector<Sight> outliers;
    for (std::size_t i = 0; i < residuals.size(); ++i)
        (residuals[i].norm() <= limit_px ? kept : outliers).push_back(bundle.sights[i]);
    bundle.sights = std::move(kept);
    return outliers;
}

/// Returns the standard deviation of a coordinate [px]; NaN without degrees of freedom. Divides by
/// the degrees of freedom, so that few views do not look better than they are.
double unbiased_sigma_px(const BoardBundle& bundle) {
    double square = 0.0;
    for (const Eigen::Vector2d& r : residuals_px(bundle)) square += r.squaredNorm();
    const auto lenses = static_cast<double>(bundle.lenses.size());
    const double parameters = lenses * static_cast<double>(bundle.lenses.front().size()) +
                              6.0 * (lenses - 1.0) + 6.0 * views_left(bundle);
    const double freedom = 2.0 * static_cast<double>(bundle.sights.size()) - parameters;
    return freedom > 0.0 ? std::sqrt(square / freedom) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::vector<double> view_rms_px(const BoardBundle& bundle, double clip_px) {
    std::vector<double> square(bundle.T_left_board.size(), 0.0);
    std::vector<double> count(bundle.T_left_board.size(), 0.0);
    const std::vector<Eigen::Vector2d> residuals = residuals_px(bundle);
    for (std::size_t i = 0; i < residuals.size(); ++i) {
        const auto view = static_cast<std::size_t>(bundle.sights[i].view);
        // not std::min: depending on the order of its arguments, it replaces NaN by clip_px
        const double length_px = residuals[i].norm();
        const double counted_px = length_px > clip_px ? clip_px : length_px;
        square[view] += counted_px * counted_px;
        count[view] += 1.0;
    }
    for (std::size_t v = 0; v < square.size(); ++v) square[v] = std::sqrt(square[v] / count[v]);
    return square;
}

double rms_px(const BoardBundle& bundle) {
    double square = 0.0;
    for (const Eigen::Vector2d& r : residuals_px(bundle)) square += r.squaredNorm();
    return std::sqrt(square / static_cast<double>(bundle.sights.size()));
}

void drop_view(BoardBundle& bundle, int view) {
    std::erase_if(bundle.sights, [&](const Sight& sight) { return sight.view == view; });
}

int views_left(const BoardBundle& bundle) {
    std::vector<bool> seen(bundle.T_left_board.size(), false);
    for (const Sight& sight : bundle.sights) seen[static_cast<std::size_t>(sight.view)] = true;
    return static_cast<int>(std::count(seen.begin(), seen.end(), true));
}

std::optional<RobustFit> solve_robustly(BoardBundle& bundle, const RobustLimits& limits) {
    RobustFit fit;
    double sigma_px = robust_sigma_px(bundle);
    while (true) {
        const BundleOptions rough{
            Freedom::everything, kHuberSigmas * sigma_px, 50, kRoughTolerance};
        if (!solve(bundle, rough)) return std::nullopt;
        sigma_px = robust_sigma_px(bundle);
        DroppedView worst = worst_view(bundle, limits, sigma_px);
        if (!(worst.rms_px > worst.limit_px)) break;
        worst.rms_px = view_rms_px(bundle)[static_cast<std::size_t>(worst.view)];
        if (views_left(bundle) <= limits.least_views) {
            fit.contradiction = worst;
            break;
        }
        drop_view(bundle, worst.view);
        fit.dropped.push_back(worst);
    }
    fit.outliers = take_outliers(bundle, limits.point_sigmas * sigma_px);
    if (!solve(bundle, {.hold_growth = true})) return std::nullopt;
    fit.sigma_px = unbiased_sigma_px(bundle);
    return fit;
}

}  // namespace surefoot::calibration

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/bundle/bundle_start.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/calibration/bundle/planar_pose.hpp"
#include "surefoot/calibration/bundle/robust_bundle.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::calibration {
namespace {

/// Focal length divided by the longer image side: 0.1 is an equidistant lens with a field of view
/// of 570 deg. 6 is a telephoto lens with a field of view of 9.5 deg.
constexpr double kShortest = 0.1;
constexpr double kLongest = 6.0;
constexpr double kFocalStep = 1.15;
constexpr std::size_t kRefined = 3;
/// Limit of the error that one view adds to the score [px]. This limit prevents a view with wrong
/// ids from determining the focal length.
constexpr double kSaturation_px = 20.0;
/// Residuals above this count linearly [px]. Residuals of this size are normal before the
/// distortion is known.
constexpr double kStartHuber_px = 5.0;
constexpr int kStageIterations = 30;
constexpr double kStageTolerance = 1e-6;
constexpr BundleOptions kLastStage{
    Freedom::everything, kStartHuber_px, kStageIterations, kStageTolerance};

/// The sights of one view: points on the board plane, and the rays of their pixels.
struct ViewRays {
    std::vector<Eigen::Vector3d> points;
    std::vector<Eigen::Vector3d> rays;
};

std::vector<ViewRays> rays_of(const BoardBundle& bundle) {
    const camera::CameraModel model = model_of(bundle.kind, bundle.lenses.front());
    std::vector<ViewRays> views(bundle.T_left_board.size());
    for (const Sight& sight : bundle.sights) {
        const auto ray = camera::unproject(model, sight.pixel);
        if (!ray) continue;
        ViewRays& view = views[static_cast<std::size_t>(sight.view)];
        view.points.push_back(sight.point_board_m);
        view.rays.push_back(*ray);
    }
    return views;
}

void set_focal(BoardBundle& bundle, double focal_px) {
    const auto count = static_cast<Eigen::Index>(parameter_names(bundle.kind).size());
    bundle.lenses.assign(1, Eigen::VectorXd::Zero(count));
    bundle.lenses[0].head<4>() << focal_px, focal_px, 0.5 * (bundle.size.width - 1),
        0.5 * (bundle.size.height - 1);
}

/// Computes the board poses for the current lens. Returns the sum of the limited view errors [px].
double score(BoardBundle& bundle) {
    const std::vector<ViewRays> views = rays_of(bundle);
    for (std::size_t v = 0; v < views.size(); ++v) {
        const std::optional<Pose> T = planar_pose(views[v].points, views[v].rays);
        // NaN excludes a view without a pose until add_missing() finds a pose.
        const Pose none{Eigen::Quaterniond::Identity(), Eigen::Vector3d::Constant(kNan)};
        bundle.T_left_board[v] = T.value_or(none);
    }
    const std::vector<double> rms = view_rms_px(bundle);
    double sum = 0.0;
    for (const double view_px : rms)
        sum += std::isfinite(view_px) ? view_px / (1.0 + view_px / kSaturation_px) : kSaturation_px;
    return sum;
}

struct Candidate {
    double focal_px = 0.0;
    double score = 0.0;
};

/// Returns the best minima of the score along the focal lengths, at most kRefined, best first.
std::vector<Candidate> candidates(BoardBundle bundle) {
    const double side_px = std::max(bundle.size.width, bundle.size.height);
    std::vector<Candidate> all;
    for (double share = kShortest; share < kLongest; share *= kFocalStep) {
        set_focal(bundle, share * side_px);
        all.push_back({share * side_px, score(bundle)});
    }
    std::vector<Candidate> minima;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const bool falls = i == 0 || all[i].score <= all[i - 1].score;
        const bool rises = i + 1 == all.size() || all[i].score < all[i + 1].score;
        if (falls && rises) minima.push_back(all[i]);
    }
    std::stable_sort(minima.begin(), minima.end(), [](const Candidate& a, const Candidate& b) {
        return a.score < b.score;
    });
    minima.resize(std::min(minima.size(), kRefined));
    return minima;
}

/// Removes views in which a point has no image, because they would stop the solver.
void drop_invisible(BoardBundle& bundle) {
    const std::vector<double> rms = view_rms_px(bundle);
    for (std::size_t v = 0; v < rms.size(); ++v)
        if (!std::isfinite(rms[v])) drop_view(bundle, static_cast<int>(v));
}

std::optional<double> refine(BoardBundle& bundle) {
    drop_invisible(bundle);
    if (bundle.sights.empty()) return std::nullopt;
    std::optional<double> cost;
    for (const Freedom freedom : {Freedom::focal, Freedom::low_order, Freedom::everything}) {
        cost = solve(bundle, {freedom, kStartHuber_px, kStageIterations, kStageTolerance});
        if (!cost) return std::nullopt;
    }
    return cost;
}

/// Adds the views that the rough lens could not explain and the refined lens explains.
void add_missing(const BoardBundle& all, BoardBundle& refined) {
    BoardBundle trial = all;
    trial.lenses = refined.lenses;
    (void)score(trial);
    const std::vector<double> present = view_rms_px(refined);
    const std::vector<double> possible = view_rms_px(trial);
    for (const Sight& sight : all.sights) {
        const auto view = static_cast<std::size_t>(sight.view);
        if (!std::isnan(present[view]) || !std::isfinite(possible[view])) continue;
        refined.sights.push_back(sight);
        refined.T_left_board[view] = trial.T_left_board[view];
    }
}

struct Start {
    BoardBundle bundle;
    double cost = 0.0;
};

/// Returns the cost of a start; infinity if there is no start.
double cost_of(const std::optional<Start>& start) {
    return start ? start->cost : std::numeric_limits<double>::infinity();
}

/// Returns the cost of the views that a start leaves out because it cannot explain them. Without
/// this cost, such a start would look better.
double cost_of_missing(const BoardBundle& all, const BoardBundle& start) {
    const auto missing = static_cast<double>(all.sights.size() - start.sights.size());
    return missing * kStartHuber_px * kSaturation_px;
}

std::optional<Start> best_start(const BoardBundle& bundle) {
    std::optional<Start> best;
    for (const Candidate& candidate : candidates(bundle)) {
        BoardBundle trial = bundle;
        set_focal(trial, candidate.focal_px);
        (void)score(trial);
        const std::optional<double> cost = refine(trial);
        if (!cost) continue;
        const double total = *cost + cost_of_missing(bundle, trial);
        if (!(total < cost_of(best))) continue;
        best = Start{std::move(trial), total};
    }
    if (best) add_missing(bundle, best->bundle);
    return best;
}

/// Returns the rational lens that is nearest to Kannala and Brandt's radius r of the angle t. The
/// equation tan t (1 + k1 tan^2 t + k2 tan^4 t) = r (1 + k4 tan^2 t + k5 tan^4 t) is linear in the
/// coefficients. The highest coefficients k3 and k6 stay 0: with them the quotient may have a pole.
Eigen::VectorXd rational_like(const Eigen::VectorXd& fisheye, double widest_rad) {
    constexpr int kAngles = 60;
    const camera::CameraModel model = model_of(LensKind::fisheye, fisheye);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(kAngles, 4);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(kAngles);
    for (int i = 0; i < kAngles; ++i) {
        const double t = widest_rad * (i + 1) / kAngles;
        const auto pixel = camera::project(model, {std::sin(t), 0.0, std::cos(t)});
        if (!pixel) break;  // the direction has no image
        const double r = (pixel->x() - fisheye[2]) / fisheye[0];
        const double x = std::tan(t);
        const double x2 = x * x;
        A.row(i) << x * x2, x * x2 * x2, -r * x2, -r * x2 * x2;
        b[i] = r - x;
    }
    const Eigen::VectorXd k = A.colPivHouseholderQr().solve(b);
    Eigen::VectorXd lens = Eigen::VectorXd::Zero(12);
    lens.head<4>() = fisheye.head<4>();
    lens.segment<2>(4) = k.head<2>();
    lens.segment<2>(9) = k.tail<2>();
    return lens;
}

void become_rational(BoardBundle& bundle) {
    const camera::CameraModel model = model_of(bundle.kind, bundle.lenses[0]);
    if (bundle.kind == LensKind::fisheye) {
        constexpr double kWidest_rad = 1.4;  // at wider angles the tangent grows without limit
        double least_z = 1.0;
        for (const Sight& sight : bundle.sights)
            if (const auto ray = camera::unproject(model, sight.pixel))
                least_z = std::min(least_z, ray->normalized().z());
        const double widest_rad = std::acos(std::clamp(least_z, std::cos(kWidest_rad), 1.0));
        bundle.lenses[0] = rational_like(bundle.lenses[0], widest_rad);
    } else {
        bundle.lenses[0].conservativeResizeLike(Eigen::VectorXd::Zero(12));
    }
    bundle.kind = LensKind::rational;
    drop_invisible(bundle);
}

/// Starts a rational lens from a pinhole camera and from a fisheye: neither is near every rational
/// lens. From a field of view of 100 deg on, the polynomial of the pinhole sometimes ends in a
/// false minimum.
std::optional<Start> best_rational_start(const BoardBundle& bundle) {
    std::optional<Start> best;
    for (const LensKind near : {LensKind::pinhole5, LensKind::fisheye}) {
        BoardBundle simple = bundle;
        simple.kind = near;
        std::optional<Start> start = best_start(simple);
        if (!start) continue;
        become_rational(start->bundle);
        if (start->bundle.sights.empty()) continue;
        std::optional<double> cost = solve(start->bundle, kLastStage);
        if (!cost) continue;
        add_missing(bundle, start->bundle);
        cost = solve(start->bundle, kLastStage);
        if (!cost) continue;
        start->cost = *cost + cost_of_missing(bundle, start->bundle);
        if (start->cost < cost_of(best)) best = std::move(start);
    }
    return best;
}

}  // namespace

bool start_bundle(BoardBundle& bundle) {
    std::optional<Start> start =
        bundle.kind == LensKind::rational ? best_rational_start(bundle) : best_start(bundle);
    if (!start) return false;
    bundle = std::move(start->bundle);
    return true;
}

}  // namespace surefoot::calibration

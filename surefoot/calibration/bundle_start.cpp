// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/bundle_start.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/calibration/planar_pose.hpp"
#include "surefoot/calibration/robust_bundle.hpp"

namespace surefoot::calibration {
namespace {

/// Over the longer image side: 0.1 is an equidistant lens of 570 deg, 6 a telephoto lens of 9 deg.
constexpr double kShortest = 0.1;
constexpr double kLongest = 6.0;
constexpr double kFocalStep = 1.15;
constexpr std::size_t kRefined = 3;
/// A view's error saturates here, so that one with wrong ids cannot choose the focal length [px].
constexpr double kSaturation_px = 20.0;
/// Before the distortion is known, errors of this size are normal [px].
constexpr double kStartHuber_px = 5.0;
constexpr int kStageIterations = 30;
constexpr double kStageTolerance = 1e-6;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Sights of one view as plane points and rays.
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

/// Board poses for the present lens; how badly they explain the views.
double score(BoardBundle& bundle) {
    const std::vector<ViewRays> views = rays_of(bundle);
    for (std::size_t v = 0; v < views.size(); ++v) {
        const std::optional<Pose> T = planar_pose(views[v].points, views[v].rays);
        // NaN keeps a view without a pose out of all that follows.
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

/// Best first: the minima of the score along the focal lengths.
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

/// Views in which some point has no image would stop the solver: they wait outside.
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

/// Views that the rough lens could not explain get another chance with the refined one.
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

}  // namespace

bool start_bundle(BoardBundle& bundle) {
    const LensKind wanted = bundle.kind;
    if (wanted == LensKind::rational) bundle.kind = LensKind::pinhole5;
    std::optional<BoardBundle> best;
    double best_cost = std::numeric_limits<double>::infinity();
    for (const Candidate& candidate : candidates(bundle)) {
        BoardBundle trial = bundle;
        set_focal(trial, candidate.focal_px);
        (void)score(trial);
        const std::optional<double> cost = refine(trial);
        if (!cost) continue;
        // What a start cannot explain must not make it look better.
        const auto missing = static_cast<double>(bundle.sights.size() - trial.sights.size());
        const double total = *cost + missing * kStartHuber_px * kSaturation_px;
        if (!(total < best_cost)) continue;
        best_cost = total;
        best = std::move(trial);
    }
    if (best) {
        add_missing(bundle, *best);
        bundle = std::move(*best);
    }
    bundle.kind = wanted;
    if (!best) return false;
    const Eigen::Index known = bundle.lenses[0].size();
    bundle.lenses[0].conservativeResize(static_cast<Eigen::Index>(parameter_names(wanted).size()));
    bundle.lenses[0].tail(bundle.lenses[0].size() - known).setZero();
    return true;
}

}  // namespace surefoot::calibration

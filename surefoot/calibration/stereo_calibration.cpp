// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/stereo_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/calibration/bundle/relative_pose.hpp"
#include "surefoot/calibration/bundle/view_scatter.hpp"
#include "surefoot/calibration/lenses/rectified_errors.hpp"
#include "surefoot/camera/rectifier.hpp"

namespace surefoot::calibration {
namespace {

constexpr std::array<double, 3> kDistances_m{0.5, 1.0, 2.0};
/// Limit of a gross error of a relative pose, in robust standard deviations. A pair beyond the
/// limit would only disturb the joint solution.
constexpr double kGrossSigmas = 8.0;
constexpr double kMadToSigma = 1.4826;
/// Least limit of the scatter, as a share of the baseline and in rad: noiseless views scatter less.
constexpr double kLeastScatter = 1e-3;

/// An image pair with the results of the two separate cameras.
struct Pair {
    std::size_t index = 0;
    const ViewFit* left = nullptr;
    const ViewFit* right = nullptr;
    Pose T_left_right;
    double alone_rms_px = 0.0;
};

/// Expected rms of a pair in the joint solution, over all points of both images. It follows from
/// the corner noise of the separate cameras. Separately, two board poses adapt to the noise;
/// jointly, only one pose does. With a board of eight points this raises the rms by a seventh.
double alone_rms(const CameraFit& left, const CameraFit& right) {
    constexpr double kPose = 6.0;
    double square = 0.0;
    for (const Eigen::Vector2d& r : left.residuals_px) square += r.squaredNorm();
    for (const Eigen::Vector2d& r : right.residuals_px) square += r.squaredNorm();
    const auto points = static_cast<double>(left.residuals_px.size() + right.residuals_px.size());
    const double followed = (2.0 * points - kPose) / std::max(1.0, 2.0 * points - 2.0 * kPose);
    return std::sqrt(square / points * followed);
}

std::vector<Pair> pairs_of(const MonoCalibration& left, const MonoCalibration& right) {
    std::vector<Pair> pairs;
    for (const ViewFit& l : left.views) {
        const auto r = std::find_if(right.views.begin(),
                                    right.views.end(),
                                    [&](const ViewFit& view) { return view.index == l.index; });
        if (r == right.views.end()) continue;
        pairs.push_back({l.index,
                         &l,
                         &*r,
                         l.T_camera_board * r->T_camera_board.inverse(),
                         alone_rms(l.camera, r->camera)});
    }
    return pairs;
}

/// Returns the pairs that both cameras can use, without repeated and unnecessary pairs.
std::vector<std::size_t> usable_pairs(const Board& board,
                                      std::span<const BoardView> left,
                                      std::span<const BoardView> right,
                                      ImageSize size,
                                      const CalibrationOptions& options,
                                      std::vector<RejectedView>& rejected) {
    std::vector<std::size_t> usable;
    for (std::size_t i = 0; i < left.size(); ++i) {
        const auto bad_left = view_problem(board, left[i], size, options.least_points);
        const auto bad_right = view_problem(board, right[i], size, options.least_points);
        if (bad_left) reject(rejected, i, "left: " + *bad_left);
        if (bad_right) reject(rejected, i, "right: " + *bad_right);
        if (!bad_left && !bad_right) usable.push_back(i);
    }
    const auto motion = [&](std::size_t a, std::size_t b) {
        return std::max(motion_px(left[a], left[b]), motion_px(right[a], right[b]));
    };
    return select_views(usable, motion, options.selection, rejected);
}

std::vector<BoardView> chosen(std::span<const BoardView> views,
                              std::span<const std::size_t> indices) {
    std::vector<BoardView> result;
    for (const std::size_t i : indices) result.push_back(views[i]);
    return result;
}

/// Calibrates one camera from the views of the pairs. Converts view indices to pair indices. A
/// removed view removes its pair.
Result<MonoCalibration> calibrate_camera(const char* name,
                                         const Board& board,
                                         std::span<const BoardView> views,
                                         std::span<const std::size_t> indices,
                                         ImageSize size,
                                         LensKind kind,
                                         const StereoOptions& options,
                                         std::vector<RejectedView>& rejected) {
    CalibrationOptions this_camera = options.camera;
    this_camera.selection = {0.0, indices.size()};  // selection works on pairs, not on single views
    auto result = calibrate_mono(board, chosen(views, indices), size, kind, this_camera);
    if (!result) {
        std::string text = fmt::format("{} camera: {}", name, result.error().message);
        if (!rejected.empty()) text += fmt::format(" ({})", summary_of(rejected, views.size()));
        return Error{result.error().code, text};
    }
    for (const RejectedView& view : result->rejected)
        reject(rejected, indices[view.index], fmt::format("{}: {}", name, view.reason));
    for (ViewFit& view : result->views) view.index = indices[view.index];
    return result;
}

std::string scatter_text(const PoseDistance& off) {
    return fmt::format(
        "the relative pose of the two cameras differs by {:.4f} m and {:.2f} deg from that of the "
        "other pairs",
        off.translation_m,
        off.rotation_rad * 180.0 / std::numbers::pi);
}

/// Removes pairs whose relative pose is far outside the scatter of the others.
void drop_gross(std::vector<Pair>& pairs, const Pose& middle, std::vector<RejectedView>& rejected) {
    std::vector<double> metres;
    std::vector<double> radians;
    for (const Pair& pair : pairs) {
        metres.push_back(distance(middle, pair.T_left_right).translation_m);
        radians.push_back(distance(middle, pair.T_left_right).rotation_rad);
    }
    const double most_m = std::max(kGrossSigmas * kMadToSigma * median(metres),
                                   kLeastScatter * middle.translation_m.norm());
    const double most_rad = std::max(kGrossSigmas * kMadToSigma * median(radians), kLeastScatter);
    std::erase_if(pairs, [&](const Pair& pair) {
        const PoseDistance off = distance(middle, pair.T_left_right);
        const bool gross = off.translation_m > most_m || off.rotation_rad > most_rad;
        if (gross) {
            reject(rejected,
                   pair.index,
                   scatter_text(off) +
                       "; check that both images are from the same moment and that the files are "
                       "in order");
        }
        return gross;
    });
}

void add_sights(std::span<const Eigen::Vector3d> points,
                const BoardView& view,
                int this_camera,
                int index,
                std::vector<Sight>& sights) {
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
        const auto id = static_cast<std::size_t>(view.ids[i]);
        sights.push_back({this_camera, index, view.ids[i], points[id], view.pixels[i]});
    }
}

/// Returns the start of the joint bundle: lenses and boards of the separate cameras, and the median
/// relative pose.
BoardBundle bundle_of(const Board& board,
                      std::span<const BoardView> left_views,
                      std::span<const BoardView> right_views,
                      const MonoCalibration& left,
                      const MonoCalibration& right,
                      std::span<const Pair> pairs) {
    BoardBundle bundle;
    bundle.kind = left.kind;
    bundle.size = {left.camera.width, left.camera.height};
    bundle.lenses = {left.parameters, right.parameters};
    const std::vector<Eigen::Vector3d> points = board.points_m();
    std::vector<Pose> relative;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const Pair& pair = pairs[i];
        relative.push_back(pair.T_left_right);
        bundle.T_left_board.push_back(pair.left->T_camera_board);
        const int view = static_cast<int>(i);
        add_sights(points, left_views[pair.index], 0, view, bundle.sights);
        add_sights(points, right_views[pair.index], 1, view, bundle.sights);
    }
    bundle.T_left_right = median_pose(relative);
    bundle.disc_radius_m = 0.5 * (left.disc_radius_m + right.disc_radius_m);
    return bundle;
}

RobustLimits limits_of(std::span<const Pair> pairs, const StereoOptions& options) {
    std::vector<double> alone;
    for (const Pair& pair : pairs) alone.push_back(pair.alone_rms_px);
    const double usual_px = median(alone);
    RobustLimits limits = options.camera.limits;
    limits.least_views = options.least_pairs;
    for (const double rms : alone)
        limits.view_limits_px.push_back(options.pair_factor * std::max(rms, usual_px));
    return limits;
}

void reject_dropped(const RobustFit& fit,
                    std::span<const Pair> pairs,
                    const Pose& T_left_right,
                    std::vector<RejectedView>& rejected) {
    for (const DroppedView& dropped : fit.dropped) {
        const Pair& pair = pairs[static_cast<std::size_t>(dropped.view)];
        reject(rejected,
               pair.index,
               fmt::format(
                   "rms {:.2f} px for the pair and {:.2f} px for its single images; the limit for "
                   "the pair is {:.2f} px; {}: check that both images are from the same moment",
                   dropped.rms_px,
                   pair.alone_rms_px,
                   dropped.limit_px,
                   scatter_text(distance(T_left_right, pair.T_left_right))));
    }
}

/// Stores the fits of the pairs, the rms and the noise of the solution in `result`.
void describe(const BoardBundle& bundle,
              std::span<const Sight> all,
              std::span<const Pair> pairs,
              const RobustFit& fit,
              StereoCalibration& result) {
    std::vector<CameraFit> left = camera_fits(bundle, all, fit.outliers, 0);
    std::vector<CameraFit> right = camera_fits(bundle, all, fit.outliers, 1);
    const std::vector<double> rms = view_rms_px(bundle);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (std::isnan(rms[i])) continue;
        result.pairs.push_back({pairs[i].index,
                                bundle.T_left_board[i],
                                std::move(left[i]),
                                std::move(right[i]),
                                rms[i]});
    }
    result.rms_px = rms_px(bundle);
    result.sigma_px = fit.sigma_px;
    result.disc_radius_m = bundle.disc_radius_m;
}

/// Returns the points of a view that the estimate used. For discs: the images of their centres,
/// from the solution, plus the residuals of the centres of gravity.
BoardView used_points(const Board& board,
                      const BoardView& view,
                      const CameraFit& fit,
                      const camera::Camera& camera,
                      const Pose& T_camera_board) {
    const std::vector<Eigen::Vector3d> points = board.points_m();
    BoardView used;
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
        const auto& out = fit.outliers;
        if (std::find(out.begin(), out.end(), view.ids[i]) != out.end()) continue;
        Eigen::Vector2d pixel = view.pixels[i];
        if (view.disc_radius_m > 0.0) {
            const auto centre = camera::project(
                camera.model, T_camera_board * points[static_cast<std::size_t>(view.ids[i])]);
            if (!centre) continue;
            pixel = *centre + fit.residuals_px[i];
        }
        used.ids.push_back(view.ids[i]);
        used.pixels.push_back(pixel);
    }
    return used;
}

void describe_rectified(const Board& board,
                        std::span<const BoardView> left_views,
                        std::span<const BoardView> right_views,
                        const StereoParameters& parameters,
                        StereoCalibration& result) {
    std::vector<std::pair<BoardView, BoardView>> used;
    const camera::StereoRig& rig = result.rig;
    const Pose T_right_left = rig.T_left_right.inverse();
    for (const PairFit& pair : result.pairs) {
        const Pose& T_left_board = pair.T_left_board;
        used.emplace_back(
            used_points(board, left_views[pair.index], pair.left, rig.left, T_left_board),
            used_points(board,
                        right_views[pair.index],
                        pair.right,
                        *rig.right,
                        T_right_left * T_left_board));
    }
    const camera::Rectification plan = camera::plan_rectification(
        result.rig, camera::RectificationConfig{}, camera::Rectifier::kVirtualBaseline_m);
    result.row_focal_px =
        0.5 * (parameters.left.head<2>().mean() + parameters.right.head<2>().mean());
    result.row_rms_px = row_rms_px(plan, used, result.row_focal_px);
    result.rectified_focal_px = plan.rig.fx_px;
    const std::vector<double> sigmas_m =
        depth_sigmas_m(parameters, result.covariance, kDistances_m);
    for (std::size_t i = 0; i < kDistances_m.size(); ++i)
        result.depth_errors[i] = {kDistances_m[i], sigmas_m[i]};
}

Result<std::vector<Pair>> agreeing_pairs(const MonoCalibration& left,
                                         const MonoCalibration& right,
                                         std::size_t views,
                                         int least,
                                         std::vector<RejectedView>& rejected) {
    std::vector<Pair> pairs = pairs_of(left, right);
    std::vector<Pose> relative;
    relative.reserve(pairs.size());
    for (const Pair& pair : pairs) relative.push_back(pair.T_left_right);
    if (!pairs.empty()) drop_gross(pairs, median_pose(relative), rejected);
    if (static_cast<int>(pairs.size()) >= least) return pairs;
    return input_error(
        fmt::format("stereo calibration: only {} usable pairs; take at least {} ({})",
                    pairs.size(),
                    least,
                    summary_of(rejected, views)));
}

}  // namespace

Result<StereoCalibration> calibrate_stereo(const Board& board,
                                           std::span<const BoardView> left_views,
                                           std::span<const BoardView> right_views,
                                           ImageSize size,
                                           LensKind kind,
                                           const StereoOptions& options) {
    if (left_views.size() != right_views.size()) {
        return usage_error(
            fmt::format("stereo calibration: {} left views, but {} right views; give one right "
                        "view for each left view",
                        left_views.size(),
                        right_views.size()));
    }
    StereoCalibration result;
    result.kind = kind;
    if (const auto found = board.problem()) return usage_error(*found);
    const std::vector<std::size_t> usable =
        usable_pairs(board, left_views, right_views, size, options.camera, result.rejected);
    const auto left =
        calibrate_camera("left", board, left_views, usable, size, kind, options, result.rejected);
    if (!left) return left.error();
    const auto right =
        calibrate_camera("right", board, right_views, usable, size, kind, options, result.rejected);
    if (!right) return right.error();
    const auto pairs =
        agreeing_pairs(*left, *right, left_views.size(), options.least_pairs, result.rejected);
    if (!pairs) return pairs.error();
    BoardBundle bundle = bundle_of(board, left_views, right_views, *left, *right, *pairs);
    const std::vector<Sight> all = bundle.sights;
    const std::optional<RobustFit> fit = solve_robustly(bundle, limits_of(*pairs, options));
    if (!fit)
        return input_error(
            "stereo calibration: the joint optimisation failed; add views of the board");
    reject_dropped(*fit, *pairs, bundle.T_left_right, result.rejected);
    if (fit->contradiction) {
        return input_error(
            fmt::format("stereo calibration: fewer than {} pairs agree on one relative pose; check "
                        "that left and right images are from the same moment and rig ({})",
                        options.least_pairs,
                        summary_of(result.rejected, left_views.size())));
    }

    const StereoParameters parameters{
        kind, size, bundle.lenses[0], bundle.lenses[1], bundle.T_left_right};
    result.rig = rig_of(parameters);
    if (const auto found = result.rig.problem())
        return input_error("stereo calibration: " + *found);
    result.stated_sigma_px = stated_sigma_px(bundle, fit->sigma_px);
    const auto uncertainty = covariance(bundle, result.stated_sigma_px);
    if (!uncertainty)
        return input_error(
            "stereo calibration: the pairs do not determine the cameras; add views with other "
            "tilts and distances of the board");
    result.covariance = *uncertainty;
    describe(bundle, all, *pairs, *fit, result);
    describe_rectified(board, left_views, right_views, parameters, result);
    return result;
}

}  // namespace surefoot::calibration

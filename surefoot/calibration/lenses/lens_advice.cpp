// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/lenses/lens_advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/calibration/bundle/bundle_start.hpp"
#include "surefoot/calibration/bundle/mono_bundle.hpp"
#include "surefoot/calibration/bundle/planar_pose.hpp"
#include "surefoot/calibration/bundle/robust_bundle.hpp"
#include "surefoot/calibration/bundle/view_selection.hpp"

namespace surefoot::calibration {
namespace {

constexpr std::size_t kMostViews = 16;
constexpr std::size_t kFewestViews = 3;
constexpr std::size_t kFewestHalved = 8;
constexpr int kFewestPoints = 8;
/// The rms of an advised lens must be below this share of the rms of the chosen lens. It must also
/// be smaller by more than kLeastGain_px, because corner noise alone can cause smaller differences.
constexpr double kBetter = 0.7;
constexpr double kLeastGain_px = 0.02;
/// Lenses explain the boards about equally well if their rms is below the best rms times this
/// factor.
constexpr double kAlike = 1.1;
/// Larger errors count linearly [px]: a single wrong corner must not choose the lens.
constexpr double kHuber_px = 1.0;
constexpr int kIterations = 50;
constexpr double kTolerance = 1e-6;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Selects views with different poses, in ascending order of index.
std::vector<std::size_t> chosen_views(const Board& board,
                                      std::span<const BoardView> views,
                                      ImageSize size) {
    std::vector<std::size_t> usable;
    for (std::size_t i = 0; i < views.size(); ++i)
        if (!view_problem(board, views[i], size, kFewestPoints)) usable.push_back(i);
    SelectionLimits limits;
    limits.most_views = kMostViews;
    std::vector<RejectedView> rejected;
    const auto motion = [&](std::size_t a, std::size_t b) { return motion_px(views[a], views[b]); };
    return select_views(usable, motion, limits, rejected);
}

std::optional<Eigen::VectorXd> fitted_lens(BoardBundle bundle) {
    if (!start_bundle(bundle)) return std::nullopt;
    if (!solve(bundle, {Freedom::everything, kHuber_px, kIterations, kTolerance}))
        return std::nullopt;
    return bundle.lenses[0];
}

/// Returns the rms of a view with its best pose [px]; infinite if the lens does not image the view.
double shown_rms_px(BoardBundle view, const Eigen::VectorXd& lens) {
    view.lenses = {lens};
    const camera::CameraModel model = model_of(view.kind, lens);
    std::vector<Eigen::Vector3d> points;
    std::vector<Eigen::Vector3d> rays;
    for (const Sight& sight : view.sights) {
        const auto ray = camera::unproject(model, sight.pixel);
        if (!ray) continue;
        points.push_back(sight.point_board_m);
        rays.push_back(*ray);
    }
    if (2 * points.size() < view.sights.size()) return kInfinity;
    const auto pose = planar_pose(points, rays);
    if (!pose) return kInfinity;
    view.T_left_board = {*pose};
    if (!std::isfinite(rms_px(view))) return kInfinity;
    if (!solve(view, {Freedom::poses, kHuber_px, kIterations, kTolerance})) return kInfinity;
    const double rms = rms_px(view);
    if (!std::isfinite(rms)) return kInfinity;
    return rms;
}

/// Returns the name of a lens kind for use in a sentence.
std::string name_of(LensKind kind) {
    switch (kind) {
        case LensKind::fisheye: return "a fisheye";
        case LensKind::rational: return "a wide lens of the rational model";
        default: return "a pinhole camera";
    }
}

const char* model_name(LensKind kind) {
    return kLensKindNames[static_cast<std::size_t>(kind)];
}

}  // namespace

std::optional<LensTrial> try_lens(const Board& board,
                                  std::span<const BoardView> views,
                                  ImageSize size,
                                  LensKind kind) {
    const std::vector<std::size_t> kept = chosen_views(board, views, size);
    if (kept.size() < kFewestViews) return std::nullopt;
    const std::size_t halves = kept.size() < kFewestHalved ? 1 : 2;
    std::vector<double> all_px;
    for (std::size_t half = 0; half < halves; ++half) {
        std::vector<std::size_t> own;
        for (std::size_t i = 0; i < kept.size(); ++i)
            if (halves == 1 || i % halves == half) own.push_back(kept[i]);
        const auto lens = fitted_lens(mono_bundle(board, views, own, size, kind));
        for (std::size_t i = 0; i < kept.size(); ++i) {
            if (halves > 1 && i % halves == half) continue;
            const std::size_t one[] = {kept[i]};
            all_px.push_back(lens ? shown_rms_px(mono_bundle(board, views, one, size, kind), *lens)
                                  : kInfinity);
        }
    }
    return LensTrial{kind, median(std::move(all_px))};
}

std::optional<LensAdvice> advise_lens(const Board& board,
                                      std::span<const BoardView> views,
                                      ImageSize size,
                                      LensKind chosen) {
    const auto own = try_lens(board, views, size, chosen);
    if (!own) return std::nullopt;
    std::vector<LensTrial> others;
    double best_px = kInfinity;
    for (const LensKind kind : {LensKind::pinhole5, LensKind::fisheye, LensKind::rational}) {
        if (kind == chosen) continue;
        const auto trial = try_lens(board, views, size, kind);
        if (!trial) continue;
        others.push_back(*trial);
        best_px = std::min(best_px, trial->rms_px);
    }
    if (!(best_px < kBetter * own->rms_px && best_px < own->rms_px - kLeastGain_px))
        return std::nullopt;
    const auto better = std::find_if(others.begin(), others.end(), [&](const LensTrial& trial) {
        return trial.rms_px <= kAlike * best_px;
    });
    return LensAdvice{*own, *better};
}

std::string in_words(const LensAdvice& advice) {
    const std::string own = std::isfinite(advice.chosen.rms_px)
                                ? fmt::format("rms {:.2f} px against {:.2f} px with {}",
                                              advice.better.rms_px,
                                              advice.chosen.rms_px,
                                              model_name(advice.chosen.kind))
                                : fmt::format("rms {:.2f} px; {} does not fit most views",
                                              advice.better.rms_px,
                                              model_name(advice.chosen.kind));
    return fmt::format("this lens looks like {} ({}): try --model {}",
                       name_of(advice.better.kind),
                       own,
                       model_name(advice.better.kind));
}

}  // namespace surefoot::calibration

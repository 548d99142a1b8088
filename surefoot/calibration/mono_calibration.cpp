// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/mono_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/calibration/bundle/bundle_start.hpp"
#include "surefoot/calibration/bundle/mono_bundle.hpp"
#include "surefoot/calibration/bundle/view_scatter.hpp"
#include "surefoot/calibration/lenses/lens_advice.hpp"

namespace surefoot::calibration {
namespace {

constexpr const char* kUnexplained =
    "calibration: no camera fits the views; check the board, the order of its points and the lens "
    "model";

std::vector<std::size_t> usable_views(const Board& board,
                                      std::span<const BoardView> views,
                                      ImageSize size,
                                      const CalibrationOptions& options,
                                      std::vector<RejectedView>& rejected) {
    std::vector<std::size_t> usable;
    for (std::size_t i = 0; i < views.size(); ++i) {
        if (const auto found = view_problem(board, views[i], size, options.least_points))
            reject(rejected, i, *found);
        else
            usable.push_back(i);
    }
    const auto motion = [&](std::size_t a, std::size_t b) { return motion_px(views[a], views[b]); };
    return select_views(usable, motion, options.selection, rejected);
}

/// Variation of the boards in a bundle.
struct Variety {
    double tilt_deg = 0.0;        ///< largest angle between two boards
    double distance_ratio = 1.0;  ///< distance of the farthest board divided by that of the nearest
};

Variety variety_of(const BoardBundle& bundle) {
    std::vector<Pose> poses;
    const std::vector<double> rms = view_rms_px(bundle);
    for (std::size_t v = 0; v < rms.size(); ++v)
        if (!std::isnan(rms[v])) poses.push_back(bundle.T_left_board[v]);
    Variety variety;
    for (const Pose& a : poses) {
        for (const Pose& b : poses) {
            const double cosine = std::clamp(a.R().col(2).dot(b.R().col(2)), -1.0, 1.0);
            variety.tilt_deg =
                std::max(variety.tilt_deg, std::acos(cosine) * 180.0 / std::numbers::pi);
            variety.distance_ratio =
                std::max(variety.distance_ratio, a.translation_m.norm() / b.translation_m.norm());
        }
    }
    return variety;
}

/// Returns the reason why the result must not be used; empty if the result is valid.
std::string weakness_of(const MonoCalibration& result,
                        const CalibrationOptions& options,
                        const Variety& variety) {
    if (variety.tilt_deg < options.least_tilt_deg) return "the views are too similar";
    if (result.covariance.size() == 0) return "the views do not determine the camera";
    const double share = std::sqrt(result.covariance(0, 0)) / result.parameters[0];
    if (!(share <= options.most_focal_sigma)) {
        return fmt::format(
            "the focal length of {:.1f} px is uncertain by {:.1f} % (one sigma); the limit is "
            "{:.1f} %",
            result.parameters[0],
            100.0 * share,
            100.0 * options.most_focal_sigma);
    }
    return result.camera.problem().value_or("");
}

/// Adds the views that the robust fit removed to `rejected`, with their reasons.
void reject_dropped(const RobustFit& fit,
                    std::span<const std::size_t> kept,
                    std::vector<RejectedView>& rejected) {
    for (const DroppedView& view : fit.dropped) {
        reject(
            rejected,
            kept[static_cast<std::size_t>(view.view)],
            fmt::format("rms {:.2f} px exceeds the limit of {:.2f} px: this view contradicts the "
                        "others",
                        view.rms_px,
                        view.limit_px));
    }
}

std::vector<ViewFit> view_fits(const BoardBundle& bundle,
                               std::span<const std::size_t> kept,
                               std::span<const Sight> all,
                               const RobustFit& fit) {
    std::vector<CameraFit> cameras = camera_fits(bundle, all, fit.outliers, 0);
    const std::vector<double> rms = view_rms_px(bundle);
    std::vector<ViewFit> views;
    for (std::size_t v = 0; v < kept.size(); ++v)
        if (!std::isnan(rms[v]))
            views.push_back({kept[v], bundle.T_left_board[v], std::move(cameras[v])});
    return views;
}

/// Returns the error to report. If another lens kind explains the views, the error names this kind.
/// With a wrong lens, the other reasons (tilts, focal length, views that disagree) mislead.
Error failure(const Board& board,
              std::span<const BoardView> views,
              ImageSize size,
              LensKind kind,
              const std::string& reason) {
    if (const auto advice = advise_lens(board, views, size, kind))
        return input_error("calibration: " + in_words(*advice));
    return input_error(reason);
}

}  // namespace

Result<MonoCalibration> calibrate_mono(const Board& board,
                                       std::span<const BoardView> views,
                                       ImageSize size,
                                       LensKind kind,
                                       const CalibrationOptions& options) {
    if (const auto found = board.problem()) return usage_error(*found);
    MonoCalibration result;
    result.kind = kind;
    const auto least = static_cast<std::size_t>(options.limits.least_views);
    const std::vector<std::size_t> kept =
        usable_views(board, views, size, options, result.rejected);
    if (kept.size() < least) {
        return input_error(fmt::format(
            "calibration: only {} usable and different views of the board; take at least {} ({})",
            kept.size(),
            least,
            summary_of(result.rejected, views.size())));
    }

    BoardBundle bundle = mono_bundle(board, views, kept, size, kind);
    const std::vector<Sight> all = bundle.sights;
    const auto failed = [&](const std::string& reason) {
        return failure(board, views, size, kind, reason);
    };
    if (!start_bundle(bundle)) return failed(kUnexplained);
    const std::vector<double> start_rms = view_rms_px(bundle);
    for (std::size_t v = 0; v < kept.size(); ++v)
        if (std::isnan(start_rms[v]))
            reject(result.rejected, kept[v], "no pose of the board fits this view");
    const std::optional<RobustFit> fit = solve_robustly(bundle, options.limits);
    if (!fit) return failed(kUnexplained);
    reject_dropped(*fit, kept, result.rejected);
    const auto left = static_cast<std::size_t>(views_left(bundle));
    if (fit->contradiction || left < least || 2 * left < kept.size()) {
        return failed(
            fmt::format("calibration: only {} of {} views agree with each other; check the board's "
                        "size, the order of its points and the lens model ({})",
                        left - (fit->contradiction ? 1 : 0),
                        kept.size(),
                        summary_of(result.rejected, views.size())));
    }

    result.parameters = bundle.lenses[0];
    result.camera = {model_of(kind, result.parameters), size.width, size.height};
    result.stated_sigma_px = stated_sigma_px(bundle, fit->sigma_px);
    result.covariance = covariance(bundle, result.stated_sigma_px).value_or(Eigen::MatrixXd());
    const Variety variety = variety_of(bundle);
    if (const std::string found = weakness_of(result, options, variety); !found.empty()) {
        return failed(
            fmt::format("calibration: {}; the views differ by {:.1f} deg in tilt (at least {:.0f} "
                        "deg are needed) and by a factor of {:.2f} in the distance of the board: "
                        "show the board tilted by 20 to 40 deg about both axes, "
                        "near and far",
                        found,
                        variety.tilt_deg,
                        options.least_tilt_deg,
                        variety.distance_ratio));
    }
    result.rms_px = rms_px(bundle);
    result.sigma_px = fit->sigma_px;
    result.disc_radius_m = bundle.disc_radius_m;
    result.views = view_fits(bundle, kept, all, *fit);
    return result;
}

}  // namespace surefoot::calibration

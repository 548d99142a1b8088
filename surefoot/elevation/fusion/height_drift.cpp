// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/height_drift.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::elevation {
namespace {

/// Largest offset [m] that counts as drift. Larger offsets belong to other surfaces, however
/// uncertain the motion is.
constexpr double kMost_m = 0.1;
constexpr double kBin_m = 1e-4;  ///< bin width of the histogram [m]
constexpr int kBins = 2 * 1000 + 1;
constexpr int kTileCells = 8;
constexpr int kLeastOfTile = 4;  ///< smallest number of agreeing cells in a tile, of sixteen
constexpr double kAgreeingSigmas = 2.5;  ///< same as the default of elevation.gate_sigma
/// Variance of a median divided by that of a mean, for normal noise: pi / 2.
constexpr double kMedianLoss = 1.5708;
constexpr double kSlopeChi2 = 13.8;  ///< exceeded by chance in 0.1 % of cases, 2 degrees of freedom
/// A camera tilt that explains this share of the offset at the cells makes the offset unusable.
constexpr double kTiltShare = 0.25;
constexpr std::uint32_t kEveryStep = std::numeric_limits<std::uint32_t>::max();
/// If recently aligned ground shows this share of the offset, the offset is unusable.
constexpr double kFrameShare = 0.5;

int bin_of(double offset_m) {
    const double bin = std::floor((offset_m + kMost_m) / kBin_m + 0.5);
    return clamped_integer<int>(bin, 0, kBins - 1);
}

int tiles_along(int cells) {
    return (cells + kTileCells - 1) / kTileCells;
}

/// Returns the height variance that the motion added since the residual was observed. Assumes the
/// same variance per motion as before the observation.
double later_variance_m2(const HeightResidual& residual, std::uint32_t motions) {
    const auto before = static_cast<double>(residual.seen_step - residual.step);
    const auto since = static_cast<double>(motions - residual.seen_step);
    return before > 0.0 ? static_cast<double>(residual.motion_var_m2) * since / before : 0.0;
}

bool agrees(const HeightResidual& residual, double offset_m) {
    const double apart_m = static_cast<double>(residual.offset_m) - offset_m;
    return apart_m * apart_m <=
           kAgreeingSigmas * kAgreeingSigmas * static_cast<double>(residual.var_m2);
}

}  // namespace

void HeightDriftConfig::describe(ConfigVisitor& visitor) {
    visitor.boolean(
        "enabled", enabled, "true: correct old parts of the map by the drift of the body's height");
    visitor.integer(
        "min_motions",
        min_motions,
        1,
        100000,
        "a cell is old after this number of frames with an uncertain motion (covariance above 0) "
        "since its last agreeing observation; its height error must also reach min_drift_m");
    visitor.number(
        "min_drift_m",
        min_drift_m,
        0.0,
        1.0,
        "a cell is old only if the motions since an observation last agreed with it cause "
        "at least this height error (1 sigma)");
    visitor.number("level_m",
                   level_m,
                   0.0,
                   1.0,
                   "largest height difference between a cell and the map two cells beside it; the "
                   "drift check skips cells with a larger difference");
    visitor.integer("kept_motions",
                    kept_motions,
                    0,
                    100000,
                    "the difference between measured and remembered height of an old cell is kept "
                    "for this number of frames with an uncertain motion (covariance above 0)");
    visitor.integer("min_cells",
                    min_cells,
                    1,
                    4096,
                    "a height correction needs at least this many cells. The check uses every "
                    "fourth cell (every second one of every second row), and of the old cells only "
                    "the half that agreed with an observation the longest time ago");
    visitor.integer("min_tiles",
                    min_tiles,
                    4,
                    1000000,
                    "smallest number of squares of 8 x 8 cells that a height correction needs; a "
                    "square counts if at least four of its cells show the offset");
    visitor.number(
        "min_spread_m",
        min_spread_m,
        0.0,
        100.0,
        "a height correction needs at least this standard deviation of the positions of the "
        "squares (see min_tiles), along the direction in which they spread most");
    visitor.number("agreeing_share",
                   agreeing_share,
                   0.5,
                   1.0,
                   "a height correction needs at least this share of the old cells (see min_cells) "
                   "with the same height offset within their noise");
    visitor.number("significance_sigmas",
                   significance_sigmas,
                   0.1,
                   100.0,
                   "smallest height offset that corrects the map [sigma of the offset]");
    visitor.number(
        "motion_sigmas",
        motion_sigmas,
        0.0,
        100.0,
        "largest height offset that counts as drift [sigma of the motion since the alignment]");
    visitor.number("depth_scale_sigma",
                   depth_scale_sigma,
                   0.0,
                   1.0,
                   "relative error that all depths of one frame share (1 sigma)");
}

std::string_view to_string(HeightDriftReason reason) noexcept {
    switch (reason) {
        case HeightDriftReason::off: return "off";
        case HeightDriftReason::no_old_ground: return "no_old_ground";
        case HeightDriftReason::few_cells: return "few_cells";
        case HeightDriftReason::no_common_offset: return "no_common_offset";
        case HeightDriftReason::not_significant: return "not_significant";
        case HeightDriftReason::tilted: return "tilted";
        case HeightDriftReason::frame_is_off: return "frame_is_off";
        case HeightDriftReason::beyond_motion: return "beyond_motion";
        case HeightDriftReason::moved: return "moved";
    }
    return "unknown";
}

bool HeightDrift::allows(double offset_m, double motion_var_m2) const noexcept {
    return offset_m * offset_m <= config_.motion_sigmas * config_.motion_sigmas * motion_var_m2;
}

void HeightDrift::reserve(const grid::GridGeometry& geometry) {
    steps_.reserve(HeightResiduals::kMostOld);
    weights_.reserve(kBins);
    tiles_.reserve(static_cast<std::size_t>(tiles_along(geometry.nx)) *
                   static_cast<std::size_t>(tiles_along(geometry.ny)));
}

std::uint32_t HeightDrift::middle_step(std::span<const HeightResidual> old) {
    steps_.clear();
    steps_.reserve(old.size());
    for (const HeightResidual& residual : old) steps_.push_back(residual.step);
    const auto middle = steps_.begin() + static_cast<std::ptrdiff_t>((steps_.size() - 1) / 2);
    std::nth_element(steps_.begin(), middle, steps_.end());
    return *middle;
}

double HeightDrift::median_m(std::span<const HeightResidual> residuals, std::uint32_t last_step) {
    weights_.assign(kBins, 0.0);
    double sum = 0.0;
    for (const HeightResidual& residual : residuals) {
        if (residual.step > last_step) continue;
        const double weight = 1.0 / static_cast<double>(residual.var_m2);
        const int bin_of_cell = bin_of(static_cast<double>(residual.offset_m));
        weights_[static_cast<std::size_t>(bin_of_cell)] += weight;
        sum += weight;
    }
    double below = 0.0;
    int bin = 0;
    for (; bin < kBins - 1; ++bin) {
        below += weights_[static_cast<std::size_t>(bin)];
        if (below >= 0.5 * sum) break;
    }
    return bin * kBin_m - kMost_m;
}

void HeightDrift::add_agreeing(const HeightResidual& residual, const grid::GridGeometry& geometry) {
    const auto cell = geometry.cell_at(residual.at_m.x(), residual.at_m.y());
    if (!cell) return;  // the cell left the window
    Tile& tile = tiles_[static_cast<std::size_t>(cell->iy / kTileCells * tiles_along(geometry.nx) +
                                                 cell->ix / kTileCells)];
    ++tile.cells;
    tile.sum_m += static_cast<double>(residual.offset_m);
    tile.sum_from_m += residual.from_camera_m.cast<double>();
}

HeightDrift::Field HeightDrift::field_of_tiles() const {
    Field field;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    for (const Tile& tile : tiles_) {
        if (tile.cells < kLeastOfTile) continue;
        const double n = tile.cells;
        const Eigen::Vector3d point(
            tile.sum_from_m.x() / n, tile.sum_from_m.y() / n, tile.sum_m / n);
        ++field.tiles;
        sum += point;
        squares += point * point.transpose();
    }
    if (field.tiles < 4) return field;
    const double n = field.tiles;
    const Eigen::Matrix3d about_mean = squares - sum * sum.transpose() / n;
    field.mean_m = sum.head<2>() / n;
    field.offset_m = sum.z() / n;
    field.scatter_m2 = std::max(0.0, about_mean(2, 2) / (n - 1.0));
    const Eigen::Matrix2d places = about_mean.topLeftCorner<2, 2>();
    const double half = 0.5 * (places(0, 0) - places(1, 1));
    const double longer =
        0.5 * (places(0, 0) + places(1, 1)) + std::sqrt(half * half + places(0, 1) * places(0, 1));
    field.spread_m = std::sqrt(longer / n);
    const double det = places(0, 0) * places(1, 1) - places(0, 1) * places(0, 1);
    if (!(det > 0.0)) return field;
    // Least squares for offset = mean + slope (position - mean position).
    const Eigen::Vector2d leaning = about_mean.topRightCorner<2, 1>();
    field.slope = {(places(1, 1) * leaning.x() - places(0, 1) * leaning.y()) / det,
                   (places(0, 0) * leaning.y() - places(0, 1) * leaning.x()) / det};
    const double explained_m2 = field.slope.dot(leaning);
    const double rest_m2 = std::max(about_mean(2, 2) - explained_m2, 0.0) / (n - 3.0);
    field.slope_chi2 = explained_m2 / std::max(rest_m2, kBin_m * kBin_m);
    return field;
}

HeightDrift::Evidence HeightDrift::collect(std::span<const HeightResidual> residuals,
                                           double offset_m,
                                           std::uint32_t last_step,
                                           const Frame& frame) {
    const int tiles = tiles_along(frame.geometry.nx) * tiles_along(frame.geometry.ny);
    tiles_.assign(static_cast<std::size_t>(tiles), {});
    Evidence evidence;
    for (const HeightResidual& residual : residuals) {
        if (residual.step > last_step) continue;
        ++evidence.asked;
        if (!agrees(residual, offset_m)) continue;
        ++evidence.agreeing;
        add_agreeing(residual, frame.geometry);
        evidence.ground_slope += residual.slope.cast<double>();
        evidence.drift_m += static_cast<double>(residual.drift_m);
        evidence.motion_var_m2 += static_cast<double>(residual.motion_var_m2);
        evidence.later_var_m2 += later_variance_m2(residual, frame.motions);
        evidence.height_m += static_cast<double>(residual.height_m);
    }
    if (evidence.agreeing == 0) return evidence;
    const auto n = static_cast<double>(evidence.agreeing);
    evidence.ground_slope /= n;
    evidence.drift_m /= n;
    evidence.motion_var_m2 /= n;
    evidence.later_var_m2 /= n;
    evidence.height_m /= n;
    evidence.field = field_of_tiles();
    return evidence;
}

double HeightDrift::variance_m2(const Evidence& evidence, const Frame& frame) const {
    const Field& field = evidence.field;
    if (field.tiles == 0) return 0.0;
    const auto square = [](double value) { return value * value; };
    const double scale_m = config_.depth_scale_sigma * (frame.camera_z_m - evidence.height_m);
    return kMedianLoss * field.scatter_m2 / field.tiles +  //
           2.0 * square(frame.systematic_sigma_m) +
           square(frame.tilt_sigma_rad) * field.mean_m.squaredNorm() + square(scale_m) +
           evidence.later_var_m2 + evidence.ground_slope.squaredNorm() * square(evidence.drift_m);
}

double HeightDrift::frame_error_m(std::span<const HeightResidual> recent,
                                  const Eigen::Vector2d& at_m,
                                  const Frame& frame) {
    if (recent.size() < static_cast<std::size_t>(config_.min_cells)) return 0.0;
    const Field field = collect(recent, median_m(recent, kEveryStep), kEveryStep, frame).field;
    if (field.tiles < config_.min_tiles) return 0.0;
    return field.offset_m + field.slope.dot(at_m - field.mean_m);
}

HeightDriftReason HeightDrift::reason_of(const HeightDriftReport& report,
                                         const Evidence& evidence,
                                         std::span<const HeightResidual> recent,
                                         const Frame& frame) {
    using enum HeightDriftReason;
    if (evidence.asked < config_.min_cells) return few_cells;
    const auto asked = static_cast<double>(evidence.asked);
    if (static_cast<double>(evidence.agreeing) < config_.agreeing_share * asked)
        return no_common_offset;
    const Field& field = evidence.field;
    if (field.tiles < config_.min_tiles || !(field.spread_m >= config_.min_spread_m))
        return few_cells;
    const double offset_m = std::abs(report.offset_m);
    if (!(offset_m >= config_.significance_sigmas * report.sigma_m) || offset_m < kBin_m)
        return not_significant;
    const double leaning_m = std::abs(field.slope.dot(field.mean_m));
    if (field.slope_chi2 > kSlopeChi2 && leaning_m >= kTiltShare * offset_m) return tilted;
    if (std::abs(frame_error_m(recent, field.mean_m, frame)) >= kFrameShare * offset_m)
        return frame_is_off;
    return allows(offset_m, evidence.motion_var_m2) ? moved : beyond_motion;
}

HeightDrift::Verdict HeightDrift::judge(std::span<const HeightResidual> old,
                                        std::span<const HeightResidual> recent,
                                        const Frame& frame) {
    Verdict verdict;
    HeightDriftReport& report = verdict.report;
    if (old.empty()) {
        report.reason = HeightDriftReason::no_old_ground;
        return verdict;
    }
    verdict.last_step = middle_step(old);
    report.offset_m = median_m(old, verdict.last_step);
    const Evidence evidence = collect(old, report.offset_m, verdict.last_step, frame);
    report.cells = evidence.agreeing;
    report.sigma_m = std::sqrt(variance_m2(evidence, frame));
    report.reason = reason_of(report, evidence, recent, frame);
    return verdict;
}

}  // namespace surefoot::elevation

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/foothold.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/grid/whole_cells.hpp"
#include "surefoot/traversability/disc.hpp"

namespace surefoot::traversability {
namespace {

constexpr float kNothing = -std::numeric_limits<float>::infinity();

/// Reuses the memory of `widths`, because every frame calls this.
void set_half_widths(double radius_m, double resolution_m, std::vector<int>& widths) {
    const int reach = Disc::reach_of(radius_m, resolution_m);
    widths.resize(static_cast<std::size_t>(reach) + 1);
    for (int dy = 0; dy <= reach; ++dy)
        widths[static_cast<std::size_t>(dy)] = Disc::half_width_of(radius_m, resolution_m, dy);
}

int reach_of(const std::vector<int>& half_widths) {
    return static_cast<int>(half_widths.size()) - 1;
}

float at_or_nan(ImageView<const float> layer, int ix, int iy) {
    return layer.empty() ? kNanF : layer.at(ix, iy);
}

double variance_of(const FootholdGround& ground, int ix, int iy) {
    return ground.height_var_m2.empty() ? 0.0
                                        : static_cast<double>(ground.height_var_m2.at(ix, iy));
}

}  // namespace

/// Sums and extremes around the cells of one row.
struct FootholdFinder::Row {
    std::vector<Sums> foot;            ///< sums over F; xz with x relative to the cell
    std::vector<double> yz;            ///< sum of y z over F, y in cells relative to the cell
    std::vector<double> unknown_band;  ///< number of unknown cells of B
    std::vector<double> tight_band;    ///< number of cells of B with too little clearance
    std::vector<float> patch_high;
    std::vector<float> patch_low;
    std::vector<float> low_near;  ///< largest low_shown_ in B and up to corner_m beyond B
    std::vector<float> low_possible;

    void reset(int nx) {
        const auto n = static_cast<std::size_t>(nx);
        foot.assign(n, {});
        yz.assign(n, 0.0);
        unknown_band.assign(n, 0.0);
        tight_band.assign(n, 0.0);
        for (auto* best : {&patch_high, &patch_low, &low_near, &low_possible})
            best->assign(n, kNothing);
    }
};

FootholdFinder::FootholdFinder(const FootholdConfig& config) : config_(config) {}
FootholdFinder::FootholdFinder(FootholdFinder&&) noexcept = default;
FootholdFinder& FootholdFinder::operator=(FootholdFinder&&) noexcept = default;
FootholdFinder::~FootholdFinder() = default;

void FootholdFinder::shape(double resolution_m) {
    if (resolution_m == resolution_m_) return;
    resolution_m_ = resolution_m;
    const double foot_m = config_.foot_radius_m + config_.margin_m;
    set_half_widths(foot_m, resolution_m, foot_);
    set_half_widths(foot_m + config_.band_m, resolution_m, band_);
    set_half_widths(foot_m + config_.band_m + config_.corner_m, resolution_m, near_);
    for (int yaw = 0; yaw < kYaws; ++yaw) turned_[static_cast<std::size_t>(yaw)] = turned_foot(yaw);
    patch_cells_ = std::max(1, grid::whole_cells(std::round(config_.patch_side_m / resolution_m)));
    const double overhead_side = config_.overhead_side_m / resolution_m;
    overhead_cells_ = std::max(1.0, std::round(overhead_side * overhead_side));
    foot_cells_ = 0.0;
    foot_moment_ = 0.0;
    for (int dy = -reach_of(foot_); dy <= reach_of(foot_); ++dy) {
        const int h = foot_[static_cast<std::size_t>(std::abs(dy))];
        foot_cells_ += 2 * h + 1;
        foot_moment_ += (2 * h + 1) * dy * dy;
    }
    const double errors = std::max(
        1.0, std::numbers::pi * foot_m * foot_m / (config_.correlation_m * config_.correlation_m));
    slope_sigmas_per_m_ = config_.sigma_factor / (0.5 * foot_m * std::sqrt(errors));
}

FootholdFinder::TurnedFoot FootholdFinder::turned_foot(int yaw) const {
    // Sine and cosine of 22.5 deg. They are written out, so that no math library influences where a
    // foot may stand.
    constexpr double kSin = 0.38268343236508977;
    constexpr double kCos = 0.92387953251128674;
    constexpr double kHalf = 0.70710678118654752;
    constexpr double kCosines[kYaws] = {1.0, kCos, kHalf, kSin, 0.0, -kSin, -kHalf, -kCos};
    constexpr double kSines[kYaws] = {0.0, kSin, kHalf, kCos, 1.0, kCos, kHalf, kSin};
    constexpr double kRounding_m = 1e-9;
    const double half_width_m = 0.5 * config_.foot_width_m;
    const double half_length_m =
        std::sqrt(config_.foot_radius_m * config_.foot_radius_m - half_width_m * half_width_m);
    TurnedFoot turned;
    const int reach = reach_of(foot_);
    turned.runs.reserve(foot_.size() * 2);
    for (int dy = -reach; dy <= reach; ++dy) {
        const int h = foot_[static_cast<std::size_t>(std::abs(dy))];
        TurnedFoot::Run run{dy, 1, 0};
        for (int dx = -h; dx <= h; ++dx) {
            const double along = dx * kCosines[yaw] + dy * kSines[yaw];
            const double across = dy * kCosines[yaw] - dx * kSines[yaw];
            if (std::abs(along) * resolution_m_ > half_length_m + kRounding_m ||
                std::abs(across) * resolution_m_ > half_width_m + kRounding_m) {
                continue;
            }
            if (run.first_dx > run.last_dx) run.first_dx = dx;
            run.last_dx = dx;
            turned.xx += dx * dx;
            turned.xy += dx * dy;
            turned.yy += dy * dy;
        }
        if (run.first_dx <= run.last_dx) turned.runs.push_back(run);
    }
    return turned;
}

void FootholdFinder::find(const FootholdGround& ground, Executor& executor, Image<Foothold>& out) {
    SUREFOOT_ASSERT(!config_.problem());
    nx_ = ground.height_m.width;
    ny_ = ground.height_m.height;
    out.resize(nx_, ny_);
    if (!config_.fits(ground.resolution_m)) {
        std::fill_n(out.data(), out.size(), Foothold::unknown);
        return;
    }
    shape(ground.resolution_m);
    sums_.resize((static_cast<std::size_t>(nx_) + 1) * static_cast<std::size_t>(ny_));
    patch_m_.resize(nx_, ny_);
    patch_k_sigma_m_.resize(nx_, ny_);
    for (RunMaxima* maxima : {&patch_high_, &patch_low_, &low_shown_, &low_possible_})
        maxima->reset(nx_, ny_);
    rows_.resize(static_cast<std::size_t>(ny_));
    struct Job {
        FootholdFinder& finder;
        const FootholdGround& ground;
        Image<Foothold>& out;
    } job{*this, ground, out};
    executor.parallel_for(ny_, [&job](int iy) {
        job.finder.sum_row(job.ground, iy);
        job.finder.patch_row(job.ground, iy);
    });
    executor.parallel_for(
        ny_, [&job](int iy) { job.finder.judge_row(job.ground, iy, job.out.row(iy)); });
}

/// Computes all figures that depend only on one row of the ground.
void FootholdFinder::sum_row(const FootholdGround& ground, int iy) {
    Sums* sums = sums_.data() + static_cast<std::ptrdiff_t>(iy) * (nx_ + 1);
    float* shown = low_shown_.row(iy);
    float* possible = low_possible_.row(iy);
    Sums total;
    for (int ix = 0; ix < nx_; ++ix) {
        sums[ix] = total;
        const float height_m = ground.height_m.at(ix, iy);
        const float clearance_m = at_or_nan(ground.clearance_m, ix, iy);
        if (static_cast<double>(clearance_m) < config_.clearance_m) total.tight += 1.0;
        if (!std::isfinite(height_m)) {
            total.unknown += 1.0;
            const float free_m = at_or_nan(ground.free_above_m, ix, iy);
            shown[ix] = std::isnan(free_m) ? kNothing : -free_m;
            possible[ix] = kNothing;
            continue;
        }
        const auto z_m = static_cast<double>(height_m);
        const double var_m2 = variance_of(ground, ix, iy);
        const auto k_sigma_m = static_cast<float>(config_.sigma_factor * std::sqrt(var_m2));
        const bool is_agreed = ground.observations.empty() || ground.observations.at(ix, iy) > 1;
        shown[ix] = is_agreed ? -(height_m + k_sigma_m) : kNothing;
        possible[ix] = -(height_m - k_sigma_m);
        total.z += z_m;
        total.xz += ix * z_m;
        total.var += var_m2;
    }
    sums[nx_] = total;
    low_shown_.build(iy);
    low_possible_.build(iy);
}

/// Computes the patches that begin in the cells of a row. Patches with an unknown cell, or beyond
/// the map, are unknown.
void FootholdFinder::patch_row(const FootholdGround& ground, int iy) {
    const double cells = patch_cells_ * patch_cells_;
    const double per_error = 1.0 / std::min(cells, config_.independent_cells);
    for (int ix = 0; ix < nx_; ++ix) {
        double z_m = 0.0;
        double var_m2 = 0.0;
        const bool inside = ix + patch_cells_ <= nx_ && iy + patch_cells_ <= ny_;
        for (int i = 0; inside && i < patch_cells_ * patch_cells_; ++i) {
            const int x = ix + i % patch_cells_;
            const int y = iy + i / patch_cells_;
            z_m += static_cast<double>(ground.height_m.at(x, y));
            var_m2 += variance_of(ground, x, y);
        }
        const bool known = inside && std::isfinite(z_m);
        const auto mean_m = static_cast<float>(z_m / cells);
        const auto k_sigma_m =
            static_cast<float>(config_.sigma_factor * std::sqrt(var_m2 / cells * per_error));
        patch_m_.at(ix, iy) = known ? mean_m : kNanF;
        patch_k_sigma_m_.at(ix, iy) = k_sigma_m;
        patch_high_.row(iy)[ix] = known ? mean_m + k_sigma_m : kNothing;
        patch_low_.row(iy)[ix] = known ? -(mean_m - k_sigma_m) : kNothing;
    }
    patch_high_.build(iy);
    patch_low_.build(iy);
}

int FootholdFinder::patch_half_width(int dy) const {
    // All rows of the patch must lie within F over their full width.
    return std::min(foot_[static_cast<std::size_t>(std::abs(dy))],
                    foot_[static_cast<std::size_t>(std::abs(dy + patch_cells_ - 1))]);
}

void FootholdFinder::gather(int iy, Row& row) const {
    row.reset(nx_);
    const int foot = reach_of(foot_);
    const int band = reach_of(band_);
    const int near = reach_of(near_);
    for (int dy = std::max(-near, -iy); dy <= std::min(near, ny_ - 1 - iy); ++dy) {
        const auto distance = static_cast<std::size_t>(std::abs(dy));
        low_shown_.take(iy + dy, -near_[distance], near_[distance], row.low_near.data());
        if (std::abs(dy) > band) continue;
        const Sums* sums = sums_.data() + static_cast<std::ptrdiff_t>(iy + dy) * (nx_ + 1);
        const int h = band_[distance];
        low_possible_.take(iy + dy, -h, h, row.low_possible.data());
        for (int ix = h; ix < nx_ - h; ++ix) {
            const Sums& begin = sums[ix - h];
            const Sums& end = sums[ix + h + 1];
            row.unknown_band[static_cast<std::size_t>(ix)] += end.unknown - begin.unknown;
            row.tight_band[static_cast<std::size_t>(ix)] += end.tight - begin.tight;
        }
        if (std::abs(dy) > foot) continue;
        const int f = foot_[distance];
        for (int ix = f; ix < nx_ - f; ++ix) {
            const Sums& begin = sums[ix - f];
            const Sums& end = sums[ix + f + 1];
            Sums& total = row.foot[static_cast<std::size_t>(ix)];
            const double z = end.z - begin.z;
            total.z += z;
            total.xz += (end.xz - begin.xz) - ix * z;
            total.var += end.var - begin.var;
            total.unknown += end.unknown - begin.unknown;
            total.tight += end.tight - begin.tight;
            row.yz[static_cast<std::size_t>(ix)] += dy * z;
        }
        if (dy + patch_cells_ - 1 > foot) continue;
        const int p = patch_half_width(dy);
        if (2 * p + 1 < patch_cells_) continue;
        patch_high_.take(iy + dy, -p, p - patch_cells_ + 1, row.patch_high.data());
        patch_low_.take(iy + dy, -p, p - patch_cells_ + 1, row.patch_low.data());
    }
}

void FootholdFinder::judge_row(const FootholdGround& ground, int iy, Foothold* out) {
    Row& row = rows_[static_cast<std::size_t>(iy)];
    gather(iy, row);
    for (int ix = 0; ix < nx_; ++ix) out[ix] = judge(ground, ix, iy, row);
}

Foothold FootholdFinder::judge(const FootholdGround& ground, int ix, int iy, const Row& row) const {
    const float height_m = ground.height_m.at(ix, iy);
    if (!std::isfinite(height_m)) return Foothold::unknown;
    const auto at = static_cast<std::size_t>(ix);
    const auto inside = [&](int reach) {
        return ix >= reach && iy >= reach && ix < nx_ - reach && iy < ny_ - reach;
    };
    const Sums& foot = row.foot[at];
    const bool foot_known = inside(reach_of(foot_)) && foot.unknown == 0.0;
    const double middle_m = foot_known
                                ? foot.z / foot_cells_
                                : static_cast<double>(height_m) -
                                      config_.sigma_factor * std::sqrt(variance_of(ground, ix, iy));
    // The wider area is tested everywhere; B itself is tested only if the wider area shows a drop.
    if (middle_m + static_cast<double>(row.low_near[at]) > config_.drop_m &&
        middle_m + static_cast<double>(low_in_band(ix, iy)) > config_.drop_m) {
        return Foothold::drop;
    }
    const bool band_known = inside(reach_of(band_)) && row.unknown_band[at] == 0.0;
    if (!foot_known || !band_known) return Foothold::unknown;

    const double slope_x = foot.xz / foot_moment_ / resolution_m_;
    const double slope_y = row.yz[at] / foot_moment_ / resolution_m_;
    const double slope = std::sqrt(slope_x * slope_x + slope_y * slope_y);
    const double slope_k_sigma = slope_sigmas_per_m_ * std::sqrt(foot.var / foot_cells_);
    if (slope - slope_k_sigma > config_.max_slope) return Foothold::tilted;
    Foothold found = Foothold::safe;
    // If the highest and the lowest patch are near every height of p, all patches are near p.
    const double rise_m = slope * (config_.foot_radius_m + config_.margin_m);
    const bool level =
        static_cast<double>(row.patch_high[at]) - (middle_m - rise_m) <= config_.max_residual_m &&
        static_cast<double>(row.patch_low[at]) + (middle_m + rise_m) <= config_.max_residual_m;
    if (!level) found = judge_patches(ix, iy, middle_m, slope_x, slope_y);
    if (found == Foothold::rough) return found;
    if (foot.tight >= overhead_cells_) return Foothold::low;
    if (row.tight_band[at] > 0.0 || slope + slope_k_sigma > config_.max_slope ||
        middle_m + static_cast<double>(row.low_possible[at]) > config_.drop_m ||
        drop_begins(middle_m, slope, row.low_near[at]) ||
        (slope > 0.5 * config_.max_slope && tilts_at_a_yaw(ix, iy))) {
        return Foothold::unsure;
    }
    const bool cut_off = !ground.reach_step_m.empty() && std::isnan(ground.reach_step_m.at(ix, iy));
    return found == Foothold::safe && cut_off ? Foothold::unreachable : found;
}

Foothold FootholdFinder::judge_patches(
    int ix, int iy, double middle_m, double slope_x, double slope_y) const {
    const double to_middle = 0.5 * (patch_cells_ - 1);
    const int foot = reach_of(foot_);
    Foothold found = Foothold::safe;
    for (int dy = -foot; dy + patch_cells_ - 1 <= foot; ++dy) {
        const int p = patch_half_width(dy);
        const float* mean_m = patch_m_.row(iy + dy) + ix;
        const float* k_sigma_m = patch_k_sigma_m_.row(iy + dy) + ix;
        const double row_m = middle_m + slope_y * (dy + to_middle) * resolution_m_;
        for (int dx = -p; dx <= p - patch_cells_ + 1; ++dx) {
            const double plane_m = row_m + slope_x * (dx + to_middle) * resolution_m_;
            const double residual_m = std::abs(static_cast<double>(mean_m[dx]) - plane_m);
            const auto k_sigma = static_cast<double>(k_sigma_m[dx]);
            if (residual_m - k_sigma > config_.max_residual_m) return Foothold::rough;
            if (residual_m + k_sigma > config_.max_residual_m) found = Foothold::unsure;
        }
    }
    return found;
}

float FootholdFinder::low_in_band(int ix, int iy) const {
    const int band = reach_of(band_);
    float low = kNothing;
    for (int dy = std::max(-band, -iy); dy <= std::min(band, ny_ - 1 - iy); ++dy) {
        const int h = band_[static_cast<std::size_t>(std::abs(dy))];
        low = std::max(low, low_shown_.largest(iy + dy, ix, -h, h));
    }
    return low;
}

bool FootholdFinder::drop_begins(double middle_m, double slope, float low_near) const {
    if (config_.corner_m == 0.0) return false;
    const double rise_m =
        slope * (config_.foot_radius_m + config_.margin_m + config_.band_m + config_.corner_m);
    return middle_m - rise_m + static_cast<double>(low_near) > 0.5 * config_.drop_m;
}

bool FootholdFinder::tilts_at_a_yaw(int ix, int iy) const {
    for (const TurnedFoot& turned : turned_) {
        const double determinant = turned.xx * turned.yy - turned.xy * turned.xy;
        // A foot of a single row of cells defines no plane.
        if (!(determinant > 0.0)) continue;
        double xz = 0.0;
        double yz = 0.0;
        for (const TurnedFoot::Run& run : turned.runs) {
            const Sums* sums =
                sums_.data() + static_cast<std::ptrdiff_t>(iy + run.dy) * (nx_ + 1) + ix;
            const Sums& begin = sums[run.first_dx];
            const Sums& end = sums[run.last_dx + 1];
            const double z = end.z - begin.z;
            xz += (end.xz - begin.xz) - ix * z;
            yz += run.dy * z;
        }
        const double slope_x = (turned.yy * xz - turned.xy * yz) / determinant / resolution_m_;
        const double slope_y = (turned.xx * yz - turned.xy * xz) / determinant / resolution_m_;
        if (slope_x * slope_x + slope_y * slope_y > config_.max_slope * config_.max_slope)
            return true;
    }
    return false;
}

void FootholdConfig::describe(ConfigVisitor& visitor) {
    visitor.number("foot_radius_m", foot_radius_m, 0.01, 1.0, "half the diagonal of a foot");
    visitor.number("foot_width_m", foot_width_m, 0.01, 1.0, "length of the shorter side of a foot");
    visitor.number(
        "margin_m",
        margin_m,
        0.0,
        1.0,
        "largest position error of edges in the map; the search adds this margin to the foot");
    visitor.number(
        "band_m", band_m, 0.0, 1.0, "width of the solid ground that is required around the foot");
    visitor.number("corner_m",
                   corner_m,
                   0.0,
                   1.0,
                   "a foothold is unsure if ground in the band, or up to this distance beyond the "
                   "band, is proven to lie more than half of drop_m below the foot; 0 = no such "
                   "check");
    visitor.number("drop_m",
                   drop_m,
                   0.001,
                   1.0,
                   "ground that lies below the foot by more than this length is a drop");
    visitor.number("max_slope",
                   max_slope,
                   0.001,
                   10.0,
                   "largest slope of the plane under the foot, rise over run");
    visitor.number(
        "patch_side_m", patch_side_m, 0.001, 1.0, "side length of the square patches under a foot");
    visitor.number("max_residual_m",
                   max_residual_m,
                   0.001,
                   1.0,
                   "largest distance of the mean of a patch from the plane under the foot");
    visitor.number(
        "sigma_factor",
        sigma_factor,
        0.0,
        100.0,
        "number of standard deviations (sigma) by which the ground must stay within every limit");
    visitor.number("independent_cells",
                   independent_cells,
                   1.0,
                   10000.0,
                   "largest number of cells in a patch whose errors count as independent");
    visitor.number(
        "correlation_m",
        correlation_m,
        0.001,
        10.0,
        "distance on the ground within which errors of the stereo matcher are correlated");
    visitor.number("clearance_m", clearance_m, 0.0, 100.0, "required free height over the foot");
    visitor.number("overhead_side_m",
                   overhead_side_m,
                   0.0,
                   1.0,
                   "side length of a square: a low overhead object over less than this area may be "
                   "a wrong match and makes the foothold unsure");
}

std::optional<std::string> FootholdConfig::problem() const {
    if (foot_width_m > std::numbers::sqrt2 * foot_radius_m) {
        return fmt::format(
            "foothold.foot_width_m = {} must be at most sqrt(2) times "
            "foothold.foot_radius_m = {}: it is the shorter side of the foot",
            foot_width_m,
            foot_radius_m);
    }
    if (patch_side_m <= foot_radius_m) return std::nullopt;
    return fmt::format("foothold.patch_side_m = {} must not exceed foothold.foot_radius_m = {}",
                       patch_side_m,
                       foot_radius_m);
}

bool FootholdConfig::fits(double resolution_m) const noexcept {
    const double reach_m = foot_radius_m + margin_m + band_m + corner_m;
    return resolution_m <= foot_radius_m && reach_m <= (RunMaxima::kMargin - 1) * resolution_m;
}

std::string_view to_string(Foothold foothold) noexcept {
    switch (foothold) {
        case Foothold::unknown: return "unknown";
        case Foothold::safe: return "safe";
        case Foothold::unsure: return "unsure";
        case Foothold::drop: return "drop";
        case Foothold::tilted: return "tilted";
        case Foothold::rough: return "rough";
        case Foothold::low: return "low";
        case Foothold::unreachable: return "unreachable";
    }
    return "unknown";
}

}  // namespace surefoot::traversability

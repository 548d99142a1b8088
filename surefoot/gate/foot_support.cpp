// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/foot_support.hpp"

#include <algorithm>
#include <optional>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/gate/nosing_lines.hpp"
#include "surefoot/gate/tilt.hpp"

namespace surefoot::gate {
namespace {

using grid::FixedPoint;

/// Exact sums over cells, in units of 0.1 mm. x and y are doubled coordinates from the middle of
/// the foot. z is the height above the plane of the stance.
struct Sums {
    std::int64_t n = 0;
    std::int64_t x = 0, y = 0, z = 0;
    std::int64_t xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;

    void add(FixedPoint p, std::int64_t height) noexcept {
        ++n;
        x += p.x;
        y += p.y;
        z += height;
        xx += p.x * p.x;
        xy += p.x * p.y;
        yy += p.y * p.y;
        xz += p.x * height;
        yz += p.y * height;
    }
};

/// The weighted mean of a patch. A cell whose sigma exceeds `patch_sigma` has a smaller weight: the
/// ratio of the two variances. So a cell with a rejected measurement does not spoil the patch.
struct PatchSums {
    std::int64_t n = 0;
    double weight = 0.0;
    double x = 0.0, y = 0.0, z = 0.0;  ///< weighted sums of x, y and z
    double variance = 0.0;             ///< sum of the variances times the squared weights

    void add(FixedPoint p, std::int64_t height, std::int64_t sigma, std::int64_t sure) noexcept {
        const auto variance_of = [](std::int64_t s) { return static_cast<double>(s * s); };
        const double w = variance_of(sure) / variance_of(std::max(sigma, sure));
        ++n;
        weight += w;
        x += w * static_cast<double>(p.x);
        y += w * static_cast<double>(p.y);
        z += w * static_cast<double>(height);
        variance += w * w * variance_of(sigma);
    }
};

/// z = height + slope_x * (x - mean_x) + slope_y * (y - mean_y), with z in 0.1 mm. x and y are
/// doubled coordinates.
struct FootPlane {
    bool valid = false;
    double mean_x = 0.0;
    double mean_y = 0.0;
    double height = 0.0;
    double slope_x = 0.0;
    double slope_y = 0.0;

    [[nodiscard]] double at(double x, double y) const noexcept {
        return height + slope_x * (x - mean_x) + slope_y * (y - mean_y);
    }
    /// Squared tangent of the tilt against odom's z axis; the heights of the plane count from a
    /// plane with the slopes `below`. The factor 2 accounts for the doubled coordinates.
    [[nodiscard]] double tilt_tan_sq(const StancePlane::Tangents& below) const noexcept {
        const double x = 2.0 * slope_x + below.x;
        const double y = 2.0 * slope_y + below.y;
        return x * x + y * y;
    }
};

/// Solves the normal equations of the centred points. The sums are exact. After them, the function
/// uses only + - * /, and the compiler makes no fused multiply-add. So all computers give the same
/// bits.
FootPlane fit_plane(const Sums& sums) noexcept {
    FootPlane plane;
    if (sums.n < 3) return plane;
    const auto n = static_cast<double>(sums.n);
    const auto x = static_cast<double>(sums.x);
    const auto y = static_cast<double>(sums.y);
    const auto z = static_cast<double>(sums.z);
    const double xx = n * static_cast<double>(sums.xx) - x * x;
    const double xy = n * static_cast<double>(sums.xy) - x * y;
    const double yy = n * static_cast<double>(sums.yy) - y * y;
    const double xz = n * static_cast<double>(sums.xz) - x * z;
    const double yz = n * static_cast<double>(sums.yz) - y * z;
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 0.0)) return plane;
    plane.valid = true;
    plane.mean_x = x / n;
    plane.mean_y = y / n;
    plane.height = z / n;
    plane.slope_x = (xz * yy - yz * xy) / determinant;
    plane.slope_y = (yz * xx - xz * xy) / determinant;
    return plane;
}

std::int64_t rounded(double value) noexcept {
    return saturated_integer<std::int64_t>(value < 0.0 ? value - 0.5 : value + 0.5);
}

/// The patches of a foot in the foot's axes.
class Patches {
  public:
    static constexpr std::int64_t kMaxPerSide = 16;  // Machine::problem() checks this

    Patches(const GroundBox& box, const FixedPose& target, const GateLimits& limits) noexcept
        : pose_(target),
          sure_(limits.patch_sigma_tenth_mm),
          length_(box.length_tenth_mm),
          width_(box.width_tenth_mm),
          along_(per_side(length_, limits)),
          across_(per_side(width_, limits)) {}

    /// Adds a cell. `p`: doubled odom coordinates from the middle of the foot. A cell that only
    /// overlaps the rim belongs to the nearest patch, so no cell is lost.
    void add(FixedPoint p, std::int64_t height, std::int64_t sigma) noexcept {
        const std::int64_t forward = p.x * pose_.cos_yaw + p.y * pose_.sin_yaw;
        const std::int64_t left = p.y * pose_.cos_yaw - p.x * pose_.sin_yaw;
        const std::int64_t row = index(forward, length_, along_);
        const std::int64_t column = index(left, width_, across_);
        sums_[static_cast<std::size_t>(row * across_ + column)].add(p, height, sigma, sure_);
    }
    [[nodiscard]] std::int64_t count() const noexcept { return along_ * across_; }
    [[nodiscard]] const PatchSums& operator[](std::int64_t i) const noexcept {
        return sums_[static_cast<std::size_t>(i)];
    }

  private:
    static std::int64_t per_side(std::int64_t size, const GateLimits& limits) noexcept {
        return std::clamp<std::int64_t>(size / limits.patch_side_tenth_mm, 1, kMaxPerSide);
    }
    static std::int64_t index(std::int64_t at, std::int64_t size, std::int64_t count) noexcept {
        const std::int64_t from_edge =
            at + size * FixedPose::kOne;  // coordinates are doubled, so half a size is `size`
        return std::clamp<std::int64_t>(
            grid::floor_div(from_edge * count, 2 * size * FixedPose::kOne), 0, count - 1);
    }

    FixedPose pose_;
    std::int64_t sure_;
    std::int64_t length_;
    std::int64_t width_;
    std::int64_t along_;
    std::int64_t across_;
    std::array<PatchSums, static_cast<std::size_t>(kMaxPerSide* kMaxPerSide)> sums_{};
};

/// The state of the test of one landing foot.
struct Landing {
    const Scene& scene;
    const FootSweep& foot;
    FootPlane plane;
    Findings& findings;

    /// Returns a finding at the cell of a point in doubled coordinates from the middle of the foot.
    [[nodiscard]] Finding at(double x,
                             double y,
                             std::int64_t value,
                             std::int64_t limit) const noexcept {
        const grid::FixedGrid& grid = scene.ground.grid();
        const std::int64_t odom_x = foot.landing_center.x + rounded(x / 2.0);
        const std::int64_t odom_y = foot.landing_center.y + rounded(y / 2.0);
        return finding_at(grid::floor_div(odom_x - grid.origin_x, grid.side),
                          grid::floor_div(odom_y - grid.origin_y, grid.side),
                          foot.foot,
                          value,
                          limit);
    }
};

const StepLimits& step_limits(const Scene& scene) noexcept {
    return scene.machine.limits.step[static_cast<std::size_t>(scene.movement.movement_class)];
}

/// Tests the step limits. `where`: a finding whose value is the rise to test [0.1 mm].
void check_rise(const StepLimits& limits, Finding where, Findings& findings) noexcept {
    const std::int64_t rise = where.value_tenth_mm;
    const auto deny = [&](Reason reason, std::int64_t value, std::int64_t limit) {
        where.value_tenth_mm = where.severity = value;
        where.limit_tenth_mm = limit;
        findings.deny(reason, where);
    };
    if (!(rise <= limits.up_tenth_mm)) deny(Reason::step_too_high, rise, limits.up_tenth_mm);
    if (!(-rise <= limits.down_tenth_mm)) deny(Reason::step_too_low, -rise, limits.down_tenth_mm);
}

void check_step(const Landing& landing) noexcept {
    const std::int64_t rise = rounded(landing.plane.at(0.0, 0.0));
    Evidence& evidence = landing.findings.evidence;
    const std::int64_t worst = evidence.height_delta_tenth_mm;
    if ((rise < 0 ? -rise : rise) > (worst < 0 ? -worst : worst))
        evidence.height_delta_tenth_mm = rise;
    const StepLimits& limits = step_limits(landing.scene);
    check_rise(limits, landing.at(0.0, 0.0, rise, 0), landing.findings);
    // Also tests the rise of this foot alone. If one foot stands above the mean of both feet and
    // the other foot below, the height of one foot could change by twice the limit.
    const auto& feet = landing.scene.stance.feet_tenth_mm;
    const auto stood = feet[landing.foot.foot == Foot::left ? 0 : 1];
    if (stood) check_rise(limits, landing.at(0.0, 0.0, rise - *stood, 0), landing.findings);
}

/// Tests the tilt limit. Returns false if it denies, like check_patch().
bool check_tilt(const Landing& landing) noexcept {
    const Ground& ground = landing.scene.ground;
    const auto below = landing.scene.stance.plane.tangents(ground.grid().side);
    const double tan_sq =
        steepest_tan_sq(landing.plane.tilt_tan_sq(below), ground.vertical_bound_tan());
    Evidence& evidence = landing.findings.evidence;
    evidence.max_tilt_tan_sq = std::max(evidence.max_tilt_tan_sq, tan_sq);
    if (keeps_tilt_limit(tan_sq, landing.scene.machine.limits)) return true;
    Finding finding = landing.at(0.0, 0.0, 0, 0);
    finding.severity = rounded(1e6 * std::min(tan_sq, 1e6));
    landing.findings.deny(Reason::slope, finding);
    return false;
}

bool check_patch(const Landing& landing, const PatchSums& patch) noexcept {
    if (patch.n == 0) return true;  // with large cells, some patches are empty
    const GateLimits& limits = landing.scene.machine.limits;
    const double x = patch.x / patch.weight;
    const double y = patch.y / patch.weight;
    // Errors of neighbouring cells are correlated. So at most `independent` cells reduce the
    // variance.
    const std::int64_t independent =
        std::min<std::int64_t>(patch.n, limits.patch_independent_cells);
    const double alike = static_cast<double>(patch.n) / static_cast<double>(independent);
    const double variance = alike * patch.variance / (patch.weight * patch.weight);
    Evidence& evidence = landing.findings.evidence;
    evidence.max_patch_sigma_sq_tenth_mm2 =
        std::max(evidence.max_patch_sigma_sq_tenth_mm2, variance);
    const auto sigma_limit = static_cast<double>(limits.patch_sigma_tenth_mm);
    const bool resolvable = variance <= sigma_limit * sigma_limit;  // false for NaN
    if (!resolvable) {
        Finding finding = landing.at(x, y, 0, limits.patch_sigma_tenth_mm);
        finding.severity = rounded(variance);
        landing.findings.deny(Reason::not_resolvable, finding);
    }
    // If the patch is not resolvable, tests the residual alone, without sigma.
    const double noise_sq = resolvable ? limits.sigma_factor * limits.sigma_factor * variance : 0.0;
    const double residual = patch.z / patch.weight - landing.plane.at(x, y);
    const double size = residual < 0.0 ? -residual : residual;
    const double slack = static_cast<double>(limits.patch_residual_tenth_mm) - size;
    const bool even = slack >= 0.0 && noise_sq <= slack * slack;  // false for NaN
    if (!even)
        landing.findings.deny(Reason::roughness,
                              landing.at(x, y, rounded(size), limits.patch_residual_tenth_mm));
    return resolvable && even;
}

/// The sums over the cells under a landing foot.
struct FootCells {
    Sums all{};
    Patches patches;
    bool has_pebble = false;   ///< true: one cell stands alone (stands_alone)
    std::int64_t grounds = 0;  ///< number of the other cells
    Finding lowest{};          ///< lowest of the other cells; value = height above the stance
    Finding highest{};

    void add(FixedPoint p, std::int64_t height, std::int64_t sigma) noexcept {
        all.add(p, height);
        patches.add(p, height, sigma);
    }
    void add_extreme(Finding here, std::int64_t low, std::int64_t high) noexcept {
        here.value_tenth_mm = low;
        if (grounds == 0 || low < lowest.value_tenth_mm) lowest = here;
        here.value_tenth_mm = high;
        if (grounds == 0 || high > highest.value_tenth_mm) highest = here;
        ++grounds;
    }
};

/// True for a single cell outside the step limits whose eight neighbours are known and within the
/// limits. The cell must be neither an obstacle for a swinging foot nor a drop. Such a cell is a
/// wrong match or a pebble, and the mean of its patch includes it. A real kerb or sill fills more
/// than one cell. Only one such cell per foot is allowed, because the foot would stand on several
/// of them.
bool stands_alone(const Scene& scene,
                  std::int64_t ix,
                  std::int64_t iy,
                  std::int64_t rise) noexcept {
    const StepLimits& step = step_limits(scene);
    const auto kept = [&](std::int64_t height) {
        return height <= step.up_tenth_mm && -height <= step.down_tenth_mm;
    };
    const GateLimits& limits = scene.machine.limits;
    if (kept(rise) || rise > limits.swing_clearance_tenth_mm || -rise > limits.drop_tenth_mm)
        return false;
    return scene.ground.all_around(
        ix, iy, [&](const GroundCell& beside, std::int64_t x, std::int64_t y) {
            return kept(beside.height_tenth_mm - scene.stance.plane.at(x, y));
        });
}

/// Adds all cells under the foot. Returns false if a cell is unknown: then no plane exists.
bool gather_cells(const Scene& scene,
                  const FootSweep& foot,
                  const ReachableSurfaces& reachable,
                  Findings& findings,
                  FootCells& cells) noexcept {
    std::optional<NosingLines> lines;
    if (scene.movement.movement_class == MovementClass::stair)
        lines.emplace(scene.ground, scene.machine.limits, foot.landing, 0);
    return grid::for_each_overlapped_cell(
        foot.landing, scene.ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
            GroundCell cell = scene.ground.cell(ix, iy);
            const bool sharpened = lines && lines->sharpen(ix, iy, cell);
            const Finding here = finding_at(ix, iy, foot.foot, 0, 0);
            if (!cell.known()) {
                findings.deny(reason_of_unknown(cell.knowledge), here);
                return false;
            }
            // A cell across a nosing can be a surface of its own.
            if (cell.knowledge == Knowledge::measured && !sharpened &&
                !reachable.contains(cell.component))
                findings.deny(Reason::disconnected, here);
            // Other rules refuse heights above 3 m. The clamp keeps the sums exact.
            const auto above = [&](const StancePlane& plane) {
                return std::clamp<std::int64_t>(
                    cell.height_tenth_mm - plane.at(ix, iy), -30'000, 30'000);
            };
            const std::int64_t height = above(scene.stance.plane);
            cells.add(scene.ground.doubled_center(ix, iy, foot.landing_center),
                      height,
                      cell.sigma_tenth_mm);
            // Where the ground under the feet bends or its slope is unsure, all planes must agree.
            std::int64_t low = height;
            std::int64_t high = height;
            for (const StancePlane& part : scene.stance.parts) {
                low = std::min(low, above(part));
                high = std::max(high, above(part));
            }
            if (!cells.has_pebble && stands_alone(scene, ix, iy, height))
                cells.has_pebble = true;
            else
                cells.add_extreme(here, low, high);
            return true;
        });
}

}  // namespace

void check_landing(const Scene& scene,
                   const FootSweep& foot,
                   const GroundBox& box,
                   const ReachableSurfaces& reachable,
                   Findings& findings) noexcept {
    const GateLimits& limits = scene.machine.limits;
    FootCells cells{.patches = Patches(box, scene.sweep.target, limits)};
    if (!gather_cells(scene, foot, reachable, findings, cells)) return;
    const Landing landing{scene, foot, fit_plane(cells.all), findings};
    if (!landing.plane.valid) {
        findings.deny(Reason::not_resolvable, landing.at(0.0, 0.0, 0, 0));
        return;
    }
    // With a larger spread, some cell is an obstacle or a drop. A plane through both levels would
    // give a height and a tilt that no part of the ground has.
    const std::int64_t spread = cells.highest.value_tenth_mm - cells.lowest.value_tenth_mm;
    const std::int64_t spread_limit = limits.swing_clearance_tenth_mm + limits.drop_tenth_mm;
    if (spread > spread_limit) {
        findings.deny(Reason::roughness, landing.at(0.0, 0.0, spread, spread_limit));
        return;
    }
    check_step(landing);
    bool flat = check_tilt(landing);
    for (std::int64_t i = 0; i < cells.patches.count(); ++i)
        flat = check_patch(landing, cells.patches[i]) && flat;
    if (!flat) return;  // already refused: tilt or patches explain it better than cell heights
    check_rise(step_limits(scene), cells.highest, findings);
    check_rise(step_limits(scene), cells.lowest, findings);
}

}  // namespace surefoot::gate

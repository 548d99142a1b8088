// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/footprint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/grid/convex_area.hpp"
#include "surefoot/traversability/footprint_rows.hpp"

namespace surefoot::traversability {
namespace {

using grid::CellRun;
using grid::ConvexArea;

static_assert(2 * Footprint::kMaxVertices <= ConvexArea::kMaxPoints);

/// Corners closer to a straight line than this share of the polygon's size count as straight.
constexpr double kStraight = 1e-9;

double cross(const Eigen::Vector2d& u, const Eigen::Vector2d& v) {
    return u.x() * v.y() - u.y() * v.x();
}

/// Returns why these corners do not form a convex polygon, or nothing.
std::optional<std::string> convexity_problem(std::span<const Eigen::Vector2d> vertices_m,
                                             double reach_m) {
    const std::size_t n = vertices_m.size();
    const double straight_m2 = kStraight * reach_m * reach_m;
    double doubled_area_m2 = 0.0;
    for (std::size_t i = 1; i + 1 < n; ++i) {
        doubled_area_m2 += cross(vertices_m[i] - vertices_m[0], vertices_m[i + 1] - vertices_m[0]);
    }
    if (std::abs(doubled_area_m2) <= straight_m2)
        return "its corners lie on a line; give corners that enclose an area";
    // Convex: every corner lies on the inner side of every edge.
    const double side = doubled_area_m2 > 0.0 ? 1.0 : -1.0;
    for (std::size_t i = 0; i < n; ++i) {
        const Eigen::Vector2d edge = vertices_m[(i + 1) % n] - vertices_m[i];
        for (std::size_t k = 0; k < n; ++k) {
            if (side * cross(edge, vertices_m[k] - vertices_m[i]) < -straight_m2) {
                return fmt::format(
                    "corner {} (counted from 0) lies outside of the edge from corner {}"
                    "; list the corners in order around the polygon, or take their convex hull",
                    k,
                    i);
            }
        }
    }
    return std::nullopt;
}

bool is_finite(const FootprintPose& pose) {
    return std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.yaw_rad);
}

/// Writes the corners of the footprint at a pose.
void place(const Footprint& footprint, const FootprintPose& pose, Eigen::Vector2d* placed_m) {
    const double c = std::cos(pose.yaw_rad);
    const double s = std::sin(pose.yaw_rad);
    for (const Eigen::Vector2d& p : footprint.points_m()) {
        *placed_m++ = {pose.x_m + c * p.x() - s * p.y(), pose.y_m + s * p.x() + c * p.y()};
    }
}

bool is_valid(const FootprintLayers& layers) {
    const auto fits = [&](ImageView<const float> layer) {
        return layer.width == layers.geometry.nx && layer.height == layers.geometry.ny;
    };
    const double resolution_m = layers.geometry.resolution_m;
    return resolution_m > 0.0 && std::isfinite(resolution_m) &&
           layers.geometry.origin_m.allFinite() && fits(layers.rating) &&
           (layers.height_m.empty() || fits(layers.height_m));
}

/// Builds a report from runs of cells; no cell may appear twice.
class Gathering {
  public:
    explicit Gathering(const FootprintLayers& layers) noexcept : layers_(layers) {}

    void add(const CellRun& run) noexcept {
        const CellRun inside = run.clipped(layers_.geometry);
        cells_ += run.cells();
        outside_ += run.cells() - inside.cells();
        if (inside.cells() == 0) return;
        waiting_[static_cast<std::size_t>(waiting_count_++)] = inside;
        if (waiting_count_ == kWaiting) read();
    }

    [[nodiscard]] FootprintReport report() noexcept {
        read();
        FootprintReport report;
        report.outcome =
            cells_ > outside_ ? FootprintOutcome::rated : FootprintOutcome::outside_map;
        report.cells = cells_;
        report.outside = outside_;
        report.unknown = cells_ - rating_.known;
        if (rating_.known > 0) {
            report.worst_rating = rating_.joined_min();
            report.worst_cell = worst_cell();
            report.mean_rating = rating_.joined_sum() / static_cast<double>(rating_.known);
        }
        if (layers_.height_m.empty()) return report;
        report.without_height = cells_ - height_m_.known;
        if (height_m_.known > 0) {
            report.lowest_m = height_m_.joined_min();
            report.highest_m = height_m_.joined_max();
        }
        return report;
    }

  private:
    /// Number of runs that are read at a time: enough for a footprint, few enough for the stack.
    static constexpr int kWaiting = 64;

    void read() noexcept {
        const std::span<const CellRun> runs{waiting_.data(),
                                            static_cast<std::size_t>(waiting_count_)};
        waiting_count_ = 0;
        const std::int64_t worst = rows::add_runs(layers_.rating, runs, rating_);
        if (worst >= 0) worst_run_ = runs[static_cast<std::size_t>(worst)];
        if (!layers_.height_m.empty()) rows::add_runs(layers_.height_m, runs, height_m_);
    }

    [[nodiscard]] grid::Cell worst_cell() const noexcept {
        const auto iy = static_cast<int>(worst_run_.iy);
        const float* const ratings = layers_.rating.row(iy);
        const float* const at =
            std::find(ratings + worst_run_.first, ratings + worst_run_.end, rating_.joined_min());
        return {static_cast<int>(at - ratings), iy};  // in range: a difference of pointers
    }

    const FootprintLayers& layers_;
    rows::LaneStatistics rating_;
    rows::LaneStatistics height_m_;
    CellRun worst_run_;  ///< the first run that holds the worst rating
    std::int64_t cells_ = 0;
    std::int64_t outside_ = 0;
    std::array<CellRun, kWaiting> waiting_;
    int waiting_count_ = 0;
};

/// Appends the cells that the footprint sweeps between two poses that differ by at most
/// kMaxTurn_rad. Returns false if the cells cannot be counted.
bool append_sweep(const Footprint& footprint,
                  const FootprintPose& from,
                  const FootprintPose& to,
                  const grid::GridGeometry& geometry,
                  std::vector<CellRun>& runs) {
    const std::size_t n = footprint.points_m().size();
    std::array<Eigen::Vector2d, ConvexArea::kMaxPoints> corners_m;
    place(footprint, from, corners_m.data());
    place(footprint, to, corners_m.data() + n);
    // On a unit interval, a function deviates from its chord by at most max |second derivative| /
    // 8. A corner at distance r that turns by a has the second derivative r a^2; translation adds
    // none.
    const double turn_rad = to.yaw_rad - from.yaw_rad;
    const double bulge_m = footprint.reach_m() * turn_rad * turn_rad / 8.0;
    const ConvexArea area({corners_m.data(), 2 * n}, footprint.radius_m() + bulge_m, geometry);
    for (std::int64_t iy = area.first_row(); iy < area.end_row(); ++iy)
        runs.push_back(area.row(iy));
    return !area.empty();
}

/// Appends the pieces of the way between two neighbouring poses.
bool append_way(const Footprint& footprint,
                const FootprintPose& from,
                const FootprintPose& to,
                const grid::GridGeometry& geometry,
                std::vector<CellRun>& runs) {
    const bool turns = footprint.reach_m() > 0.0;  // a circle looks the same at any yaw
    const double turn_rad =
        turns ? std::remainder(to.yaw_rad - from.yaw_rad, 2.0 * std::numbers::pi) : 0.0;
    // in range: a turn of at most pi
    const int pieces = std::max(1, static_cast<int>(std::ceil(std::abs(turn_rad) / kMaxTurn_rad)));
    const auto at = [&](int k) {
        const double s = static_cast<double>(k) / pieces;
        return FootprintPose{from.x_m + s * (to.x_m - from.x_m),
                             from.y_m + s * (to.y_m - from.y_m),
                             from.yaw_rad + s * turn_rad};
    };
    for (int k = 0; k < pieces; ++k) {
        if (!append_sweep(footprint, at(k), at(k + 1), geometry, runs)) return false;
    }
    return true;
}

/// Adds the union of the runs.
void add_union(std::vector<CellRun>& runs, Gathering& gathering) {
    std::sort(runs.begin(), runs.end(), [](const CellRun& a, const CellRun& b) {
        return a.iy != b.iy ? a.iy < b.iy : a.first < b.first;
    });
    for (std::size_t i = 0; i < runs.size();) {
        CellRun joined = runs[i];
        for (++i; i < runs.size() && runs[i].iy == joined.iy && runs[i].first <= joined.end; ++i)
            joined.end = std::max(joined.end, runs[i].end);
        gathering.add(joined);
    }
}

FootprintReport not_asked(FootprintOutcome why) {
    FootprintReport report;
    report.outcome = why;
    return report;
}

}  // namespace

Result<Footprint> Footprint::circle(double radius_m) {
    if (!(radius_m > 0.0 && radius_m <= kMaxReach_m)) {
        return usage_error(fmt::format(
            "footprint: the radius of a circle is {} m; give more than 0 and at most {} m",
            radius_m,
            kMaxReach_m));
    }
    Footprint footprint;
    footprint.points_m_[0] = Eigen::Vector2d::Zero();
    footprint.count_ = 1;
    footprint.radius_m_ = radius_m;
    return footprint;
}

Result<Footprint> Footprint::polygon(std::span<const Eigen::Vector2d> vertices_m) {
    const std::size_t n = vertices_m.size();
    if (n < 3 || n > kMaxVertices) {
        return usage_error(fmt::format(
            "footprint: the polygon has {} corners; give 3 to {} corners", n, kMaxVertices));
    }
    Footprint footprint;
    for (std::size_t i = 0; i < n; ++i) {
        const double reach_m = vertices_m[i].norm();
        if (!(reach_m <= kMaxReach_m)) {  // NaN too
            return usage_error(
                fmt::format("footprint: corner {} (counted from 0) is at ({}, {}) m; give finite "
                            "numbers within {} m",
                            i,
                            vertices_m[i].x(),
                            vertices_m[i].y(),
                            kMaxReach_m));
        }
        footprint.reach_m_ = std::max(footprint.reach_m_, reach_m);
        footprint.points_m_[i] = vertices_m[i];
    }
    if (const auto problem = convexity_problem(vertices_m, footprint.reach_m_)) {
        return usage_error(fmt::format("footprint: not a convex polygon: {}", *problem));
    }
    footprint.count_ = static_cast<int>(n);
    return footprint;
}

bool is_traversable(const FootprintReport& report,
                    double threshold,
                    UnknownPolicy policy) noexcept {
    if (report.outcome != FootprintOutcome::rated) return false;
    const bool all_known = report.unknown == 0 && report.without_height == 0;
    if (policy != UnknownPolicy::ignored && !all_known) return false;
    const auto worst = static_cast<double>(report.worst_rating);
    return worst > 0.0 && worst >= threshold;  // NaN fails
}

FootprintReport query(const Footprint& footprint,
                      const FootprintPose& pose,
                      const FootprintLayers& layers) noexcept {
    if (!is_valid(layers)) return not_asked(FootprintOutcome::invalid_map);
    if (!is_finite(pose)) return not_asked(FootprintOutcome::invalid_pose);
    std::array<Eigen::Vector2d, Footprint::kMaxVertices> corners_m;
    place(footprint, pose, corners_m.data());
    const ConvexArea area(
        {corners_m.data(), footprint.points_m().size()}, footprint.radius_m(), layers.geometry);
    if (area.empty()) return not_asked(FootprintOutcome::invalid_pose);
    Gathering gathering(layers);
    for (std::int64_t iy = area.first_row(); iy < area.end_row(); ++iy) gathering.add(area.row(iy));
    return gathering.report();
}

FootprintReport query_path(const Footprint& footprint,
                           std::span<const FootprintPose> poses,
                           const FootprintLayers& layers,
                           PathScratch& scratch) {
    if (!is_valid(layers)) return not_asked(FootprintOutcome::invalid_map);
    if (poses.empty() || !std::all_of(poses.begin(), poses.end(), is_finite))
        return not_asked(FootprintOutcome::invalid_pose);
    scratch.runs.clear();
    for (std::size_t i = 0; i == 0 || i + 1 < poses.size(); ++i) {
        const FootprintPose& next = poses[std::min(i + 1, poses.size() - 1)];
        if (!append_way(footprint, poses[i], next, layers.geometry, scratch.runs))
            return not_asked(FootprintOutcome::invalid_pose);
    }
    Gathering gathering(layers);
    add_union(scratch.runs, gathering);
    return gathering.report();
}

}  // namespace surefoot::traversability

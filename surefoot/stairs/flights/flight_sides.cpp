// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/flights/flight_sides.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "surefoot/geometry/statistics.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr double kNearest_m = 0.05;  ///< begin of the strip; the ends of edges are this uncertain
constexpr double kFarthest_m = 0.25;
constexpr double kInside_m = 0.1;  ///< a rail may stand on the tread, up to this far inside its end
constexpr double kWall_m = 0.3;
constexpr double kOpen_m = 0.1;
constexpr double kLeastShare = 1.0 / 3.0;
constexpr double kLeastRail_m = 0.75;
constexpr double kMostRail_m = 1.1;
constexpr double kRailBand_m = 0.1;

/// One tread: its nosing, its end, its height and the slope of the nosing line.
struct Tread {
    Vector2d nose_m;   ///< end of its edge on the examined side
    Vector2d way;      ///< direction of travel over the tread
    Vector2d outward;  ///< unit vector away from the flight
    double depth_m = 0.0;
    double level_m = 0.0;
    double climb = 0.0;
};

/// The data of the cells in a strip beside a tread.
struct Strip {
    int cells = 0;
    int walls = 0;
    int open = 0;
    int level = 0;
    double rail_m = 0.0;  ///< highest possible rail above the nosing line; 0 = none

    [[nodiscard]] SideKind kind() const {
        const int known = walls + open + level;
        if (cells == 0 || known < kLeastShare * cells) return SideKind::unknown;
        if (walls >= kLeastShare * known) return SideKind::wall;
        return open >= kLeastShare * known ? SideKind::open : SideKind::level;
    }
};

/// Measures the tread of a step. Returns false if the tread is too short or was not seen.
bool tread_of(const Flight& flight, std::size_t step, bool left, Tread& tread) {
    const Edge& edge = flight.edges[step];
    const bool up = flight.kind == FlightKind::up;
    if (!up && !edge.lower_seen) return false;
    const bool is_last = step + 1 == flight.edges.size();
    // Seen from the stance, edges of flights up run to the right. Edges of flights down run to the
    // left.
    const bool at_from = left == up;
    tread.nose_m = at_from ? edge.from_m : edge.to_m;
    tread.outward = at_from ? Vector2d(-edge.along()) : edge.along();
    tread.way = up ? Vector2d(-edge.down()) : edge.down();
    tread.level_m = up ? edge.upper_m : edge.lower_m;
    const double ends_m = up ? edge.upper_depth_m : edge.lower_depth_m;
    const double next_m =
        is_last ? ends_m : tread.way.dot(flight.edges[step + 1].middle_m() - edge.middle_m());
    tread.depth_m = std::min({ends_m, next_m, 2.0 * kWall_m});
    const double climb = flight.going_m > 0.0 && !is_last ? flight.riser_m / flight.going_m : 0.0;
    tread.climb = up ? climb : -climb;
    return tread.depth_m > 2.0 * kNearest_m;
}

float at_or_nan(const ImageView<const float>& layer, const grid::Cell& cell) {
    return layer.empty() ? std::nanf("") : layer.row(cell.iy)[cell.ix];
}

Strip strip_beside(const Terrain& terrain, const Tread& tread) {
    const double cell_m = terrain.geometry.resolution_m;
    Strip strip;
    for (double s_m = kNearest_m; s_m <= tread.depth_m - kNearest_m; s_m += cell_m) {
        for (double t_m = -kInside_m; t_m <= kFarthest_m; t_m += cell_m) {
            const Vector2d p_m = tread.nose_m + s_m * tread.way + t_m * tread.outward;
            const auto cell = terrain.geometry.cell_at(p_m.x(), p_m.y());
            if (!cell) continue;
            const double height_m = static_cast<double>(at_or_nan(terrain.height_m, *cell));
            const double above_m = height_m - tread.level_m;
            const double hangs_m =
                above_m + static_cast<double>(at_or_nan(terrain.clearance_m, *cell));
            for (const double rail_m : {above_m, hangs_m}) {
                const double over_noses_m = rail_m - s_m * tread.climb;
                if (over_noses_m >= kLeastRail_m && over_noses_m <= kMostRail_m)
                    strip.rail_m = std::max(strip.rail_m, over_noses_m);
            }
            if (t_m < kNearest_m) continue;
            ++strip.cells;
            const double lower_m =
                std::isnan(height_m)
                    ? static_cast<double>(at_or_nan(terrain.free_above_m, *cell)) - tread.level_m
                    : above_m;
            if (above_m >= kWall_m)
                ++strip.walls;
            else if (lower_m <= -kOpen_m)
                ++strip.open;
            else if (!std::isnan(above_m))
                ++strip.level;
        }
    }
    return strip;
}

}  // namespace

FlightSide FlightSides::observe_beside(const Terrain& terrain, const Flight& flight, bool left) {
    // Sorted by danger, the most dangerous first.
    constexpr std::array kKinds = {SideKind::open, SideKind::level, SideKind::wall};
    std::array<int, kKinds.size()> votes{};
    rails_m_.clear();
    int steps = 0;
    for (std::size_t k = 0; k < flight.edges.size(); ++k) {
        Tread tread;
        if (!tread_of(flight, k, left, tread)) continue;
        const Strip strip = strip_beside(terrain, tread);
        ++steps;
        for (std::size_t i = 0; i < kKinds.size(); ++i) votes[i] += strip.kind() == kKinds[i];
        if (strip.rail_m > 0.0) rails_m_.push_back(strip.rail_m);
    }
    FlightSide side;
    const auto most = std::max_element(votes.begin(), votes.end());
    if (*most > 0) side.kind = kKinds[static_cast<std::size_t>(most - votes.begin())];
    if (rails_m_.empty()) return side;
    const double rail_m = upper_median_in_place(rails_m_);
    const auto along = std::count_if(rails_m_.begin(), rails_m_.end(), [&](double one_m) {
        return std::abs(one_m - rail_m) <= 0.5 * kRailBand_m;
    });
    if (along >= 2 && 2 * along >= steps) side.rail_m = rail_m;
    return side;
}

void FlightSides::find(const Terrain& terrain, Flight& flight) {
    flight.left = observe_beside(terrain, flight, true);
    flight.right = observe_beside(terrain, flight, false);
}

}  // namespace surefoot::stairs

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/safety_oracle/seen_ground.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/sim/motion/planar.hpp"
#include "surefoot/sim/safety_oracle/safety_figures.hpp"
#include "surefoot/sim/safety_oracle/swept_box.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;

Lattice lattice_around(const Vector2d& center_m, double reach_m) {
    Lattice lattice;
    const int half = saturated_integer<int>(std::ceil(reach_m / lattice.resolution_m));
    lattice.nx = lattice.ny = 2 * half;
    lattice.origin_m = center_m.array() - half * lattice.resolution_m;
    return lattice;
}

/// Returns the largest distance of a movement's region from base_link.
double reach_of(const Machine& machine) {
    double reach_m = 0.0;
    for (int command = 0; command < Machine::kMovementCodes; ++command) {
        const Movement* movement = rules::movement_of(machine, command);
        if (movement == nullptr) continue;
        const Rect region = rules::region_of(rules::figures_of(machine, *movement), 0.0);
        reach_m =
            std::max(reach_m, region.min_m.cwiseAbs().cwiseMax(region.max_m.cwiseAbs()).norm());
    }
    return reach_m;
}

/// A movement from a pose.
struct Way {
    rules::Figures figures;
    PlanarPose T_world_start;
};
/// Returns an empty optional for an unusable command.
std::optional<Way> way_of(const Machine& machine, const Pose& T_world_body, int command) {
    const Movement* movement = rules::movement_of(machine, command);
    if (movement == nullptr) return std::nullopt;
    const Eigen::Vector3d& at_m = T_world_body.translation_m;
    return Way{rules::figures_of(machine, *movement),
               PlanarPose::of(at_m.x(), at_m.y(), yaw_rad(T_world_body))};
}

/// Calls test(ix, iy) for all cells whose centre `area` covers, until one fails. Returns true if
/// none failed.
template <typename Test>
bool all_in(const SweptBox& area, const Lattice& lattice, Test&& test) {
    const auto index = [&](double p_m, double origin_m) {
        return saturated_integer<int>(std::floor((p_m - origin_m) / lattice.resolution_m));
    };
    const Rect& bounds = area.bounds();
    const int last_x = index(bounds.max_m.x(), lattice.origin_m.x());
    const int last_y = index(bounds.max_m.y(), lattice.origin_m.y());
    for (int iy = index(bounds.min_m.y(), lattice.origin_m.y()); iy <= last_y; ++iy) {
        for (int ix = index(bounds.min_m.x(), lattice.origin_m.x()); ix <= last_x; ++ix) {
            if (area.covers(lattice.center_m(ix, iy)) && !test(ix, iy)) return false;
        }
    }
    return true;
}

}  // namespace

SeenGround::SeenGround(const SceneTruth& truth,
                       std::int64_t until_ns,
                       const Machine& machine,
                       const Vector2d& center_m,
                       double radius_m,
                       Executor& executor)
    : lattice_(lattice_around(center_m, radius_m + reach_of(machine))),
      seen_(visibility_mask(truth, lattice_, {.until_ns = until_ns}, executor)) {}

bool SeenGround::is_known(int ix, int iy, const VouchedGround& vouched) const {
    return (lattice_.center_m(ix, iy) - vouched.center_m).norm() <= vouched.radius_m ||
           (seen_.contains(ix, iy) && seen_.at(ix, iy) != 0);
}

bool SeenGround::holds_zone(const Machine& machine,
                            const Pose& T_world_body,
                            int command,
                            const VouchedGround& vouched) const {
    const auto way = way_of(machine, T_world_body, command);
    if (!way) return false;
    const rules::Figures& figures = way->figures;
    const PlanarPose& T_world_start = way->T_world_start;
    const auto known = [&](int ix, int iy) { return is_known(ix, iy, vouched); };
    return std::all_of(figures.feet.begin(), figures.feet.end(), [&](const Rect& foot) {
        const SweptBox corridor(
            grown(foot, figures.foot_margin_m), T_world_start, figures.T_start_target);
        const SweptBox band(
            grown(foot, figures.band_m), T_world_start * figures.T_start_target, {});
        return all_in(corridor, lattice_, known) && all_in(band, lattice_, known);
    });
}

bool SeenGround::holds_body(const Machine& machine,
                            const Pose& T_world_body,
                            int command,
                            const VouchedGround& vouched) const {
    const auto way = way_of(machine, T_world_body, command);
    if (!way) return false;
    const rules::Figures& figures = way->figures;
    const PlanarPose& T_world_start = way->T_world_start;
    return std::all_of(figures.body.begin(), figures.body.end(), [&](const auto& part) {
        const Rect box = grown(part.box, figures.sway_m);
        const SweptBox here(box, T_world_start, {});
        return all_in(
            SweptBox(box, T_world_start, figures.T_start_target), lattice_, [&](int ix, int iy) {
                return here.covers(lattice_.center_m(ix, iy)) || is_known(ix, iy, vouched);
            });
    });
}

}  // namespace surefoot::sim

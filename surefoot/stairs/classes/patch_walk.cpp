// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/classes/patch_walk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "surefoot/core/angles.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr std::int32_t kNone = PatchMap::kNone;

/// Largest slope sigma (5 deg) of a patch that may carry the machine.
constexpr double kCarries_sigma_rad = 0.09;
constexpr double kContact_m = 0.2;   ///< smallest width of a contact for a foot
constexpr double kStance_m = 0.3;    ///< equal to kStance_m in feature_finder.cpp
constexpr double kSurface_m = 0.05;  ///< height range of one surface under the body
/// Largest height error over the depth of a tread, from its tilt and from map distortion (see
/// flights.cpp).
constexpr double kTread_m = 0.035;

}  // namespace

void PatchWalk::find(const Terrain& terrain,
                     const TerrainFeatures& features,
                     const PatchMap& patches) {
    find_contacts(patches);
    find_stance(terrain.stance_m, patches);
    link_neighbours(patches.block_m);
    for (const Flight& flight : features.flights) link_flight(terrain.geometry, flight, patches);
    walk(patches);
    find_near_ground(patches);
}

void PatchWalk::find_contacts(const PatchMap& patches) {
    contacts_.clear();
    for (int by = 0; by < patches.of_block.height(); ++by) add_contacts(patches, true, by);
    for (int bx = 0; bx < patches.of_block.width(); ++bx) add_contacts(patches, false, bx);
    std::sort(contacts_.begin(), contacts_.end(), [](const Contact& a, const Contact& b) {
        return a.low != b.low ? a.low < b.low : a.high < b.high;
    });
}

/// Adds the contacts of one row or column of blocks. Planes give the heights at the contact.
void PatchWalk::add_contacts(const PatchMap& patches, bool along_x, int line) {
    const int blocks = along_x ? patches.of_block.width() : patches.of_block.height();
    int last = -1;
    std::int32_t last_id = kNone;
    for (int k = 0; k < blocks; ++k) {
        const std::int32_t id =
            along_x ? patches.of_block.row(line)[k] : patches.of_block.row(k)[line];
        if (id == kNone) continue;
        const double gap_m = (k - last - 1) * patches.block_m;
        if (last_id != kNone && id != last_id && gap_m <= config_.classes.reach_m) {
            const double middle = 0.5 * (last + k) + 0.5;
            const Vector2d p_m =
                patches.origin_m + patches.block_m * (along_x ? Vector2d(middle, line + 0.5)
                                                              : Vector2d(line + 0.5, middle));
            const std::int32_t low = std::min(id, last_id), high = std::max(id, last_id);
            const double rise_m = patches.patches[static_cast<std::size_t>(high)].height_m(p_m) -
                                  patches.patches[static_cast<std::size_t>(low)].height_m(p_m);
            contacts_.push_back({low, high, static_cast<float>(rise_m), static_cast<float>(gap_m)});
        }
        last = k;
        last_id = id;
    }
}

bool PatchWalk::may_carry(const PlanarPatch& patch) const {
    return patch.slope_rad() <= config_.classes.ramp_deg * kRadPerDeg &&
           patch.slope_sigma_rad <= kCarries_sigma_rad;
}

/// Counts the blocks within the radius for each patch that may carry the machine.
PatchWalk::NearStance PatchWalk::count_near(const Vector2d& stance_m,
                                            double radius_m,
                                            const PatchMap& patches) {
    near_stance_.assign(patches.patches.size(), 0);
    NearStance near{.nearest_m = std::numeric_limits<double>::infinity()};
    for (int by = 0; by < patches.of_block.height(); ++by) {
        for (int bx = 0; bx < patches.of_block.width(); ++bx) {
            const std::int32_t id = patches.of_block.row(by)[bx];
            if (id == kNone || !may_carry(patches.patches[static_cast<std::size_t>(id)])) continue;
            const Vector2d p_m = patches.block_middle_m(bx, by);
            const double away_m = (p_m - stance_m).norm();
            if (away_m < near.nearest_m) {
                near.nearest_m = away_m;
                near.nearest_at_m = p_m;
            }
            if (away_m > radius_m) continue;
            ++near_stance_[static_cast<std::size_t>(id)];
            ++near.blocks;
        }
    }
    return near;
}

/// Marks the patches under the machine as the start of the walk.
void PatchWalk::find_stance(const Vector2d& stance_m, const PatchMap& patches) {
    walked_.assign(patches.patches.size(), 0);
    waiting_.clear();
    waiting_.reserve(patches.patches.size());
    if (!stance_m.allFinite()) return;
    NearStance near = count_near(stance_m, kStance_m, patches);
    if (!std::isfinite(near.nearest_m)) return;
    Vector2d at_m = stance_m;
    if (near.blocks == 0) {  // the ground at the feet is not visible
        near = count_near(stance_m, near.nearest_m + kStance_m, patches);
        at_m = near.nearest_at_m;
    }
    double lowest_m = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < near_stance_.size(); ++i)
        if (4 * near_stance_[i] >= near.blocks)
            lowest_m = std::min(lowest_m, patches.patches[i].height_m(at_m));
    for (std::size_t i = 0; i < near_stance_.size(); ++i) {
        const double above_m = patches.patches[i].height_m(at_m) - lowest_m;
        if (near_stance_[i] == 0 || !(std::abs(above_m) <= kSurface_m)) continue;
        walked_[i] = 1;
        waiting_.push_back(static_cast<std::int32_t>(i));
    }
}

/// Links two patches if the height between their planes is at most one step, over at least a foot's
/// width.
void PatchWalk::link_neighbours(double block_m) {
    links_.clear();
    const double near_m = config_.smear_m + block_m;  // an edge may be oblique to the grid
    for (std::size_t i = 0; i < contacts_.size();) {
        const Contact& first = contacts_[i];
        int steps = 0;
        for (; i < contacts_.size(); ++i) {
            const Contact& contact = contacts_[i];
            if (contact.low != first.low || contact.high != first.high) break;
            const double rise_m = std::abs(static_cast<double>(contact.rise_m));
            const double gap_m = near_m + config_.shadow_per_height * rise_m;
            if (rise_m <= config_.classes.max_step_m && static_cast<double>(contact.gap_m) <= gap_m)
                ++steps;
        }
        if (steps * block_m < kContact_m) continue;
        links_.push_back({first.low, first.high, false});
        links_.push_back({first.high, first.low, false});
    }
}

/// Returns the patch on one side of an edge whose plane has the measured level of that side.
std::int32_t PatchWalk::patch_beside(const grid::GridGeometry& grid,
                                     const Edge& edge,
                                     bool upper,
                                     const PatchMap& patches) {
    const Vector2d off = (upper ? -1.0 : 1.0) * edge.down();
    const double level_m = upper ? edge.upper_m : edge.lower_m;
    for (const double off_m : {0.05, 0.1, 0.15, 0.2}) {
        for (const double share : {0.5, 0.3, 0.7, 0.1, 0.9}) {
            const Vector2d p_m = edge.from_m + share * (edge.to_m - edge.from_m) + off_m * off;
            const auto cell = grid.cell_at(p_m.x(), p_m.y());
            if (!cell) continue;
            const std::int32_t id = patches.of_cell.row(cell->iy)[cell->ix];
            if (id == kNone) continue;
            const PlanarPatch& patch = patches.patches[static_cast<std::size_t>(id)];
            if (std::abs(patch.height_m(p_m) - level_m) <= kTread_m) return id;
        }
    }
    return kNone;
}

void PatchWalk::link_flight(const grid::GridGeometry& grid,
                            const Flight& flight,
                            const PatchMap& patches) {
    if (flight.steps < 2) return;  // a single step adds no evidence to its two planes
    const bool up = flight.kind == FlightKind::up;
    std::int32_t last = kNone;
    const auto update = [&](std::int32_t id) {
        if (id == kNone) return;
        if (last != kNone && id != last) {
            links_.push_back({last, id, true});
            links_.push_back({id, last, true});
        }
        last = id;
    };
    for (const Edge& edge : flight.edges) {
        update(patch_beside(grid, edge, !up, patches));
        if (edge.lower_seen || up) update(patch_beside(grid, edge, up, patches));
    }
}

void PatchWalk::walk(const PatchMap& patches) {
    const auto before = [](const Link& a, const Link& b) {
        return a.from != b.from ? a.from < b.from : a.to < b.to;
    };
    std::sort(links_.begin(), links_.end(), before);
    for (std::size_t next = 0; next < waiting_.size(); ++next) {
        const Link from{waiting_[next], kNone, false};
        for (auto link = std::lower_bound(links_.begin(), links_.end(), from, before);
             link != links_.end() && link->from == from.from;
             ++link) {
            const auto to = static_cast<std::size_t>(link->to);
            if (walked_[to] != 0 || !(link->proven || may_carry(patches.patches[to]))) continue;
            walked_[to] = 1;
            waiting_.push_back(link->to);
        }
    }
}

/// Finds the reachable ground nearest to each block. Distances are counted along rows, columns and
/// diagonals.
void PatchWalk::find_near_ground(const PatchMap& patches) {
    const int nbx = patches.of_block.width();
    const int nby = patches.of_block.height();
    near_.assign(static_cast<std::size_t>(nbx) * static_cast<std::size_t>(nby), {kFar, 0.0F});
    const auto straight_m = static_cast<float>(patches.block_m);
    const float diagonal_m = straight_m * std::numbers::sqrt2_v<float>;
    const auto reach_m = static_cast<float>(config_.classes.reach_m);
    const auto pass = [&](int way) {
        for (int i = 0; i < nby; ++i) {
            const int by = way > 0 ? i : nby - 1 - i;
            for (int k = 0; k < nbx; ++k) {
                const int bx = way > 0 ? k : nbx - 1 - k;
                NearGround& own = near_[static_cast<std::size_t>(by * nbx + bx)];
                const std::int32_t id = patches.of_block.row(by)[bx];
                if (id != kNone && walked_[static_cast<std::size_t>(id)] != 0) {
                    if (way < 0) continue;
                    const Vector2d p_m = patches.block_middle_m(bx, by);
                    const double height_m =
                        patches.patches[static_cast<std::size_t>(id)].height_m(p_m);
                    own = {0.0F, static_cast<float>(height_m)};
                    continue;
                }
                const auto observation = [&](int dx, int dy, float step_m) {
                    const int x = bx + dx, y = by + dy;
                    if (x < 0 || y < 0 || x >= nbx || y >= nby) return;
                    const NearGround& other = near_[static_cast<std::size_t>(y * nbx + x)];
                    const float distance_m = other.distance_m + step_m;
                    if (distance_m < own.distance_m && distance_m <= reach_m)
                        own = {distance_m, other.height_m};
                };
                observation(-way, 0, straight_m);
                observation(-1, -way, diagonal_m);
                observation(0, -way, straight_m);
                observation(1, -way, diagonal_m);
            }
        }
    };
    pass(+1);
    pass(-1);
}

}  // namespace surefoot::stairs

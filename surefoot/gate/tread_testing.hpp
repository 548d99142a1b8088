// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>

#include "surefoot/core/rng.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/tread_support.hpp"

/// Shared by the tests of the rules of treads. Each rule is compared with the same rule in plain
/// code, at its limits to the tenth of a millimetre.
namespace surefoot::gate::testing {

inline constexpr std::int64_t kNone = Tread::kNone;

/// A machine with a movement of class stair, on a map that is set cell by cell.
struct OnTreads {
    std::unique_ptr<grid::MapSnapshot> map = Terrain().snapshot();
    Machine machine = rex();
    Query query = make_query(kForward, 0.0, 0.0, 1.0, 0.0);
    Sweep sweep;
    std::optional<Ground> ground;

    OnTreads() {
        machine.limits.step[1] = {true, 1800, 1800};
        machine.movements[kForward].movement_class = MovementClass::stair;
        map->sigma_tenth_mm.fill(0);
        map->drift_tenth_mm.fill(0);
        place(0, 0, 0.0);
    }
    void place(std::int64_t x_tenth_mm, std::int64_t y_tenth_mm, double yaw_rad) {
        query = make_query(kForward, 0.0, 0.0, std::cos(yaw_rad), std::sin(yaw_rad));
        query.x_tenth_mm = x_tenth_mm;
        query.y_tenth_mm = y_tenth_mm;
        look();
    }
    /// Call it again after a change of the machine.
    void look() {
        sweep =
            sweep_of(machine,
                     fixed_pose(query.x_tenth_mm, query.y_tenth_mm, query.cos_yaw, query.sin_yaw),
                     machine.movements[query.command]);
        ground.emplace(*map, query, machine.limits);
    }
    /// A random position within a cell, random heading and ankle, feet of two sizes.
    void place_anywhere(Rng& rng) {
        machine.right_foot.length_tenth_mm = 3320;
        machine.right_foot.width_tenth_mm = 1700;
        machine.ankle_from_heel_tenth_mm = 1000 + static_cast<std::int32_t>(rng.below(1800));
        machine.limits.patch_side_tenth_mm = 300 + static_cast<std::int32_t>(rng.below(300));
        place(static_cast<std::int64_t>(rng.below(250)),
              static_cast<std::int64_t>(rng.below(250)),
              rng.uniform(-3.2, 3.2));
    }
    [[nodiscard]] Scene scene() const {
        return {machine,
                machine.movements[query.command],
                *ground,
                sweep,
                Stance::level_at(query.stance_height_tenth_mm)};
    }
    [[nodiscard]] std::size_t index(std::int64_t ix, std::int64_t iy) const {
        return static_cast<std::size_t>(iy * map->nx + ix);
    }
    [[nodiscard]] const GroundBox& box(std::size_t foot) const {
        return foot == 0 ? machine.left_foot : machine.right_foot;
    }

    /// A position along and across a landed foot, from its middle, doubled and rounded.
    struct Place {
        std::int64_t along = 0;
        std::int64_t across = 0;
    };
    [[nodiscard]] Place place_of(std::size_t foot, double x_tenth_mm, double y_tenth_mm) const {
        constexpr double kOne = 1048576.0;
        const grid::FixedPoint middle = sweep.feet[foot].landing_center;
        const double x = 2.0 * (x_tenth_mm - static_cast<double>(middle.x));
        const double y = 2.0 * (y_tenth_mm - static_cast<double>(middle.y));
        const auto c = static_cast<double>(sweep.target.cos_yaw);
        const auto s = static_cast<double>(sweep.target.sin_yaw);
        return {static_cast<std::int64_t>(std::floor((c * x + s * y) / kOne + 0.5)),
                static_cast<std::int64_t>(std::floor((c * y - s * x) / kOne + 0.5))};
    }
    [[nodiscard]] Place middle_of(std::size_t foot, std::int64_t ix, std::int64_t iy) const {
        const auto at = [](std::int64_t origin, std::int64_t i) {
            return static_cast<double>(origin) + 250.0 * (static_cast<double>(i) + 0.5);
        };
        return place_of(foot, at(map->origin_x_tenth_mm, ix), at(map->origin_y_tenth_mm, iy));
    }
    /// Half of a cell's projection on the axes of the foot, doubled, rounded up.
    [[nodiscard]] std::int64_t reach() const {
        const double shadow = std::abs(static_cast<double>(sweep.target.cos_yaw)) +
                              std::abs(static_cast<double>(sweep.target.sin_yaw));
        return 1 + static_cast<std::int64_t>(std::ceil(250.0 * shadow / 1048576.0));
    }
    [[nodiscard]] std::int64_t ankle(std::size_t foot) const {
        return 2 * machine.ankle_from_heel_tenth_mm - box(foot).length_tenth_mm;
    }
    template <typename Visit>
    void each_cell(const grid::FixedConvex& region, Visit&& visit) const {
        grid::for_each_overlapped_cell(
            region, ground->grid(), [&](std::int64_t ix, std::int64_t iy) {
                visit(ix, iy);
                return true;
            });
    }
};

inline std::set<Reason> reasons_of(const Findings& findings) {
    std::set<Reason> all;
    for (int i = 0; i < kReasonCount; ++i) {
        if (findings.reasons().contains(static_cast<Reason>(i))) all.insert(static_cast<Reason>(i));
    }
    return all;
}

/// How much of a foot a tread supports: enough, perhaps enough, or too little.
enum class Carried { whole, unsure, little };

inline Findings tread_findings(const OnTreads& on, std::size_t foot, const Tread& tread) {
    ReachableSurfaces reachable;
    reachable.add(1);
    Findings findings;
    check_tread(on.scene(), on.sweep.feet[foot], on.box(foot), tread, reachable, findings);
    return findings;
}

inline Carried answer_of(const Findings& findings) {
    if (findings.reasons().contains(Reason::support_area)) return Carried::little;
    return findings.reasons().contains(Reason::edge_margin) ? Carried::unsure : Carried::whole;
}

}  // namespace surefoot::gate::testing

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "surefoot/sim/safety_oracle/foot_ground.hpp"
#include "surefoot/sim/safety_oracle/safety_rules.hpp"
#include "surefoot/sim/safety_oracle/swept_box.hpp"

namespace surefoot::sim::rules {

/// Tolerance for rounding errors [m, rad]: a value that equals its limit does not exceed it.
inline constexpr double kRounding = 1e-7;

/// Keeps the worst finding of each danger.
class Collector {
  public:
    explicit Collector(const PlanarPose& T_world_field) : T_world_field_(T_world_field) {}

    struct Place {
        Eigen::Vector2d p_field_m = Eigen::Vector2d::Zero();
        double z_m = 0.0;
    };
    /// A larger `badness` is worse.
    void add(Danger danger, double badness, double value, double limit, const Place& place) {
        Slot& slot = slots_[static_cast<std::size_t>(danger)];
        if (slot.used && badness <= slot.badness) return;
        const Eigen::Vector2d p_world = T_world_field_ * place.p_field_m;
        slot = {true, badness, {danger, value, limit, {p_world.x(), p_world.y(), place.z_m}}};
    }
    [[nodiscard]] bool is_worse(Danger danger, double badness) const {
        const Slot& slot = slots_[static_cast<std::size_t>(danger)];
        return !slot.used || badness > slot.badness;
    }
    [[nodiscard]] std::vector<Finding> findings() const {
        std::vector<Finding> all;
        for (const Slot& slot : slots_) {
            if (slot.used) all.push_back(slot.finding);
        }
        return all;
    }

  private:
    struct Slot {
        bool used = false;
        double badness = 0.0;
        Finding finding;
    };
    PlanarPose T_world_field_;
    std::array<Slot, kDangerCount> slots_;
};

/// The tests of one pose and one movement that flat ground and treads share.
struct Inspection {
    const GroundField& field;
    const std::vector<char>& reached;
    const Figures& figures;
    PlanarPose T_field_body;
    PlanarPose T_field_target;
    Stance stance;
    Collector found;

    [[nodiscard]] double above_plane(const Eigen::Vector2d& p_field, double z_m) const {
        return z_m - stance.plane.at(p_field);
    }
    [[nodiscard]] bool is_reached(const SolePoint& p) const {
        return reached[field.index(p.i, p.j)] != 0;
    }
    /// Tests the ground under the standing feet. Their heights may differ by `most_apart_m`.
    /// Returns false if it is unknown.
    bool check_stance(double most_apart_m);
    /// Tests the tilt and the patches of the ground under a landing foot.
    void check_sole(const FootGround& under, const Rect& foot);
    /// Tests the path of a foot: nothing is higher above the stance than `clearance_m` or hangs
    /// lower than `lower_edge_m`.
    void check_way(const Rect& foot, double clearance_m, double lower_edge_m);
    /// Tests that no ground and no solid is in the space over `area` between two heights above the
    /// stance.
    void check_space(const SweptBox& area, double low_m, double high_m);

    /// Calls f(p_field, sample) for the samples in `area`, in tiles that `matters` selects.
    /// `matters(tile, low, high)` gets the lowest and highest height of the stance plane in the
    /// tile.
    template <typename Matters, typename F>
    void for_samples_in(const Rect& area, Matters&& matters, F&& f) const {
        const auto range = field.range_of(area);
        for (const GroundField::Tile& tile : field.tiles()) {
            const int min_i = std::max(range.min_i, tile.range.min_i);
            const int max_i = std::min(range.max_i, tile.range.max_i);
            const int min_j = std::max(range.min_j, tile.range.min_j);
            const int max_j = std::min(range.max_j, tile.range.max_j);
            if (min_i > max_i || min_j > max_j) continue;
            const Eigen::Vector2d low = GroundField::point_m(min_i, min_j);
            const Eigen::Vector2d high = GroundField::point_m(max_i, max_j);
            const Eigen::Vector2d& slope = stance.plane.slope;
            const double middle_m = stance.plane.at(0.5 * (low + high));
            const double spread_m = 0.5 * slope.cwiseAbs().dot(high - low) + kRounding;
            if (!matters(tile, middle_m - spread_m, middle_m + spread_m)) continue;
            for (int j = min_j; j <= max_j; ++j) {
                for (int i = min_i; i <= max_i; ++i) f(GroundField::point_m(i, j), field.at(i, j));
            }
        }
    }
};
[[nodiscard]] Inspection inspection_at(const GroundField& field,
                                       const std::vector<char>& reached,
                                       const Figures& figures,
                                       const PlanarPose& T_field_body);

}  // namespace surefoot::sim::rules

// SPDX-License-Identifier: Apache-2.0
// A doorway is passable, and a table is not a floor.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "surefoot/traversability/foothold.hpp"
#include "surefoot/traversability/footprint.hpp"
#include "surefoot/traversability/reachability.hpp"
#include "surefoot/traversability/traversability.hpp"
#include "tests/terrain/scene_cameras.hpp"

namespace surefoot::terrain {
namespace {

using traversability::Foothold;
using traversability::Footprint;
using traversability::FootprintPose;

constexpr double kLook_s = 0.4;
constexpr double kSafe = 0.80;  ///< smallest rating of safe ground

/// Drives the path of a scene to its end; offers map and ratings there.
class Drive {
  public:
    explicit Drive(const std::string& name)
        : scene_(sim::make_scene(name, 5).value()),
          cameras_(scene_.scene),
          map_(elevation::ElevationConfig{}) {
        for (double time_s = 0.0; time_s <= scene_.motion->duration_s(); time_s += kLook_s) {
            T_odom_body_ = scene_.motion->at(time_s).T_world_body;
            add_look(cameras_, cameras_.look_from(T_odom_body_), T_odom_body_, map_);
        }
        const traversability::TraversabilityConfig config;
        const double resolution_m = grid().resolution_m;
        traversability::Traversability(config).rate(
            layers().height_m.view(), resolution_m, serial(), rating_);
        traversability::Reachability(config.reach)
            .reach(
                grid(), layers().height_m.view(), T_odom_body_.translation_m.head<2>(), reach_m_);
        traversability::FootholdFinder({}).find({layers().height_m.view(),
                                                 layers().height_var_m2.view(),
                                                 layers().clearance_m.view(),
                                                 layers().free_above_m.view(),
                                                 reach_m_.view(),
                                                 resolution_m},
                                                serial(),
                                                holds_);
    }
    [[nodiscard]] double parameter(const std::string& name) const { return drawn(scene_, name); }
    [[nodiscard]] const grid::GridGeometry& grid() const { return map_.geometry(); }
    [[nodiscard]] const elevation::ElevationLayers& layers() const { return map_.layers(); }
    [[nodiscard]] const grid::Layer& reach_m() const { return reach_m_; }
    [[nodiscard]] Foothold foothold(grid::Cell cell) const { return holds_.at(cell.ix, cell.iy); }
    [[nodiscard]] float rating(grid::Cell cell) const {
        return rating_.traversability.at(cell.ix, cell.iy);
    }
    /// Whether a machine `width_m` wide may go straight from one pose to another.
    [[nodiscard]] bool passable(double width_m, FootprintPose from, FootprintPose to) const {
        const double half_m = 0.5 * width_m;
        const auto body = Footprint::polygon(std::array<Eigen::Vector2d, 4>{
            {{-0.2, -half_m}, {0.2, -half_m}, {0.2, half_m}, {-0.2, half_m}}});
        traversability::PathScratch scratch;
        const std::array<FootprintPose, 2> way{from, to};
        return is_traversable(
            query_path(body.value(),
                       way,
                       {grid(), rating_.traversability.view(), layers().height_m.view()},
                       scratch),
            kSafe);
    }

  private:
    sim::ScriptedScene scene_;
    SceneCameras cameras_;
    elevation::ElevationMap map_;
    Pose T_odom_body_;
    traversability::TraversabilityLayers rating_;
    grid::Layer reach_m_;
    Image<Foothold> holds_;
};

/// Calls f(cell) for the cells of a map whose middle lies in a box.
template <typename F>
void for_cells(const grid::GridGeometry& grid,
               const Eigen::Vector2d& low_m,
               const Eigen::Vector2d& high_m,
               const F& f) {
    for (int iy = 0; iy < grid.ny; ++iy) {
        for (int ix = 0; ix < grid.nx; ++ix) {
            const Eigen::Vector2d at_m = grid.center_m({ix, iy});
            if ((at_m.array() > low_m.array()).all() && (at_m.array() < high_m.array()).all())
                f(grid::Cell{ix, iy});
        }
    }
}

TEST(Indoors, ADoorwayIsPassable) {
    const Drive drive("door_900");
    const Eigen::Vector2d door_m(drive.parameter("distance_m"), drive.parameter("lateral_m"));
    const double half_m = 0.45;
    const double margin_m = 0.1;
    int cells = 0;
    int blocked = 0;
    int safe = 0;
    // From before the posts to behind them, two or three cells away from each post.
    const Eigen::Vector2d reach_m(0.5, half_m - margin_m);
    for_cells(drive.grid(), door_m - reach_m, door_m + reach_m, [&](grid::Cell cell) {
        ++cells;
        const bool open = std::isnan(drive.layers().clearance_m.at(cell.ix, cell.iy));
        const bool level = drive.reach_m().at(cell.ix, cell.iy) <= 0.02F;
        blocked += open && level ? 0 : 1;
        safe += static_cast<double>(drive.rating(cell)) >= kSafe ? 1 : 0;
    });
    EXPECT_GT(cells, 1000);
    EXPECT_EQ(blocked, 0) << "cells blocked by an overhang or not reached";
    EXPECT_GT(safe, 95 * cells / 100);
    // A foothold with its margins needs a width of 0.7 m: only the middle of the door has it.
    int middle = 0;
    int footholds = 0;
    const Eigen::Vector2d strip_m(0.5, 0.05);
    for_cells(drive.grid(), door_m - strip_m, door_m + strip_m, [&](grid::Cell cell) {
        ++middle;
        footholds += drive.foothold(cell) == Foothold::safe ? 1 : 0;
    });
    EXPECT_GT(middle, 100);
    EXPECT_GT(footholds, 95 * middle / 100);
    const FootprintPose before{door_m.x() - 0.6, door_m.y(), 0.0};
    const FootprintPose behind{door_m.x() + 0.6, door_m.y(), 0.0};
    EXPECT_TRUE(drive.passable(0.6, before, behind));
    EXPECT_FALSE(drive.passable(1.0, before, behind)) << "a width of 1.0 m must hit the posts";
}

TEST(Indoors, ATableIsNotAFloor) {
    const Drive drive("table");
    const double top_m = drive.parameter("top_m");
    const double near_x_m = drive.parameter("distance_m");
    const double half_width_m = 0.5 * drive.parameter("width_m");
    // The scene rotates the table about the middle of the path's end.
    const Eigen::Rotation2Dd turn(drive.parameter("angle_deg") * std::numbers::pi / 180.0);
    const auto in_table = [&](const Eigen::Vector2d& at_m) {
        const Eigen::Vector2d in_m = turn.inverse() * (at_m - Eigen::Vector2d(near_x_m, 0.0));
        return in_m.x() > 0.0 && in_m.x() < drive.parameter("length_m") &&
               std::abs(in_m.y() - drive.parameter("lateral_m")) < half_width_m;
    };
    int top = 0;
    int top_reached = 0;
    int floor = 0;
    int floor_below = 0;
    for_cells(drive.grid(), {0.0, -3.0}, {4.0, 3.0}, [&](grid::Cell cell) {
        if (!in_table(drive.grid().center_m(cell))) return;
        EXPECT_NE(drive.foothold(cell), Foothold::safe) << cell.ix << ", " << cell.iy;
        const auto height_m = static_cast<double>(drive.layers().height_m.at(cell.ix, cell.iy));
        const auto free_m = static_cast<double>(drive.layers().clearance_m.at(cell.ix, cell.iy));
        if (height_m > 0.5 * top_m) {
            ++top;
            top_reached += std::isnan(drive.reach_m().at(cell.ix, cell.iy)) ? 0 : 1;
        } else if (!std::isnan(height_m)) {
            ++floor;
            floor_below += std::abs(free_m - (top_m - height_m)) < 0.05 ? 1 : 0;
        }
    });
    EXPECT_GT(top, 100);
    EXPECT_LT(top_reached, top / 20) << "only cells mixed with floor along the rim may be reached";
    EXPECT_GT(floor, 1000) << "floor seen under the rim";
    // The far side of the top is edge-on, and some cells are seen only once from these poses.
    EXPECT_GT(floor_below, 80 * floor / 100);
    const double start_m = near_x_m - 1.0;
    EXPECT_TRUE(drive.passable(0.5, {start_m, 0.0, 0.0}, {start_m + 0.5, 0.0, 0.0}));
    EXPECT_FALSE(drive.passable(0.5, {start_m, 0.0, 0.0}, {near_x_m + 0.4, 0.0, 0.0}));
}

}  // namespace
}  // namespace surefoot::terrain

// SPDX-License-Identifier: Apache-2.0
// Counts every allocation of this test program, to bound the memory use of the terrain part of a
// frame: motion, depth image, cloud, clean-up, height bounds, rating and footprints.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "surefoot/core/allocations_testing.hpp"
#include "surefoot/elevation/elevation_map.hpp"
#include "surefoot/elevation/fusion/height_bounds.hpp"
#include "surefoot/stairs/tracking/feature_tracker.hpp"
#include "surefoot/traversability/footprint.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::pipeline {
namespace {

using heap::allocations;
using heap::held_bytes;
using traversability::Footprint;
using traversability::FootprintPose;

constexpr std::int64_t kFrame_ns = 66'666'667;

/// The ZED at VGA, pitched down by 32 deg.
camera::RectifiedRig zed() {
    camera::RectifiedRig rig;
    rig.width = 672;
    rig.height = 376;
    rig.fx_px = rig.fy_px = 342.0;
    rig.cx_px = 0.5 * (rig.width - 1);
    rig.cy_px = 0.5 * (rig.height - 1);
    rig.baseline_m = 0.12;
    const Eigen::Quaterniond pitched_down = exp_so3({0.0, 32.0 * std::numbers::pi / 180.0, 0.0});
    rig.T_body_camera = Pose{pitched_down, Eigen::Vector3d::Zero()} * T_body_optical();
    return rig;
}

/// Returns a level floor `below_m` under the camera with a match in every pixel.
DepthImage floor_image(const camera::RectifiedRig& rig, double below_m) {
    DepthImage depth;
    depth.resize(rig.width, rig.height);
    const Eigen::Matrix3d R_body_camera = rig.T_body_camera.R();
    for (int v = 0; v < rig.height; ++v) {
        for (int u = 0; u < rig.width; ++u) {
            const Eigen::Vector3d ray = rig.point(u, v, rig.depth_to_disparity_px_m());
            const double down = -(R_body_camera * ray).z();
            depth.disparity_px.at(u, v) =
                down > 0.0 ? static_cast<float>(rig.depth_to_disparity_px_m() * down / below_m)
                           : std::nanf("");
        }
    }
    depth.sigma_px.fill(0.2F);
    depth.outlier_probability.fill(0.05F);
    return depth;
}

/// A default map with all its consumers, fed as in a run.
class Terrain {
  public:
    Terrain() : map_(config()), rater_(traversability::TraversabilityConfig{}) {
        depths_.push_back(floor_image(rig_, 1.0));
        depths_.push_back(floor_image(rig_, 0.6));  // contradicts: inflates, replaces, clears
        cloud_.assign(500, {{1.0F, 0.0F, -1.0F}, 1e-4F, 1e-4F});
    }

    void frame(int k) {
        const std::int64_t time_ns = k * kFrame_ns;
        const Pose T_odom_body{Eigen::Quaterniond::Identity(), {0.03 * k, -0.01 * k, 1.0}};
        map_.follow(T_odom_body, 1e-8 * Matrix6::Identity());
        const DepthImage& depth = depths_[k % 30 < 20 ? 0 : 1];
        const FusionCounts counts = map_.add(rig_, T_odom_body, depth, time_ns);
        cleared_ += counts.cells_cleared;
        fused_ += counts.cells_fused;
        inflated_ += counts.cells_inflated;
        map_.add_points(cloud_, {}, T_odom_body, time_ns);
        const auto& layers = map_.layers();
        bounds_.compute({layers.height_m.view(),
                         layers.height_var_m2.view(),
                         layers.horizontal_drift_m.view(),
                         map_.geometry().resolution_m},
                        serial(),
                        lower_m_,
                        upper_m_);
        const double resolution_m = map_.geometry().resolution_m;
        rater_.rate(layers.height_m.view(), resolution_m, serial(), rating_);
        rater_.rate(layers.height_m.view(), resolution_m, {90, 90, 60, 60}, serial(), rating_);
        ask(0.03 * k);
    }

    [[nodiscard]] std::int64_t cleared() const { return cleared_; }
    [[nodiscard]] std::int64_t fused() const { return fused_; }
    [[nodiscard]] std::int64_t inflated() const { return inflated_; }
    [[nodiscard]] std::int64_t cells_asked() const { return cells_asked_; }
    [[nodiscard]] std::int64_t input_bytes() const {
        std::int64_t bytes = static_cast<std::int64_t>(cloud_.size() * sizeof(cloud_[0]));
        for (const DepthImage& depth : depths_)
            bytes += static_cast<std::int64_t>(3 * depth.disparity_px.size() * sizeof(float));
        return bytes;
    }

  private:
    static elevation::ElevationConfig config() {
        elevation::ElevationConfig config;
        return config;
    }

    void ask(double x_m) {
        const traversability::FootprintLayers layers{
            map_.geometry(), rating_.traversability.view(), map_.layers().height_m.view()};
        const std::array<FootprintPose, 3> way{
            {{x_m, 0.0, 0.0}, {x_m + 1.0, 0.0, 0.5}, {x_m + 1.5, 0.0, 1.0}}};
        cells_asked_ += query(disc_, way[1], layers).cells;
        cells_asked_ += query(foot_, way[1], layers).cells;
        cells_asked_ += query_path(foot_, way, layers, scratch_).cells;
    }

    camera::RectifiedRig rig_ = zed();
    std::vector<DepthImage> depths_;
    std::vector<elevation::MeasuredPoint> cloud_;
    elevation::ElevationMap map_;
    elevation::HeightBounds bounds_;
    grid::Layer lower_m_;
    grid::Layer upper_m_;
    traversability::Traversability rater_;
    traversability::TraversabilityLayers rating_;
    Footprint disc_ = *Footprint::circle(0.3);
    Footprint foot_ = *Footprint::polygon(
        std::array<Eigen::Vector2d, 4>{{{-0.2, -0.1}, {0.2, -0.1}, {0.2, 0.1}, {-0.2, 0.1}}});
    traversability::PathScratch scratch_;
    std::int64_t cleared_ = 0;
    std::int64_t fused_ = 0;
    std::int64_t inflated_ = 0;
    std::int64_t cells_asked_ = 0;
};

TEST(TerrainMemory, NothingIsAllocatedOnceWarm) {
    const std::int64_t before_first = allocations;
    Terrain terrain;
    constexpr int kWarm = 40;
    for (int k = 0; k < kWarm; ++k) terrain.frame(k);
    EXPECT_GT(allocations, before_first) << "the counter works";
    const std::int64_t cleared = terrain.cleared();
    const std::int64_t fused = terrain.fused();
    const std::int64_t inflated = terrain.inflated();
    const std::int64_t asked = terrain.cells_asked();
    const std::int64_t before = allocations;
    // This is far enough that the layers move back to the middle of their memory.
    for (int k = kWarm; k < kWarm + 130; ++k) terrain.frame(k);
    EXPECT_EQ(allocations - before, 0);
    EXPECT_GT(terrain.cleared(), cleared) << "the clean-up must have had work";
    EXPECT_GT(terrain.fused(), fused);
    EXPECT_GT(terrain.inflated(), inflated);
    EXPECT_GT(terrain.cells_asked(), asked);
}

/// Steps up, and the edge of a drop beside them.
stairs::TerrainFeatures stairs_found(int steps, double shift_m) {
    stairs::TerrainFeatures found;
    stairs::Flight flight;
    flight.steps = steps;
    for (int k = 0; k < steps; ++k) {
        stairs::Edge edge;
        edge.from_m = {1.0 + 0.3 * k + shift_m, 0.5};
        edge.to_m = {1.0 + 0.3 * k + shift_m, -0.5};
        edge.lower_m = 0.2 * k;
        edge.upper_m = 0.2 * (k + 1);
        edge.lower_seen = true;
        flight.edges.push_back(edge);
    }
    found.edges = flight.edges;
    if (steps > 0) found.flights = {flight};
    stairs::Edge drop;
    drop.from_m = {0.5 + shift_m, -2.0};
    drop.to_m = {0.5 + shift_m, -1.0};
    drop.lower_m = -0.5;
    found.edges.push_back(drop);
    found.drops = {stairs::line_feature(drop, true)};
    found.doors.resize(static_cast<std::size_t>(steps % 3));
    return found;
}

TEST(TerrainMemory, FollowingFeaturesAllocatesNothingOnceWarm) {
    grid::Layer height_m(200, 200, 0.0F);
    stairs::Terrain terrain;
    terrain.geometry = {0.025, 200, 200, {-2.5, -2.5}};
    terrain.height_m = height_m.view();
    std::vector<stairs::TerrainFeatures> found;
    for (int k = 0; k < 8; ++k) found.push_back(stairs_found(k % 5, 0.01 * k));
    found.emplace_back();
    stairs::FeatureTracker tracker{stairs::TrackingConfig{}};
    stairs::TerrainFeatures told;
    std::size_t flights = 0;
    const auto observation = [&](int k) {
        // The frames without features last long enough that features disappear and return.
        const auto i = static_cast<std::size_t>(k % 60 < 40 ? k % 8 : 8);
        tracker.update(found[i], terrain, {k * kFrame_ns, {}}, told);
        flights += told.flights.size();
    };
    for (int k = 0; k < 120; ++k) observation(k);
    EXPECT_GT(flights, 0U);
    const std::int64_t before = allocations;
    for (int k = 120; k < 600; ++k) observation(k);
    EXPECT_EQ(allocations - before, 0);
}

TEST(TerrainMemory, ADefaultMapWithItsRatingHoldsAtMostTwentyMegabytes) {
    constexpr std::int64_t kMost_bytes = 20'000'000;
    const std::int64_t before = held_bytes;
    const elevation::ElevationMap map({});
    const std::int64_t layers = held_bytes - before;
    const std::int64_t cells = static_cast<std::int64_t>(map.geometry().nx) * map.geometry().ny;
    EXPECT_GE(layers, cells * 44) << "the layers that readers see: 8 floats, a count and a time";

    const std::int64_t before_terrain = held_bytes;
    Terrain terrain;
    for (int k = 0; k < 40; ++k) terrain.frame(k);
    const std::int64_t all = held_bytes - before_terrain - terrain.input_bytes();
    RecordProperty("layers_bytes", std::to_string(layers));
    RecordProperty("all_bytes", std::to_string(all));
    std::printf(
        "a map of %d x %d cells: %.2f MB; fed with images of 672 x 376, with clean-up, "
        "bounds and rating: %.2f MB\n",
        map.geometry().nx,
        map.geometry().ny,
        static_cast<double>(layers) / 1e6,
        static_cast<double>(all) / 1e6);
    EXPECT_LE(all, kMost_bytes);
}

}  // namespace
}  // namespace surefoot::pipeline

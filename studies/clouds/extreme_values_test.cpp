// SPDX-License-Identifier: Apache-2.0
// No content of a file may crash the program. The tests pass extreme float values to all code that
// converts them to indices. UBSan (preset asan-ubsan) checks each conversion.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "studies/clouds/surface_dem.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/eval/clouds/cloud_distance.hpp"
#include "surefoot/eval/clouds/cloud_measures.hpp"
#include "surefoot/eval/clouds/cloud_outliers.hpp"
#include "surefoot/eval/clouds/voxels.hpp"
#include "surefoot/eval/maps/dem.hpp"
#include "surefoot/geometry/kd_tree.hpp"
#include "surefoot/grid/snapshot_builder.hpp"
#include "surefoot/stairs/classes/ground_classes.hpp"
#include "surefoot/stairs/feature_finder.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::app {
namespace {

constexpr int kSide = 48;
constexpr double kResolution_m = 0.025;
constexpr int kTries = 20;

/// A random extreme float value.
float extreme(Rng& rng) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    constexpr float kEnds[] = {1e38F,
                               -3.4e38F,
                               std::numeric_limits<float>::max(),
                               std::numeric_limits<float>::lowest(),
                               kInfinity,
                               -kInfinity,
                               std::numeric_limits<float>::quiet_NaN(),
                               std::numeric_limits<float>::denorm_min(),
                               1e19F,
                               -2147483648.0F,
                               4e9F,
                               1e5F};
    return kEnds[rng.below(std::size(kEnds))];
}

grid::Layer extreme_map(Rng& rng, double share) {
    grid::Layer map(kSide, kSide, 0.0F);
    // Extreme values fill a patch as well as single cells, because real voids are connected.
    const float patch = extreme(rng);
    const std::uint64_t first = rng.below(kSide);
    for (int iy = 0; iy < kSide; ++iy) {
        for (int ix = 0; ix < kSide; ++ix) {
            float& z_m = map.at(ix, iy);
            z_m = 0.17F * static_cast<float>(ix / 11) + 0.002F * static_cast<float>(rng.normal());
            if (rng.uniform() < share) z_m = extreme(rng);
            if (static_cast<std::uint64_t>(iy) >= first && ix > 30) z_m = patch;
        }
    }
    return map;
}

grid::GridGeometry geometry() {
    grid::GridGeometry g;
    g.resolution_m = kResolution_m;
    g.nx = kSide;
    g.ny = kSide;
    return g;
}

TEST(ExtremeValues, RatingsAreInTheirRangeOrUnknown) {
    for (int i = 0; i < kTries; ++i) {
        Rng rng(static_cast<std::uint64_t>(i));
        const grid::Layer map = extreme_map(rng, 0.02 * i);
        traversability::TraversabilityLayers layers;
        traversability::rate(
            traversability::TraversabilityConfig{}, map.view(), kResolution_m, serial(), layers);
        for (int iy = 0; iy < kSide; ++iy) {
            for (int ix = 0; ix < kSide; ++ix) {
                const float rating = layers.traversability.at(ix, iy);
                EXPECT_TRUE(std::isnan(rating) || (rating >= 0.0F && rating <= 1.0F)) << i;
            }
        }
    }
}

TEST(ExtremeValues, StairsAndClassesOfAnyHeights) {
    for (int i = 0; i < kTries; ++i) {
        Rng rng(static_cast<std::uint64_t>(100 + i));
        const grid::Layer map = extreme_map(rng, 0.01 * i);
        const grid::Layer variance = extreme_map(rng, 0.5);
        stairs::Terrain terrain;
        terrain.geometry = geometry();
        terrain.height_m = map.view();
        if (i % 3 == 1) terrain.height_var_m2 = variance.view();
        if (i % 3 == 2) terrain.clearance_m = variance.view();
        terrain.stance_m = {0.1, 0.6};
        stairs::TerrainFeatures found;
        const stairs::StairsConfig config;
        stairs::FeatureFinder(config).find(terrain, found);
        const stairs::GroundClasses classes = stairs::classify_ground(config, terrain, found);
        EXPECT_EQ(classes.tread_height_m.width(), kSide);
    }
}

TEST(ExtremeValues, SnapshotsHoldNoBrokenHeight) {
    for (int i = 0; i < kTries; ++i) {
        Rng rng(static_cast<std::uint64_t>(200 + i));
        const grid::Layer height = extreme_map(rng, 0.02 * i);
        const grid::Layer variance = extreme_map(rng, 0.3);
        grid::SnapshotInput input;
        input.geometry = geometry();
        input.height_m = height.view();
        input.variance_m2 = variance.view();
        input.drift_m = variance.view();
        input.clearance_m = variance.view();
        input.free_above_m = height.view();
        input.drop_evidence = variance.view();
        const auto snapshot = std::make_unique<grid::MapSnapshot>();
        static_cast<void>(grid::build_snapshot(input, *snapshot));
        for (int iy = 0; iy < kSide; ++iy) {
            for (int ix = 0; ix < kSide; ++ix) {
                if (std::abs(height.at(ix, iy)) <= 1000.0F) continue;
                const auto cell = static_cast<std::size_t>(iy * kSide + ix);
                EXPECT_NE(snapshot->source[cell], grid::EvidenceSource::measured) << i;
            }
        }
    }
}

TEST(ExtremeValues, CloudsOfAnyCoordinates) {
    for (int i = 0; i < kTries; ++i) {
        Rng rng(static_cast<std::uint64_t>(300 + i));
        std::vector<Eigen::Vector3d> points_m;
        std::vector<Eigen::Vector3f> finite_m;
        std::vector<Eigen::Vector3f> near_m;
        for (int k = 0; k < 500; ++k) {
            Eigen::Vector3f p_m(
                static_cast<float>(rng.uniform()), static_cast<float>(rng.uniform()), 0.0F);
            if (rng.below(10) == 0) p_m[static_cast<Eigen::Index>(rng.below(3))] = extreme(rng);
            points_m.push_back(p_m.cast<double>());
            if (!p_m.allFinite()) continue;
            finite_m.push_back(p_m);
            if (p_m.cwiseAbs().maxCoeff() <= geometry::KdTree::kFarthest_m) near_m.push_back(p_m);
        }
        eval::CloudBounds bounds;
        bounds.add(points_m);
        // The far points need too many cells, which is an error; then test a grid of usual size.
        EXPECT_FALSE(bounds.grid(kResolution_m, eval::Lattice::cell));
        eval::DemGrid grid;
        grid.geometry = geometry();
        for (const eval::Reduce reduce : {eval::Reduce::max, eval::Reduce::mean}) {
            eval::DemBuilder builder(grid, reduce);
            builder.add(points_m);
            EXPECT_EQ(builder.heights_m().width(), kSide);
        }
        EXPECT_TRUE(surface_dem(grid, {}, [&](const auto& take) { return take(points_m); }));
        EXPECT_FALSE(eval::fits_voxels(geometry::box_of(finite_m), 1e-3));
        EXPECT_TRUE(eval::voxel_number(3.4e38F, 1e-3) > 0);
        EXPECT_TRUE(eval::height_histogram(finite_m).levels.empty());
        const geometry::KdTree tree(near_m);
        EXPECT_EQ(eval::cloud_distances_m(tree, finite_m).size(), finite_m.size());
        const eval::OutlierFilter filter(tree, {});
        int kept = 0;
        for (const Eigen::Vector3f& p_m : finite_m) kept += filter.keeps(p_m) ? 1 : 0;
        EXPECT_GT(kept, 400);
    }
}

}  // namespace
}  // namespace surefoot::app

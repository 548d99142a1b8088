// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/sampling/depth_samples.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/elevation/sampling/depth_points.hpp"

namespace surefoot::elevation {
namespace {

/// A width that no register divides.
constexpr int kWidth = 333;
constexpr int kHeight = 150;

camera::RectifiedRig rig() {
    camera::RectifiedRig rig;
    rig.width = kWidth;
    rig.height = kHeight;
    rig.fx_px = 170.0;
    rig.fy_px = 171.0;
    rig.cx_px = 165.3;
    rig.cy_px = 76.1;
    rig.baseline_m = 0.12;
    const Eigen::Quaterniond pitched_down = exp_so3({0.02, 32.0 * std::numbers::pi / 180.0, 0.3});
    rig.T_body_camera = Pose{pitched_down, {0.1, 0.02, 0.0}} * T_body_optical();
    return rig;
}

/// A tilted plane with steps, holes, wild values and pixels with an outlier probability.
DepthImage depth_image(Rng& rng) {
    DepthImage depth;
    depth.resize(kWidth, kHeight);
    for (int v = 0; v < kHeight; ++v) {
        for (int u = 0; u < kWidth; ++u) {
            double d = 4.0 + 0.08 * v + 0.005 * u + (u > 200 && v > 60 ? 3.0 : 0.0);
            d += 0.1 * rng.normal();
            const double wild = rng.uniform(0.0, 1.0);
            if (wild < 0.05) d = std::numeric_limits<double>::quiet_NaN();
            if (wild > 0.99) d = std::numeric_limits<double>::infinity();
            if (wild > 0.97 && wild < 0.98) d = -1.0;
            if (wild > 0.96 && wild < 0.97) d = 200.0;
            depth.disparity_px.at(u, v) = static_cast<float>(d);
            depth.sigma_px.at(u, v) =
                wild > 0.5 && wild < 0.52 ? 0.0F : static_cast<float>(rng.uniform(0.05, 0.5));
            depth.outlier_probability.at(u, v) = static_cast<float>(rng.uniform(0.0, 0.6));
        }
    }
    return depth;
}

struct Result {
    std::vector<std::uint32_t> cell;
    std::vector<float> z_m;
    std::vector<float> var_m2;
    FusionCounts counts;
    bool operator==(const Result& other) const {
        return cell == other.cell && z_m == other.z_m && var_m2 == other.var_m2;
    }
};

void collect(const CellSamples& samples, Result& result) {
    for (int b = 0; b < samples.blocks(); ++b) {
        const CellSamples::Block block = samples.block(b);
        result.cell.insert(result.cell.end(), block.cell.begin(), block.cell.end());
        result.z_m.insert(result.z_m.end(), block.z_m.begin(), block.z_m.end());
        result.var_m2.insert(result.var_m2.end(), block.var_m2.begin(), block.var_m2.end());
    }
}

Result fast(const ElevationConfig& config,
            const Pose& T_odom_body,
            const DepthImage& depth,
            const grid::GridGeometry& geometry) {
    DepthSampler sampler;
    CellSamples samples;
    Result result;
    sampler.sample(config, rig(), T_odom_body, depth, geometry, serial(), samples, result.counts);
    collect(samples, result);
    return result;
}

Result plain(const ElevationConfig& config,
             const Pose& T_odom_body,
             const DepthImage& depth,
             const grid::GridGeometry& geometry) {
    std::vector<GridPoint> points;
    CellSamples samples;
    Result result;
    points_from_depth(config, rig(), T_odom_body, depth, geometry.origin_m, points, result.counts);
    result.counts.outside += samples_from_points(points, geometry, samples);
    collect(samples, result);
    return result;
}

grid::GridGeometry geometry() {
    grid::GridGeometry geometry;
    geometry.resolution_m = 0.025;
    geometry.nx = 100;
    geometry.ny = 90;
    geometry.origin_m = {10.5, -1.0};
    return geometry;
}

const Pose kBody{Eigen::Quaterniond::Identity(), {10.0, 0.0, 3.4}};

TEST(DepthSamples, AgreeWithThePointsInDoubles) {
    Rng rng(3);
    const DepthImage depth = depth_image(rng);
    ElevationConfig switched_off;
    switched_off.prefilter.range = false;
    switched_off.prefilter.height = false;
    switched_off.pixels.surface_check = false;
    ElevationConfig narrow;
    narrow.prefilter.max_range_m = 2.5;
    narrow.prefilter.min_height_m = -1.2;
    narrow.prefilter.max_height_m = -0.4;
    narrow.pixels.reach_px = 7;
    for (const ElevationConfig& config : {ElevationConfig{}, switched_off, narrow}) {
        const Result a = plain(config, kBody, depth, geometry());
        const Result b = fast(config, kBody, depth, geometry());
        EXPECT_EQ(a.counts.points, b.counts.points);
        EXPECT_EQ(a.counts.gated_confidence, b.counts.gated_confidence);
        // At a limit, rounding decides. This affects one point in 2^22 of the range of a float, so
        // some points a frame.
        constexpr int kAtALimit = 3;
        EXPECT_LE(std::abs(a.counts.gated_range - b.counts.gated_range), kAtALimit);
        EXPECT_LE(std::abs(a.counts.gated_height - b.counts.gated_height), kAtALimit);
        EXPECT_LE(std::abs(a.counts.outside - b.counts.outside), kAtALimit);
        ASSERT_GT(a.cell.size(), 3000U);
        ASSERT_EQ(a.cell.size(), b.cell.size());
        int elsewhere = 0;
        for (std::size_t i = 0; i < a.cell.size(); ++i) {
            elsewhere += a.cell[i] == b.cell[i] ? 0 : 1;
            // Heights of 4 m in floats: 2^-22 m each for the product and the sum.
            EXPECT_NEAR(a.z_m[i], b.z_m[i], 2e-6F);
            EXPECT_NEAR(b.var_m2[i] / a.var_m2[i], 1.0F, 1e-5F);
        }
        EXPECT_LE(elsewhere, kAtALimit);
    }
}

TEST(DepthSamples, SameBytesOnEveryInstructionSet) {
    Rng rng(4);
    const DepthImage depth = depth_image(rng);
    const Result all = fast({}, kBody, depth, geometry());
    for (std::int64_t targets = hwy::SupportedTargets(); targets != 0; targets &= targets - 1) {
        hwy::SetSupportedTargetsForTest(targets & -targets);
        EXPECT_TRUE(all == fast({}, kBody, depth, geometry()))
            << hwy::TargetName(targets & -targets);
    }
    hwy::SetSupportedTargetsForTest(0);
}

TEST(DepthSamples, ImagesOfAnySize) {
    for (const auto& [width, height] : {std::pair{1, 1}, {0, 0}, {3, 40}, {65, 2}}) {
        DepthImage depth;
        depth.resize(width, height);
        depth.disparity_px.fill(20.0F);
        depth.sigma_px.fill(0.2F);
        depth.outlier_probability.fill(0.0F);
        ElevationConfig config;
        config.pixels.surface_check = false;
        const Result result = fast(config, kBody, depth, geometry());
        EXPECT_EQ(result.counts.points, width * height);
    }
}

}  // namespace
}  // namespace surefoot::elevation

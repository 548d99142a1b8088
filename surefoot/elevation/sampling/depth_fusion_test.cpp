// SPDX-License-Identifier: Apache-2.0
// The whole depth path on rendered scenes: exact geometry, known noise, truth from the scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <vector>

#include "surefoot/core/allocations_testing.hpp"
#include "surefoot/core/executors_testing.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/elevation/elevation_map.hpp"

namespace surefoot::elevation {
namespace {

constexpr double kSigma_px = 0.25;

/// Flat ground at 0, and at `height_m` beyond the line x = edge_m; a riser closes a step up.
struct StepScene {
    double edge_m = 100.0;
    double height_m = 0.0;
    [[nodiscard]] double truth_m(double x_m) const { return x_m >= edge_m ? height_m : 0.0; }
};

camera::RectifiedRig zed(int width = 672, int height = 376) {
    camera::RectifiedRig rig;
    rig.width = width;
    rig.height = height;
    rig.fx_px = 341.925 * width / 672.0;
    rig.fy_px = rig.fx_px;
    rig.cx_px = 0.5 * (width - 1);
    rig.cy_px = 0.5 * (height - 1);
    rig.baseline_m = 0.12;
    const Eigen::Quaterniond pitched_down = exp_so3({0.0, 32.0 * std::numbers::pi / 180.0, 0.0});
    rig.T_body_camera = Pose{pitched_down, Eigen::Vector3d::Zero()} * T_body_optical();
    return rig;
}

Pose body_at(double x_m) {
    return {Eigen::Quaterniond::Identity(), {x_m, 0.0, 1.0}};
}

/// Depth along z of the first surface on a ray with unit z in the camera; NaN for none.
double cast(const StepScene& scene, const Eigen::Vector3d& from_m, const Eigen::Vector3d& ray) {
    double nearest = std::numeric_limits<double>::infinity();
    const auto consider = [&](double z, bool is_there) {
        if (is_there && z > 0.0 && z < nearest) nearest = z;
    };
    const double to_ground = -from_m.z() / ray.z();
    consider(to_ground, from_m.x() + to_ground * ray.x() < scene.edge_m);
    const double to_upper = (scene.height_m - from_m.z()) / ray.z();
    consider(to_upper, from_m.x() + to_upper * ray.x() >= scene.edge_m);
    const double to_riser = (scene.edge_m - from_m.x()) / ray.x();
    const double riser_z_m = from_m.z() + to_riser * ray.z();
    consider(
        to_riser,
        riser_z_m >= std::min(0.0, scene.height_m) && riser_z_m <= std::max(0.0, scene.height_m));
    return std::isinf(nearest) ? static_cast<double>(kNanF) : nearest;
}

DepthImage render(const StepScene& scene,
                  const camera::RectifiedRig& rig,
                  const Pose& T_odom_body) {
    DepthImage depth;
    depth.resize(rig.width, rig.height);
    const Pose T_odom_camera = T_odom_body * rig.T_body_camera;
    for (int v = 0; v < rig.height; ++v) {
        for (int u = 0; u < rig.width; ++u) {
            const Eigen::Vector3d ray_camera(
                (u - rig.cx_px) / rig.fx_px, (v - rig.cy_px) / rig.fy_px, 1.0);
            const double z_m =
                cast(scene, T_odom_camera.translation_m, T_odom_camera.rotation * ray_camera);
            depth.disparity_px.at(u, v) = static_cast<float>(rig.depth_to_disparity_px_m() / z_m);
        }
    }
    depth.sigma_px.fill(static_cast<float>(kSigma_px));
    depth.outlier_probability.fill(0.05F);
    return depth;
}

/// Normal noise, equal within blocks of `block_px` (1 = independent pixels).
void add_noise(DepthImage& depth, Rng& rng, int block_px) {
    const int columns = depth.disparity_px.width() / block_px + 1;
    std::vector<double> row_px(static_cast<std::size_t>(columns));
    for (int v = 0; v < depth.disparity_px.height(); ++v) {
        if (v % block_px == 0)
            std::generate(row_px.begin(), row_px.end(), [&] { return kSigma_px * rng.normal(); });
        for (int u = 0; u < depth.disparity_px.width(); ++u) {
            depth.disparity_px.at(u, v) +=
                static_cast<float>(row_px[static_cast<std::size_t>(u / block_px)]);
        }
    }
}

struct Errors {
    int cells = 0;
    double mean_m = 0.0;
    double median_abs_m = 0.0;
    double worst_sigmas = 0.0;
    double nees = 0.0;  ///< mean of (error / sigma)^2: 1 = calibrated, more = over-confident
};

/// Compares cells farther than two cells from the edge with the scene.
Errors compare(const ElevationMap& map, const StepScene& scene) {
    Errors errors;
    std::vector<double> absolute_m;
    for (int iy = 0; iy < map.geometry().ny; ++iy) {
        for (int ix = 0; ix < map.geometry().nx; ++ix) {
            const float height_m = map.layers().height_m.at(ix, iy);
            const double x_m = map.geometry().center_m({ix, iy}).x();
            if (std::isnan(height_m) || std::abs(x_m - scene.edge_m) < 0.0625) continue;
            const double error_m = static_cast<double>(height_m) - scene.truth_m(x_m);
            const double var_m2 = static_cast<double>(map.layers().height_var_m2.at(ix, iy));
            ++errors.cells;
            errors.mean_m += error_m;
            errors.nees += error_m * error_m / var_m2;
            errors.worst_sigmas =
                std::max(errors.worst_sigmas, std::abs(error_m) / std::sqrt(var_m2));
            absolute_m.push_back(std::abs(error_m));
        }
    }
    if (errors.cells == 0) return errors;
    errors.mean_m /= errors.cells;
    errors.nees /= errors.cells;
    std::nth_element(absolute_m.begin(), absolute_m.begin() + errors.cells / 2, absolute_m.end());
    errors.median_abs_m = absolute_m[static_cast<std::size_t>(errors.cells / 2)];
    return errors;
}

TEST(DepthFusion, FloorWithoutNoiseIsExact) {
    const StepScene floor;
    ElevationMap map({});
    const FusionCounts counts = map.add(zed(), body_at(0), render(floor, zed(), body_at(0)), 0);
    EXPECT_GT(counts.cells_new, 7000);
    EXPECT_EQ(counts.cells_new, map.known_cells());
    const Errors errors = compare(map, floor);
    // A float disparity of 10 px at 4 m has a rounding error of 5e-7 px: 1 um.
    EXPECT_LT(errors.median_abs_m, 2e-6);
    EXPECT_TRUE(std::isnan(map.layers().height_m.at(120, 120))) << "under the body: not visible";
}

TEST(DepthFusion, IndependentNoiseAveragesAndSigmaCoversIt) {
    const StepScene floor;
    Rng rng(21);
    DepthImage depth = render(floor, zed(), body_at(0));
    add_noise(depth, rng, 1);
    ElevationMap map({});
    map.add(zed(), body_at(0), depth, 0);
    const Errors errors = compare(map, floor);
    EXPECT_GT(errors.cells, 7000);
    EXPECT_LT(errors.nees, 1.0);
    EXPECT_LT(errors.worst_sigmas, 5.0);
    // The upper start of the mean shift and the curvature of 1/d leave at most a millimetre.
    EXPECT_LT(std::abs(errors.mean_m), 0.001);
}

TEST(DepthFusion, SharedErrorsOfAMatcherAreNotTakenForIndependent) {
    const StepScene floor;
    double nees = 0.0;
    constexpr int kSeeds = 5;
    for (int seed = 0; seed < kSeeds; ++seed) {
        Rng rng(mix_seed(31, static_cast<std::uint64_t>(seed)));
        DepthImage depth = render(floor, zed(), body_at(0));
        add_noise(depth, rng, 40);
        ElevationMap map({});
        map.add(zed(), body_at(0), depth, 0);
        nees += compare(map, floor).nees / kSeeds;
    }
    // About 170 blocks per frame: the mean over 850 squared normals has the relative error sqrt(2 /
    // 850) = 5 %.
    EXPECT_LT(nees, 1.0 + 4.0 * 0.05) << "over-confident";
    EXPECT_GT(nees, 0.5) << "needlessly modest";
}

struct Border {
    int cells = 0;
    double mean_m = 0.0;
    double nees = 0.0;
};

/// The nearest cells of a floor that a standing camera observes for a while, at the lower border of
/// the image.
Border lower_border(double border_share) {
    const StepScene floor;
    // The lower border meets the floor 0.559 m before the camera, and so 1 mm beyond a cell.
    const Pose T_odom_body = body_at(0.017);
    Border border;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        Rng rng(mix_seed(51, seed));
        ElevationConfig config;
        config.reduction.border_share = border_share;
        ElevationMap map(config);
        for (int view = 0; view < 10; ++view) {
            DepthImage depth = render(floor, zed(), T_odom_body);
            add_noise(depth, rng, 12);
            map.add(zed(), T_odom_body, depth, view);
        }
        for (int iy = 108; iy < 132; ++iy) {  // 0.3 m to both sides
            const float* row_m = &map.layers().height_m.at(0, iy);
            const auto at = std::find_if_not(
                row_m, row_m + map.geometry().nx, [](float z_m) { return std::isnan(z_m); });
            if (at == row_m + map.geometry().nx) continue;
            const int ix = static_cast<int>(at - row_m);
            const double z_m = static_cast<double>(*at);
            ++border.cells;
            border.mean_m += z_m;
            border.nees += z_m * z_m / static_cast<double>(map.layers().height_var_m2.at(ix, iy));
        }
    }
    border.mean_m /= border.cells;
    border.nees /= border.cells;
    return border;
}

TEST(DepthFusion, GroundBeyondTheImageIsNotMeasuredByPointsThatErrTowardsIt) {
    const Border trusted = lower_border(0.0);
    EXPECT_EQ(trusted.cells, 96);
    EXPECT_GT(trusted.mean_m, 0.007) << "what this is about";
    EXPECT_GT(trusted.nees, 1.7);
    const Border wanted = lower_border(ReductionConfig{}.border_share);
    EXPECT_EQ(wanted.cells, 96);
    EXPECT_LT(std::abs(wanted.mean_m), 0.004);
    EXPECT_LT(wanted.nees, 1.5);
}

/// A wall fills the image from its lower to its upper border, so no cell of the wall is wholly in
/// view.
TEST(DepthFusion, AWallThatReachesBeyondTheImageIsSeen) {
    StepScene wall;
    wall.edge_m = 0.45;
    wall.height_m = 3.0;
    ElevationMap map({});
    const FusionCounts counts = map.add(zed(), body_at(0), render(wall, zed(), body_at(0)), 0);
    int high = 0;
    for (int iy = 110; iy < 130; ++iy) {
        for (int ix = 120; ix < 150; ++ix) high += map.layers().height_m.at(ix, iy) > 0.3F;
    }
    EXPECT_GE(high, 20);
    EXPECT_GT(counts.cells_new, 20);
}

TEST(DepthFusion, ManyViewsImproveHeightsAndStayHonest) {
    const StepScene floor;
    Rng rng(41);
    ElevationMap map({});
    double first_median_m = 0.0;
    for (int view = 0; view < 12; ++view) {
        const Pose T_odom_body = body_at(0.02 * view);
        DepthImage depth = render(floor, zed(), T_odom_body);
        add_noise(depth, rng, 40);
        map.follow(T_odom_body, Matrix6::Zero());
        map.add(zed(), T_odom_body, depth, view);
        if (view == 0) first_median_m = compare(map, floor).median_abs_m;
    }
    const Errors errors = compare(map, floor);
    EXPECT_LT(errors.median_abs_m, 0.6 * first_median_m);
    EXPECT_LT(errors.nees, 1.2);
    // The camera stands: the same image again and again must change nothing.
    const Pose T_odom_body = body_at(0.3);
    DepthImage depth = render(floor, zed(), T_odom_body);
    add_noise(depth, rng, 40);
    map.add(zed(), T_odom_body, depth, 100);
    const ElevationLayers once = map.layers();
    for (int repeat = 0; repeat < 5; ++repeat) map.add(zed(), T_odom_body, depth, 101 + repeat);
    int lowered = 0;
    for (std::size_t i = 0; i < once.height_var_m2.size(); ++i) {
        lowered += map.layers().height_var_m2.data()[i] < once.height_var_m2.data()[i] ? 1 : 0;
    }
    // Cells that disagreed (about 1 % for a gate of 2.5 sigma) were inflated; their variance may
    // shrink again.
    EXPECT_LT(lowered, 0.03 * static_cast<double>(map.known_cells()));
}

TEST(DepthFusion, StepUpHasBothLevelsAndTheEdgeCellTakesTheUpper) {
    const StepScene step{1.2125, 0.18};  // the edge in the middle of a cell
    Rng rng(51);
    DepthImage depth = render(step, zed(), body_at(0));
    add_noise(depth, rng, 1);
    ElevationMap map({});
    map.add(zed(), body_at(0), depth, 0);
    const Errors errors = compare(map, step);
    EXPECT_GT(errors.cells, 5000);
    EXPECT_LT(errors.nees, 1.2);
    EXPECT_LT(errors.worst_sigmas, 6.0);
    int upper = 0;
    int known = 0;
    for (int iy = 100; iy < 140; ++iy) {
        const float height_m =
            map.layers().height_m.at(map.geometry().cell_at(1.2125, 0.0)->ix, iy);
        if (std::isnan(height_m)) continue;
        ++known;
        upper += height_m > 0.15F ? 1 : 0;
    }
    EXPECT_GT(known, 30);
    EXPECT_GE(upper, 0.9 * known);
}

/// A drop as a matcher measures it: a ramp across the edge joins the disparities on both sides.
void smear_columns(DepthImage& depth, int half_px) {
    const DepthImage sharp = depth;
    const Image<float>& d = sharp.disparity_px;
    for (int u = 0; u < d.width(); ++u) {
        for (int v = 1; v < d.height(); ++v) {
            if (d.at(u, v) - d.at(u, v - 1) < 1.5F) continue;
            const int first = std::max(0, v - half_px);
            const int last = std::min(d.height() - 1, v - 1 + half_px);
            for (int w = first; w <= last; ++w) {
                const float s = static_cast<float>(w - first) / static_cast<float>(last - first);
                depth.disparity_px.at(u, w) = (1.0F - s) * d.at(u, first) + s * d.at(u, last);
            }
        }
    }
}

int cells_between_the_levels(const ElevationMap& map, const StepScene& drop) {
    int between = 0;
    for (std::size_t i = 0; i < map.layers().height_m.size(); ++i) {
        const float h_m = map.layers().height_m.data()[i];
        between += h_m < -0.03F && static_cast<double>(h_m) > drop.height_m + 0.03 ? 1 : 0;
    }
    return between;
}

TEST(DepthFusion, RampsThatMatchersInventBehindDropsAreNotFused) {
    const StepScene drop{1.3, -0.18};
    DepthImage depth = render(drop, zed(), body_at(0));
    smear_columns(depth, 4);
    ElevationConfig config;
    config.pixels.surface_check = false;
    ElevationMap fooled(config);
    fooled.add(zed(), body_at(0), depth, 0);
    ElevationMap map({});
    const FusionCounts counts = map.add(zed(), body_at(0), depth, 0);
    EXPECT_GT(counts.gated_confidence, 1000);
    EXPECT_GT(cells_between_the_levels(fooled, drop), 200) << "the scene must be a trap";
    EXPECT_EQ(cells_between_the_levels(map, drop), 0);
    EXPECT_GT(map.known_cells(), 0.85 * static_cast<double>(fooled.known_cells()));
}

TEST(DepthFusion, PixelsWithoutATrueDisparitySigmaOrTrustAreNotFused) {
    const camera::RectifiedRig rig = zed();
    const DepthImage good = render({}, rig, body_at(0));
    const auto cells_after = [&](auto spoil) {
        DepthImage depth = good;
        spoil(depth);
        ElevationMap map({});
        map.add(rig, body_at(0), depth, 0);
        return map.known_cells();
    };
    EXPECT_EQ(cells_after([](auto& depth) { depth.disparity_px.fill(kNanF); }), 0);
    EXPECT_EQ(cells_after([](auto& depth) { depth.disparity_px.fill(0.0F); }), 0);
    EXPECT_EQ(cells_after([](auto& depth) { depth.disparity_px.fill(-5.0F); }), 0);
    EXPECT_EQ(cells_after([](auto& depth) {
                  depth.disparity_px.fill(std::numeric_limits<float>::infinity());
              }),
              0);
    EXPECT_EQ(cells_after([](auto& depth) { depth.sigma_px.fill(kNanF); }), 0);
    EXPECT_EQ(cells_after([](auto& depth) { depth.sigma_px.fill(0.0F); }), 0);
    EXPECT_EQ(cells_after([](auto& depth) { depth.outlier_probability.fill(0.9F); }), 0);
    EXPECT_EQ(cells_after([](auto& depth) { depth.outlier_probability.fill(kNanF); }), 0);
    EXPECT_EQ(cells_after([](auto& depth) { depth.resize(0, 0); }), 0);
    EXPECT_GT(cells_after([](auto&) {}), 7000);
}

TEST(DepthFusion, EverySensorModelGivesFiniteHeightsAndPositiveVariances) {
    const camera::RectifiedRig rig = zed(168, 94);
    const DepthImage depth = render({}, rig, body_at(0));
    for (int model = 0; model <= static_cast<int>(SensorModel::basic); ++model) {
        ElevationConfig config;
        config.sensor.model = static_cast<SensorModel>(model);
        config.reduction.min_points = 2;  // the small image has few pixels a cell
        ElevationMap map(config);
        map.add(rig, body_at(0), depth, 0);
        EXPECT_GT(map.known_cells(), 1000) << "model " << model;
        for (std::size_t i = 0; i < map.layers().height_m.size(); ++i) {
            if (std::isnan(map.layers().height_m.data()[i])) continue;
            EXPECT_NEAR(map.layers().height_m.data()[i], 0.0F, 1e-4F) << "model " << model;
            EXPECT_GT(map.layers().height_var_m2.data()[i], 0.0F) << "model " << model;
        }
    }
}

TEST(DepthFusion, HeightVarianceOfACellIsThatOfItsPixels) {
    ElevationConfig config;
    config.camera_tilt_sigma_rad = 0.002;
    ElevationMap map(config);
    const camera::RectifiedRig rig = zed();
    map.add(rig, body_at(0), render({}, rig, body_at(0)), 0);
    for (const Eigen::Vector2d& place_m :
         {Eigen::Vector2d(0.8125, 0.0125), Eigen::Vector2d(2.0125, 0.8125)}) {
        const auto cell = map.geometry().cell_at(place_m.x(), place_m.y());
        ASSERT_TRUE(cell);
        const Pose T_odom_camera = body_at(0) * rig.T_body_camera;
        const Eigen::Vector3d p_m =
            T_odom_camera.inverse() * Eigen::Vector3d(place_m.x(), place_m.y(), 0.0);
        const SensorReading reading{p_m.z(),
                                    p_m.norm(),
                                    kSigma_px,
                                    0.0,
                                    0.0,
                                    rig.cy_px,
                                    rig.fx_px,
                                    rig.depth_to_disparity_px_m()};
        const Eigen::Vector3d up = T_odom_camera.R().row(2).transpose();
        Matrix6 tilt = Matrix6::Zero();
        tilt.bottomRightCorner<3, 3>() = 4e-6 * (Eigen::Matrix3d::Identity() - up * up.transpose());
        const double expected_m2 =
            height_variance_m2(ray_variance(config.sensor, reading), p_m, up, tilt) +
            std::pow(config.reduction.systematic_sigma_m, 2);
        // Pixels lie up to half a cell off its centre: at 0.8 m that changes z^4 by up to 6 %.
        EXPECT_NEAR(
            static_cast<double>(map.layers().height_var_m2.at(cell->ix, cell->iy)) / expected_m2,
            1.0,
            0.06)
            << place_m.transpose();
    }
}

TEST(DepthFusion, SameInputGivesTheSameBytes) {
    Rng rng(61);
    DepthImage depth = render({1.2, 0.1}, zed(), body_at(0));
    add_noise(depth, rng, 1);
    ElevationMap first({});
    ElevationMap second({});
    first.add(zed(), body_at(0), depth, 0);
    second.add(zed(), body_at(0), depth, 0);
    for (std::size_t i = 0; i < first.layers().height_m.size(); ++i) {
        const float a = first.layers().height_m.data()[i];
        const float b = second.layers().height_m.data()[i];
        ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << "cell " << i;
    }
}

TEST(DepthFusion, NothingIsAllocatedOnceWarm) {
    ElevationConfig config;
    config.prefilter.down_sampling = true;
    config.prefilter.outlier_removal = true;
    ElevationMap map(config);
    const camera::RectifiedRig rig = zed(168, 94);
    const std::vector<DepthImage> depths{render({}, rig, body_at(0)),
                                         render({1.2, 0.1}, rig, body_at(0))};
    const std::vector<MeasuredPoint> cloud(500, {{1.0F, 0.0F, -1.0F}, 1e-4F, 1e-4F});
    Matrix6 covariance = Matrix6::Identity() * 1e-8;
    const auto frame = [&](int k) {
        const Pose T_odom_body = body_at(0.011 * k);
        map.follow(T_odom_body, covariance);
        map.add(rig, T_odom_body, depths[static_cast<std::size_t>(k % 2)], k);
        map.add_points(cloud, {}, T_odom_body, k);
    };
    for (int k = 0; k < 3; ++k) frame(k);
    const std::int64_t before = heap::allocations;
    for (int k = 3; k < 30; ++k) frame(k);
    EXPECT_EQ(heap::allocations - before, 0);
}

TEST(DepthFusion, NothingIsAllocatedWhenHeightsAreAlignedEither) {
    const camera::RectifiedRig rig = zed(336, 188);
    ElevationConfig config;
    config.height_drift.enabled = true;
    config.height_drift.min_motions = 1;
    config.height_drift.min_drift_m = 0.0;
    config.height_drift.motion_sigmas = 1e9;
    ElevationMap map(config);
    const std::vector<DepthImage> depths{render({}, rig, body_at(0)),
                                         render({1.2, 0.1}, rig, body_at(0))};
    int moved = 0;
    const auto frame = [&](int k) {
        Pose T_odom_body = body_at(0.011 * k);
        T_odom_body.translation_m.z() += k % 6 == 0 ? 0.05 : 0.0;
        // During the first frames, no motion makes a cell old.
        map.follow(T_odom_body, Matrix6::Identity() * (k < 2 ? 0.0 : 1e-8));
        map.add(rig, T_odom_body, depths[static_cast<std::size_t>(k % 2)], k);
        moved += map.height_drift().reason == HeightDriftReason::moved ? 1 : 0;
    };
    for (int k = 0; k < 2; ++k) frame(k);
    ASSERT_EQ(map.height_drift().reason, HeightDriftReason::no_old_ground);
    const std::int64_t before = heap::allocations;
    for (int k = 2; k < 30; ++k) frame(k);
    EXPECT_EQ(heap::allocations - before, 0);
    EXPECT_GT(moved, 0);
}

/// Twice the resolution of zed() in the middle third of the image.
camera::RectifiedRig fine_part_of_zed() {
    camera::RectifiedRig rig = zed(1344, 752);
    rig.cx_px -= 448.0;
    rig.cy_px -= 250.0;
    rig.width = 448;
    rig.height = 250;
    return rig;
}

struct TwoHeights {
    int fine = 0;
    int coarse = 0;
};

/// Counts cells at the heights of two scenes of flat ground: the fine one at 0.
TwoHeights cells_at(const ElevationMap& map, double coarse_m) {
    TwoHeights cells;
    for (int iy = 0; iy < map.geometry().ny; ++iy) {
        for (int ix = 0; ix < map.geometry().nx; ++ix) {
            const float height_m = map.layers().height_m.at(ix, iy);
            if (std::isnan(height_m)) continue;
            const auto z_m = static_cast<double>(height_m);
            EXPECT_TRUE(std::abs(z_m) < 1e-4 || std::abs(z_m - coarse_m) < 1e-4) << z_m;
            (std::abs(z_m) < 1e-4 ? cells.fine : cells.coarse) += 1;
        }
    }
    return cells;
}

TEST(DepthFusion, ACellTakesOneMeasurementOfTheFinestView) {
    const StepScene floor;
    constexpr double kOther_m = 0.02;
    const StepScene higher{-100.0, kOther_m};  // tells both views apart
    const camera::RectifiedRig fine_rig = fine_part_of_zed();
    const DepthImage fine = render(floor, fine_rig, body_at(0));
    const DepthImage coarse = render(higher, zed(), body_at(0));
    ElevationMap map({});
    const camera::RectifiedRig coarse_rig = zed();
    const DepthView views[] = {{fine_rig, fine}, {coarse_rig, coarse}};
    const FusionCounts counts = map.add(views, body_at(0), 0);
    EXPECT_EQ(counts.cells_measured, map.known_cells());
    EXPECT_EQ(counts.cells_new, map.known_cells());
    const TwoHeights cells = cells_at(map, kOther_m);
    EXPECT_GT(cells.fine, 800);
    EXPECT_GT(cells.coarse, 4000);
    ElevationMap alone({});
    alone.add(coarse_rig, body_at(0), coarse, 0);
    EXPECT_LE(std::abs(map.known_cells() - alone.known_cells()), 60)
        << "the border of the part is known";
}

/// The fine part shows floor where the coarse view shows an obstacle: the obstacle stays.
TEST(DepthFusion, AnObstacleOfTheCoarserViewIsKept) {
    const camera::RectifiedRig fine_rig = fine_part_of_zed();
    const camera::RectifiedRig coarse_rig = zed();
    const DepthImage fine = render({}, fine_rig, body_at(0));
    for (const double height_m : {0.1, 0.5, 1.8}) {  // the last one ends above the camera
        const DepthImage coarse = render({1.5, height_m}, coarse_rig, body_at(0));
        ElevationMap alone({});
        alone.add(coarse_rig, body_at(0), coarse, 0);
        ElevationMap map({});
        const DepthView views[] = {{fine_rig, fine}, {coarse_rig, coarse}};
        map.add(views, body_at(0), 0);
        int obstacle = 0;
        for (std::size_t i = 0; i < alone.layers().height_m.size(); ++i) {
            const float z_m = alone.layers().height_m.data()[i];
            if (!(z_m > 0.08F)) continue;
            ++obstacle;
            EXPECT_EQ(map.layers().height_m.data()[i], z_m) << height_m << " " << i;
        }
        EXPECT_GT(obstacle, 30) << height_m;
    }
}

TEST(DepthFusion, WhereFineMatchesFailTheCoarserViewCounts) {
    const StepScene floor;
    constexpr double kOther_m = 0.02;
    const StepScene higher{-100.0, kOther_m};
    const camera::RectifiedRig fine_rig = fine_part_of_zed();
    DepthImage fine = render(floor, fine_rig, body_at(0));
    // Four of five fine matches fail.
    for (std::size_t i = 0; i < fine.disparity_px.size(); ++i)
        if (i % 5 != 0) fine.disparity_px.data()[i] = kNanF;
    const camera::RectifiedRig coarse_rig = zed();
    const DepthImage coarse = render(higher, coarse_rig, body_at(0));
    ElevationConfig config;
    config.pixels.surface_check = false;  // it needs the neighbours of a pixel
    ElevationMap map(config);
    const DepthView views[] = {{fine_rig, fine}, {coarse_rig, coarse}};
    map.add(views, body_at(0), 0);
    ElevationMap alone(config);
    alone.add(coarse_rig, body_at(0), coarse, 0);
    const ElevationLayers::Layer& expected_m = alone.layers().height_m;
    EXPECT_GT(alone.known_cells(), 5000);
    int others = 0;
    for (std::size_t i = 0; i < expected_m.size(); ++i) {
        if (std::isnan(expected_m.data()[i])) continue;
        others += map.layers().height_m.data()[i] == expected_m.data()[i] ? 0 : 1;
    }
    // At the border of the image the coarse view has few points in a cell, too.
    EXPECT_LE(others, 3);
}

/// A fifth of the fine matches fails: enough are left.
TEST(DepthFusion, AFewFailedFineMatchesDoNotMatter) {
    const StepScene floor;
    constexpr double kOther_m = 0.02;
    const camera::RectifiedRig fine_rig = fine_part_of_zed();
    DepthImage fine = render(floor, fine_rig, body_at(0));
    for (std::size_t i = 0; i < fine.disparity_px.size(); ++i)
        if (i % 5 == 0) fine.disparity_px.data()[i] = kNanF;
    const camera::RectifiedRig coarse_rig = zed();
    const DepthImage coarse = render({-100.0, kOther_m}, coarse_rig, body_at(0));
    ElevationConfig config;
    config.pixels.surface_check = false;  // it needs the neighbours of a pixel
    ElevationMap map(config);
    const DepthView views[] = {{fine_rig, fine}, {coarse_rig, coarse}};
    map.add(views, body_at(0), 0);
    EXPECT_GT(cells_at(map, kOther_m).fine, 800);
}

/// The wall gives a cell about 1400 points in the fine view, and would give it a quarter of them in
/// the coarse view. `min_face_points` counts points of the coarse view.
TEST(DepthFusion, AFaceNeedsMorePixelsInAFinerView) {
    const camera::RectifiedRig fine_rig = fine_part_of_zed();
    const camera::RectifiedRig coarse_rig = zed();
    const StepScene wall{1.5, 1.8};  // ends above the camera
    const DepthImage fine = render(wall, fine_rig, body_at(0));
    DepthImage nothing = render(wall, coarse_rig, body_at(0));
    nothing.disparity_px.fill(kNanF);
    ElevationConfig config;
    // No height has so many points of the wall.
    config.reduction.upper_share = 0.5;
    config.reduction.window_sigma = 0.5;
    const auto faces = [&](int least) {
        config.reduction.min_face_points = least;
        ElevationMap map(config);
        const DepthView views[] = {{fine_rig, fine}, {coarse_rig, nothing}};
        map.add(views, body_at(0), 0);
        const ElevationLayers::Layer& height_m = map.layers().height_m;
        return std::count_if(height_m.data(), height_m.data() + height_m.size(), [](float z_m) {
            return z_m > 0.1F;
        });
    };
    EXPECT_GT(faces(250), 10);
    EXPECT_EQ(faces(600), 0);
}

TEST(DepthFusion, TwoViewsAllocateNothingAndDoNotDependOnTheExecutor) {
    const camera::RectifiedRig fine_rig = fine_part_of_zed();
    const camera::RectifiedRig coarse_rig = zed();
    const DepthImage fine = render({1.2, 0.1}, fine_rig, body_at(0));
    const DepthImage coarse = render({1.2, 0.1}, coarse_rig, body_at(0));
    for (const bool aligns : {false, true}) {
        ElevationConfig config;
        config.height_drift.enabled = aligns;
        ElevationMap map(config);
        const auto frame = [&](int k) {
            map.follow(body_at(0.011 * k), Matrix6::Identity() * 1e-8);
            const DepthView views[] = {{fine_rig, fine}, {coarse_rig, coarse}};
            // Every second frame has a fine part.
            map.add(std::span(views).subspan(k % 2 == 0 ? 0 : 1), body_at(0.011 * k), k);
        };
        for (int k = 0; k < 4; ++k) frame(k);
        const std::int64_t before = heap::allocations;
        for (int k = 4; k < 12; ++k) frame(k);
        EXPECT_EQ(heap::allocations - before, 0);

        ElevationMap serial_map(config);
        ElevationMap other_map(config);
        Backwards reversed;
        const DepthView views[] = {{fine_rig, fine}, {coarse_rig, coarse}};
        serial_map.add(views, body_at(0), 0);
        other_map.add(views, body_at(0), 0, reversed);
        for (std::size_t i = 0; i < serial_map.layers().height_m.size(); ++i) {
            const float a_m = serial_map.layers().height_m.data()[i];
            const float b_m = other_map.layers().height_m.data()[i];
            ASSERT_TRUE(a_m == b_m || (std::isnan(a_m) && std::isnan(b_m))) << i;
        }
    }
}

TEST(DepthFusion, AFinerViewIsNewInformationAlsoAtRest) {
    const StepScene floor;
    const camera::RectifiedRig fine_rig = fine_part_of_zed();
    const camera::RectifiedRig coarse_rig = zed();
    const DepthImage fine = render(floor, fine_rig, body_at(0));
    const DepthImage coarse = render(floor, coarse_rig, body_at(0));
    ElevationMap map({});
    const grid::GridGeometry& geometry = map.geometry();
    const grid::Cell ahead{geometry.nx / 2 + 64, geometry.ny / 2};  // 1.6 m before the camera
    const auto var_m2 = [&] { return map.layers().height_var_m2.at(ahead.ix, ahead.iy); };
    map.add(coarse_rig, body_at(0), coarse, 0);
    const float first_m2 = var_m2();
    map.add(coarse_rig, body_at(0), coarse, 1);
    EXPECT_EQ(var_m2(), first_m2) << "the same errors again";
    const DepthView views[] = {{fine_rig, fine}, {coarse_rig, coarse}};
    map.add(views, body_at(0), 2);
    const float fine_m2 = var_m2();
    EXPECT_LT(fine_m2, 0.5F * first_m2);
    for (int i = 3; i < 6; ++i) map.add(views, body_at(0), i);
    map.add(coarse_rig, body_at(0), coarse, 7);
    EXPECT_EQ(var_m2(), fine_m2);
}

}  // namespace
}  // namespace surefoot::elevation

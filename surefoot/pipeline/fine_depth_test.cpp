// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/fine_depth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "surefoot/camera/rig_scaling.hpp"
#include "surefoot/camera/rigs_testing.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/pipeline/pipeline.hpp"

namespace surefoot::pipeline {
namespace {

constexpr std::int64_t kPeriod_ns = 100'000'000;

TEST(FineScale, BringsEveryCameraNearTheTunedSize) {
    const FineConfig automatic;
    EXPECT_EQ(fine_scale(automatic, 672, 376), 1);    // ZED, VGA
    EXPECT_EQ(fine_scale(automatic, 848, 480), 1);    // RealSense D435
    EXPECT_EQ(fine_scale(automatic, 1241, 376), 1);   // KITTI: wide, but few rows
    EXPECT_EQ(fine_scale(automatic, 1280, 720), 2);   // ZED, HD720
    EXPECT_EQ(fine_scale(automatic, 1920, 1080), 3);  // ZED, HD1080
    EXPECT_EQ(fine_scale(automatic, 2208, 1242), 3);  // ZED, HD2K
    EXPECT_EQ(fine_scale(automatic, 10, 10), 1);
    FineConfig fixed;
    fixed.scale = 4;
    EXPECT_EQ(fine_scale(fixed, 1280, 720), 4);
    EXPECT_EQ(fine_scale(fixed, 3, 720), 3) << "an image of no column cannot be matched";
}

/// A camera on a machine, `pitch_deg` below the horizon.
camera::RectifiedRig rig_looking_down(double pitch_deg, double fx_px = 700.0) {
    camera::RectifiedRig rig;
    rig.width = 1280;
    rig.height = 720;
    rig.fx_px = rig.fy_px = fx_px;
    rig.cx_px = 640.0;
    rig.cy_px = 360.0;
    rig.baseline_m = 0.12;
    rig.T_body_camera =
        Pose{exp_so3({0.0, pitch_deg * 3.14159265358979 / 180.0, 0.0}), {0.1, 0.0, 0.05}} *
        T_body_optical();
    return rig;
}

bool contains(const camera::PixelBox& box, double u, double v) {
    return u >= box.u && v >= box.v && u <= box.u + box.width - 1 && v <= box.v + box.height - 1;
}

/// Every point of the region that the camera shows lies in the box, whatever the pose.
TEST(FineRegion, ShowsEveryPointOfTheRegion) {
    const FineConfig config;
    Rng rng(4);
    int inside = 0;
    for (int n = 0; n < 300; ++n) {
        const camera::RectifiedRig rig = rig_looking_down(rng.uniform(10.0, 80.0));
        const Pose T_odom_body{exp_so3({0.0, 0.0, rng.uniform(-3.0, 3.0)}) *
                                   exp_so3({rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), 0.0}),
                               {rng.uniform(-5.0, 5.0), rng.uniform(-5.0, 5.0), 7.0}};
        const double height_m = rng.uniform(0.8, 1.5);
        const camera::PixelBox box = fine_region(config, rig, T_odom_body, height_m, 32);
        EXPECT_GE(box.u, 0);
        EXPECT_GE(box.v, 0);
        EXPECT_LE(box.u + box.width, rig.width);
        EXPECT_LE(box.v + box.height, rig.height);
        const Pose T_camera_odom = (T_odom_body * rig.T_body_camera).inverse();
        const Eigen::Vector3d x_axis = T_odom_body.R().col(0);
        const double yaw_rad = std::atan2(x_axis.y(), x_axis.x());
        for (int k = 0; k < 100; ++k) {
            const double x_m = rng.uniform(config.from_m, config.to_m);
            const double y_m = rng.uniform(-config.half_width_m, config.half_width_m);
            const Eigen::Vector3d p =
                T_camera_odom *
                (T_odom_body.translation_m +
                 Eigen::Vector3d(x_m * std::cos(yaw_rad) - y_m * std::sin(yaw_rad),
                                 x_m * std::sin(yaw_rad) + y_m * std::cos(yaw_rad),
                                 rng.uniform(-config.depth_m, config.height_m) - height_m));
            if (p.z() < 0.1) continue;
            const double u = rig.fx_px * p.x() / p.z() + rig.cx_px;
            const double v = rig.fy_px * p.y() / p.z() + rig.cy_px;
            if (u < 0.0 || v < 0.0 || u > rig.width - 1 || v > rig.height - 1) continue;
            ++inside;
            EXPECT_TRUE(contains(box, u, v)) << n << ": " << u << ", " << v;
        }
    }
    EXPECT_GT(inside, 10'000);
}

TEST(FineRegion, LeavesOutTheRestOfTheImage) {
    const camera::RectifiedRig rig = rig_looking_down(32.0);
    const Pose T_odom_body{Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.0}};
    const camera::PixelBox box = fine_region({}, rig, T_odom_body, 1.0, 0);
    EXPECT_GT(box.v, 100) << "the upper rows show ground beyond 2.5 m";
    EXPECT_EQ(box.v + box.height, rig.height);
    FineConfig narrow;
    narrow.half_width_m = 0.1;
    narrow.from_m = 1.5;
    const camera::PixelBox small = fine_region(narrow, rig, T_odom_body, 1.0, 0);
    EXPECT_LT(small.width, 300);
    const camera::PixelBox wider = fine_region(narrow, rig, T_odom_body, 1.0, 100);
    EXPECT_EQ(wider.u, small.u - 100) << "room for the matches in the right image";
    EXPECT_EQ(wider.width, small.width + 100);
}

TEST(FineRegion, IsEmptyIfTheCameraDoesNotShowIt) {
    const Pose T_odom_body{Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.0}};
    EXPECT_EQ(fine_region({}, rig_looking_down(-60.0), T_odom_body, 1.0, 0), camera::PixelBox{});
    Pose broken = T_odom_body;
    broken.translation_m.z() = static_cast<double>(kNanF);
    EXPECT_EQ(fine_region({}, rig_looking_down(30.0), broken, 1.0, 0), camera::PixelBox{});
    FineConfig behind;
    behind.from_m = -3.0;
    behind.to_m = -2.0;
    EXPECT_EQ(fine_region(behind, rig_looking_down(30.0), T_odom_body, 1.0, 0), camera::PixelBox{});
}

Pose at(double x_m) {
    return {Eigen::Quaterniond::Identity(), {x_m, 0.0, 1.0}};
}

TEST(FineSchedule, ObservesAWalkAtTheGivenRate) {
    FineConfig config;
    config.every_s = 0.5;
    FineSchedule schedule(config, {});
    std::vector<int> fine;
    for (int i = 0; i < 20; ++i) {
        if (!schedule.is_due(1'000'000'000 + i * kPeriod_ns, at(0.05 * i))) continue;
        schedule.observed();
        fine.push_back(i);
    }
    EXPECT_EQ(fine, (std::vector<int>{0, 5, 10, 15}));
}

TEST(FineSchedule, ObservesAMachineThatStopsAtOnce) {
    FineConfig config;
    config.every_s = 10.0;
    config.still_s = 0.2;
    FineSchedule schedule(config, {});
    std::vector<int> fine;
    for (int i = 0; i < 30; ++i) {
        const double x_m = 0.05 * std::min(i, 12);  // stops at frame 12
        if (!schedule.is_due(i * kPeriod_ns, at(x_m))) continue;
        schedule.observed();
        fine.push_back(i);
    }
    EXPECT_EQ(fine, (std::vector<int>{0, 14})) << "once, not with every frame at rest";
}

TEST(FineSchedule, ANotObservedFrameStaysDue) {
    FineSchedule schedule({}, {});
    EXPECT_TRUE(schedule.is_due(0, at(0.0)));
    EXPECT_TRUE(schedule.is_due(1, at(0.0)));
}

/// A camera 1 m above level ground that points straight down. Its images have `disparity_px` at
/// every pixel.
class FlatGround {
  public:
    FlatGround(int width, int height, int disparity_px) {
        const double baseline_m =
            camera::test::ideal_rig(64, 64, 10.0).T_left_right.translation_m.x();
        rig_ = camera::test::ideal_rig(width, height, disparity_px / baseline_m);
        rig_.T_body_left = Pose{Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), {0.0, 0.0, 1.0}};
        Rng rng(11);
        GreyImage noise(width + disparity_px + 2, height + 2);
        for (std::size_t i = 0; i < noise.size(); ++i)
            noise.data()[i] = static_cast<std::uint8_t>(rng.uniform(40.0, 215.0));
        // Means of 3 x 3 pixels: texture that survives a smaller size.
        const auto grey = [&](int u, int v) {
            int sum = 0;
            for (int y = 0; y < 3; ++y)
                for (int x = 0; x < 3; ++x) sum += noise.at(u + x, v + y);
            return static_cast<std::uint8_t>(sum / 9);
        };
        left_ = GreyImage(width, height);
        right_ = GreyImage(width, height);
        for (int v = 0; v < height; ++v) {
            for (int u = 0; u < width; ++u) {
                left_.at(u, v) = grey(u, v);
                right_.at(u, v) = grey(u + disparity_px, v);
            }
        }
    }
    [[nodiscard]] const camera::StereoRig& rig() const { return rig_; }
    [[nodiscard]] StereoFrame frame(int index) const {
        StereoFrame frame;
        frame.index = index;
        frame.time_ns = 1'000'000'000 + index * kPeriod_ns;
        frame.left = left_;
        frame.right = right_;
        // Another brightness: a frame of equal images would count as repeated.
        for (GreyImage* const image : {&frame.left, &frame.right})
            for (std::size_t i = 0; i < image->size(); ++i)
                image->data()[i] = static_cast<std::uint8_t>(image->data()[i] + index);
        MotionEstimate motion;
        motion.time_ns = frame.time_ns;
        motion.health = Health::ok;
        motion.reason = HealthReason::none;
        frame.known_motion = motion;
        return frame;
    }

  private:
    camera::StereoRig rig_;
    GreyImage left_;
    GreyImage right_;
};

PipelineConfig flat_config() {
    PipelineConfig config;
    config.fine.scale = 2;
    config.fine.every_s = 0.25;
    config.fine.from_m = -0.15;
    config.fine.to_m = 0.15;
    config.fine.half_width_m = 0.15;
    config.fine.depth_m = config.fine.height_m = 0.0;
    config.elevation.prefilter.range = false;
    return config;
}

struct Cells {
    int known = 0;
    double worst_m = 0.0;
    double least_var_m2 = 1.0;
};

Cells cells_of(const Pipeline& pipeline) {
    Cells cells;
    const elevation::ElevationLayers& layers = pipeline.map().layers();
    for (std::size_t i = 0; i < layers.height_m.size(); ++i) {
        const auto height_m = static_cast<double>(layers.height_m.data()[i]);
        if (std::isnan(height_m)) continue;
        ++cells.known;
        cells.worst_m = std::max(cells.worst_m, std::abs(height_m));
        cells.least_var_m2 =
            std::min(cells.least_var_m2, static_cast<double>(layers.height_var_m2.data()[i]));
    }
    return cells;
}

/// Also with a size that is not a multiple of the scale.
TEST(FineDepth, TheMapTakesTheFinerDepth) {
    for (const auto& [width, height] : {std::pair(1280, 720), std::pair(1283, 725)}) {
        const FlatGround ground(width, height, 80);
        Serial serial;
        auto pipeline = Pipeline::make(flat_config(), ground.rig(), serial);
        ASSERT_TRUE(pipeline.ok()) << pipeline.error().message;
        const StereoFrame first = ground.frame(0);
        pipeline->align({&first, 1}, Pose{});
        EXPECT_EQ(pipeline->rig().width, width / 2);
        EXPECT_NEAR(pipeline->rig().depth_to_disparity_px_m(), 40.0, 1e-9);
        const FrameReport fine = pipeline->process(first, Work::full);
        EXPECT_EQ(pipeline->depth().disparity_px.width(), width / 2);
        EXPECT_GT(fine.fine_pixels, 20'000);
        EXPECT_EQ(fine.fusion.cells_measured, fine.known_cells) << "one measurement per cell";
        const Cells both = cells_of(*pipeline);
        EXPECT_LT(both.worst_m, 0.01);

        PipelineConfig coarse_config = flat_config();
        coarse_config.fine.to_m = 50.0;
        coarse_config.fine.from_m = 49.0;  // outside of the image
        auto coarse = Pipeline::make(coarse_config, ground.rig(), serial);
        ASSERT_TRUE(coarse.ok());
        coarse->align({&first, 1}, Pose{});
        EXPECT_EQ(coarse->process(first, Work::full).fine_pixels, 0);
        const Cells alone = cells_of(*coarse);
        EXPECT_GT(alone.known, 500);
        EXPECT_GE(both.known, alone.known);
        EXPECT_LT(both.least_var_m2, 0.6 * alone.least_var_m2);

        EXPECT_EQ(pipeline->process(ground.frame(1), Work::full).fine_pixels, 0) << "not due";
        EXPECT_GT(pipeline->process(ground.frame(3), Work::full).fine_pixels, 0);
    }
}

TEST(FineDepth, AtTheScaleOneEveryFrameIsWhole) {
    const FlatGround ground(672, 376, 40);
    PipelineConfig config = flat_config();
    config.fine.scale = 0;
    Serial serial;
    auto pipeline = Pipeline::make(config, ground.rig(), serial);
    ASSERT_TRUE(pipeline.ok());
    const StereoFrame first = ground.frame(0);
    pipeline->align({&first, 1}, Pose{});
    const FrameReport report = pipeline->process(first, Work::full);
    EXPECT_EQ(report.fine_pixels, 0);
    EXPECT_EQ(report.image_pixels, 672 * 376);
}

/// Depth of all pixels of FlatGround(1280, 720, 80).
DepthImage whole_depth() {
    DepthImage depth;
    depth.disparity_px = Image<float>(1280, 720, 80.0F);
    depth.sigma_px = Image<float>(1280, 720, 0.2F);
    depth.outlier_probability = Image<float>(1280, 720, 0.0F);
    return depth;
}

/// The depth of a frame that carries it belongs to the full image.
TEST(FineDepth, KnownDepthKeepsItsSize) {
    const FlatGround ground(1280, 720, 80);
    Serial serial;
    auto pipeline = Pipeline::make(flat_config(), ground.rig(), serial);
    ASSERT_TRUE(pipeline.ok());
    StereoFrame first = ground.frame(0);
    first.left = first.right = {};
    first.known_depth = whole_depth();
    pipeline->align({&first, 1}, Pose{});
    EXPECT_EQ(pipeline->rig().width, 1280);
    const FrameReport report = pipeline->process(first, Work::full);
    EXPECT_GT(report.known_cells, 500);
    EXPECT_EQ(report.fine_pixels, 0);
}

/// The alignment measures depth at full size; it does not belong to the coarse camera.
TEST(FineDepth, NoDepthOfTheAlignmentStays) {
    const FlatGround ground(1280, 720, 80);
    Serial serial;
    auto pipeline = Pipeline::make(flat_config(), ground.rig(), serial);
    ASSERT_TRUE(pipeline.ok());
    const StereoFrame first = ground.frame(0);
    pipeline->align({&first, 1});
    EXPECT_EQ(pipeline->rig().width, 640);
    EXPECT_EQ(pipeline->depth().disparity_px.size(), 0);
    EXPECT_GT(pipeline->process(first, Work::full).depth_pixels, 0);
}

/// Sizes and depth after an alignment depend on its frames alone, not on an earlier alignment.
TEST(FineDepth, ASecondAlignmentUndoesTheFirst) {
    const FlatGround ground(1280, 720, 80);
    Serial serial;
    const StereoFrame first = ground.frame(0);
    const auto fresh = [&] { return Pipeline::make(flat_config(), ground.rig(), serial); };
    auto once = fresh();
    ASSERT_TRUE(once.ok());
    once->align({&first, 1}, Pose{});
    const FrameReport expected = once->process(first, Work::full);

    auto twice = fresh();
    twice->align({&first, 1}, Pose{});
    twice->align({&first, 1}, Pose{});
    auto after_depth = fresh();
    StereoFrame with_depth = first;
    with_depth.known_depth = whole_depth();
    after_depth->align({&with_depth, 1}, Pose{});
    ASSERT_EQ(after_depth->rig().width, 1280);
    after_depth->align({&first, 1}, Pose{});

    for (Pipeline* const pipeline : {&*twice, &*after_depth}) {
        EXPECT_EQ(pipeline->rig().width, 640);
        const FrameReport report = pipeline->process(first, Work::full);
        EXPECT_EQ(report.fine_pixels, expected.fine_pixels);
        EXPECT_EQ(report.depth_pixels, expected.depth_pixels);
        EXPECT_EQ(report.known_cells, expected.known_cells);
    }
}

TEST(FineConfig, ARegionThatEndsBeforeItsStartIsAnError) {
    PipelineConfig config;
    config.fine.from_m = 3.0;
    const auto problem = config.problem();
    ASSERT_TRUE(problem);
    EXPECT_EQ(*problem, "fine.from_m = 3 must be less than fine.to_m = 2.5");
}

}  // namespace
}  // namespace surefoot::pipeline

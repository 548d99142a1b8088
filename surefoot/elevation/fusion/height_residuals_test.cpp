// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/height_residuals.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "surefoot/core/unknown.hpp"

namespace surefoot::elevation {
namespace {

constexpr int kSide = 12;
constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr std::size_t kMiddle = 4 * kSide + 4;  ///< a cell that gives a residual

/// A level map, 5 motions old; the frame measures every cell 10 mm higher.
struct Ground {
    grid::GridGeometry geometry;
    ElevationLayers layers;
    std::vector<float> aligned_var_m2;
    std::vector<std::uint32_t> step;
    std::vector<std::uint8_t> is_asked;
    std::vector<CellMeasurement> measured;
    HeightResiduals residuals;

    Ground()
        : aligned_var_m2(kSide * kSide, 1e-5F),
          step(kSide * kSide, 0),
          is_asked(kSide * kSide, 0),
          measured(kSide * kSide, {0.01F, 2e-5F, 0.01F, 0.01F, 5}) {
        geometry.nx = geometry.ny = kSide;
        geometry.resolution_m = 0.025;
        layers.height_m = ElevationLayers::Layer(kSide, kSide, 0.0F);
        layers.height_var_m2 = ElevationLayers::Layer(kSide, kSide, 1e-5F + 4e-4F);
        layers.horizontal_drift_m = ElevationLayers::Layer(kSide, kSide, 0.002F);
    }

    std::size_t gather(std::uint32_t motions = 5) {
        return residuals.gather({geometry,
                                 layers,
                                 {aligned_var_m2.data(), step.data(), is_asked.data()},
                                 measured.data(),
                                 {0.0, 0.0},
                                 {1.0, 0.0},
                                 motions,
                                 3,
                                 4,
                                 0.03,
                                 0.01});
    }
};

TEST(HeightResiduals, EverySecondCellOfLevelOldGroundIsAskedOnce) {
    Ground ground;
    EXPECT_EQ(ground.gather(), 16U);  // 4 x 4: two cells at the border have no neighbours
    ASSERT_EQ(ground.residuals.old().size(), 16U);
    EXPECT_TRUE(ground.residuals.recent().empty());
    const HeightResidual& first = ground.residuals.old().front();
    EXPECT_FLOAT_EQ(first.offset_m, 0.01F);
    EXPECT_FLOAT_EQ(first.var_m2, 3e-5F);
    EXPECT_FLOAT_EQ(first.motion_var_m2, 4e-4F);
    EXPECT_EQ(first.step, 0U);
    EXPECT_EQ(first.at_m, ground.geometry.center_m({2, 2}));
    EXPECT_EQ(ground.gather(), 0U) << "asked already";
    EXPECT_EQ(ground.residuals.old().size(), 16U) << "and kept";
}

TEST(HeightResiduals, AreKeptForTheirMotionsAndUntilTheyAreUsed) {
    Ground ground;
    ground.gather(5);
    ground.gather(9);
    EXPECT_EQ(ground.residuals.old().size(), 16U);
    ground.gather(10);
    EXPECT_TRUE(ground.residuals.old().empty());
    Ground used;
    used.gather(5);
    used.residuals.forget();
    EXPECT_TRUE(used.residuals.old().empty());
}

TEST(HeightResiduals, GroundAlignedLatelyIsRecentAndWhatDidNotMoveIsNeither) {
    Ground ground;
    EXPECT_EQ(ground.gather(2), 0U);
    EXPECT_EQ(ground.residuals.recent().size(), 16U);
    EXPECT_EQ(ground.gather(2), 0U);
    EXPECT_EQ(ground.residuals.recent().size(), 16U) << "of this frame alone";
    ground.layers.height_var_m2.fill(1e-5F + 0.99e-4F);
    EXPECT_EQ(ground.gather(5), 0U) << "moved by less than min_drift_m";
    EXPECT_TRUE(ground.residuals.recent().empty());
}

TEST(HeightResiduals, StepsUnknownNeighboursAndCellsOutsideOfNumbersAreLeftOut) {
    const auto lost = [](const auto& spoil) {
        Ground ground;
        spoil(ground);
        return 16 - static_cast<int>(ground.gather());
    };
    EXPECT_EQ(lost([](Ground& g) { g.measured[kMiddle].points = 0; }), 1);
    for (const float bad : {kNanF, kInf, -kInf}) {
        EXPECT_EQ(lost([&](Ground& g) { g.measured[kMiddle].z_m = bad; }), 1) << bad;
        EXPECT_EQ(lost([&](Ground& g) { g.measured[kMiddle].var_m2 = bad; }), 1) << bad;
        EXPECT_EQ(lost([&](Ground& g) { g.layers.height_var_m2.data()[kMiddle] = bad; }), 1) << bad;
        EXPECT_EQ(lost([&](Ground& g) { g.aligned_var_m2[kMiddle] = bad; }), 1) << bad;
        EXPECT_EQ(lost([&](Ground& g) { g.layers.horizontal_drift_m.data()[kMiddle] = bad; }), 1);
        // The cell itself, and the four cells that use it as a neighbour.
        EXPECT_EQ(lost([&](Ground& g) { g.layers.height_m.data()[kMiddle] = bad; }), 5) << bad;
    }
    EXPECT_EQ(lost([](Ground& g) { g.layers.height_m.data()[kMiddle] = 0.031F; }), 5);
    EXPECT_EQ(lost([](Ground& g) { g.layers.height_m.data()[kMiddle] = 0.029F; }), 0);
}

TEST(HeightResiduals, PlacesAreSeenFromTheCameraAlongTheBody) {
    Ground ground;
    const Eigen::Vector2d camera_m(-1.0, 0.5);
    ground.residuals.gather(
        {ground.geometry,
         ground.layers,
         {ground.aligned_var_m2.data(), ground.step.data(), ground.is_asked.data()},
         ground.measured.data(),
         camera_m,
         {0.0, 1.0},
         5,
         3,
         4,
         0.03,
         0.01});
    const HeightResidual& first = ground.residuals.old().front();
    const Eigen::Vector2d from_m = first.at_m - camera_m;
    EXPECT_NEAR(first.from_camera_m.x(), from_m.y(), 1e-6) << "ahead is +y";
    EXPECT_NEAR(first.from_camera_m.y(), -from_m.x(), 1e-6) << "left is -x";
}

TEST(HeightResiduals, AMapOfFewCellsHasNone) {
    for (const int side : {1, 4, 5}) {
        Ground ground;
        ground.geometry.nx = ground.geometry.ny = side;
        EXPECT_EQ(ground.gather(), side == 5 ? 1U : 0U) << side;
    }
}

}  // namespace
}  // namespace surefoot::elevation

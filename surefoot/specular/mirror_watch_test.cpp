// SPDX-License-Identifier: Apache-2.0
#include "surefoot/specular/mirror_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/allocations_testing.hpp"
#include "surefoot/core/angles.hpp"
#include "surefoot/specular/fake_floor_testing.hpp"

namespace surefoot::specular {
namespace {

using namespace testing;

constexpr double kAngle_rad = 3.0 * kRadPerDeg;
constexpr double kOffset_m = 1.6;

/// Drives toward x = 1 m over a floor.
class Drive {
  public:
    explicit Drive(const SpecularConfig& config = {}) : watch_(config) {}

    void go(const FakeFloor& floor, int frames) {
        const camera::RectifiedRig rig = fake_rig();
        for (int i = 0; i < frames; ++i, ++frame_) {
            const Pose body = fake_body(std::min(0.03 * frame_, 1.0), 0.0);
            const FakeView view = look_at(floor, rig, body, rng_);
            const std::int64_t before = heap::allocations;
            watch_.add(rig, body, view.left.view(), view.disparity_px.view(), 0.0);
            if (frame_ > 0) allocations_ += heap::allocations - before;
        }
    }
    [[nodiscard]] const MirrorWatch& watch() const { return watch_; }
    [[nodiscard]] std::int64_t allocations() const { return allocations_; }

  private:
    MirrorWatch watch_;
    Rng rng_{11};
    int frame_ = 0;
    std::int64_t allocations_ = 0;
};

TEST(MirrorWatch, finds_a_mirror_within_30_mm_and_2_deg) {
    Drive drive;
    drive.go(with_mirror(carpet(1), kAngle_rad, kOffset_m, 0.9), 45);
    ASSERT_EQ(drive.watch().panes().size(), 1U);
    const SuspectedPane& pane = drive.watch().panes().front();
    EXPECT_NEAR(std::atan2(pane.normal.y(), pane.normal.x()), kAngle_rad, 2.0 * kRadPerDeg);
    EXPECT_NEAR(pane.offset_m, kOffset_m, 0.03);
    EXPECT_GT(pane.correlation, 0.5);
    EXPECT_LT(pane.from_m, -0.4);
    EXPECT_GT(pane.to_m, 0.4);
    EXPECT_EQ(drive.allocations(), 0);
}

TEST(MirrorWatch, suspects_nothing_without_a_mirror) {
    for (const FakeFloor& floor : {carpet(1), tiles(2, 0.25, false), tiles(3, 0.25, true)}) {
        Drive drive;
        drive.go(floor, 45);
        EXPECT_TRUE(drive.watch().panes().empty());
    }
}

TEST(MirrorWatch, forgets_a_mirror_that_was_carried_away) {
    Drive drive;
    drive.go(with_mirror(carpet(1), kAngle_rad, kOffset_m, 0.9), 45);
    ASSERT_FALSE(drive.watch().panes().empty());
    drive.go(carpet(1), 250);
    EXPECT_TRUE(drive.watch().panes().empty());
}

TEST(MirrorWatch, forgets_everything_where_odom_is_placed_anew) {
    MirrorWatch watch{SpecularConfig{}};
    Drive drive;
    drive.go(with_mirror(carpet(1), kAngle_rad, kOffset_m, 0.9), 45);
    MirrorWatch copy = drive.watch();
    copy.forget();
    EXPECT_TRUE(copy.panes().empty());
}

TEST(MirrorWatch, switched_off_it_suspects_nothing) {
    SpecularConfig config;
    config.enabled = false;
    Drive drive(config);
    drive.go(with_mirror(carpet(1), kAngle_rad, kOffset_m, 0.9), 45);
    EXPECT_TRUE(drive.watch().panes().empty());
}

TEST(LevelFloor, is_told_in_odom_and_only_where_it_is_level) {
    GroundObservation ground;
    ground.accepted = true;
    ground.height_m = 0.95;
    const Pose body = fake_body(2.0, 3.0, 1.0);
    EXPECT_NEAR(level_floor_z_m(ground, body).value_or(9.0), 0.05, 1e-9);
    ground.normal =
        Eigen::AngleAxisd(2.0 * kRadPerDeg, Eigen::Vector3d::UnitY()) * Eigen::Vector3d::UnitZ();
    EXPECT_FALSE(level_floor_z_m(ground, body));
    ground.normal = Eigen::Vector3d::UnitZ();
    ground.accepted = false;
    EXPECT_FALSE(level_floor_z_m(ground, body));
}

TEST(HideBehind, hides_cells_at_and_behind_the_seen_part) {
    const SpecularConfig config;
    const grid::GridGeometry geometry{0.025, 120, 120, {0.0, -1.5}};
    Image<std::uint8_t> hidden(120, 120, 0);
    SuspectedPane pane;
    pane.offset_m = 1.5;
    pane.from_m = -0.4;
    pane.to_m = 0.6;
    hide_behind({&pane, 1}, config, geometry, hidden.view());
    const auto is_hidden = [&](double x_m, double y_m) {
        const auto cell = geometry.cell_at(x_m, y_m);
        return hidden.at(cell->ix, cell->iy) != 0;
    };
    EXPECT_TRUE(is_hidden(1.51, 0.0));
    EXPECT_TRUE(is_hidden(2.9, 0.0));
    EXPECT_TRUE(is_hidden(1.46, 0.0));  // the margin before the line
    EXPECT_FALSE(is_hidden(1.40, 0.0));
    EXPECT_TRUE(is_hidden(1.51, 0.70));  // the margin beside it
    EXPECT_FALSE(is_hidden(1.51, 0.85));
    EXPECT_FALSE(is_hidden(1.51, -0.65));
    EXPECT_TRUE(is_hidden(2.5, 1.1));  // the strip grows behind the line
}

TEST(SpecularConfig, names_scores_that_contradict) {
    SpecularConfig config;
    EXPECT_FALSE(config.problem());
    config.keep_score = config.mirror_score + 1.0;
    ASSERT_TRUE(config.problem());
    EXPECT_NE(config.problem()->find("specular.keep_score"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::specular

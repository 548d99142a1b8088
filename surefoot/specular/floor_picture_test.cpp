// SPDX-License-Identifier: Apache-2.0
#include "surefoot/specular/floor_picture.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/specular/fake_floor_testing.hpp"

namespace surefoot::specular {
namespace {

using namespace testing;

/// Mean difference of picture and floor, over the observed cells of a square.
double mean_error(const FloorPicture& picture, const FakeFloor& floor, double x_m, double y_m) {
    double sum = 0.0;
    int count = 0;
    for (double x = x_m - 0.15; x < x_m + 0.15; x += 0.01) {
        for (double y = y_m - 0.15; y < y_m + 0.15; y += 0.01) {
            const auto cell = picture.geometry().cell_at(x, y);
            if (!cell) continue;
            const float grey = picture.brightness().at(cell->ix, cell->iy);
            if (std::isnan(grey)) continue;
            const Eigen::Vector2d center_m = picture.geometry().center_m(*cell);
            sum += std::abs(static_cast<double>(grey) - floor(center_m.x(), center_m.y()));
            ++count;
        }
    }
    return count > 400 ? sum / count : std::nan("");
}

TEST(FloorPicture, is_the_floor_from_above) {
    const FakeFloor floor = carpet(3);
    const camera::RectifiedRig rig = fake_rig();
    FloorPicture picture{SpecularConfig{}};
    Rng rng(1);
    for (int i = 0; i < 16; ++i) {
        const Pose body = fake_body(0.02 * i, 0.0, 0.01 * i);
        const FakeView view = look_at(floor, rig, body, rng);
        picture.follow(body);
        picture.add(rig, body, view.left.view(), view.disparity_px.view(), 0.0);
    }
    // Blotches of 12 mm and pixels of 5 mm: some grey values of 15 rms are blurred away.
    EXPECT_LT(mean_error(picture, floor, 1.2, 0.1), 9.0);
    // The same picture compared with another floor.
    EXPECT_GT(mean_error(picture, carpet(4), 1.2, 0.1), 15.0);
}

TEST(FloorPicture, leaves_out_what_stands_on_the_floor) {
    const FakeFloor floor = carpet(3);
    const camera::RectifiedRig rig = fake_rig();
    const Pose body = fake_body(0.0, 0.0);
    Rng rng(1);
    FakeView view = look_at(floor, rig, body, rng);
    for (std::size_t i = 0; i < view.disparity_px.size(); ++i) view.disparity_px.data()[i] *= 1.2F;
    FloorPicture picture{SpecularConfig{}};
    for (int i = 0; i < 4; ++i)
        picture.add(rig, body, view.left.view(), view.disparity_px.view(), 0.0);
    EXPECT_TRUE(std::isnan(mean_error(picture, floor, 1.2, 0.0)));
}

TEST(FloorPicture, follows_the_body_and_keeps_what_was_seen) {
    const FakeFloor floor = carpet(3);
    const camera::RectifiedRig rig = fake_rig();
    FloorPicture picture{SpecularConfig{}};
    Rng rng(1);
    const Pose body = fake_body(0.0, 0.0);
    const FakeView view = look_at(floor, rig, body, rng);
    picture.follow(body);
    for (int i = 0; i < 4; ++i)
        picture.add(rig, body, view.left.view(), view.disparity_px.view(), 0.0);
    const double before = mean_error(picture, floor, 1.2, 0.0);
    picture.follow(fake_body(1.5, 0.0));
    EXPECT_NEAR(mean_error(picture, floor, 1.2, 0.0), before, 1e-6);
    picture.clear();
    EXPECT_TRUE(std::isnan(mean_error(picture, floor, 1.2, 0.0)));
}

TEST(FloorPicture, images_of_another_size_and_broken_poses_do_nothing) {
    const camera::RectifiedRig rig = fake_rig();
    FloorPicture picture{SpecularConfig{}};
    const GreyImage left(10, 10);
    const Image<float> disparity_px(10, 10);
    picture.add(rig, fake_body(0.0, 0.0), left.view(), disparity_px.view(), 0.0);
    Pose broken = fake_body(0.0, 0.0);
    broken.translation_m.x() = std::nan("");
    picture.follow(broken);
    picture.add(rig, broken, left.view(), disparity_px.view(), 0.0);
    EXPECT_TRUE(std::isnan(picture.brightness().at(300, 250)));
}

}  // namespace
}  // namespace surefoot::specular

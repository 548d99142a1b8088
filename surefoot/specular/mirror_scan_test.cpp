// SPDX-License-Identifier: Apache-2.0
#include "surefoot/specular/mirror_scan.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/angles.hpp"
#include "surefoot/specular/fake_floor_testing.hpp"
#include "surefoot/specular/suspicion.hpp"

namespace surefoot::specular {
namespace {

using namespace testing;

/// A picture of the floor with 3 grey values of noise.
struct Picture {
    grid::GridGeometry geometry{0.01, 400, 400, {-1.0, -2.0}};
    Image<float> grey{400, 400};

    explicit Picture(const FakeFloor& floor) {
        Rng rng(5);
        for (int iy = 0; iy < geometry.ny; ++iy) {
            for (int ix = 0; ix < geometry.nx; ++ix) {
                const Eigen::Vector2d at_m = geometry.center_m({ix, iy});
                grey.at(ix, iy) =
                    static_cast<float>(floor(at_m.x(), at_m.y()) + 3.0 * rng.normal());
            }
        }
    }
    [[nodiscard]] std::optional<PatchLine> scan(double angle_deg) const {
        MirrorPatch patch;
        patch.sample(geometry, grey.view(), {1.0, 0.0}, angle_deg * kRadPerDeg);
        return MirrorScan().find(patch);
    }
};

bool is_suspected(const std::optional<PatchLine>& line) {
    return line && is_suspect(*line, SpecularConfig{});
}

TEST(MirrorScan, finds_the_line_of_a_mirror) {
    // At the middle of the patch the line lies 0.20 m behind its middle; it leans by 0.4 deg.
    const double angle_rad = 10.4 * kRadPerDeg;
    const double offset_m = std::cos(angle_rad) * 1.0 + 0.20;
    const Picture picture(with_mirror(carpet(1), angle_rad, offset_m, 0.9));
    const auto line = picture.scan(10.0);
    ASSERT_TRUE(line);
    EXPECT_TRUE(is_suspected(line)) << line->score;
    EXPECT_GT(line->correlation, SpecularConfig{}.mirror_correlation);
    EXPECT_GT(line->unique, 3.0);
    EXPECT_NEAR(0.01 * (line->at - 127.5), 0.20, 0.01);
    EXPECT_NEAR(line->lean_rad, 0.4 * kRadPerDeg, 0.3 * kRadPerDeg);
}

TEST(MirrorScan, finds_glass_that_mirrors_a_seventh) {
    const Picture picture(with_mirror(carpet(2), 0.0, 1.15, 0.15));
    const auto line = picture.scan(0.0);
    ASSERT_TRUE(line);
    EXPECT_TRUE(is_suspected(line)) << line->score;
    EXPECT_LT(line->correlation, 0.3);
    EXPECT_NEAR(0.01 * (line->at - 127.5), 0.15, 0.01);
}

TEST(MirrorScan, finds_a_mirror_half_a_metre_wide_and_where_it_ends) {
    const FakeFloor floor = carpet(3);
    const FakeFloor mirrored = with_mirror(floor, 0.0, 1.1, 0.9);
    const Picture picture([&](double x_m, double y_m) {
        return std::abs(y_m - 0.4) < 0.25 ? mirrored(x_m, y_m) : floor(x_m, y_m);
    });
    const auto line = picture.scan(0.0);
    ASSERT_TRUE(is_suspected(line));
    EXPECT_NEAR(0.01 * (line->first_cell - 96), 0.15, 0.17);
    EXPECT_NEAR(0.01 * (line->last_cell - 95), 0.65, 0.17);
}

TEST(MirrorScan, finds_nothing_on_floors_without_a_mirror) {
    const FakeFloor half_shade = [floor = carpet(6)](double x_m, double y_m) {
        return floor(x_m, y_m) * (x_m + 0.3 * y_m > 1.1 ? 0.5 : 1.0);
    };
    const struct {
        const char* name;
        FakeFloor floor;
    } floors[] = {{"carpet", carpet(1)},
                  {"plain", [](double, double) { return 120.0; }},
                  {"tiles", tiles(2, 0.25, false)},
                  {"equal tiles", tiles(3, 0.25, true)},
                  {"stripes", stripes(4, 0.1)},
                  {"shadow", half_shade}};
    for (const auto& [name, floor] : floors) {
        const Picture picture(floor);
        for (int angle_deg = 0; angle_deg < 180; angle_deg += 5) {
            const auto line = picture.scan(angle_deg);
            EXPECT_FALSE(is_suspected(line))
                << name << " at " << angle_deg << " deg: score " << line->score << ", unique "
                << line->unique << ", correlation " << line->correlation;
        }
    }
}

TEST(MirrorScan, needs_floor_on_both_sides) {
    Picture picture(with_mirror(carpet(1), 0.0, 1.2, 0.9));
    for (int iy = 0; iy < 400; ++iy)
        for (int ix = 230; ix < 400; ++ix) picture.grey.at(ix, iy) = std::nanf("");
    EXPECT_FALSE(is_suspected(picture.scan(0.0)));
    picture.grey.fill(std::nanf(""));
    EXPECT_FALSE(picture.scan(0.0));
}

TEST(MirrorScan, looks_near_a_line_alone) {
    const Picture picture(with_mirror(carpet(1), 0.0, 1.2, 0.9));
    MirrorPatch patch;
    patch.sample(picture.geometry, picture.grey.view(), {1.0, 0.0}, 0.0);
    MirrorScan scan;
    EXPECT_TRUE(is_suspected(scan.find(patch, 127.5 + 20.0)));
    EXPECT_FALSE(is_suspected(scan.find(patch, 127.5 - 20.0)));
}

}  // namespace
}  // namespace surefoot::specular

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/stereo_shadows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::sim {
namespace {

constexpr int kReach = 8;
constexpr float kJump_px = 0.7F;  ///< of the default configuration: 0.5 and the steepest surface

/// Boxes before a far wall; some places show nothing.
struct Picture {
    Image<float> disparity_px;
    Image<std::int32_t> surface;

    explicit Picture(Rng& rng) : disparity_px(150, 90, 5.0F), surface(150, 90, 0) {
        for (int box = 1; box < 7; ++box) {
            const int u0 = static_cast<int>(rng.below(140));
            const int v0 = static_cast<int>(rng.below(80));
            const int width = 1 + static_cast<int>(rng.below(60));
            const int height = 1 + static_cast<int>(rng.below(40));
            const auto near_px = static_cast<float>(rng.uniform(4.0, 12.0));
            for (int v = v0; v < std::min(v0 + height, 90); ++v) {
                for (int u = u0; u < std::min(u0 + width, 150); ++u) {
                    surface.at(u, v) = box == 6 ? -1 : box;
                    disparity_px.at(u, v) = box == 6 ? std::numeric_limits<float>::quiet_NaN()
                                                     : near_px + 0.01F * static_cast<float>(u);
                }
            }
        }
    }

    /// Steps from the nearest jump to a nearer surface on one line, pixel after pixel; 0 = none.
    [[nodiscard]] int steps(int u, int v, int du, int dv) const {
        for (int k = 0; k < kReach; ++k, u -= du, v -= dv) {
            const int before_u = u - du;
            const int before_v = v - dv;
            if (before_u < 0 || before_v < 0 || before_u >= 150 || before_v >= 90) return 0;
            const bool border = surface.at(before_u, before_v) >= 0 &&
                                surface.at(before_u, before_v) != surface.at(u, v);
            const float fall_px = disparity_px.at(before_u, before_v) - disparity_px.at(u, v);
            if (border && fall_px > kJump_px) return k + 1;
            if (surface.at(u, v) < 0 || (border && -fall_px > kJump_px)) return 0;
        }
        return 0;
    }
};

TEST(StereoShadowsTest, SeamsAndRampsLieWhereEachPixelByItselfSeesAJump) {
    Rng rng(4);
    int seams = 0;
    int ramps = 0;
    for (int round = 0; round < 40; ++round) {
        const Picture picture(rng);
        ShadowMap map;
        Serial serial;
        find_shadows(picture.disparity_px, picture.surface, ShadowConfig{}, 1, serial, map);
        for (int v = 0; v < 90; ++v) {
            for (int u = 0; u < 150; ++u) {
                int nearest = 0;
                for (const auto& [du, dv] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
                    const int steps = picture.steps(u, v, du, dv);
                    if (steps > 0 && (nearest == 0 || steps < nearest)) nearest = steps;
                }
                const Shadow shadow = map.shadow.at(u, v);
                const bool right_camera = shadow == Shadow::occluded || shadow == Shadow::outside;
                if (nearest == 0) {
                    ASSERT_TRUE(shadow == Shadow::none || right_camera) << u << " " << v;
                } else if (nearest <= 2) {
                    const bool beyond =
                        static_cast<float>(u) - picture.disparity_px.at(u, v) < -0.5F;
                    ASSERT_TRUE(shadow == Shadow::fattened || (beyond && right_camera))
                        << round << ": " << u << " " << v;
                    ++seams;
                } else {
                    ASSERT_TRUE(shadow == Shadow::ramp || right_camera) << u << " " << v;
                    ++ramps;
                }
            }
        }
    }
    EXPECT_GT(seams, 2000);
    EXPECT_GT(ramps, 5000);
}

}  // namespace
}  // namespace surefoot::sim

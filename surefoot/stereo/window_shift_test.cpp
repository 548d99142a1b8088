// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/window_shift.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::stereo {
namespace {

constexpr int kSide = 48;
constexpr int kMiddle = kSide / 2;

/// Grey values known at every position: waves in all directions, 6 to 20 px long.
class Waves {
  public:
    explicit Waves(std::uint64_t seed) {
        Rng rng(seed);
        for (int i = 0; i < 25; ++i) {
            const double length_px = rng.uniform(6.0, 20.0);
            const double turn_rad = rng.uniform(0.0, std::numbers::pi);
            const double k = 2.0 * std::numbers::pi / length_px;
            waves_.push_back({k * std::cos(turn_rad),
                              k * std::sin(turn_rad),
                              rng.uniform(0.0, 2.0 * std::numbers::pi)});
        }
    }
    [[nodiscard]] double at(double x, double y) const {
        double grey = 128.0;
        for (const Wave& wave : waves_)
            grey += 9.0 * std::sin(wave.x * x + wave.y * y + wave.phase);
        return grey;
    }

  private:
    struct Wave {
        double x, y, phase;
    };
    std::vector<Wave> waves_;
};

struct View {
    double columns_px = 0.0;
    double slant_x = 0.0;
    double slant_y = 0.0;
    double rows_px = 0.0;
    double gain = 1.0;
    double offset = 0.0;
    double noise = 0.0;
};

/// The waves, moved by `view` about the middle of the image.
GreyImage picture(const Waves& waves, const View& view, Rng& rng) {
    GreyImage image(kSide, kSide);
    for (int v = 0; v < kSide; ++v) {
        for (int u = 0; u < kSide; ++u) {
            const double y = v - kMiddle - view.rows_px;
            const double x =
                (u - kMiddle - view.columns_px - view.slant_y * y) / (1.0 + view.slant_x);
            const double grey =
                view.gain * waves.at(x, y) + view.offset + view.noise * rng.normal();
            image.at(u, v) = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
        }
    }
    return image;
}

WindowShift whole(const View& view) {
    return {std::round(view.columns_px), std::round(view.rows_px)};
}

TEST(WindowShift, FindsFractionsOfAPixelAsTheyAre) {
    Rng rng(1);
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const Waves waves(seed);
        const GreyImage left = picture(waves, {}, rng);
        for (const double rows_px : {-0.45, -0.3, -0.15, 0.0, 0.1, 0.25, 0.4, 2.3}) {
            const View view{rng.uniform(-4.0, 4.0),
                            rng.uniform(-0.05, 0.05),
                            rng.uniform(-0.1, 0.1),
                            rows_px,
                            rng.uniform(0.7, 1.3),
                            rng.uniform(-10.0, 10.0)};
            const auto found = refine_shift(
                left.view(), picture(waves, view, rng).view(), kMiddle, kMiddle, whole(view));
            ASSERT_TRUE(found);
            EXPECT_NEAR(found->rows_px, view.rows_px, 0.012);
            EXPECT_NEAR(found->columns_px, view.columns_px, 0.012);
        }
    }
}

TEST(WindowShift, NoiseOfBothEyesPullsToNoSide) {
    constexpr int kWindows = 400;
    constexpr double kTrue_px = 0.25;
    Rng rng(2);
    double sum = 0.0;
    double square = 0.0;
    for (int i = 0; i < kWindows; ++i) {
        const Waves waves(100 + static_cast<std::uint64_t>(i));
        View view;
        view.noise = 8.0;
        const GreyImage left = picture(waves, view, rng);
        view.columns_px = rng.uniform(-0.5, 0.5);
        view.rows_px = kTrue_px;
        const auto found =
            refine_shift(left.view(), picture(waves, view, rng).view(), kMiddle, kMiddle, {});
        ASSERT_TRUE(found);
        const double off_px = found->rows_px - kTrue_px;
        sum += off_px;
        square += off_px * off_px;
    }
    const double mean_px = sum / kWindows;
    const double sigma_px = std::sqrt(square / kWindows);
    EXPECT_LT(sigma_px, 0.1);
    EXPECT_LT(std::abs(mean_px), 4.0 * sigma_px / std::sqrt(kWindows));
}

TEST(WindowShift, SaysNothingWhereItCannotTell) {
    Rng rng(3);
    const Waves waves(3);
    const GreyImage left = picture(waves, {}, rng);
    const auto refined = [&](const GreyImage& from, const GreyImage& to, int u, int v) {
        return refine_shift(from.view(), to.view(), u, v, {}).has_value();
    };
    EXPECT_TRUE(refined(left, left, kMiddle, kMiddle));
    for (const int rim : {0, kShiftHalf_px, kSide - 1 - kShiftHalf_px, kSide - 1}) {
        EXPECT_FALSE(refined(left, left, rim, kMiddle));
        EXPECT_FALSE(refined(left, left, kMiddle, rim));
    }
    const GreyImage grey(kSide, kSide, 90);
    EXPECT_FALSE(refined(grey, left, kMiddle, kMiddle));
    EXPECT_FALSE(refined(left, grey, kMiddle, kMiddle));
    GreyImage stripes(kSide, kSide);  // nothing shows their shift along the stripes
    for (int v = 0; v < kSide; ++v) {
        for (int u = 0; u < kSide; ++u) stripes.at(u, v) = left.at(kMiddle, v);
    }
    EXPECT_FALSE(refined(stripes, stripes, kMiddle, kMiddle));
    // Two pixels away from the start.
    EXPECT_FALSE(refined(left, picture(waves, {0.0, 0.0, 0.0, 2.0}, rng), kMiddle, kMiddle));
}

}  // namespace
}  // namespace surefoot::stereo

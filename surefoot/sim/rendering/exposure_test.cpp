// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/exposure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace surefoot::sim {
namespace {

/// An image whose signal at the configured exposure is the same everywhere.
Image<float> even(double signal_dn) {
    return Image<float>(64, 48, static_cast<float>(signal_dn));
}

ExposureConfig automatic() {
    ExposureConfig config;
    config.automatic = true;
    return config;
}

TEST(ExposureTest, MeteringSaturates) {
    Image<float> image = even(100.0);
    EXPECT_DOUBLE_EQ(metered_mean_dn(image, 1.0), 100.0);
    EXPECT_DOUBLE_EQ(metered_mean_dn(image, 2.0), 200.0);
    EXPECT_DOUBLE_EQ(metered_mean_dn(image, 3.0), 255.0);
    for (int v = 0; v < 24; ++v) std::fill_n(image.row(v), 64, 1000.0F);
    EXPECT_DOUBLE_EQ(metered_mean_dn(image, 1.0), 0.5 * (255.0 + 100.0));
}

TEST(ExposureTest, WithoutControlNothingChanges) {
    ExposureControl control({}, 1);
    control.settle(even(3.0));
    control.update(even(250.0), 0.1);
    const Shot shot = control.shot(5.0);
    EXPECT_EQ(shot.exposure_s, ExposureConfig{}.exposure_s);
    EXPECT_EQ(shot.gain, 1.0);
    EXPECT_EQ(shot.light, 1.0);
}

TEST(ExposureTest, TheErrorFallsByEForEveryLag) {
    const ExposureConfig config = automatic();
    for (const double signal_dn : {30.0, 110.0, 200.0}) {
        ExposureControl control(config, 1);
        const Image<float> scene = even(signal_dn);
        double before = std::log(config.target_dn / signal_dn);
        for (int i = 0; i < 30; ++i) {
            control.update(scene, 0.1);
            const double after = std::log(config.target_dn / (signal_dn * control.shot(0.0).light));
            EXPECT_NEAR(after, before * std::exp(-0.1 / config.lag_s), 1e-9) << signal_dn;
            before = after;
        }
        EXPECT_NEAR(metered_mean_dn(scene, control.shot(0.0).light), config.target_dn, 0.01);
    }
}

TEST(ExposureTest, ABlindingSceneRecoversFromSaturation) {
    ExposureControl control(automatic(), 1);
    const Image<float> snow = even(2000.0);
    control.update(snow, 0.1);
    EXPECT_DOUBLE_EQ(metered_mean_dn(snow, control.shot(0.0).light), 255.0);
    for (int i = 0; i < 60; ++i) control.update(snow, 0.1);
    EXPECT_NEAR(metered_mean_dn(snow, control.shot(0.0).light), 110.0, 0.5);
}

TEST(ExposureTest, TimeGoesFirstThenGainThenNothing) {
    const ExposureConfig config = automatic();  // 8 ms, at most 16 ms and gain 8
    ExposureControl control(config, 1);
    control.settle(even(80.0));
    EXPECT_NEAR(control.shot(0.0).exposure_s, 0.008 * 110.0 / 80.0, 1e-9);
    EXPECT_EQ(control.shot(0.0).gain, 1.0);
    control.settle(even(11.0));  // ten times too dark
    EXPECT_NEAR(control.shot(0.0).exposure_s, 0.016, 1e-12);
    EXPECT_NEAR(control.shot(0.0).gain, 5.0, 1e-6);
    EXPECT_NEAR(control.shot(0.0).light, 10.0, 1e-5);
    control.settle(even(1.0));
    EXPECT_NEAR(control.shot(0.0).gain, 8.0, 1e-6);
    for (int i = 0; i < 100; ++i) control.update(even(0.0), 0.1);
    EXPECT_NEAR(control.shot(0.0).gain, 8.0, 1e-12);
    control.settle(even(1e6));
    EXPECT_NEAR(control.shot(0.0).exposure_s, config.min_exposure_s, 1e-9);
}

TEST(ExposureTest, TheSunOverExposesForTenToThirtySeconds) {
    ExposureConfig config = automatic();
    config.sun_warm_up = true;
    std::set<double> durations_s;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        ExposureControl control(config, seed);
        const Image<float> scene = even(100.0);
        control.settle(scene);
        const double last_s = control.warm_up_s();
        EXPECT_GE(last_s, 10.0);
        EXPECT_LE(last_s, 30.0);
        durations_s.insert(last_s);
        EXPECT_NEAR(control.shot(0.0).light, 8.0 * 1.1, 1e-6);
        EXPECT_GT(metered_mean_dn(scene, control.shot(0.3 * last_s).light), 254.0);
        double before = 1e9;
        for (double t_s = 0.0; t_s < last_s; t_s += 0.5) {
            control.update(scene, 0.5);  // the control does not fight the sun
            EXPECT_LT(control.shot(t_s).light, before);
            before = control.shot(t_s).light;
        }
        EXPECT_NEAR(control.shot(last_s).light, 1.1, 1e-6);
    }
    EXPECT_GT(*durations_s.rbegin() - *durations_s.begin(), 12.0);
    EXPECT_EQ(ExposureControl(config, 7).warm_up_s(), ExposureControl(config, 7).warm_up_s());
    EXPECT_EQ(ExposureControl(automatic(), 7).warm_up_s(), 0.0);
}

}  // namespace
}  // namespace surefoot::sim

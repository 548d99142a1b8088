// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/flights/ray_flight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "surefoot/core/rng.hpp"

namespace surefoot::stairs {
namespace {

constexpr double kHeight_m = 1.0;    ///< height of the camera
constexpr double kFirst_m = 0.8;     ///< run to the first nosing
constexpr double kBin_rad = 0.0015;  ///< half a pixel of a ZED

/// The bins of a flight down, one per ray.
std::vector<RayBin> seen_of(int steps, double riser_m, double going_m) {
    std::vector<RayBin> bins;
    const double first_rad = std::atan2(kHeight_m, kFirst_m);
    for (int k = -20; k < 200; ++k) {
        RayBin bin;
        bin.steepness = std::tan(first_rad - k * kBin_rad);
        int tread = 0;
        while (tread < steps &&
               (kHeight_m + tread * riser_m) / bin.steepness > kFirst_m + tread * going_m)
            ++tread;
        bin.depth_m = tread * riser_m;
        bin.sigma_m = 0.01;
        bins.push_back(bin);
    }
    return bins;
}

void add_noise(std::vector<RayBin>& bins, double sigma_m, std::uint64_t seed) {
    Rng rng(seed);
    for (RayBin& bin : bins) {
        bin.depth_m += sigma_m * rng.normal();
        bin.sigma_m = sigma_m;
    }
}

TEST(RayFlight, AnEvenFlightIsFoundInNoise) {
    RayFlight finder{StairsConfig{}};
    std::uint64_t seed = 0;
    for (const int steps : {2, 4, 6}) {
        for (const double riser_m : {0.15, 0.18, 0.21}) {
            for (const double going_m : {0.23, 0.31}) {
                auto bins = seen_of(steps, riser_m, going_m);
                add_noise(bins, 0.03, ++seed);
                const auto flight = finder.fit(bins, kHeight_m, kFirst_m);
                ASSERT_TRUE(flight) << seed;
                EXPECT_NEAR(flight->riser_m, riser_m, 0.006) << seed;
                EXPECT_NEAR(flight->going_m, going_m, 0.02) << seed;
                if (steps < 6) {  // the floor below these steps is visible
                    EXPECT_EQ(flight->steps, steps) << seed;
                }
            }
        }
    }
}

TEST(RayFlight, ABlurredTreadIsStillOne) {
    RayFlight finder{StairsConfig{}};
    auto bins = seen_of(5, 0.17, 0.27);
    // The matcher blurs the whole second tread between the first and the third.
    const auto tread = [&](double depth_m) {
        return std::find_if(
            bins.begin(), bins.end(), [&](const RayBin& bin) { return bin.depth_m > depth_m; });
    };
    const auto begin = tread(0.3);
    const auto end = tread(0.4);
    for (auto bin = begin; bin != end; ++bin)
        bin->depth_m =
            0.17 + 0.34 * static_cast<double>(bin - begin) / static_cast<double>(end - begin);
    add_noise(bins, 0.02, 5);
    const auto flight = finder.fit(bins, kHeight_m, kFirst_m);
    ASSERT_TRUE(flight);
    EXPECT_NEAR(flight->riser_m, 0.17, 0.005);
    EXPECT_NEAR(flight->going_m, 0.27, 0.02);
}

TEST(RayFlight, RampsFallsAndLevelGroundAreNoFlights) {
    RayFlight finder{StairsConfig{}};
    const auto is_none = [&](const std::function<double(double steepness)>& depth_m) {
        auto bins = seen_of(0, 0.0, 0.0);
        for (RayBin& bin : bins)
            if (kHeight_m / bin.steepness > kFirst_m) bin.depth_m = depth_m(bin.steepness);
        add_noise(bins, 0.02, 9);
        return !finder.fit(bins, kHeight_m, kFirst_m).has_value();
    };
    EXPECT_TRUE(is_none([](double) { return 0.0; }));
    EXPECT_TRUE(is_none([](double) { return 0.15; }));
    EXPECT_TRUE(is_none([](double) { return 0.7; }));
    for (const double slope : {0.12, 0.3, 0.6}) {
        const auto ramp = [&](double steepness) {
            return slope * (kHeight_m - kFirst_m * steepness) / (steepness - slope);
        };
        EXPECT_TRUE(is_none([&](double s) { return s > slope ? ramp(s) : 1.3; })) << slope;
        EXPECT_TRUE(is_none([&](double s) { return s > slope ? std::min(ramp(s), 0.5) : 0.5; }))
            << slope << ", and a floor";
    }
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(is_none([&](double) { return nan; }));
    EXPECT_FALSE(finder.fit({}, kHeight_m, kFirst_m));
}

}  // namespace
}  // namespace surefoot::stairs

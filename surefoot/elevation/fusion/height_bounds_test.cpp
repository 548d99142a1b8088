// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/height_bounds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::elevation {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Map {
    grid::Layer height_m;
    grid::Layer var_m2;
    grid::Layer drift_m;

    [[nodiscard]] HeightBounds::Input input() const {
        return {height_m.view(), var_m2.view(), drift_m.view(), 0.025, 2.0};
    }
};

Map random_map(Rng& rng, int nx, int ny, double drift_m) {
    Map map{grid::Layer(nx, ny), grid::Layer(nx, ny), grid::Layer(nx, ny)};
    for (std::size_t i = 0; i < map.height_m.size(); ++i) {
        map.height_m.data()[i] =
            rng.uniform(0.0, 1.0) < 0.3 ? kNanF : static_cast<float>(rng.uniform(-1.0, 1.0));
        map.var_m2.data()[i] = static_cast<float>(rng.uniform(0.0, 1e-3));
        map.drift_m.data()[i] = static_cast<float>(rng.uniform(0.0, drift_m));
    }
    return map;
}

/// Checks every cell against the definition.
void expect_as_defined(const Map& map, const grid::Layer& lower_m, const grid::Layer& upper_m) {
    const int nx = map.height_m.width();
    const int ny = map.height_m.height();
    for (int iy = 0; iy < ny; ++iy) {
        for (int ix = 0; ix < nx; ++ix) {
            if (std::isnan(map.height_m.at(ix, iy))) {
                EXPECT_TRUE(std::isnan(lower_m.at(ix, iy)) && std::isnan(upper_m.at(ix, iy)));
                continue;
            }
            const double drift_m = static_cast<double>(map.drift_m.at(ix, iy));
            const double cells = std::ceil(2.0 * drift_m / 0.025);
            float lowest_m = kInfinity;
            float highest_m = -kInfinity;
            for (int y = 0; y < ny; ++y) {
                for (int x = 0; x < nx; ++x) {
                    if (std::abs(x - ix) > cells || std::abs(y - iy) > cells) continue;
                    const float height_m = map.height_m.at(x, y);
                    if (std::isnan(height_m)) continue;
                    const float spread_m = 2.0F * std::sqrt(map.var_m2.at(x, y));
                    lowest_m = std::min(lowest_m, height_m - spread_m);
                    highest_m = std::max(highest_m, height_m + spread_m);
                }
            }
            EXPECT_EQ(lower_m.at(ix, iy), lowest_m) << ix << ", " << iy << ": " << cells;
            EXPECT_EQ(upper_m.at(ix, iy), highest_m) << ix << ", " << iy << ": " << cells;
        }
    }
}

TEST(HeightBounds, AreWhatTheDefinitionSays) {
    Rng rng(8);
    HeightBounds bounds;
    grid::Layer lower_m;
    grid::Layer upper_m;
    for (const auto& [nx, ny] : {std::pair{1, 1}, {1, 9}, {7, 5}, {33, 20}, {16, 40}}) {
        for (const double drift_m : {0.0, 0.02, 0.1, 0.6, 50.0}) {
            const Map map = random_map(rng, nx, ny, drift_m);
            bounds.compute(map.input(), serial(), lower_m, upper_m);
            expect_as_defined(map, lower_m, upper_m);
        }
    }
}

TEST(HeightBounds, AnUnknownDriftReachesEverywhere) {
    Map map{grid::Layer(9, 1, 0.0F), grid::Layer(9, 1, 0.0F), grid::Layer(9, 1, 0.0F)};
    map.height_m.at(8, 0) = 1.0F;
    map.height_m.at(4, 0) = kNanF;
    for (const float drift_m : {kNanF, kInfinity, 1e30F}) {
        map.drift_m.at(0, 0) = drift_m;
        grid::Layer lower_m;
        grid::Layer upper_m;
        HeightBounds().compute(map.input(), serial(), lower_m, upper_m);
        EXPECT_EQ(upper_m.at(0, 0), 1.0F) << drift_m;
        EXPECT_EQ(lower_m.at(0, 0), 0.0F) << drift_m;
        EXPECT_EQ(upper_m.at(1, 0), 0.0F) << drift_m;
        EXPECT_TRUE(std::isnan(upper_m.at(4, 0)));
    }
}

}  // namespace
}  // namespace surefoot::elevation

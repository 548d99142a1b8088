// SPDX-License-Identifier: Apache-2.0
// How often are steps detected on ground without steps? Ground: smooth ramps, planes, hills, dips
// and waves of 0 to 35 deg, drawn by seeds (surefoot/stairs/smooth_ground_testing.hpp), with height
// errors.
// Usage: stairs_smooth OUT.csv FIRST_SEED SEEDS
//
// Writes OUT.csv, one line per map: seed, kind, slope_deg, sigma_mm (one sigma of the height
// errors), correlation_mm (their correlation length, 0 = uncorrelated), stated (1 = the map states
// their variance), flights, kerbs, drops, edges (number detected, seen from the middle of the map),
// find_us (time of the call).
#include <fmt/format.h>
#include <fmt/os.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "surefoot/stairs/feature_finder.hpp"
#include "surefoot/stairs/smooth_ground_testing.hpp"

namespace surefoot::experiments {
namespace {

using stairs::testing::SmoothGround;
using stairs::testing::SmoothMap;

constexpr const char* kKindNames[] = {"ramp", "plane", "hill", "waves"};

struct Errors {
    double sigma_m;
    double correlation_m;
    bool stated;
};
constexpr Errors kErrors[] = {{0.0, 0.0, false},
                              {0.006, 0.0, false},
                              {0.012, 0.0, false},
                              {0.012, 0.0, true},
                              {0.006, 0.1, true},
                              {0.012, 0.1, false},
                              {0.012, 0.1, true}};

int measure(const std::vector<std::string>& words) {
    if (words.size() != 3) {
        fmt::print(stderr, "usage: stairs_smooth OUT.csv FIRST_SEED SEEDS\n");
        return 2;
    }
    const std::uint64_t first = std::strtoull(words[1].c_str(), nullptr, 10);
    const std::uint64_t seeds = std::strtoull(words[2].c_str(), nullptr, 10);
    auto out = fmt::output_file(words[0]);
    out.print(
        "seed,kind,slope_deg,sigma_mm,correlation_mm,stated,flights,kerbs,drops,edges,find_us\n");
    stairs::FeatureFinder finder{stairs::StairsConfig{}};
    stairs::TerrainFeatures found;
    for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
        const SmoothGround ground(seed);
        for (const Errors& errors : kErrors) {
            const SmoothMap map(ground, errors.sigma_m, errors.correlation_m, errors.stated, seed);
            const auto start = std::chrono::steady_clock::now();
            finder.find(map.terrain(), found);
            const std::chrono::duration<double, std::micro> took =
                std::chrono::steady_clock::now() - start;
            out.print("{},{},{:.2f},{:g},{:g},{},{},{},{},{},{:.0f}\n",
                      seed,
                      kKindNames[static_cast<int>(ground.kind)],
                      ground.slope_deg,
                      1e3 * errors.sigma_m,
                      1e3 * errors.correlation_m,
                      errors.stated ? 1 : 0,
                      found.flights.size(),
                      found.kerbs.size(),
                      found.drops.size(),
                      found.edges.size(),
                      took.count());
        }
    }
    return 0;
}

}  // namespace
}  // namespace surefoot::experiments

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::experiments::measure({argv + 1, argv + argc});
}

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "apps/surefoot/bench_result.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/traversability/foothold.hpp"
#include "surefoot/traversability/footprint.hpp"
#include "surefoot/traversability/rating_confidence.hpp"
#include "surefoot/traversability/reachability.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::app {
namespace {

using traversability::Traversability;
using traversability::TraversabilityConfig;
using traversability::TraversabilityLayers;
using traversability::Way;

constexpr double kResolution_m = 0.025;
constexpr int kSide = 240;
constexpr int kRepeats = 41;

/// Floor with four stairs, a ramp and a box, 2 mm of noise and 3 % of holes: what the ancestors
/// were timed on (repeated every 6 m on larger maps).
grid::Layer measured_ground(int side, double resolution_m) {
    constexpr std::uint64_t kSeed = 11;
    constexpr double kPeriod_m = 6.0;
    Rng rng(kSeed);
    grid::Layer height_m(side, side);
    for (int iy = 0; iy < side; ++iy) {
        for (int ix = 0; ix < side; ++ix) {
            const double x_m = std::fmod(ix * resolution_m, kPeriod_m);
            const double y_m = std::fmod(iy * resolution_m, kPeriod_m);
            double z_m = 0.0;
            if (x_m > 4.0 && y_m > 2.0 && y_m < 4.0)
                z_m = 0.17 * std::min(4.0, std::floor((x_m - 4.0) / 0.29) + 1.0);
            if (x_m < 2.0 && y_m > 4.0) z_m = 0.3 * (2.0 - x_m);
            if (x_m > 1.4 && x_m < 2.0 && y_m > 1.5 && y_m < 2.0) z_m = 0.4;
            const bool hole = rng.uniform() < 0.03;
            height_m.at(ix, iy) = hole ? std::numeric_limits<float>::quiet_NaN()
                                       : static_cast<float>(z_m + 0.002 * rng.normal());
        }
    }
    return height_m;
}

Timing time_rating(const TraversabilityConfig& config,
                   const grid::Layer& height_m,
                   double resolution_m,
                   Executor& executor,
                   Way way = Way::fast) {
    Traversability rater(config.widened_to(resolution_m), way);
    TraversabilityLayers layers;
    // Fewer for large maps: a second or two, not minutes.
    const int repeats = std::clamp(kRepeats * kSide / height_m.width(), 5, kRepeats);
    return timed(repeats, [&] { rater.rate(height_m.view(), resolution_m, executor, layers); });
}

/// The cells that 60 x 60 changed ones can affect, in the middle of a rated map.
Timing time_change(const TraversabilityConfig& config,
                   const grid::Layer& height_m,
                   Executor& executor) {
    Traversability rater(config);
    TraversabilityLayers layers;
    rater.rate(height_m.view(), kResolution_m, executor, layers);
    const auto affected = rater.affected_by({90, 90, 60, 60}, kResolution_m);
    return timed(kRepeats,
                 [&] { rater.rate(height_m.view(), kResolution_m, affected, executor, layers); });
}

/// From the floor beside the stairs, the box and the ramp, over every hole.
Timing time_reach(const TraversabilityConfig& config, const grid::Layer& height_m) {
    const grid::GridGeometry geometry{kResolution_m, kSide, kSide, {0.0, 0.0}};
    traversability::Reachability reachability(config.reach);
    grid::Layer reach_step_m;
    return timed(kRepeats, [&] {
        reachability.reach(geometry, height_m.view(), {3.0, 3.0}, reach_step_m);
    });
}

/// On top of the ratings.
Timing time_confidence(const TraversabilityConfig& config,
                       const grid::Layer& height_m,
                       Executor& executor) {
    const grid::Layer var_m2(kSide, kSide, 9e-6F);
    Traversability rater(config);
    TraversabilityLayers layers;
    rater.rate(height_m.view(), kResolution_m, executor, layers);
    traversability::RatingConfidence confidence(config, kResolution_m);
    traversability::ConfidenceLayers out;
    return timed(kRepeats, [&] {
        confidence.compute({height_m.view(), var_m2.view(), rater.rated_step_heights(), layers},
                           out);
    });
}

/// Where the whole foot may stand; every known cell counts as reachable.
Timing time_footholds(const grid::Layer& height_m, Executor& executor) {
    const grid::Layer var_m2(kSide, kSide, 9e-6F);
    const grid::Layer nothing_above(kSide, kSide, std::numeric_limits<float>::quiet_NaN());
    traversability::FootholdFinder finder({});
    Image<traversability::Foothold> found;
    return timed(kRepeats, [&] {
        finder.find({height_m.view(),
                     var_m2.view(),
                     nothing_above.view(),
                     nothing_above.view(),
                     {},
                     kResolution_m},
                    executor,
                    found);
    });
}

/// A query alone is shorter than the clock resolves.
template <typename Query>
Timing time_query(const Query& query) {
    constexpr int kQueries = 1000;
    Timing timing = timed(kRepeats, [&] {
        for (int i = 0; i < kQueries; ++i) query(i);
    });
    timing.median_ms /= kQueries;
    timing.p99_ms /= kQueries;
    if (timing.least_cpu_ms) *timing.least_cpu_ms /= kQueries;
    if (timing.median_cpu_ms) *timing.median_cpu_ms /= kQueries;
    return timing;
}

/// What lies under footprints that stand, at many places and yaws, on known floor.
Result<std::vector<BenchResult>> bench_footprints() {
    using namespace traversability;
    const grid::Layer floor_m(kSide, kSide, 0.0F);
    const grid::Layer rating(kSide, kSide, 0.95F);
    const FootprintLayers layers{
        {kResolution_m, kSide, kSide, {-3.0, -3.0}}, rating.view(), floor_m.view()};
    const auto circle = Footprint::circle(0.3);
    if (!circle) return circle.error();
    const auto polygon = Footprint::polygon(
        std::vector<Eigen::Vector2d>{{-0.2, -0.1}, {0.2, -0.1}, {0.2, 0.1}, {-0.2, 0.1}});
    if (!polygon) return polygon.error();
    const auto pose = [](int i) {
        return FootprintPose{0.0017 * (i % 1000) - 1.0, 0.0013 * (i % 700) - 0.5, 0.0063 * i};
    };
    std::int64_t refused = 0;
    const auto count = [&](const FootprintReport& report) {
        if (!is_traversable(report, 0.8)) ++refused;
    };
    PathScratch scratch;
    const auto path = [&](int i) {
        constexpr int kPoses = 11;  // one every 0.1 m
        std::array<FootprintPose, kPoses> poses;
        for (int k = 0; k < kPoses; ++k) {
            const FootprintPose start = pose(i);
            poses[static_cast<std::size_t>(k)] = {start.x_m + 0.1 * k, start.y_m, 0.01 * (i % 40)};
        }
        count(query_path(*polygon, poses, layers, scratch));
    };
    std::vector<BenchResult> results{
        {"terrain/circle_0.3", time_query([&](int i) { count(query(*circle, pose(i), layers)); })},
        {"terrain/polygon_0.2x0.4",
         time_query([&](int i) { count(query(*polygon, pose(i), layers)); })},
        {"terrain/path_1m_polygon", time_query(path)}};
    if (refused > 0) {
        return input_error("bench terrain: the flat floor was refused; the timing means nothing");
    }
    return results;
}

}  // namespace

Result<std::vector<BenchResult>> bench_terrain(const CommonOptions& common, Executor& executor) {
    const TraversabilityConfig thesis = *traversability::preset("rex_zed");
    const grid::Layer ground = measured_ground(kSide, kResolution_m);
    std::vector<BenchResult> results = bench_elevation(executor);
    for (const auto& [name, config] : {std::pair{"rex_zed", thesis},
                                       std::pair{"default", TraversabilityConfig{}},
                                       std::pair{"laser", *traversability::preset("laser")}}) {
        results.push_back({fmt::format("terrain/rate_{}_240x240", name),
                           time_rating(config, ground, kResolution_m, executor),
                           time_rating(config, ground, kResolution_m, executor, Way::plain)});
    }
    if (common.threads == 1) {
        hwy::SetSupportedTargetsForTest(HWY_AVX2 | HWY_SSE4 | HWY_SSSE3 | HWY_SCALAR);
        results.push_back({"terrain/rate_rex_zed_avx2_240x240",
                           time_rating(thesis, ground, kResolution_m, executor)});
        hwy::SetSupportedTargetsForTest(0);
    }
    for (const int side : {120, 480, 960, 1920}) {
        results.push_back(
            {fmt::format("terrain/rate_rex_zed_{0}x{0}", side),
             time_rating(thesis, measured_ground(side, kResolution_m), kResolution_m, executor)});
    }
    constexpr double kFine_m = 0.01;
    results.push_back({"terrain/rate_rex_zed_600x600_1cm",
                       time_rating(thesis, measured_ground(600, kFine_m), kFine_m, executor)});
    results.push_back(
        {"terrain/rate_rex_zed_changed_60x60", time_change(thesis, ground, executor)});
    results.push_back({"terrain/reach_240x240", time_reach({}, ground)});
    results.push_back({"terrain/confidence_240x240", time_confidence({}, ground, executor)});
    results.push_back({"terrain/footholds_240x240", time_footholds(ground, executor)});
    const auto footprints = bench_footprints();
    if (!footprints) return footprints.error();
    results.insert(results.end(), footprints->begin(), footprints->end());
    return results;
}

}  // namespace surefoot::app

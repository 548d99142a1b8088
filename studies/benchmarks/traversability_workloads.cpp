// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "studies/benchmarks/terrain_workloads.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/traversability/foothold.hpp"
#include "surefoot/traversability/footprint.hpp"
#include "surefoot/traversability/rating_confidence.hpp"
#include "surefoot/traversability/reachability.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::app {
namespace {

using traversability::FootprintPose;
using traversability::Traversability;
using traversability::TraversabilityConfig;
using traversability::TraversabilityLayers;
using traversability::Way;

constexpr double kResolution_m = 0.025;
constexpr int kSide = 240;
constexpr int kRepeats = 41;

/// Returns a floor with four stairs, a ramp and a box, with 2 mm of noise and 3 % of holes. The
/// reference implementations were timed on this map. Larger maps repeat it every 6 m.
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

/// A map and its rating.
struct Rated {
    grid::Layer height_m;
    Traversability rater;
    TraversabilityLayers layers = {};
};

Workload::Prepare rating(const TraversabilityConfig& config,
                         int side,
                         double resolution_m,
                         Executor& executor,
                         Way way = Way::fast) {
    return [=, &executor]() -> Result<Workload::Job> {
        const auto map =
            std::make_shared<Rated>(Rated{measured_ground(side, resolution_m),
                                          Traversability(config.widened_to(resolution_m), way)});
        return Workload::Job([map, resolution_m, &executor] {
            map->rater.rate(map->height_m.view(), resolution_m, executor, map->layers);
        });
    };
}

Workload rating_of(const std::string& settings,
                   const TraversabilityConfig& config,
                   int side,
                   Executor& executor) {
    // Uses fewer repetitions for large maps, so that a workload takes at most about two seconds.
    return {fmt::format("terrain/rate_{0}_{1}x{1}", settings, side),
            std::clamp(kRepeats * kSide / side, 5, kRepeats),
            rating(config, side, kResolution_m, executor)};
}

/// Limits the instruction sets to AVX2 while the job exists.
Workload rating_on_avx2(const TraversabilityConfig& config, Executor& executor) {
    struct Avx2 {
        Avx2() { hwy::SetSupportedTargetsForTest(HWY_AVX2 | HWY_SSE4 | HWY_SSSE3 | HWY_SCALAR); }
        Avx2(const Avx2&) = delete;
        Avx2& operator=(const Avx2&) = delete;
        ~Avx2() { hwy::SetSupportedTargetsForTest(0); }
    };
    const auto prepare = [rate = rating(config, kSide, kResolution_m, executor)]() {
        auto job = rate();
        if (!job) return job;
        return Result<Workload::Job>(
            [job = *std::move(job), only = std::make_shared<Avx2>()] { job(); });
    };
    return {fmt::format("terrain/rate_rex_zed_avx2_{0}x{0}", kSide), kRepeats, prepare};
}

/// Rates again the cells that a change of 60 x 60 cells in the middle of a rated map can affect.
Workload rating_a_change(const TraversabilityConfig& config, Executor& executor) {
    const auto prepare = [config, &executor]() -> Result<Workload::Job> {
        const auto map = std::make_shared<Rated>(
            Rated{measured_ground(kSide, kResolution_m), Traversability(config)});
        map->rater.rate(map->height_m.view(), kResolution_m, executor, map->layers);
        const auto affected = map->rater.affected_by({90, 90, 60, 60}, kResolution_m);
        return Workload::Job([map, affected, &executor] {
            map->rater.rate(map->height_m.view(), kResolution_m, affected, executor, map->layers);
        });
    };
    return {"terrain/rate_rex_zed_changed_60x60", kRepeats, prepare};
}

/// Computes reachability from the floor beside the stairs, the box and the ramp, across the holes.
Workload reaching(const TraversabilityConfig& config) {
    struct State {
        grid::Layer height_m = measured_ground(kSide, kResolution_m);
        traversability::Reachability reachability;
        grid::Layer reach_step_m = {};
    };
    const auto prepare = [config]() -> Result<Workload::Job> {
        const auto state = std::make_shared<State>(
            State{.reachability = traversability::Reachability(config.reach)});
        return Workload::Job([state] {
            const grid::GridGeometry geometry{kResolution_m, kSide, kSide, {0.0, 0.0}};
            state->reachability.reach(
                geometry, state->height_m.view(), {3.0, 3.0}, state->reach_step_m);
        });
    };
    return {fmt::format("terrain/reach_{0}x{0}", kSide), kRepeats, prepare};
}

/// Times the confidence of the ratings, without the rating itself.
Workload telling_confidence(const TraversabilityConfig& config, Executor& executor) {
    struct State {
        Rated map;
        traversability::RatingConfidence confidence;
        grid::Layer var_m2{kSide, kSide, 9e-6F};
        traversability::ConfidenceLayers out = {};
    };
    const auto prepare = [config, &executor]() -> Result<Workload::Job> {
        const auto state = std::make_shared<State>(
            State{{measured_ground(kSide, kResolution_m), Traversability(config)},
                  traversability::RatingConfidence(config, kResolution_m)});
        Rated& map = state->map;
        map.rater.rate(map.height_m.view(), kResolution_m, executor, map.layers);
        return Workload::Job([state] {
            const Rated& rated = state->map;
            state->confidence.compute({rated.height_m.view(),
                                       state->var_m2.view(),
                                       rated.rater.rated_step_heights(),
                                       rated.layers},
                                      state->out);
        });
    };
    return {fmt::format("terrain/confidence_{0}x{0}", kSide), kRepeats, prepare};
}

/// Finds footholds; every known cell counts as reachable.
Workload finding_footholds(Executor& executor) {
    struct State {
        grid::Layer height_m = measured_ground(kSide, kResolution_m);
        grid::Layer var_m2{kSide, kSide, 9e-6F};
        grid::Layer nothing_above{kSide, kSide, std::numeric_limits<float>::quiet_NaN()};
        traversability::FootholdFinder finder{{}};
        Image<traversability::Foothold> found;
    };
    const auto prepare = [&executor]() -> Result<Workload::Job> {
        const auto state = std::make_shared<State>();
        return Workload::Job([state, &executor] {
            state->finder.find({state->height_m.view(),
                                state->var_m2.view(),
                                state->nothing_above.view(),
                                state->nothing_above.view(),
                                {},
                                kResolution_m},
                               executor,
                               state->found);
        });
    };
    return {fmt::format("terrain/footholds_{0}x{0}", kSide), kRepeats, prepare};
}

/// A flat floor without unknown cells.
struct Floor {
    grid::Layer height_m{kSide, kSide, 0.0F};
    grid::Layer rating{kSide, kSide, 0.95F};

    [[nodiscard]] traversability::FootprintLayers layers() const {
        return {{kResolution_m, kSide, kSide, {-3.0, -3.0}}, rating.view(), height_m.view()};
    }
};

FootprintPose place(int i) {
    return {0.0017 * (i % 1000) - 1.0, 0.0013 * (i % 700) - 0.5, 0.0063 * i};
}

/// Runs `ask(footprint, i, layers)` for many positions and yaws.
template <typename Ask>
Workload asking(std::string name,
                const Result<traversability::Footprint>& footprint,
                const Ask& ask) {
    constexpr int kQueries = 1000;
    const auto prepare = [footprint, ask]() -> Result<Workload::Job> {
        if (!footprint) return footprint.error();
        const auto floor = std::make_shared<Floor>();
        const auto refused = [floor, footprint, ask] {
            std::int64_t count = 0;
            for (int i = 0; i < kQueries; ++i) {
                const auto report = ask(*footprint, i, floor->layers());
                if (!traversability::is_traversable(report, 0.8)) ++count;
            }
            return count;
        };
        if (refused() > 0)
            return input_error("the flat floor was refused, so the timing means nothing");
        return Workload::Job([refused] {
            volatile std::int64_t count = refused();
            static_cast<void>(count);
        });
    };
    return {std::move(name), kRepeats, prepare, {}, kQueries};
}

/// Times queries of standing footprints and of a path of 1 m.
std::vector<Workload> footprints() {
    using namespace traversability;
    const auto stand = [](const Footprint& footprint, int i, const FootprintLayers& layers) {
        return query(footprint, place(i), layers);
    };
    const auto walk = [scratch = std::make_shared<PathScratch>()](
                          const Footprint& footprint, int i, const FootprintLayers& layers) {
        constexpr int kPoses = 11;  // one pose every 0.1 m
        std::array<FootprintPose, kPoses> poses;
        for (int k = 0; k < kPoses; ++k) {
            const FootprintPose start = place(i);
            poses[static_cast<std::size_t>(k)] = {start.x_m + 0.1 * k, start.y_m, 0.01 * (i % 40)};
        }
        return query_path(footprint, poses, layers, *scratch);
    };
    const auto polygon = Footprint::polygon(
        std::vector<Eigen::Vector2d>{{-0.2, -0.1}, {0.2, -0.1}, {0.2, 0.1}, {-0.2, 0.1}});
    return {asking("terrain/circle_0.3", Footprint::circle(0.3), stand),
            asking("terrain/polygon_0.2x0.4", polygon, stand),
            asking("terrain/path_1m_polygon", polygon, walk)};
}

}  // namespace

std::vector<Workload> traversability_workloads(bool one_thread, Executor& executor) {
    constexpr double kFine_m = 0.01;
    constexpr int kFineSide = 600;
    const TraversabilityConfig thesis = *traversability::preset("rex_zed");
    std::vector<Workload> all;
    for (const auto& [name, config] : {std::pair{"rex_zed", thesis},
                                       std::pair{"default", TraversabilityConfig{}},
                                       std::pair{"laser", *traversability::preset("laser")}}) {
        all.push_back(rating_of(name, config, kSide, executor));
        all.back().prepare_plain = rating(config, kSide, kResolution_m, executor, Way::plain);
    }
    if (one_thread) all.push_back(rating_on_avx2(thesis, executor));
    for (const int side : {120, 480, 960, 1920})
        all.push_back(rating_of("rex_zed", thesis, side, executor));
    all.push_back({"terrain/rate_rex_zed_600x600_1cm",
                   kRepeats / 2,
                   rating(thesis, kFineSide, kFine_m, executor)});
    all.push_back(rating_a_change(thesis, executor));
    all.push_back(reaching({}));
    all.push_back(telling_confidence({}, executor));
    all.push_back(finding_footholds(executor));
    for (Workload& query : footprints()) all.push_back(std::move(query));
    return all;
}

}  // namespace surefoot::app

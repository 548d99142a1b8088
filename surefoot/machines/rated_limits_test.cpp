// SPDX-License-Identifier: Apache-2.0
// The table of rated limits says for each limit in which direction it allows more. These tests ask
// the gate about random ground: a laxer limit never refuses a step that a stricter limit allows,
// and at least once it allows a step that the stricter limit refuses.
#include "surefoot/io/settings/rated_limits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <string>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/gate/gate_testing.hpp"

namespace surefoot {
namespace {

using gate::testing::kBackward;
using gate::testing::kForward;
using gate::testing::kMs;
using gate::testing::kNowNs;
using gate::testing::Terrain;

using SetLimit = std::function<void(GateLimits&, double)>;

template <typename Int>
SetLimit scaled(Int GateLimits::*member, double per_unit) {
    return [=](GateLimits& limits, double value) {
        limits.*member = static_cast<Int>(std::lround(value * per_unit));
    };
}

SetLimit step(std::size_t movement_class, std::int32_t StepLimits::*member) {
    return [=](GateLimits& limits, double value) {
        limits.step[movement_class].*member = static_cast<std::int32_t>(std::lround(value * 1e4));
    };
}

/// Setters of the machine limits by their key in a machine file.
std::map<std::string, SetLimit> setters() {
    return {
        {"limits.walk.up_m", step(0, &StepLimits::up_tenth_mm)},
        {"limits.walk.down_m", step(0, &StepLimits::down_tenth_mm)},
        {"limits.stair.up_m", step(1, &StepLimits::up_tenth_mm)},
        {"limits.stair.down_m", step(1, &StepLimits::down_tenth_mm)},
        {"limits.tilt_deg",
         [](GateLimits& limits, double value) {
             limits.min_normal_z = std::cos(value * std::numbers::pi / 180.0);
         }},
        {"limits.patch_side_m", scaled(&GateLimits::patch_side_tenth_mm, 1e4)},
        {"limits.patch_residual_m", scaled(&GateLimits::patch_residual_tenth_mm, 1e4)},
        {"limits.patch_sigma_m", scaled(&GateLimits::patch_sigma_tenth_mm, 1e4)},
        {"limits.sigma_factor",
         [](GateLimits& limits, double value) { limits.sigma_factor = value; }},
        {"limits.patch_independent_cells", scaled(&GateLimits::patch_independent_cells, 1.0)},
        {"limits.cell_sigma_m", scaled(&GateLimits::cell_sigma_tenth_mm, 1e4)},
        {"limits.swing_clearance_m", scaled(&GateLimits::swing_clearance_tenth_mm, 1e4)},
        {"limits.foot_margin_m", scaled(&GateLimits::foot_margin_tenth_mm, 1e4)},
        {"limits.drop_m", scaled(&GateLimits::drop_tenth_mm, 1e4)},
        {"limits.drop_band_m", scaled(&GateLimits::drop_band_tenth_mm, 1e4)},
        {"limits.drop_evidence", scaled(&GateLimits::drop_evidence, 255.0)},
        {"limits.drift_m", scaled(&GateLimits::drift_tenth_mm, 1e4)},
        {"limits.tread_share", scaled(&GateLimits::tread_share_permille, 1e3)},
        {"limits.tread_overhang_m", scaled(&GateLimits::tread_overhang_tenth_mm, 1e4)},
        {"limits.frame_age_ms", scaled(&GateLimits::frame_age_ns, 1e6)},
        {"limits.pose_age_ms", scaled(&GateLimits::pose_age_ns, 1e6)},
        {"limits.future_tolerance_ms", scaled(&GateLimits::future_tolerance_ns, 1e6)},
        {"limits.verdict_ttl_ms", scaled(&GateLimits::verdict_ttl_ns, 1e6)},
        {"limits.attestation_radius_m", scaled(&GateLimits::attestation_radius_tenth_mm, 1e4)},
    };
}

/// A question on ground with one random fault, and the moment after the answer at which it counts.
struct Case {
    std::unique_ptr<grid::MapSnapshot> map;
    gate::Query query;
    Machine machine = gate::testing::rex();
    std::int64_t used_ns = kNowNs;
};

/// The fault is about as large as a limit, so that the limit's value decides.
Case random_case(std::uint64_t seed) {
    Rng rng(seed);
    const auto uniform = [&](double low, double high) { return rng.uniform(low, high); };
    Terrain terrain;
    Case one;
    GateLimits& limits = one.machine.limits;
    std::uint8_t command = kForward;
    double attested_m = 0.0;
    double evidence = 0.0;
    switch (seed % 14) {
        case 0: terrain.drift.fill(static_cast<float>(uniform(0.0, 0.05))); break;
        case 1: {  // noise of the heights
            const double amplitude_m = uniform(0.0, 0.04);
            for (std::size_t i = 0; i < terrain.height.size(); ++i)
                terrain.height.data()[i] = static_cast<float>(amplitude_m * rng.uniform());
            break;
        }
        case 2: {  // variance of the heights
            const double sigma_m = uniform(0.0, 0.02);
            terrain.variance.fill(static_cast<float>(sigma_m * sigma_m));
            break;
        }
        case 3: {  // variance of the heights, with patches that may be as uncertain
            const double sigma_m = uniform(0.008, 0.02);
            terrain.variance.fill(static_cast<float>(sigma_m * sigma_m));
            limits.patch_sigma_tenth_mm = 99;
            limits.cell_sigma_tenth_mm = 290;
            break;
        }
        case 4: {  // variance of the heights, when only the sigma of a cell counts
            const double sigma_m = uniform(0.005, 0.018);
            terrain.variance.fill(static_cast<float>(sigma_m * sigma_m));
            limits.patch_sigma_tenth_mm = 99;
            limits.patch_residual_tenth_mm = 490;
            break;
        }
        case 5: {  // an object beside or in front of the feet
            const double x_m = uniform(0.1, 0.7);
            const double y_m = uniform(0.2, 0.5);
            terrain.box(x_m, x_m + 0.1, y_m, y_m + 0.1, uniform(0.0, 0.08));
            break;
        }
        case 6: terrain.box(uniform(0.6, 0.9), 3.0, -3.0, 3.0, -uniform(0.0, 0.1)); break;
        case 7: {  // a slope, where steps of a decimetre are allowed
            limits.step[0] = {true, 1000, 1000};
            limits.swing_clearance_tenth_mm = 1000;
            limits.drop_tenth_mm = 990;
            const double slope = std::tan(uniform(0.0, 12.0) * std::numbers::pi / 180.0);
            for (int v = 0; v < terrain.geometry.ny; ++v)
                for (int u = 0; u < terrain.geometry.nx; ++u)
                    terrain.height.at(u, v) =
                        static_cast<float>(slope * terrain.geometry.center_m({u, v}).x());
            break;
        }
        case 8: terrain.box(0.35, 3.0, -3.0, 3.0, uniform(-0.04, 0.04)); break;
        case 9: one.used_ns = kNowNs + static_cast<std::int64_t>(uniform(0.0, 600.0)) * kMs; break;
        case 10: {  // old frames, old poses, poses with future stamps
            const auto age_ns = static_cast<std::int64_t>(uniform(0.0, 500.0) * 1e6);
            if (rng.uniform() < 0.3) {
                terrain.input.frame_time_ns = kNowNs - age_ns;
            } else if (rng.uniform() < 0.5) {
                terrain.input.pose_time_ns = kNowNs - age_ns;
            } else {
                terrain.input.pose_time_ns = kNowNs + age_ns / 40;
            }
            break;
        }
        case 11: {  // ground that an operator attests
            attested_m = uniform(0.6, 1.9);
            terrain.box(-0.6, 0.6, -0.6, 0.6, static_cast<double>(kNanF));
            break;
        }
        case 12: evidence = uniform(1.0, 255.0); break;
        default: {  // stairs, up or down
            one.machine = gate::testing::stair_rex();
            const bool up = rng.uniform() < 0.5;
            command = up ? kForward : kBackward;
            const double way = up ? 1.0 : -1.0;
            const double near_m = up ? uniform(0.28, 0.36) : uniform(0.12, 0.19);
            const double far_m = near_m + uniform(0.3, 0.5);
            const double rise_m = way * (rng.uniform() < 0.5 ? 0.15 : uniform(0.08, 0.27));
            terrain.drift.fill(0.001F);
            const auto level = [&](double from_m, double to_m, double z_m) {
                terrain.box(std::min(way * from_m, way * to_m),
                            std::max(way * from_m, way * to_m),
                            -3.0,
                            3.0,
                            z_m);
            };
            level(near_m, far_m, rise_m);
            level(far_m, 3.0, 2.0 * rise_m);
        }
    }
    one.map = terrain.snapshot();
    if (evidence > 0.0) {  // rays that passed below the floor
        one.map->drop_evidence[gate::testing::cell_at(*one.map, 0.7, 0.18)] =
            static_cast<std::uint8_t>(evidence);
        grid::seal(*one.map);
    }
    one.query = gate::query_at_body(command, *one.map);
    if (attested_m > 0.0) {
        one.query.attested.active = true;
        one.query.attested.radius_tenth_mm = static_cast<std::int32_t>(attested_m * 1e4);
    }
    return one;
}

/// Verdict with the limit at `value`, or at the nearest value that a valid machine may have.
gate::Verdict ask(const Case& one, const SetLimit& set, double value, double rated) {
    Machine machine = one.machine;
    constexpr int kTries = 8;
    for (int i = 0; i < kTries; ++i) {
        set(machine.limits, value);
        if (machine.problem() == nullptr) break;
        value = 0.5 * (value + rated);
    }
    return gate::decide(machine, one.query, *one.map, gate::testing::kReady, kNowNs);
}

/// An object as high as the swing clearance counts as ground that a foot may step on, and its edge
/// counts as a drop.
bool is_edge_of_new_ground(const io::RatedLimit& limit, const gate::Verdict& verdict) {
    return std::string(limit.key) == "limits.swing_clearance_m" &&
           verdict.primary == gate::Reason::drop_off;
}

TEST(RatedLimits, TheTableSaysInWhichDirectionTheGateAllowsMore) {
    constexpr std::uint64_t kFirstSeed = 39'001;
    constexpr std::uint64_t kCases = 1200;
    const auto by_key = setters();
    std::map<std::string, int> more;
    for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kCases; ++seed) {
        const Case one = random_case(seed);
        for (const io::RatedLimit& limit : io::rated_limits()) {
            ASSERT_TRUE(by_key.contains(limit.key)) << limit.key;
            const SetLimit& set = by_key.at(limit.key);
            const bool whole = std::string(limit.key).ends_with("independent_cells");
            const double apart = whole ? 2.0 : 0.4 * limit.rated;
            const double laxer = limit.rated + (limit.larger_allows_more ? apart : -apart);
            const double stricter = limit.rated - (limit.larger_allows_more ? apart : -apart);
            const gate::Verdict at_laxer = ask(one, set, laxer, limit.rated);
            const bool lax = at_laxer.allows_step(one.used_ns);
            const bool strict = ask(one, set, stricter, limit.rated).allows_step(one.used_ns);
            EXPECT_TRUE(lax || !strict || is_edge_of_new_ground(limit, at_laxer))
                << limit.key << ": case " << seed << " is allowed at " << stricter << ", not at "
                << laxer;
            more[limit.key] += lax && !strict ? 1 : 0;
        }
    }
    for (const io::RatedLimit& limit : io::rated_limits())
        EXPECT_GT(more[limit.key], 0) << limit.key << " decides no case";
}

}  // namespace
}  // namespace surefoot

// SPDX-License-Identifier: Apache-2.0
// Properties that hold on any map: less evidence never helps, equal bytes give equal verdicts,
// nothing allocates, nothing crashes.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <set>

#include "surefoot/core/allocations_testing.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

/// A floor with noise and, at times, objects on it.
std::unique_ptr<grid::MapSnapshot> random_map(Rng& rng) {
    Terrain terrain;
    const double tilt_x = rng.uniform(-0.03, 0.03);
    for (int v = 0; v < 240; ++v) {
        for (int u = 0; u < 240; ++u)
            terrain.height.at(u, v) = static_cast<float>(
                tilt_x * terrain.geometry.center_m({u, v}).x() + 0.002 * rng.normal());
    }
    const auto things = rng.below(4);
    for (std::uint64_t i = 0; i < things; ++i) {
        const double x = rng.uniform(-1.0, 1.2);
        const double y = rng.uniform(-1.0, 1.0);
        const double kind = rng.uniform();
        const double value = kind < 0.4   ? rng.uniform(0.03, 0.8)
                             : kind < 0.8 ? rng.uniform(-0.5, -0.03)
                                          : static_cast<double>(kNanF);
        terrain.box(x, x + rng.uniform(0.03, 0.4), y, y + rng.uniform(0.03, 0.4), value);
    }
    return terrain.snapshot();
}

std::uint8_t random_command(Rng& rng) {
    return static_cast<std::uint8_t>(1 + rng.below(26));
}

/// Removes evidence from one cell near the machine, in one of several ways.
const char* worsen(grid::MapSnapshot& map, Rng& rng) {
    const std::size_t at = cell_at(map, rng.uniform(-0.7, 0.9), rng.uniform(-0.6, 0.6));
    const auto raise = [&rng](std::uint16_t value) {
        return static_cast<std::uint16_t>(std::min<std::uint64_t>(0xffff, value + rng.below(400)));
    };
    switch (rng.below(7)) {
        case 0: map.source[at] = grid::EvidenceSource::unknown; return "knowledge removed";
        case 1:
            map.height_tenth_mm[at] = grid::MapSnapshot::kUnknownHeight;
            return "height removed";
        case 2: map.sigma_tenth_mm[at] = raise(map.sigma_tenth_mm[at]); return "sigma added";
        case 3: map.drift_tenth_mm[at] = raise(map.drift_tenth_mm[at]); return "drift added";
        case 4:
            map.clearance_tenth_mm[at] = static_cast<std::uint16_t>(map.clearance_tenth_mm[at] / 2);
            return "clearance lowered";
        case 5:
            map.drop_evidence[at] = static_cast<std::uint8_t>(
                std::min<std::uint64_t>(255, map.drop_evidence[at] + rng.below(256)));
            return "drop evidence added";
        default:
            // Adds an obstacle to known ground only; filling a hole would be another test.
            if (map.source[at] == grid::EvidenceSource::measured &&
                map.height_tenth_mm[at] > -400 && map.drop_evidence[at] == 0)
                map.height_tenth_mm[at] += 3000;
            return "obstacle added";
    }
}

TEST(GateProperty, less_evidence_never_turns_a_refusal_into_ok) {
    Rng rng(2024);
    const Machine machine = rex();
    int refused = 0;
    int allowed = 0;
    for (int round = 0; round < 250; ++round) {
        const auto map = random_map(rng);
        const Query query = query_at_body(random_command(rng), *map);
        Verdict before = decide(machine, query, *map, kReady, kNowNs);
        for (int flip = 0; flip < 6; ++flip) {
            const char* what = worsen(*map, rng);
            seal(*map);
            const Verdict after = decide(machine, query, *map, kReady, kNowNs);
            if (before.decision != Decision::ok) {
                ASSERT_NE(after.decision, Decision::ok)
                    << "round " << round << ": " << what << " turned " << words(before);
                ++refused;
            } else {
                ++allowed;
            }
            before = after;
        }
    }
    // The rounds must produce both results, or they prove nothing.
    EXPECT_GT(refused, 500);
    EXPECT_GT(allowed, 125);
}

TEST(GateProperty, ok_means_that_an_independent_look_finds_nothing) {
    Rng rng(99);
    const Machine machine = rex();
    int allowed = 0;
    for (int round = 0; round < 250; ++round) {
        const auto map = random_map(rng);
        const Query query = query_at_body(random_command(rng), *map);
        const Verdict verdict = decide(machine, query, *map, kReady, kNowNs);
        if (verdict.decision != Decision::ok) continue;
        ++allowed;
        // Plain floating-point oracle over points of both landing feet and the drop band.
        const Movement& movement = machine.movements[query.command];
        for (const GroundBox* box : {&machine.left_foot, &machine.right_foot}) {
            for (double u = -0.28; u <= 0.28; u += 0.01) {
                for (double v = -0.19; v <= 0.19; v += 0.01) {
                    const double bx = box->center_x_tenth_mm * 1e-4 + u;
                    const double by = box->center_y_tenth_mm * 1e-4 + v;
                    const double x = movement.forward_tenth_mm * 1e-4 + movement.cos_turn * bx -
                                     movement.sin_turn * by;
                    const double y = movement.left_tenth_mm * 1e-4 + movement.sin_turn * bx +
                                     movement.cos_turn * by;
                    const std::size_t at = cell_at(*map, x, y);
                    const bool under = std::abs(u) < 0.182 && std::abs(v) < 0.094;
                    ASSERT_EQ(map->source[at], grid::EvidenceSource::measured)
                        << "round " << round << " " << x << " " << y;
                    ASSERT_GT(map->height_tenth_mm[at], -800) << "round " << round;
                    if (under) {
                        ASSERT_LT(map->height_tenth_mm[at], 800) << "round " << round;
                    }
                }
            }
        }
    }
    EXPECT_GT(allowed, 40);
}

TEST(GateProperty, equal_bytes_give_equal_verdicts_wherever_they_lie) {
    Rng rng(5);
    const Machine machine = rex();
    const auto copy = std::make_unique<grid::MapSnapshot>();
    for (int round = 0; round < 50; ++round) {
        const auto map = random_map(rng);
        std::memcpy(static_cast<void*>(copy.get()), map.get(), sizeof(*copy));
        const Query query = query_at_body(random_command(rng), *map);
        const Verdict a = decide(machine, query, *map, kReady, kNowNs);
        const Verdict b = decide(machine, query, *copy, kReady, kNowNs);
        EXPECT_EQ(a.decision, b.decision);
        EXPECT_EQ(a.reasons, b.reasons);
        EXPECT_EQ(a.evidence.worst_x_tenth_mm, b.evidence.worst_x_tenth_mm);
        EXPECT_EQ(a.evidence.value_tenth_mm, b.evidence.value_tenth_mm);
        EXPECT_EQ(a.evidence.max_tilt_tan_sq, b.evidence.max_tilt_tan_sq);
        EXPECT_EQ(a.evidence.max_patch_sigma_sq_tenth_mm2, b.evidence.max_patch_sigma_sq_tenth_mm2);
    }
}

TEST(GateProperty, a_shift_of_the_whole_world_by_cells_changes_nothing) {
    Rng rng(8);
    const Machine machine = rex();
    for (int round = 0; round < 50; ++round) {
        const auto map = random_map(rng);
        Query query = query_at_body(random_command(rng), *map);
        const Verdict here = decide(machine, query, *map, kReady, kNowNs);
        const std::int64_t shift =
            250 * (static_cast<std::int64_t>(rng.below(2'000'000)) - 1'000'000);
        map->origin_x_tenth_mm += shift;
        map->origin_y_tenth_mm -= shift;
        query.x_tenth_mm += shift;
        query.y_tenth_mm -= shift;
        seal(*map);
        const Verdict there = decide(machine, query, *map, kReady, kNowNs);
        EXPECT_EQ(here.reasons, there.reasons) << words(here) << " / " << words(there);
        EXPECT_EQ(here.evidence.max_tilt_tan_sq, there.evidence.max_tilt_tan_sq);
    }
}

TEST(GateProperty, decide_allocates_nothing) {
    Rng rng(4);
    const Machine machine = rex();
    const auto map = random_map(rng);
    for (int code = 0; code < 30; ++code) {
        Query query = query_at_body(static_cast<std::uint8_t>(code), *map);
        query.attested = {true, 0, 0, 8000, 0};
        const std::int64_t before = heap::allocations;
        const Verdict verdict = decide(machine, query, *map, kReady, kNowNs);
        EXPECT_EQ(heap::allocations, before) << words(verdict);
    }
}

/// Random bytes in every layer, random header, query and machine: no crash, and no OK by chance.
TEST(GateProperty, random_bytes_never_crash_and_never_pass) {
    Rng rng(77);
    const auto map = std::make_unique<grid::MapSnapshot>();
    const auto scramble = [&rng](auto& layer) {
        auto* words_of_layer = reinterpret_cast<unsigned char*>(layer.data());
        for (std::size_t i = 0; i + 8 <= sizeof(layer); i += 8) {
            const std::uint64_t word = rng.next_u64();
            std::memcpy(words_of_layer + i, &word, sizeof(word));
        }
    };
    const auto any = [&rng](std::int64_t reach) {
        return static_cast<std::int64_t>(rng.next_u64() >> rng.below(64)) % reach;
    };
    for (int round = 0; round < 300; ++round) {
        scramble(map->height_tenth_mm);
        scramble(map->sigma_tenth_mm);
        scramble(map->drift_tenth_mm);
        scramble(map->component);
        scramble(map->drop_evidence);
        if (round % 2 == 0)
            map->source.fill(grid::EvidenceSource::measured);
        else
            scramble(map->source);
        map->nx = static_cast<std::int32_t>(1 + rng.below(256));
        map->ny = static_cast<std::int32_t>(1 + rng.below(256));
        map->resolution_tenth_mm = static_cast<std::int32_t>(50 + rng.below(1951));
        map->origin_x_tenth_mm = any(1'000'000'000);
        map->origin_y_tenth_mm = any(1'000'000'000);
        map->gravity_source = grid::GravitySource::imu;
        map->tilt_sigma_urad = 0;
        map->health = grid::SnapshotHealth::ok;
        map->camera = CameraState::ok;
        map->frame_time_ns = map->pose_time_ns = kNowNs;
        seal(*map);
        ASSERT_TRUE(grid::is_intact(*map));
        for (int i = 0; i < 4; ++i) {
            Machine machine = rex();
            if (i == 3) {  // an absurd but legal machine
                machine.left_foot = {static_cast<std::int32_t>(any(100'000)),
                                     static_cast<std::int32_t>(any(100'000)),
                                     8000,
                                     8000};
                machine.body.parts[0].box = {0, 0, 20'000, 20'000};
            }
            const double yaw = rng.uniform(-4.0, 4.0);
            Query query = make_query(random_command(rng), 0.0, 0.0, std::cos(yaw), std::sin(yaw));
            query.x_tenth_mm = i == 0 ? any(1'000'000'000) : map->origin_x_tenth_mm + any(70'000);
            query.y_tenth_mm = i == 0 ? any(1'000'000'000) : map->origin_y_tenth_mm + any(70'000);
            query.attested = {rng.below(2) == 0,
                              query.x_tenth_mm,
                              query.y_tenth_mm,
                              static_cast<std::int32_t>(1 + rng.below(10'000)),
                              0};
            const Verdict verdict = decide(machine, query, *map, kReady, kNowNs);
            EXPECT_NE(verdict.decision, Decision::ok) << "round " << round;
        }
    }
}

/// Not a benchmark: a guard against a rule that becomes a hundred times slower.
TEST(GateProperty, a_decision_takes_less_than_a_few_milliseconds) {
    Terrain floor;
    const auto map = floor.snapshot();
    const Machine machine = rex();
    double best_us = 1e9;
    double worst_of_movements_us = 0.0;
    for (int code = 1; code < Machine::kMovementCodes; ++code) {
        best_us = 1e9;
        for (int i = 0; i < 20; ++i) {
            const auto start = std::chrono::steady_clock::now();
            const Verdict verdict = decide(machine,
                                           query_at_body(static_cast<std::uint8_t>(code), *map),
                                           *map,
                                           kReady,
                                           kNowNs);
            const std::chrono::duration<double, std::micro> took =
                std::chrono::steady_clock::now() - start;
            EXPECT_EQ(verdict.decision, Decision::ok);
            best_us = std::min(best_us, took.count());
        }
        worst_of_movements_us = std::max(worst_of_movements_us, best_us);
    }
    std::printf("decide(): %.0f us for the slowest movement\n", worst_of_movements_us);
    EXPECT_LT(worst_of_movements_us, 5000.0);  // generous: sanitizers and busy machines
}

}  // namespace
}  // namespace surefoot::gate::testing

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/snapshot_builder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::grid {
namespace {

/// Layers of a map, and the snapshot input that refers to them.
struct TestMap {
    GridGeometry geometry;
    Layer height, variance, drift;
    std::unique_ptr<MapSnapshot> out = std::make_unique<MapSnapshot>();

    TestMap(int nx, int ny, double res_m = 0.025)
        : geometry{res_m, nx, ny, {0.0, 0.0}},
          height(nx, ny, 0.0F),
          variance(nx, ny, 1e-6F),
          drift(nx, ny, 0.001F) {}

    /// One character a cell, first row = smallest y: '?' unknown, a digit = tenths of a metre.
    explicit TestMap(const std::vector<std::string>& rows)
        : TestMap(static_cast<int>(rows.front().size()), static_cast<int>(rows.size())) {
        for (int v = 0; v < geometry.ny; ++v) {
            for (int u = 0; u < geometry.nx; ++u) {
                const char c = rows[static_cast<std::size_t>(v)][static_cast<std::size_t>(u)];
                height.at(u, v) = c == '?' ? kNanF : static_cast<float>(c - '0') * 0.1F;
            }
        }
    }
    [[nodiscard]] SnapshotInput input() const {
        SnapshotInput in;
        in.geometry = geometry;
        in.height_m = height.view();
        in.variance_m2 = variance.view();
        in.drift_m = drift.view();
        in.version = 17;
        return in;
    }
    const MapSnapshot& build() {
        const Status status = build_snapshot(input(), *out);
        EXPECT_TRUE(status.ok()) << (status.ok() ? "" : status.error().message);
        return *out;
    }
};

TEST(MapSnapshot, checksum_sees_every_field_and_any_single_bit) {
    TestMap map(64, 64);
    MapSnapshot& s = const_cast<MapSnapshot&>(map.build());
    ASSERT_TRUE(is_intact(s));
    Rng rng(5);
    // For every byte except implicit padding: flip one bit, expect detection, flip it back.
    const auto flip_everywhere = [&](void* field, std::size_t size, int tries, const char* name) {
        auto* bytes = static_cast<unsigned char*>(field);
        for (int i = 0; i < tries; ++i) {
            const auto at = static_cast<std::size_t>(rng.below(size));
            const auto bit = static_cast<unsigned char>(1U << rng.below(8));
            bytes[at] ^= bit;
            EXPECT_FALSE(is_intact(s)) << name << " byte " << at;
            bytes[at] ^= bit;
        }
    };
    flip_everywhere(&s.version, sizeof(s.version), 10, "version");
    flip_everywhere(&s.frame_time_ns, sizeof(s.frame_time_ns), 10, "frame time");
    flip_everywhere(&s.origin_x_tenth_mm, sizeof(s.origin_x_tenth_mm), 10, "origin");
    flip_everywhere(&s.body_cos_yaw, sizeof(s.body_cos_yaw), 10, "cosine");
    flip_everywhere(&s.gravity_source, 1, 4, "gravity");
    flip_everywhere(&s.health, 1, 4, "health");
    flip_everywhere(&s.tilt_sigma_urad, sizeof(s.tilt_sigma_urad), 10, "tilt");
    flip_everywhere(&s.camera, 1, 4, "camera");
    flip_everywhere(s.height_tenth_mm.data(), sizeof(s.height_tenth_mm), 60, "height");
    flip_everywhere(s.sigma_tenth_mm.data(), sizeof(s.sigma_tenth_mm), 60, "sigma");
    flip_everywhere(s.drift_tenth_mm.data(), sizeof(s.drift_tenth_mm), 60, "drift");
    flip_everywhere(s.clearance_tenth_mm.data(), sizeof(s.clearance_tenth_mm), 60, "clearance");
    flip_everywhere(s.component.data(), sizeof(s.component), 60, "component");
    flip_everywhere(s.drop_evidence.data(), sizeof(s.drop_evidence), 60, "drop evidence");
    flip_everywhere(s.source.data(), sizeof(s.source), 60, "source");
    flip_everywhere(&s.edge_count, sizeof(s.edge_count), 10, "edge count");
    flip_everywhere(s.edges.data(), sizeof(s.edges), 60, "edges");
    flip_everywhere(s.block_checksum.data(), sizeof(s.block_checksum), 60, "block checksums");
    EXPECT_TRUE(is_intact(s));
}

TEST(MapSnapshot, a_default_or_senseless_one_is_not_intact_even_with_its_checksum) {
    const auto s = std::make_unique<MapSnapshot>();
    const auto sealed = [&s] {
        seal(*s);
        return is_intact(*s);
    };
    EXPECT_FALSE(is_intact(*s));
    EXPECT_FALSE(sealed()) << "no cells";
    s->nx = s->ny = 10;
    s->resolution_tenth_mm = 250;
    EXPECT_TRUE(sealed());
    s->nx = MapSnapshot::kMaxSide + 1;
    EXPECT_FALSE(sealed()) << "more cells than fit";
    s->nx = 10;
    s->resolution_tenth_mm = 0;
    EXPECT_FALSE(sealed()) << "no resolution";
    s->resolution_tenth_mm = 250;
    s->body_cos_yaw = std::nan("");
    EXPECT_FALSE(sealed()) << "NaN pose";
    s->body_cos_yaw = 1.0;
    s->edge_count = MapSnapshot::kMaxEdges + 1;
    EXPECT_FALSE(sealed()) << "more edges than fit";
    s->edge_count = -1;
    EXPECT_FALSE(sealed()) << "fewer edges than none";
    s->edge_count = MapSnapshot::kMaxEdges;
    EXPECT_TRUE(sealed());
    s->edge_count = 0;
    s->magic ^= 1U;
    EXPECT_FALSE(sealed()) << "magic";
}

TEST(MapSnapshot, padding_bytes_do_not_count) {
    TestMap map(8, 8);
    const MapSnapshot& a = map.build();
    const auto b = std::make_unique<MapSnapshot>();
    std::memset(static_cast<void*>(b.get()), 0xAB, sizeof(MapSnapshot));
    ASSERT_TRUE(build_snapshot(map.input(), *b).ok());
    EXPECT_EQ(a.checksum, b->checksum);
    EXPECT_TRUE(is_intact(*b));
}

TEST(SnapshotBuilder, rounds_against_the_cell_and_keeps_unknown_unknown) {
    TestMap map({"00000000"});
    map.height.at(1, 0) = 0.12346F;
    map.height.at(2, 0) = kNanF;
    map.height.at(3, 0) = std::numeric_limits<float>::infinity();
    map.variance.at(0, 0) = 4.0001e-6F;  // 2.00002 mm
    map.variance.at(4, 0) = kNanF;
    map.variance.at(5, 0) = -1.0F;
    map.variance.at(6, 0) = 100.0F;  // 10 m
    map.drift.at(0, 0) = kNanF;
    Layer clearance(8, 1, kNanF);
    clearance.at(0, 0) = 1.23456F;
    clearance.at(1, 0) = -0.5F;
    clearance.at(4, 0) = 50.0F;
    SnapshotInput input = map.input();
    input.clearance_m = std::as_const(clearance).view();
    ASSERT_TRUE(build_snapshot(input, *map.out).ok());
    const MapSnapshot& s = *map.out;
    EXPECT_EQ(s.height_tenth_mm[1], 1235);
    for (const std::size_t at : {2U, 3U}) {
        EXPECT_EQ(s.height_tenth_mm[at], MapSnapshot::kUnknownHeight);
        EXPECT_EQ(s.source[at], EvidenceSource::unknown);
        EXPECT_EQ(s.component[at], MapSnapshot::kNoComponent);
        EXPECT_EQ(s.sigma_tenth_mm[at], 0xffff);
    }
    EXPECT_EQ(s.sigma_tenth_mm[0], 21);
    EXPECT_EQ(s.sigma_tenth_mm[4], 0xffff) << "NaN variance";
    EXPECT_EQ(s.sigma_tenth_mm[5], 0xffff) << "negative variance";
    EXPECT_EQ(s.sigma_tenth_mm[6], 0xffff) << "beyond the range";
    EXPECT_EQ(s.drift_tenth_mm[0], 0xffff) << "NaN drift";
    EXPECT_EQ(s.clearance_tenth_mm[0], 12345);
    EXPECT_EQ(s.clearance_tenth_mm[1], 0) << "negative clearance is no room";
    EXPECT_EQ(s.clearance_tenth_mm[4], MapSnapshot::kNoCeiling);
    EXPECT_EQ(s.clearance_tenth_mm[7], MapSnapshot::kNoCeiling);
}

TEST(SnapshotBuilder, without_a_drift_layer_the_drift_is_unknown) {
    TestMap map(4, 4);
    SnapshotInput input = map.input();
    input.drift_m = {};
    ASSERT_TRUE(build_snapshot(input, *map.out).ok());
    EXPECT_EQ(map.out->drift_tenth_mm[5], 0xffff);
}

TEST(SnapshotBuilder, bad_input_is_a_sentence_and_leaves_nothing_usable) {
    TestMap map(8, 8);
    const auto refuses = [&map](const SnapshotInput& input, const char* what) {
        map.build();
        const Status status = build_snapshot(input, *map.out);
        EXPECT_FALSE(status.ok()) << what;
        EXPECT_FALSE(is_intact(*map.out)) << what;
    };
    SnapshotInput input = map.input();
    input.geometry.nx = 7;
    refuses(input, "layer of another size");
    input = map.input();
    input.geometry.resolution_m = 0.02503;
    refuses(input, "cells of a broken number of tenths");
    input.geometry.resolution_m = std::nan("");
    refuses(input, "NaN resolution");
    input = map.input();
    input.T_odom_body.translation_m.x() = std::nan("");
    refuses(input, "NaN pose");
    input = map.input();
    input.geometry.origin_m.y() = 1e9;
    refuses(input, "origin far away");
    input = map.input();
    input.geometry.nx = 0;
    refuses(input, "no cells");
    for (const double broken :
         {std::nan(""), -0.01, 1e30, std::numeric_limits<double>::infinity()}) {
        for (double SnapshotInput::*length_m : {&SnapshotInput::connect_step_m,
                                                &SnapshotInput::drop_step_m,
                                                &SnapshotInput::drop_reach_m}) {
            input = map.input();
            input.*length_m = broken;
            refuses(input, "a step or a reach that is no length");
        }
    }
}

TEST(SnapshotBuilder, crops_a_large_map_around_the_body) {
    TestMap map(400, 300);
    for (int v = 0; v < 300; ++v) {
        for (int u = 0; u < 400; ++u) map.height.at(u, v) = 0.0001F * static_cast<float>(u);
    }
    SnapshotInput input = map.input();
    const auto origin_cell = [&](double x_m, double y_m) {
        input.T_odom_body.translation_m = {x_m, y_m, 0.99};
        EXPECT_TRUE(build_snapshot(input, *map.out).ok());
        EXPECT_EQ(map.out->nx, 256);
        EXPECT_EQ(map.out->ny, 256);
        EXPECT_EQ(map.out->height_tenth_mm[0], map.out->origin_x_tenth_mm / 250) << "same cells";
        return std::pair{map.out->origin_x_tenth_mm / 250, map.out->origin_y_tenth_mm / 250};
    };
    EXPECT_EQ(origin_cell(5.0, 3.75), (std::pair<std::int64_t, std::int64_t>{72, 22}));
    EXPECT_EQ(origin_cell(0.0, 0.0), (std::pair<std::int64_t, std::int64_t>{0, 0}));
    EXPECT_EQ(origin_cell(99.0, 99.0), (std::pair<std::int64_t, std::int64_t>{144, 44}));
}

TEST(SnapshotBuilder, labels_follow_connected_surfaces) {
    TestMap map({"00?00",  //
                 "00?00",  //
                 "0??77",  //
                 "00077"});
    const MapSnapshot& s = map.build();
    const auto label = [&s](int x, int y) {
        return s.component[static_cast<std::size_t>(y * 5 + x)];
    };
    EXPECT_EQ(label(0, 0), 1);
    EXPECT_EQ(label(2, 3), 1) << "around the corner";
    EXPECT_EQ(label(3, 0), 2) << "an island of the same height";
    EXPECT_EQ(label(3, 2), 3) << "a table top";
    EXPECT_EQ(label(2, 0), MapSnapshot::kNoComponent);
}

/// Oracle: lowers labels to the smallest neighbour until nothing changes.
std::vector<int> slow_labels(const MapSnapshot& s, std::int32_t step) {
    const int n = s.nx * s.ny;
    std::vector<int> label(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) label[static_cast<std::size_t>(i)] = i;
    for (bool changed = true; changed;) {
        changed = false;
        for (int i = 0; i < n; ++i) {
            for (const int j : {i + 1, i + s.nx}) {
                if (j >= n || (j == i + 1 && j % s.nx == 0)) continue;
                const auto a = static_cast<std::size_t>(i);
                const auto b = static_cast<std::size_t>(j);
                if (s.source[a] != EvidenceSource::measured ||
                    s.source[b] != EvidenceSource::measured || label[a] == label[b] ||
                    std::abs(s.height_tenth_mm[a] - s.height_tenth_mm[b]) > step)
                    continue;
                label[a] = label[b] = std::min(label[a], label[b]);
                changed = true;
            }
        }
    }
    return label;
}

TEST(SnapshotBuilder, labels_match_the_slow_oracle_on_random_maps) {
    Rng rng(21);
    for (int round = 0; round < 60; ++round) {
        TestMap map(23, 19);
        for (int v = 0; v < 19; ++v) {
            for (int u = 0; u < 23; ++u)
                map.height.at(u, v) =
                    rng.uniform() < 0.25 ? kNanF : static_cast<float>(rng.uniform(0.0, 0.12));
        }
        const MapSnapshot& s = map.build();
        const std::vector<int> slow = slow_labels(s, 500);
        std::map<int, int> fast_of_slow;
        std::map<int, int> slow_of_fast;
        for (std::size_t i = 0; i < slow.size(); ++i) {
            if (s.source[i] != EvidenceSource::measured) continue;
            const int fast = s.component[i];
            EXPECT_EQ(fast_of_slow.emplace(slow[i], fast).first->second, fast) << "round " << round;
            EXPECT_EQ(slow_of_fast.emplace(fast, slow[i]).first->second, slow[i])
                << "round " << round;
        }
    }
}

TEST(SnapshotBuilder, a_full_map_is_one_surface_and_a_checkerboard_is_many) {
    TestMap flat(256, 256);
    const MapSnapshot& s = flat.build();
    EXPECT_EQ(s.component.front(), 1);
    EXPECT_EQ(s.component.back(), 1);
    TestMap board(256, 256);
    for (int v = 0; v < 256; ++v) {
        for (int u = 0; u < 256; ++u) board.height.at(u, v) = (u + v) % 2 == 0 ? 0.0F : 1.0F;
    }
    // There are 65535 labels for 65536 surfaces: the last surface gets none, and the gate refuses
    // it. 315 0.5 m down behind 5 occluded cells
    const MapSnapshot& many = board.build();
    EXPECT_EQ(many.component[65534], 65535);
    EXPECT_EQ(many.component[65535], MapSnapshot::kNoComponent);
}

TEST(SnapshotBuilder, a_drop_marks_its_upper_edge_across_a_shadow_only) {
    TestMap map({"555?????0000"});  // 0.5 m down behind 5 cells of shadow
    const MapSnapshot& s = map.build();
    EXPECT_EQ(s.drop_evidence[2], 255) << "upper edge";
    for (const std::size_t at : {0U, 1U, 3U, 7U, 8U, 9U}) EXPECT_EQ(s.drop_evidence[at], 0) << at;
    // Without a measured cell within reach, unknown cells are no drop.
    std::string row(60, '?');
    row[0] = '5';
    row[59] = '0';
    TestMap far({row});
    EXPECT_EQ(far.build().drop_evidence[0], 0);
    // A level floor behind an occluded region is no drop.
    TestMap level({"555???55"});
    for (const std::uint8_t evidence : level.build().drop_evidence) ASSERT_EQ(evidence, 0);
}

TEST(SnapshotBuilder, lines_of_sight_show_drops_whose_ground_was_never_seen) {
    TestMap map({"55????555????55"});
    Layer free_m(15, 1, kNanF);
    free_m.at(2, 0) = 0.48F;
    free_m.at(4, 0) = 0.44F;  // 60 mm below the edges on both sides
    free_m.at(10, 0) = 0.46F;
    free_m.at(1, 0) = -1.0F;  // ignored, because the cell is known
    SnapshotInput input = map.input();
    input.free_above_m = std::as_const(free_m).view();
    ASSERT_TRUE(build_snapshot(input, *map.out).ok());
    for (int ix = 0; ix < 15; ++ix)
        EXPECT_EQ(map.out->drop_evidence[static_cast<std::size_t>(ix)],
                  ix == 1 || ix == 6 ? 255 : 0)
            << ix;
}

TEST(SnapshotBuilder, what_lines_of_sight_left_for_unknown_ground_is_kept_and_is_no_measurement) {
    TestMap map({"5???5"});
    Layer free_m(5, 1, kNanF);
    free_m.at(0, 0) = -1.0F;     // ignored, because the cell is known
    free_m.at(1, 0) = 0.12341F;  // rounded up: the ground lies lower
    free_m.at(3, 0) = 2000.0F;   // too large for a height
    SnapshotInput input = map.input();
    input.free_above_m = std::as_const(free_m).view();
    ASSERT_TRUE(build_snapshot(input, *map.out).ok());
    const MapSnapshot& s = *map.out;
    EXPECT_EQ(s.height_tenth_mm[0], 5000);
    EXPECT_EQ(s.height_tenth_mm[1], 1235);
    EXPECT_EQ(s.height_tenth_mm[2], MapSnapshot::kUnknownHeight);
    EXPECT_EQ(s.height_tenth_mm[3], MapSnapshot::kUnknownHeight);
    for (const std::size_t at : {0U, 4U}) EXPECT_TRUE(s.is_measured(at)) << at;
    for (const std::size_t at : {1U, 2U, 3U}) {
        EXPECT_FALSE(s.is_measured(at)) << at;
        EXPECT_EQ(s.source[at], EvidenceSource::unknown) << at;
        EXPECT_EQ(s.component[at], MapSnapshot::kNoComponent) << at;
    }
}

TEST(SnapshotBuilder, drops_are_found_in_all_four_directions) {
    TestMap map({"00000",  //
                 "05550",  //
                 "05550",  //
                 "05550",  //
                 "00000"});
    const MapSnapshot& s = map.build();
    for (int y = 0; y < 5; ++y) {
        for (int x = 0; x < 5; ++x) {
            const bool rim = x >= 1 && x <= 3 && y >= 1 && y <= 3 && !(x == 2 && y == 2);
            EXPECT_EQ(s.drop_evidence[static_cast<std::size_t>(5 * y + x)], rim ? 255 : 0)
                << x << " " << y;
        }
    }
}

TEST(SnapshotBuilder, ray_evidence_is_kept_on_unknown_cells) {
    TestMap map({"0??0"});
    Layer rays(4, 1, 0.0F);
    rays.at(1, 0) = 0.5F;
    rays.at(2, 0) = kNanF;
    SnapshotInput input = map.input();
    input.drop_evidence = std::as_const(rays).view();
    ASSERT_TRUE(build_snapshot(input, *map.out).ok());
    EXPECT_EQ(map.out->drop_evidence[1], 128);
    EXPECT_EQ(map.out->drop_evidence[2], 255) << "a broken number is no all-clear";
    EXPECT_EQ(map.out->drop_evidence[0], 0);
}

/// An edge along y that begins at (x, -1) and is 2 m long.
SnapshotInput::Edge edge_at(double x_m) {
    return {{x_m, -1.0}, {x_m, 1.0}, 0.1, 0.0, 0.002, 0.003};
}

TEST(SnapshotBuilder, edges_are_kept_from_the_origin_of_the_snapshot_and_sigmas_rounded_up) {
    TestMap map(400, 300);  // larger than a snapshot: the snapshot's origin differs from the map's
    SnapshotInput input = map.input();
    input.T_odom_body.translation_m = {5.0, 3.75, 0.99};
    const SnapshotInput::Edge edges[] = {
        {{5.1, 3.0}, {5.2, 4.5}, 0.18004, -0.02006, 0.00201, 0.00301}};
    input.edges = edges;
    ASSERT_TRUE(build_snapshot(input, *map.out).ok());
    const MapSnapshot& s = *map.out;
    ASSERT_EQ(s.edge_count, 1);
    ASSERT_EQ(s.origin_x_tenth_mm, 72 * 250);
    ASSERT_EQ(s.origin_y_tenth_mm, 22 * 250);
    const SnapshotEdge expected{
        51000 - 18000, 30000 - 5500, 52000 - 18000, 45000 - 5500, 1800, -201, 21, 31};
    EXPECT_EQ(s.edges[0], expected);
    EXPECT_EQ(s.edges[1], SnapshotEdge{});
    EXPECT_TRUE(is_intact(s));
}

TEST(SnapshotBuilder, the_nearest_edges_come_first_and_no_more_than_fit) {
    TestMap map(8, 8);
    constexpr std::size_t kMany = MapSnapshot::kMaxEdges + 40;
    std::vector<SnapshotInput::Edge> edges;
    // Shuffles the edges: 79 and the number of edges have no common divisor.
    for (std::size_t i = 0; i < kMany; ++i)
        edges.push_back(edge_at(0.01 * static_cast<double>(79 * i % kMany + 1)));
    SnapshotInput input = map.input();
    input.edges = edges;
    ASSERT_TRUE(build_snapshot(input, *map.out).ok());
    ASSERT_EQ(map.out->edge_count, MapSnapshot::kMaxEdges);
    for (std::size_t i = 0; i < MapSnapshot::kMaxEdges; ++i)
        ASSERT_EQ(map.out->edges[i].from_x_tenth_mm, 100 * static_cast<int>(i + 1)) << i;
    EXPECT_TRUE(is_intact(*map.out));
    // The distance is that of the nearest point on the edge, not of its ends or its middle.
    const SnapshotInput::Edge two[] = {edge_at(0.3), {{0.2, -0.1}, {0.2, 9.0}, 0.1, 0.0, 0.0, 0.0}};
    input.edges = two;
    ASSERT_TRUE(build_snapshot(input, *map.out).ok());
    ASSERT_EQ(map.out->edge_count, 2);
    EXPECT_EQ(map.out->edges[0].to_y_tenth_mm, 90000);
    EXPECT_EQ(map.out->edges[2], SnapshotEdge{}) << "of the snapshot before";
    EXPECT_TRUE(is_intact(*map.out));
}

TEST(SnapshotBuilder, edges_with_broken_numbers_are_left_out) {
    TestMap map(8, 8);
    const double nan = std::nan("");
    std::vector<SnapshotInput::Edge> edges;
    const auto broken = [&edges](auto change) {
        edges.push_back(edge_at(0.1));
        change(edges.back());
    };
    using Edge = SnapshotInput::Edge;
    broken([&](Edge& e) { e.from_m.x() = nan; });
    broken([&](Edge& e) { e.to_m.y() = 1e9; });
    broken([&](Edge& e) { e.upper_m = nan; });
    broken([&](Edge& e) { e.lower_m = -2000.0; });
    broken([&](Edge& e) { e.height_sigma_m = nan; });
    broken([&](Edge& e) { e.height_sigma_m = -0.001; });
    broken([&](Edge& e) { e.across_sigma_m = std::numeric_limits<double>::infinity(); });
    edges.push_back(edge_at(0.2));
    SnapshotInput input = map.input();
    input.edges = edges;
    ASSERT_TRUE(build_snapshot(input, *map.out).ok());
    ASSERT_EQ(map.out->edge_count, 1);
    EXPECT_EQ(map.out->edges[0].from_x_tenth_mm, 2000);
    EXPECT_TRUE(is_intact(*map.out));
}

TEST(SnapshotBuilder, a_hidden_cell_is_unknown_and_joins_no_surface) {
    const TestMap map(5, 3);
    Image<std::uint8_t> hidden(5, 3, 0);
    for (int v = 0; v < 3; ++v) hidden.at(2, v) = 1;
    SnapshotInput in = map.input();
    in.hidden = hidden.view();
    ASSERT_TRUE(build_snapshot(in, *map.out));
    for (int v = 0; v < 3; ++v) {
        const auto row = static_cast<std::size_t>(5 * v);
        EXPECT_TRUE(map.out->is_measured(row + 1));
        EXPECT_FALSE(map.out->is_measured(row + 2));
        EXPECT_EQ(map.out->height_tenth_mm[row + 2], MapSnapshot::kUnknownHeight);
        EXPECT_NE(map.out->component[row + 1], map.out->component[row + 3]);
    }
    const Image<std::uint8_t> small(4, 3, 0);
    in.hidden = small.view();
    EXPECT_FALSE(build_snapshot(in, *map.out));
}

}  // namespace
}  // namespace surefoot::grid

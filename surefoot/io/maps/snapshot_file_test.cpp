// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/maps/snapshot_file.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

using grid::MapSnapshot;
using testing::contains;

std::unique_ptr<MapSnapshot> random_snapshot(int nx, int ny, std::uint64_t seed) {
    Rng rng(seed);
    auto s = std::make_unique<MapSnapshot>();
    s->version = rng.next_u64();
    s->config_hash = rng.next_u64();
    s->frame_time_ns = static_cast<std::int64_t>(rng.next_u64());
    s->pose_time_ns = static_cast<std::int64_t>(rng.next_u64());
    s->resolution_tenth_mm = 250;
    s->nx = nx;
    s->ny = ny;
    s->origin_x_tenth_mm = -30000;
    s->body_z_tenth_mm = 1234;
    s->body_cos_yaw = 0.6;
    s->body_sin_yaw = -0.8;
    s->gravity_source = grid::GravitySource::imu;
    s->tilt_sigma_urad = 34567;
    s->health = grid::SnapshotHealth::degraded;
    s->camera = CameraState::frozen;
    for (std::size_t i = 0; i < static_cast<std::size_t>(nx * ny); ++i) {
        s->height_tenth_mm[i] = static_cast<std::int32_t>(rng.next_u64());
        s->sigma_tenth_mm[i] = static_cast<std::uint16_t>(rng.next_u64());
        s->drift_tenth_mm[i] = static_cast<std::uint16_t>(rng.next_u64());
        s->clearance_tenth_mm[i] = static_cast<std::uint16_t>(rng.next_u64());
        s->component[i] = static_cast<std::uint16_t>(rng.next_u64());
        s->drop_evidence[i] = static_cast<std::uint8_t>(rng.next_u64());
        s->source[i] = static_cast<grid::EvidenceSource>(rng.below(3));
    }
    s->edge_count = 3;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto any = [&rng] { return static_cast<std::int32_t>(rng.next_u64()); };
        s->edges[i] = {any(), any(), any(), any(), any(), any(), any(), any()};
    }
    grid::seal(*s);
    return s;
}

template <typename T>
std::string message(const Result<T>& result) {
    return result.ok() ? "accepted" : result.error().message;
}

TEST(SnapshotFile, RoundTripsEveryFieldAndIsSmall) {
    const testing::TemporaryFolder folder;
    const auto original = random_snapshot(13, 7, 1);
    ASSERT_TRUE(write_snapshot(folder / "map.snapshot", *original).ok());
    EXPECT_LT(read_file(folder / "map.snapshot")->size(), 13U * 7U * 14U + 3U * 32U + 200U);
    const auto copy = read_snapshot(folder / "map.snapshot");
    ASSERT_TRUE(copy.ok()) << message(copy);
    EXPECT_TRUE(grid::is_intact(**copy));
    // The checksum covers every field and layer.
    EXPECT_EQ((*copy)->checksum, original->checksum);
    EXPECT_EQ((*copy)->height_tenth_mm, original->height_tenth_mm);
    EXPECT_EQ((*copy)->source, original->source);
    EXPECT_EQ((*copy)->version, original->version);
    EXPECT_EQ((*copy)->body_sin_yaw, original->body_sin_yaw);
    EXPECT_EQ((*copy)->health, original->health);
    EXPECT_EQ((*copy)->camera, CameraState::frozen);
    EXPECT_EQ((*copy)->edge_count, 3);
    EXPECT_EQ((*copy)->edges, original->edges);
}

/// Seed for the fuzzer. A search that begins with a refused file would not get past the checks of
/// the header. After a change of the layout, SUREFOOT_WRITE_SEEDS=1 io_test
/// --gtest_filter='SnapshotFile.*' writes the seed again.
TEST(SnapshotFile, TheFuzzerBeginsWithAFileOfThisLayout) {
    const std::string folder = SUREFOOT_SOURCE_DIR "/fuzz/seeds/fuzz_snapshot";
    if (std::getenv("SUREFOOT_WRITE_SEEDS") != nullptr) {
        ASSERT_TRUE(write_snapshot(folder + "/small.snapshot", *random_snapshot(3, 2, 1)).ok());
    }
    int seeds = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const auto snapshot = read_snapshot(entry.path().string());
        EXPECT_TRUE(snapshot.ok()) << message(snapshot);
        ++seeds;
    }
    EXPECT_GT(seeds, 0);
}

TEST(SnapshotFile, WhatLiesBeyondTheUsedCellsIsNotStored) {
    const auto original = random_snapshot(4, 4, 2);
    original->height_tenth_mm[5000] = 77;
    original->edges[100].upper_tenth_mm = 88;
    grid::seal(*original);
    const auto copy = parse_snapshot(*format_snapshot(*original), "map.snapshot");
    ASSERT_TRUE(copy.ok()) << message(copy);
    EXPECT_EQ((*copy)->height_tenth_mm[5000], 0);
    EXPECT_EQ((*copy)->height_tenth_mm[15], original->height_tenth_mm[15]);
    EXPECT_EQ((*copy)->edges[100], grid::SnapshotEdge{});
    EXPECT_EQ((*copy)->edges[2], original->edges[2]);
}

TEST(SnapshotFile, EveryBitErrorAndTruncationIsFound) {
    const std::string bytes = *format_snapshot(*random_snapshot(2, 2, 3));
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        std::string damaged = bytes;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
        ASSERT_FALSE(parse_snapshot(damaged, "damaged").ok()) << "bit " << bit;
    }
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        ASSERT_FALSE(parse_snapshot(std::string_view(bytes).substr(0, size), "cut").ok()) << size;
    }
    EXPECT_TRUE(contains(message(parse_snapshot(bytes + "x", "map.snapshot")), "too long a map"));
    EXPECT_TRUE(contains(message(parse_snapshot("", "map.snapshot")), "not a map snapshot"));
    EXPECT_TRUE(contains(message(parse_snapshot(bytes.substr(0, bytes.size() - 9), "map.snapshot")),
                         "map.snapshot: truncated map snapshot"));
}

TEST(SnapshotFile, AnImpossibleNumberOfEdgesIsASentence) {
    const auto snapshot = random_snapshot(2, 2, 8);
    const std::string bytes = *format_snapshot(*snapshot);
    // Magic, layout, version, hash, two times, resolution, nx and ny lie before it.
    constexpr std::size_t kAt = 4 + 4 + 4 * 8 + 3 * 4;
    ASSERT_EQ(bytes[kAt], 3);
    const auto with_count = [&](std::int32_t count) {
        std::string changed = bytes;
        for (std::size_t i = 0; i < 4; ++i) {
            changed[kAt + i] = static_cast<char>(static_cast<std::uint32_t>(count) >>
                                                 (8U * static_cast<unsigned>(i)));
        }
        return message(parse_snapshot(changed, "map.snapshot"));
    };
    for (const std::int32_t count : {-1, MapSnapshot::kMaxEdges + 1, 2'000'000'000}) {
        EXPECT_TRUE(contains(with_count(count), "0 to 128 edges are allowed")) << count;
    }
    EXPECT_TRUE(contains(with_count(2), "too long a map"));
    EXPECT_TRUE(contains(with_count(4), "truncated map"));
}

TEST(SnapshotFile, ADamagedSnapshotIsNotWritten) {
    const auto snapshot = random_snapshot(2, 2, 4);
    snapshot->height_tenth_mm[0] += 1;
    const testing::TemporaryFolder folder;
    const Status status = write_snapshot(folder / "map.snapshot", *snapshot);
    ASSERT_FALSE(status.ok());
    EXPECT_TRUE(contains(status.error().message, "not intact"));
    EXPECT_FALSE(is_file(folder / "map.snapshot"));
    EXPECT_TRUE(contains(write_snapshot("/dev/full", *random_snapshot(2, 2, 5)).error().message,
                         "/dev/full: cannot write: No space left"));
}

TEST(SnapshotFile, SurvivesDamagedFiles) {
    testing::for_each_mutation(
        *format_snapshot(*random_snapshot(3, 2, 6)), 1500, 7, [](const std::string& bytes) {
            const auto copy = parse_snapshot(bytes, "damaged");
            if (copy.ok()) {
                EXPECT_TRUE(grid::is_intact(**copy));
            }
        });
}

}  // namespace
}  // namespace surefoot::io

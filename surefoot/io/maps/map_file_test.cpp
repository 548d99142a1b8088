// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/maps/map_file.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "surefoot/io/bytes.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

using grid::MapRegion;
using testing::contains;

// Offsets in a file of version 1.0: docs/reference/map_format.md.
constexpr std::size_t kMajorAt = 8;
constexpr std::size_t kMinorAt = 10;
constexpr std::size_t kHeaderBytesAt = 12;
constexpr std::size_t kResolutionAt = 40;
constexpr std::size_t kNxAt = 64;
constexpr std::size_t kFrameAt = 128;
constexpr std::size_t kLayersAt = 160;
constexpr std::size_t kTableAt = 168;
constexpr std::size_t kEntryBytes = 64;
constexpr std::size_t kLayers = 10;

MapRegion random_region(int nx, int ny, std::uint64_t seed) {
    Rng rng(seed);
    MapRegion r;
    r.box = {-7, 1'000'000'000'000, nx, ny};
    r.resolution_m = 0.03;
    r.frame = "odom";
    r.frame_since_ns = static_cast<std::int64_t>(rng.next_u64());
    r.stamp_ns = static_cast<std::int64_t>(rng.next_u64());
    r.config_hash = rng.next_u64();
    r.T_frame_body = {exp_so3({0.1, -0.2, 0.3}), {1.0 / 3.0, -2.0, 0.9}};
    grid::for_each_layer([&](const grid::RegionLayer&, auto member, auto unknown) {
        r.*member = std::decay_t<decltype(r.*member)>(nx, ny, unknown);
    });
    const auto uniform = [&](double low, double high) {
        return static_cast<float>(rng.uniform(low, high));
    };
    for (std::size_t i = 0; i < r.height_m.size(); ++i) {
        if (i > 0 && rng.below(3) == 0) continue;
        r.height_m.data()[i] = uniform(-1.0, 1.0);
        r.height_var_m2.data()[i] = uniform(1e-6, 1e-3);
        r.count.data()[i] = 1 + static_cast<std::uint32_t>(rng.below(1'000'000'000));
        r.seen_ns.data()[i] = static_cast<std::int64_t>(rng.next_u64());
        r.horizontal_drift_m.data()[i] = uniform(0.0, 0.1);
        r.lowest_m.data()[i] = uniform(-2.0, -1.0);
        r.highest_m.data()[i] = uniform(1.0, 2.0);
        if (rng.below(2) == 0) r.clearance_m.data()[i] = uniform(0.3, 2.0);
        r.confidence.data()[i] = uniform(0.0, 1.0);
        if (rng.below(2) == 0) r.density_ratio.data()[i] = uniform(0.0, 5.0);
    }
    return r;
}

template <typename T>
std::string message(const Result<T>& result) {
    return result.ok() ? "accepted" : result.error().message;
}

template <typename T>
std::string with(std::string bytes, std::size_t at, T value) {
    std::string number;
    store_le(number, value);
    return bytes.replace(at, number.size(), number);
}

/// Appends the correct checksum, so that tests reach the checks behind it.
std::string sealed(std::string body) {
    store_le(body, map_checksum(body));
    return body;
}
std::string resealed(std::string bytes) {
    return sealed(bytes.substr(0, bytes.size() - 8));
}

TEST(MapFile, RoundTripsToTheSameBytes) {
    const testing::TemporaryFolder folder;
    const MapRegion region = random_region(13, 7, 1);
    ASSERT_TRUE(write_map(folder / "a.region", region).ok());
    const auto copy = read_map(folder / "a.region");
    ASSERT_TRUE(copy.ok()) << message(copy);
    EXPECT_EQ(*format_map(copy->region), *read_file(folder / "a.region"));
    EXPECT_EQ(copy->minor, kMapFileMinor);
    EXPECT_TRUE(copy->skipped_layers.empty());
    EXPECT_EQ(copy->region.box, region.box);
    EXPECT_EQ(copy->region.resolution_m, region.resolution_m);
    EXPECT_EQ(copy->region.frame, region.frame);
    EXPECT_EQ(copy->region.frame_since_ns, region.frame_since_ns);
    EXPECT_EQ(copy->region.stamp_ns, region.stamp_ns);
    EXPECT_EQ(copy->region.config_hash, region.config_hash);
    EXPECT_EQ(copy->region.T_frame_body.matrix(), region.T_frame_body.matrix());
    EXPECT_EQ(copy->region.count, region.count);
    EXPECT_EQ(copy->region.seen_ns, region.seen_ns);
    grid::for_each_layer([&](const grid::RegionLayer& layer, auto member, auto) {
        for (std::size_t i = 0; i < region.height_m.size(); ++i) {
            const auto a = (region.*member).data()[i];
            const auto b = (copy->region.*member).data()[i];
            ASSERT_TRUE(a == b || (a != a && b != b)) << layer.name << " " << i;
        }
    });
}

TEST(MapFile, EveryNumberLiesWhereTheDocumentSays) {
    const MapRegion region = random_region(3, 2, 2);
    const std::string bytes = *format_map(region);
    ASSERT_EQ(bytes.size(), kTableAt + kLayers * kEntryBytes + 6 * (8 * 4 + 4 + 8) + 8);
    EXPECT_EQ(bytes.substr(0, 8), "SFREGION");
    EXPECT_EQ(load_le<std::uint32_t>(&bytes[kHeaderBytesAt]), kTableAt);
    EXPECT_EQ(load_le<std::int64_t>(&bytes[16]), region.stamp_ns);
    EXPECT_EQ(load_le<double>(&bytes[kResolutionAt]), 0.03);
    EXPECT_EQ(load_le<std::int64_t>(&bytes[48]), -7);
    EXPECT_EQ(load_le<std::int32_t>(&bytes[kNxAt]), 3);
    EXPECT_EQ(load_le<double>(&bytes[72]), 1.0 / 3.0);
    EXPECT_EQ(load_le<double>(&bytes[120]), region.T_frame_body.rotation.w());
    EXPECT_STREQ(&bytes[kFrameAt], "odom");
    EXPECT_EQ(load_le<std::uint32_t>(&bytes[kLayersAt]), kLayers);
    EXPECT_STREQ(&bytes[kTableAt + kEntryBytes], "variance");
    EXPECT_STREQ(&bytes[kTableAt + kEntryBytes + 40], "m2");
    EXPECT_EQ(load_le<std::uint32_t>(&bytes[kTableAt + 3 * kEntryBytes + 56]), 3U);  // seen: i64
    EXPECT_EQ(load_le<float>(&bytes[kTableAt + kLayers * kEntryBytes]), region.height_m.at(0, 0));
    // The reference value of FNV-1a for "a".
    EXPECT_EQ(map_checksum("a"), 0xaf63dc4c8601ec8cULL);
}

TEST(MapFile, EveryChangedByteAndEveryTruncationIsFound) {
    const std::string bytes = *format_map(random_region(2, 1, 3));
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        for (int change = 1; change < 256; ++change) {
            std::string damaged = bytes;
            damaged[at] = static_cast<char>(damaged[at] ^ change);
            const auto result = parse_map(damaged, "damaged");
            ASSERT_FALSE(result.ok()) << "byte " << at << " ^ " << change;
            ASSERT_TRUE(contains(result.error().message, "damaged: ")) << result.error().message;
        }
    }
    for (std::size_t size = 0; size < bytes.size(); ++size)
        ASSERT_FALSE(parse_map(std::string_view(bytes).substr(0, size), "cut").ok()) << size;
    EXPECT_TRUE(contains(message(parse_map(bytes + "x", "f")), "its checksum is wrong"));
    EXPECT_TRUE(contains(message(parse_map("", "f")), "f: not a map region"));
    EXPECT_TRUE(contains(message(parse_map("SFREGION", "f")), "truncated map region: 8 bytes"));
}

TEST(MapFile, EveryByteMayBeAnythingUnderARightChecksum) {
    const std::string bytes = *format_map(random_region(2, 1, 4));
    for (std::size_t at = 0; at + 8 < bytes.size(); ++at) {
        for (const int value : {0, 1, 2, 0x2d, 0x7f, 0x80, 0xfe, 0xff}) {
            std::string changed = bytes;
            changed[at] = static_cast<char>(value);
            const auto result = parse_map(resealed(changed), "changed");
            if (result.ok()) {
                ASSERT_EQ(result->region.problem(), std::nullopt) << at;
            } else {
                ASSERT_GT(result.error().message.size(), 20U) << at;
            }
        }
    }
    testing::for_each_mutation(bytes, 3000, 5, [](const std::string& changed) {
        const auto result = parse_map(sealed(changed), "changed");
        if (result.ok()) {
            ASSERT_EQ(result->region.problem(), std::nullopt);
        }
    });
}

TEST(MapFile, SaysWhatIsImpossible) {
    const std::string bytes = *format_map(random_region(2, 2, 6));
    const std::size_t cells_at = kTableAt + kLayers * kEntryBytes;
    constexpr float kInf = std::numeric_limits<float>::infinity();
    struct Case {
        const char* words;
        std::string bytes;
    };
    const Case cases[] = {
        {"version 2.0; this program reads version 1: use a newer program",
         with(bytes, kMajorAt, std::uint16_t{2})},
        {"version 0.0", with(bytes, kMajorAt, std::uint16_t{0})},
        {"header of the map region has 160 bytes", with(bytes, kHeaderBytesAt, std::uint32_t{160})},
        {"header of the map region has 4294967295 bytes", with(bytes, kHeaderBytesAt, 0xffffffffU)},
        {"cells of nan m", with(bytes, kResolutionAt, std::nan(""))},
        {"-1 x 2 cells", with(bytes, kNxAt, std::int32_t{-1})},
        {"2147483647 x 2 cells", with(bytes, kNxAt, std::int32_t{2147483647})},
        {"bytes, but 3 x 2 cells of its 10 layers need", with(bytes, kNxAt, std::int32_t{3})},
        {"the name of the map's frame must be 1 to 31", with(bytes, kFrameAt, std::uint32_t{0})},
        {"frame is not filled up", with(bytes, kFrameAt + 31, 'x')},
        {"257 layers", with(bytes, kLayersAt, std::uint32_t{257})},
        {"are too few for 200 layers", with(bytes, kLayersAt, std::uint32_t{200})},
        {"reserved bytes hold 1", with(bytes, kLayersAt + 4, std::uint32_t{1})},
        {"layer elevation is missing", with(bytes, kTableAt, 'E')},
        {"layer 0 has no valid name", with(bytes, kTableAt + 39, 'x')},
        {"layer elevation has type 3", with(bytes, kTableAt + 56, std::uint32_t{3})},
        {"0 bytes per cell", with(bytes, kTableAt + 60, std::uint32_t{0})},
        {"unit 'k'", with(bytes, kTableAt + 40, 'k')},
        {"cell (0, 0) has elevation inf", with(bytes, cells_at, kInf)},
        {"cell (0, 0) has variance nan", with(bytes, cells_at + 16, std::nanf(""))},
    };
    for (const Case& c : cases) {
        const std::string said = message(parse_map(resealed(c.bytes), "m.region"));
        EXPECT_TRUE(contains(said, c.words)) << said;
        EXPECT_TRUE(said.starts_with("m.region: ")) << said;
    }
    std::string twice = bytes;
    twice.replace(kTableAt + kEntryBytes, kEntryBytes, bytes, kTableAt, kEntryBytes);
    EXPECT_TRUE(contains(message(parse_map(resealed(twice), "m")), "'elevation' appears twice"));
}

TEST(MapFile, ANewerMinorVersionMayHaveMoreHeaderAndMoreLayers) {
    const MapRegion region = random_region(3, 2, 7);
    const std::string bytes = *format_map(region);
    std::string newer = with(bytes.substr(0, kTableAt), kMinorAt, std::uint16_t{4});
    newer = with(newer, kHeaderBytesAt, static_cast<std::uint32_t>(kTableAt + 24));
    newer = with(newer, kLayersAt, static_cast<std::uint32_t>(kLayers + 1));
    newer.append(24, '\x5a');
    std::string entry("grass\0", 6);
    entry.resize(56, '\0');
    store_le(entry, std::uint32_t{77});  // a type of the future
    store_le(entry, std::uint32_t{3});
    newer += entry;
    newer += bytes.substr(kTableAt, kLayers * kEntryBytes);
    newer.append(3 * 6, '\x11');
    newer += bytes.substr(kTableAt + kLayers * kEntryBytes);
    newer.resize(newer.size() - 8);
    const auto read = parse_map(sealed(newer), "newer");
    ASSERT_TRUE(read.ok()) << message(read);
    EXPECT_EQ(read->minor, 4);
    EXPECT_EQ(read->skipped_layers, std::vector<std::string>{"grass"});
    EXPECT_EQ(*format_map(read->region), bytes);
}

TEST(MapFile, NoNanIsWrittenOtherwiseThanTheOneNan) {
    MapRegion region = random_region(2, 2, 8);
    const std::string bytes = *format_map(region);
    for (std::size_t i = 0; i < region.height_m.size(); ++i)
        if (std::isnan(region.clearance_m.data()[i]))
            region.clearance_m.data()[i] = -std::nanf("7");
    EXPECT_EQ(*format_map(region), bytes);
}

TEST(MapFile, WhatIsNoRegionIsNotWritten) {
    const testing::TemporaryFolder folder;
    MapRegion region = random_region(2, 2, 9);
    region.count.data()[0] = 0;
    const Status status = write_map(folder / "a.region", region);
    ASSERT_FALSE(status.ok());
    EXPECT_TRUE(contains(status.error().message, "not written: cell (0, 0) has count 0"));
    EXPECT_FALSE(is_file(folder / "a.region"));
    EXPECT_TRUE(contains(write_map("/dev/full", random_region(2, 2, 9)).error().message,
                         "/dev/full: cannot write"));
}

}  // namespace
}  // namespace surefoot::io

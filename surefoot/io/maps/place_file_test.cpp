// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/maps/place_file.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "surefoot/core/rng.hpp"
#include "surefoot/io/bytes.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"
#include "surefoot/io/maps/map_file.hpp"

namespace surefoot::io {
namespace {

using testing::contains;

// Offsets in a file of version 1.0: docs/reference/place_format.md.
constexpr std::size_t kMajorAt = 8;
constexpr std::size_t kMinorAt = 10;
constexpr std::size_t kHeaderBytesAt = 12;
constexpr std::size_t kKeyframesAt = 16;
constexpr std::size_t kKeyframeBytesAt = 20;
constexpr std::size_t kFeatureBytesAt = 24;
constexpr std::size_t kFirstKeyframeAt = 32;
constexpr std::size_t kPoseAt = kFirstKeyframeAt + 8;
constexpr std::size_t kWidthAt = kFirstKeyframeAt + 64;
constexpr std::size_t kFeaturesAt = kFirstKeyframeAt + 168;
constexpr std::size_t kFirstFeatureAt = kFirstKeyframeAt + 176;

place_recognition::Place random_place(int keyframes, int features, std::uint64_t seed) {
    Rng rng(seed);
    place_recognition::Place place;
    for (int i = 0; i < keyframes; ++i) {
        place_recognition::Keyframe keyframe;
        keyframe.T_map_body = {exp_so3({0.0, 0.1, rng.uniform(-3.0, 3.0)}),
                               {rng.uniform(-9.0, 9.0), 1.0 / 3.0, 0.95}};
        keyframe.view.time_ns = static_cast<std::int64_t>(rng.next_u64());
        keyframe.view.rig = {672, 376, 349.5, 349.5, 330.25, 187.0, 0.12, T_body_optical()};
        for (int k = 0; k < features; ++k) {
            const double u_px = rng.uniform(100.0, 600.0);
            const Eigen::Vector3d px(u_px, rng.uniform(40.0, 300.0), u_px - rng.uniform(2.0, 60.0));
            place_recognition::Feature feature{px.cast<float>(), {}};
            for (auto& bits : feature.descriptor.bits) bits = rng.next_u64();
            keyframe.view.features.push_back(feature);
        }
        place.keyframes.push_back(std::move(keyframe));
    }
    return place;
}

std::string formatted(const place_recognition::Place& place) {
    return format_place(place).value();
}

/// The bytes with the checksum that belongs to them.
std::string sealed(std::string bytes) {
    bytes.resize(bytes.size() - 8);
    store_le(bytes, map_checksum(bytes));
    return bytes;
}

template <typename T>
std::string with(std::string bytes, std::size_t at, T value) {
    std::string field;
    store_le(field, value);
    return sealed(bytes.replace(at, sizeof(T), field));
}

std::string error_of(std::string_view bytes) {
    const auto read = parse_place(bytes, "home.place");
    return read ? "" : read.error().message;
}

TEST(PlaceFile, WhatIsWrittenReadsBackTheSame) {
    for (const int keyframes : {0, 1, 7}) {
        const auto place = random_place(keyframes, 20 * keyframes, 3);
        const std::string bytes = formatted(place);
        EXPECT_EQ(bytes.size(),
                  40U + static_cast<std::size_t>(keyframes) *
                            (176U + 44U * 20U * static_cast<std::size_t>(keyframes)));
        const auto back = parse_place(bytes, "home.place");
        ASSERT_TRUE(back) << back.error().message;
        ASSERT_EQ(back->place.keyframes.size(), place.keyframes.size());
        EXPECT_EQ(formatted(back->place), bytes);
        for (std::size_t i = 0; i < place.keyframes.size(); ++i) {
            const auto& was = place.keyframes[i];
            const auto& is = back->place.keyframes[i];
            EXPECT_EQ(is.view.time_ns, was.view.time_ns);
            EXPECT_EQ(is.T_map_body.matrix(), was.T_map_body.matrix());
            EXPECT_EQ(is.view.rig.cx_px, was.view.rig.cx_px);
            ASSERT_EQ(is.view.features.size(), was.view.features.size());
            EXPECT_EQ(is.view.features.back().pixel_px, was.view.features.back().pixel_px);
            EXPECT_EQ(is.view.features.back().descriptor, was.view.features.back().descriptor);
        }
    }
}

TEST(PlaceFile, NumbersLieWhereTheDocumentSays) {
    const auto place = random_place(2, 5, 4);
    const std::string bytes = formatted(place);
    EXPECT_EQ(bytes.substr(0, 8), std::string("SFPLACE\0", 8));
    EXPECT_EQ(load_le<std::uint32_t>(&bytes[kKeyframesAt]), 2U);
    const auto& first = place.keyframes[0];
    EXPECT_EQ(load_le<std::int64_t>(&bytes[kFirstKeyframeAt]), first.view.time_ns);
    EXPECT_EQ(load_le<double>(&bytes[kPoseAt]), first.T_map_body.translation_m.x());
    EXPECT_EQ(load_le<std::int32_t>(&bytes[kWidthAt]), 672);
    EXPECT_EQ(load_le<std::uint32_t>(&bytes[kFeaturesAt]), 5U);
    EXPECT_EQ(load_le<float>(&bytes[kFirstFeatureAt]), first.view.features[0].pixel_px.x());
    EXPECT_EQ(load_le<std::uint64_t>(&bytes[kFirstFeatureAt + 12]),
              first.view.features[0].descriptor.bits[0]);
}

TEST(PlaceFile, AnyChangedByteAndAnyTruncationIsAnError) {
    const std::string bytes = formatted(random_place(1, 3, 5));
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        std::string changed = bytes;
        changed[i] = static_cast<char>(changed[i] ^ 0x10);
        EXPECT_NE(error_of(changed), "") << i;
        EXPECT_NE(error_of(std::string_view(bytes).substr(0, i)), "") << i;
    }
    EXPECT_NE(error_of(bytes + '\0'), "");
}

TEST(PlaceFile, SaysWhatIsWrongAndWhatToDo) {
    const std::string bytes = formatted(random_place(2, 3, 6));
    EXPECT_TRUE(contains(error_of("SFREGION and more bytes than a header has, to be sure of it"),
                         "home.place: not a remembered place"));
    EXPECT_TRUE(contains(error_of(bytes.substr(0, 200)), "its checksum is wrong"));
    EXPECT_TRUE(contains(error_of(bytes.substr(0, 20)), "truncated place: 20 bytes"));
    EXPECT_TRUE(contains(error_of(bytes.substr(0, 200)), "copy the place again"));
    const std::string newer = error_of(with(bytes, kMajorAt, std::uint16_t{2}));
    EXPECT_TRUE(contains(newer, "version 2.0")) << newer;
    EXPECT_TRUE(contains(newer, "reads version 1: use a newer program")) << newer;
    const auto says = [&](const std::string& changed, const std::string& what) {
        EXPECT_TRUE(contains(error_of(changed), what)) << error_of(changed);
    };
    says(with(bytes, kHeaderBytesAt, std::uint32_t{31}), "header of 31 bytes; 32 to");
    says(with(bytes, kHeaderBytesAt, std::uint32_t{1U << 31U}), "header of 2147483648 bytes");
    says(with(bytes, kKeyframesAt, std::uint32_t{501}), "501 keyframes; at most 500");
    says(with(bytes, kKeyframesAt, std::uint32_t{3}), "keyframe 2: the file ends after 0 bytes");
    says(with(bytes, kKeyframesAt, std::uint32_t{1}), "308 bytes follow its last keyframe");
    says(with(bytes, kKeyframeBytesAt, std::uint32_t{8}), "keyframes of 8 bytes; 176 to 4096");
    says(with(bytes, kFeatureBytesAt, std::uint32_t{43}), "features of 43 bytes; 44 to 4096");
    says(with(bytes, kFeaturesAt, std::uint32_t{401}), "keyframe 0: 401 features; at most 400");
    says(with(bytes, kFeaturesAt, std::uint32_t{400}), "bytes of this keyframe");
    says(with(bytes, kFeaturesAt + 4, std::uint32_t{9}), "reserved bytes hold 9");
    says(with(bytes, kWidthAt, std::int32_t{-1}), "keyframe 0 has images of -1 x 376");
    says(with(bytes, kPoseAt, std::numeric_limits<double>::quiet_NaN()),
         "pose in the map that is not finite");
    says(with(bytes, kFirstFeatureAt, -5.0F), "outside its image");
}

TEST(PlaceFile, ANewerMinorVersionIsRead) {
    const auto place = random_place(2, 3, 7);
    const std::string bytes = formatted(place);
    std::string longer = bytes.substr(0, 32);
    const std::string extra(4, 'e');
    longer += extra;  // in the header,
    for (std::size_t keyframe = 0; keyframe < 2; ++keyframe) {
        const std::size_t at = 32 + keyframe * 308;
        longer += bytes.substr(at, 176) + extra;  // in each keyframe,
        for (std::size_t k = 0; k < 3; ++k) longer += bytes.substr(at + 176 + 44 * k, 44) + extra;
    }
    longer += std::string(8, 's');
    longer = with(longer, kMinorAt, std::uint16_t{1});
    longer = with(longer, kHeaderBytesAt, std::uint32_t{36});
    longer = with(longer, kKeyframeBytesAt, std::uint32_t{180});
    longer = with(longer, kFeatureBytesAt, std::uint32_t{48});
    const auto read = parse_place(longer, "home.place");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->minor, 1);
    EXPECT_EQ(formatted(read->place), formatted(place));
}

TEST(PlaceFile, APlaceThatCannotBeReadIsNotWritten) {
    auto place = random_place(1, 3, 8);
    place.keyframes[0].view.rig.baseline_m = -1.0;
    const auto bytes = format_place(place);
    ASSERT_FALSE(bytes);
    EXPECT_TRUE(contains(bytes.error().message, "keyframe 0 has a baseline of -1 m"));
    const testing::TemporaryFolder folder;
    const std::string path = folder / "not_written.place";
    EXPECT_FALSE(write_place(path, place));
    EXPECT_FALSE(is_file(path));
}

TEST(PlaceFile, GoesThroughAFile) {
    const testing::TemporaryFolder folder;
    const std::string path = folder / "home.place";
    const auto place = random_place(3, 10, 9);
    ASSERT_TRUE(write_place(path, place));
    const auto read = read_place(path);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(formatted(read->place), formatted(place));
    EXPECT_FALSE(read_place(path + ".missing"));
}

}  // namespace
}  // namespace surefoot::io

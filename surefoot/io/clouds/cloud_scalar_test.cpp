// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/clouds/cloud_scalar.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "surefoot/io/bytes.hpp"
#include "surefoot/io/clouds/cloud_stream.hpp"
#include "surefoot/io/clouds/cloud_writer.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

using testing::contains;
using testing::TemporaryFolder;

/// One scalar of each type, with values that no other type can hold.
PointCloud cloud_of_all_types() {
    PointCloud cloud;
    cloud.points_m = {{1, 2, 3}, {4, 5, 6}};
    cloud.width = 2;
    cloud.scalars = {
        {"f32", std::vector<float>{0.1F, -3e38F}},
        {"f64", std::vector<double>{1688000000.03, 1e-300}},
        {"i8", std::vector<std::int8_t>{-128, 127}},
        {"u8", std::vector<std::uint8_t>{0, 255}},
        {"i16", std::vector<std::int16_t>{-32768, 32767}},
        {"u16", std::vector<std::uint16_t>{0, 65535}},
        {"i32", std::vector<std::int32_t>{-2147483648, 16777217}},
        {"u32", std::vector<std::uint32_t>{4000000399U, 4294967295U}},
        {"i64",
         std::vector<std::int64_t>{1403636579049999873, std::numeric_limits<std::int64_t>::min()}},
        {"u64", std::vector<std::uint64_t>{0, std::numeric_limits<std::uint64_t>::max()}}};
    return cloud;
}

void expect_same(const CloudScalar& a, const CloudScalar& b, const std::string& what) {
    EXPECT_EQ(a.name, b.name) << what;
    EXPECT_EQ(a.values, b.values) << what << ": " << a.name;
}

TEST(CloudScalar, EveryTypeComesBackFromEveryFormat) {
    const PointCloud cloud = cloud_of_all_types();
    for (const bool binary : {false, true}) {
        const auto pcd = parse_pcd(format_pcd(cloud, {binary, false}), "a.pcd");
        ASSERT_TRUE(pcd.ok()) << pcd.error().message;
        ASSERT_EQ(pcd->scalars.size(), cloud.scalars.size());
        for (std::size_t i = 0; i < cloud.scalars.size(); ++i)
            expect_same(pcd->scalars[i], cloud.scalars[i], binary ? "binary PCD" : "ascii PCD");
        const auto ply = parse_ply(format_ply(cloud, {binary, false}), "a.ply");
        ASSERT_TRUE(ply.ok()) << ply.error().message;
        for (std::size_t i = 0; i + 2 < cloud.scalars.size(); ++i)
            expect_same(ply->scalars[i], cloud.scalars[i], binary ? "binary PLY" : "ascii PLY");
        EXPECT_TRUE(std::holds_alternative<std::vector<double>>(ply->scalar("i64")->values))
            << "PLY has no 64-bit whole numbers";
    }
    const auto text = parse_text_cloud(format_text_cloud(cloud), "a.txt");
    ASSERT_TRUE(text.ok()) << text.error().message;
    EXPECT_EQ(text->scalar("f64")->at(0), 1688000000.03);
    EXPECT_EQ(text->scalar("u32")->at(0), 4000000399.0);
    EXPECT_EQ(text->scalar("i8")->at(0), -128.0);
    EXPECT_EQ(text->scalar("i64")->values, cloud.scalar("i64")->values);
}

TEST(CloudScalar, OnlyWhatATypeHoldsIsAdded) {
    CloudScalar bytes{"a", std::vector<std::uint8_t>()};
    for (const double bad : {-1.0, 256.0, 0.5, std::nan(""), 1e300})
        EXPECT_FALSE(bytes.add(bad)) << bad;
    for (const char* bad : {"-1", "256", "0.5", "nan", "x", ""})
        EXPECT_FALSE(bytes.add(bad)) << bad;
    EXPECT_TRUE(bytes.add("255"));
    EXPECT_TRUE(bytes.add("1e2"));
    EXPECT_EQ(bytes.at(1), 100.0);
    CloudScalar longs{"b", std::vector<std::int64_t>()};
    EXPECT_FALSE(longs.add(9223372036854775808.0));
    EXPECT_TRUE(longs.add(-9223372036854775808.0));
    CloudScalar floats{"c", {}};
    EXPECT_TRUE(floats.add(1e300));
    EXPECT_TRUE(std::isinf(floats.floats().at(0)));
    EXPECT_FALSE(no_values_of('F', 2));
    EXPECT_FALSE(no_values_of('U', 3));
}

TEST(CloudScalar, BlocksKeepTypesViewpointAndDoubles) {
    const TemporaryFolder folder;
    PointCloud cloud = cloud_of_all_types();
    cloud.points_m[0].x() = 0.1;  // a float cannot hold 0.1
    cloud.T_cloud_sensor = Pose{Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), {0.0, -1.0, 0.0}};
    ASSERT_TRUE(write_pcd(folder / "in.pcd", cloud, {true, true}).ok());
    auto stream = CloudStream::open(folder / "in.pcd");
    ASSERT_TRUE(stream.ok());
    auto writer = CloudWriter::create(folder / "out.pcd");
    ASSERT_TRUE(writer.ok());
    ASSERT_TRUE(
        stream->each_block([&](const PointCloud& block) { return writer->add(block); }).ok());
    EXPECT_TRUE(writer->notes().empty());
    ASSERT_TRUE(writer->finish().ok());
    const auto back = read_cloud(folder / "out.pcd");
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_EQ(back->points_m, cloud.points_m);
    ASSERT_TRUE(back->T_cloud_sensor.has_value());
    EXPECT_EQ(back->T_cloud_sensor->translation_m, cloud.T_cloud_sensor->translation_m);
    for (std::size_t i = 0; i < cloud.scalars.size(); ++i)
        expect_same(back->scalars[i], cloud.scalars[i], "stream");

    auto ply = CloudWriter::create(folder / "out.ply");
    ASSERT_TRUE(ply->add(*back).ok());
    ASSERT_EQ(ply->notes().size(), 3U) << "viewpoint, i64 and u64";
    EXPECT_TRUE(contains(ply->notes()[0], "only .pcd files can store a viewpoint"));
    EXPECT_TRUE(contains(ply->notes()[1], "'i64' has 64-bit whole numbers"));
    PointCloud other = *back;
    other.scalars[0].values = std::vector<double>{1.0, 2.0};
    EXPECT_TRUE(
        contains(ply->add(other).error().message, "other colours or scalars than the first"));
}

TEST(CloudScalar, WhatAFileHoldsMoreIsSaid) {
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
        "float z\n"
        "property list uchar int view\nelement camera 1\nproperty float px\nend_header\n1 2 3 2 8 "
        "9\n5\n";
    const auto cloud = parse_ply(ply, "a.ply");
    ASSERT_TRUE(cloud.ok()) << cloud.error().message;
    EXPECT_EQ(cloud->notes,
              (std::vector<std::string>{"the list 'view' of vertices is not kept",
                                        "the element 'camera' is not kept"}));
    const auto pcd = parse_pcd(
        "FIELDS x y z f _\nSIZE 4 4 4 4 1\nTYPE F F F F U\nCOUNT 1 1 1 3 4\nWIDTH 1\nHEIGHT 1\n"
        "POINTS 1\nDATA ascii\n1 2 3 4 5 6 0 0 0 0\n",
        "a.pcd");
    ASSERT_TRUE(pcd.ok()) << pcd.error().message;
    EXPECT_EQ(
        pcd->notes,
        (std::vector<std::string>{"the field 'f' is not kept, because it has 3 values per point"}));
}

}  // namespace
}  // namespace surefoot::io

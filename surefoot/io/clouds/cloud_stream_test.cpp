// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/clouds/cloud_stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "surefoot/core/unknown.hpp"
#include "surefoot/io/bytes.hpp"
#include "surefoot/io/clouds/cloud_rows.hpp"
#include "surefoot/io/clouds/cloud_writer.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

using testing::contains;
using testing::data_path;
using testing::TemporaryFolder;

/// More points than a block holds, with a colour and a scalar.
PointCloud many_points(std::size_t count, std::uint64_t seed) {
    Rng rng(seed);
    PointCloud cloud;
    cloud.scalars.push_back({"intensity", {}});
    for (std::size_t i = 0; i < count; ++i) {
        // Quarters: the same number in text, float and double.
        const auto c = [&] { return 0.25 * static_cast<double>(rng.below(40000)) - 5000.0; };
        cloud.points_m.emplace_back(c(), c(), c());
        cloud.colours.push_back({static_cast<std::uint8_t>(i), 2, 3});
        cloud.scalars[0].floats().push_back(static_cast<float>(i));
    }
    cloud.width = static_cast<int>(count);
    return cloud;
}

/// All blocks of a stream as one cloud.
PointCloud drained(CloudStream& stream, int* blocks = nullptr) {
    PointCloud all;
    while (true) {
        auto block = stream.next();
        EXPECT_TRUE(block.ok()) << (block.ok() ? "" : block.error().message);
        if (!block.ok() || block->points_m.empty()) return all;
        if (blocks != nullptr) ++*blocks;
        EXPECT_FALSE(block->problem().has_value());
        all.points_m.insert(all.points_m.end(), block->points_m.begin(), block->points_m.end());
        all.colours.insert(all.colours.end(), block->colours.begin(), block->colours.end());
        for (std::size_t i = 0; i < block->scalars.size(); ++i) {
            const CloudScalar& more = block->scalars[i];
            if (i == all.scalars.size()) all.scalars.push_back(more.without_values());
            all.scalars[i].append(more, 0, more.size());
        }
        all.width = static_cast<int>(all.points_m.size());
    }
}

void expect_same(const PointCloud& a, const PointCloud& b, const std::string& what) {
    EXPECT_EQ(a.points_m, b.points_m) << what;
    EXPECT_EQ(a.colours, b.colours) << what;
    ASSERT_EQ(a.scalars.size(), b.scalars.size()) << what;
    for (std::size_t i = 0; i < a.scalars.size(); ++i) {
        EXPECT_EQ(a.scalars[i].name, b.scalars[i].name) << what;
        ASSERT_EQ(a.scalars[i].size(), b.scalars[i].size()) << what;
        // Text has one type of numbers; every other format keeps that of the file.
        for (std::size_t k = 0; k < a.scalars[i].size(); ++k) {
            const double x = a.scalars[i].at(k);
            const double y = b.scalars[i].at(k);
            ASSERT_TRUE(x == y || (std::isnan(x) && std::isnan(y))) << what << ", point " << k;
        }
    }
}

TEST(CloudStream, BlocksAreTheFile) {
    const TemporaryFolder folder;
    PointCloud cloud = many_points(200000, 1);
    PointCloud grey = cloud;
    grey.colours.clear();
    ASSERT_TRUE(write_ply(folder / "a.ply", cloud).ok());
    ASSERT_TRUE(write_ply(folder / "wide.ply", cloud, {true, true}).ok());
    ASSERT_TRUE(write_ply(folder / "text.ply", cloud, {false, false}).ok());
    ASSERT_TRUE(write_pcd(folder / "a.pcd", cloud).ok());
    ASSERT_TRUE(write_text_cloud(folder / "a.xyz", grey).ok());
    for (const char* name : {"a.ply", "wide.ply", "text.ply", "a.pcd", "a.xyz"}) {
        auto stream = CloudStream::open(folder / name);
        ASSERT_TRUE(stream.ok()) << stream.error().message;
        const PointCloud& expected = std::string(name) == "a.xyz" ? grey : cloud;
        int blocks = 0;
        expect_same(drained(*stream, &blocks), expected, name);
        EXPECT_GT(blocks, 1) << name;
        EXPECT_EQ(stream->points().value_or(200000), 200000U) << name;
        stream->rewind();
        expect_same(drained(*stream), expected, name);
    }
}

TEST(CloudStream, BigEndianRowsAndShapes) {
    const TemporaryFolder folder;
    std::string bytes =
        "ply\nformat binary_big_endian 1.0\n  element vertex 2\nproperty double x\nproperty short "
        "y\nproperty float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n";
    for (const double x : {1.5, -2.5}) {
        store(bytes, x, std::endian::big);
        store(bytes, std::int16_t{-3}, std::endian::big);
        store(bytes, 0.25F, std::endian::big);
    }
    ASSERT_TRUE(write_file(folder / "b.ply", bytes).ok());
    auto stream = CloudStream::open(folder / "b.ply");
    ASSERT_TRUE(stream.ok());
    EXPECT_EQ(drained(*stream).points_m.at(1), Eigen::Vector3d(-2.5, -3.0, 0.25));

    PointCloud organised = many_points(12, 2);
    organised.width = 4;
    organised.height = 3;
    ASSERT_TRUE(write_pcd(folder / "o.pcd", organised).ok());
    auto rows = CloudStream::open(folder / "o.pcd");
    ASSERT_TRUE(rows.ok());
    EXPECT_EQ(drained(*rows).points_m, organised.points_m);
}

TEST(CloudStream, RealFilesAsReadWhole) {
    for (const char* name : {"clouds/room_scan1.pcd",
                             "clouds/samp11-utm.pcd",
                             "clouds/maze.ply",
                             "clouds/simple.las",
                             "clouds/1.2-with-color.las",
                             "clouds/icp_tutorial_cloud_0.vtk",
                             "conformance/clouds/sor_7_4.asc"}) {
        const std::string path = data_path(name);
        if (path.empty()) continue;
        const auto whole = read_cloud(path);
        auto stream = CloudStream::open(path);
        ASSERT_TRUE(whole.ok()) << whole.error().message;
        ASSERT_TRUE(stream.ok());
        expect_same(drained(*stream), *whole, name);
    }
}

TEST(CloudStream, SaysWhatIsWrongWithAFile) {
    const TemporaryFolder folder;
    const auto why = [&](const std::string& name, const std::string& bytes) -> std::string {
        EXPECT_TRUE(write_file(folder / name, bytes).ok());
        auto stream = CloudStream::open(folder / name);
        if (!stream) return stream.error().message;
        while (true) {
            const auto block = stream->next();
            if (!block) return block.error().message;
            if (block->points_m.empty()) return "nothing";
        }
    };
    const std::string ply = format_ply(many_points(100, 3));
    EXPECT_TRUE(contains(why("cut.ply", ply.substr(0, ply.size() - 1)), "truncated"));
    EXPECT_TRUE(
        contains(why("lies.ply",
                     "ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\n"
                     "property float x\nproperty float y\nproperty float z\nend_header\nxx"),
                 "announces 99999999999 'vertex'"));
    EXPECT_TRUE(contains(why("empty.xyz", "# nothing\n"), "no points"));
    EXPECT_TRUE(contains(why("mixed.xyz", "1 2 3\r\n4 5 6\n7 8\n"), "2 numbers"));
    EXPECT_EQ(why("mixed_ends.xyz", "1 2 3\r\n4 5 6\n"), "nothing");
    EXPECT_TRUE(
        contains(why("comma.xyz", "1,5 2,5 3,5\n4,5 5,5\n"), "comma.xyz:1: commas and blanks"));
    EXPECT_TRUE(contains(why("a.e57", "x"), "unknown cloud format '.e57'"));
    EXPECT_TRUE(contains(CloudStream::open(folder / "none.ply").error().message, "cannot read"));
}

TEST(ShiftedReader, CountsFromNearLargeCoordinates) {
    EXPECT_EQ(shift_for({1.0, -999.0, 0.0}), Eigen::Vector3d(0.0, 0.0, 0.0));
    EXPECT_EQ(shift_for({637012.24, -5403400.1, 412.5}),
              Eigen::Vector3d(637000.0, -5403400.0, 0.0));
    const TemporaryFolder folder;
    PointCloud cloud;
    cloud.points_m = {
        {kNan, 0, 0}, {637012.241, 851431.552, 431.667}, {637012.242, 851431.553, 431.7}};
    cloud.width = 3;
    ASSERT_TRUE(write_ply(folder / "utm.ply", cloud, {true, true}).ok());
    const auto read = read_shifted(folder / "utm.ply");
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(read->shift_m, Eigen::Vector3d(637000.0, 851400.0, 0.0));
    EXPECT_EQ(read->skipped, 1);
    ASSERT_EQ(read->points_m.size(), 2U);
    // A float near 12 m or 31 m has steps of 1 or 2 micrometres: the millimetre is still there.
    EXPECT_NEAR(static_cast<double>(read->points_m[1].x() - read->points_m[0].x()), 1e-3, 2e-6);
    // The other cloud of a pair goes where the first is.
    const auto same = read_shifted(folder / "utm.ply", Eigen::Vector3d(637000.0, 851000.0, 0.0));
    EXPECT_NEAR(static_cast<double>(same->points_m[0].y()), 431.552, 4e-5);
}

TEST(ShiftedReader, RefusesWhatIsFarAwayOrNotThere) {
    const TemporaryFolder folder;
    PointCloud cloud;
    cloud.points_m = {{0, 0, 0}, {1e30, 0, 0}};
    cloud.width = 2;
    ASSERT_TRUE(write_ply(folder / "far.ply", cloud).ok());
    EXPECT_TRUE(contains(read_shifted(folder / "far.ply").error().message, "more than 100 km"));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    cloud.points_m = {{nan, nan, nan}, {nan, 0, 0}};
    ASSERT_TRUE(write_ply(folder / "nan.ply", cloud).ok());
    EXPECT_TRUE(contains(read_shifted(folder / "nan.ply").error().message,
                         "no point with finite coordinates (2 points in the file)"));
    ASSERT_TRUE(write_ply(folder / "empty.ply", PointCloud{}).ok());
    EXPECT_TRUE(
        contains(read_shifted(folder / "empty.ply").error().message, "(0 points in the file)"));
}

TEST(CloudWriter, WritesWhatComesInBlocks) {
    const TemporaryFolder folder;
    const PointCloud cloud = many_points(1000, 4);
    for (const char* name : {"a.ply", "a.pcd", "a.xyz"}) {
        const bool text = std::string(name) == "a.xyz";  // text files store colours as columns
        ASSERT_TRUE(write_ply(folder / "in.ply", cloud).ok());
        auto writer = CloudWriter::create(folder / name);
        ASSERT_TRUE(writer.ok()) << writer.error().message;
        auto stream = CloudStream::open(folder / "in.ply");
        ASSERT_TRUE(stream.ok());
        const auto block = stream->next();
        ASSERT_TRUE(writer->add(*block).ok());
        ASSERT_TRUE(writer->add(*block).ok());
        EXPECT_FALSE(is_file(folder / name)) << "before it is finished";
        ASSERT_TRUE(writer->finish().ok());
        EXPECT_FALSE(is_file(folder / (std::string(name) + ".part")));
        const auto back = read_cloud(folder / name);
        ASSERT_TRUE(back.ok()) << back.error().message;
        ASSERT_EQ(back->points_m.size(), 2000U);
        EXPECT_EQ(back->points_m[1999], cloud.points_m[999]);
        EXPECT_EQ(back->colours.size(), text ? 0U : 2000U);
        EXPECT_EQ(text ? back->scalar("G")->at(7) : back->colours[7].g, 2.0);
        EXPECT_EQ(back->scalar("intensity")->at(1001), 1.0);
    }
}

TEST(CloudWriter, LeavesNothingOfWhatIsNotFinished) {
    const TemporaryFolder folder;
    {
        auto writer = CloudWriter::create(folder / "a.ply");
        ASSERT_TRUE(writer.ok());
        ASSERT_TRUE(writer->add(many_points(10, 5)).ok());
    }
    EXPECT_FALSE(is_file(folder / "a.ply") || is_file(folder / "a.ply.part"));
    auto none = CloudWriter::create(folder / "none.pcd");
    ASSERT_TRUE(none.ok() && none->finish().ok());
    EXPECT_TRUE(read_cloud(folder / "none.pcd")->points_m.empty());
    EXPECT_TRUE(contains(CloudWriter::create(folder / "a.las").error().message, "not '.las'"));
    EXPECT_TRUE(contains(CloudWriter::create("/nowhere/a.ply").error().message, "cannot write"));
}

/// Two points of format 3 of LAS 1.2, the second with a colour of 16 bits.
std::string las_bytes() {
    std::string bytes(227, '\0');
    const auto put = [&](std::size_t at, auto value) {
        std::string packed;
        store_le(packed, value);
        bytes.replace(at, packed.size(), packed);
    };
    bytes.replace(0, 4, "LASF");
    put(24, std::uint8_t{1});
    put(25, std::uint8_t{2});
    put(94, std::uint16_t{227});
    put(96, std::uint32_t{227});
    put(104, std::uint8_t{3});
    put(105, std::uint16_t{34});
    put(107, std::uint32_t{2});
    for (int axis = 0; axis < 3; ++axis) {
        put(static_cast<std::size_t>(131 + 8 * axis), 0.001);
        put(static_cast<std::size_t>(155 + 8 * axis), 1000.0 * axis);
    }
    for (const int i : {0, 1}) {
        std::string record(34, '\0');
        std::string xyz;
        for (const std::int32_t c : {1500, -2000, 3}) store_le(xyz, c + i);
        record.replace(0, 12, xyz);
        record[12] = 7;
        record[15] = static_cast<char>(0xE0 | 2);
        record[29] = static_cast<char>(i == 1 ? 0x80 : 0x10);
        bytes += record;
    }
    return bytes;
}

TEST(Las, ReadsPointsClassesAndColours) {
    const auto cloud = parse_las(las_bytes(), "a.las");
    ASSERT_TRUE(cloud.ok()) << cloud.error().message;
    ASSERT_EQ(cloud->points_m.size(), 2U);
    EXPECT_NEAR(
        (cloud->points_m[1] - Eigen::Vector3d(1.501, 998.001, 2000.004)).norm(), 0.0, 1e-12);
    EXPECT_EQ(cloud->scalar("intensity")->at(0), 7.0);
    EXPECT_EQ(cloud->scalar("classification")->at(0), 2.0);
    EXPECT_EQ(cloud->colours[1], (Rgb{0x80, 0, 0}));
}

TEST(Las, RefusesWhatIsDamagedOrCompressed) {
    const std::string good = las_bytes();
    const auto why = [](const std::string& bytes) {
        const auto cloud = parse_las(bytes, "a.las");
        return cloud.ok() ? std::string("accepted") : cloud.error().message;
    };
    EXPECT_TRUE(contains(why("LAXF"), "not a LAS file"));
    EXPECT_TRUE(contains(why(good.substr(0, 100)), "truncated LAS header"));
    EXPECT_TRUE(contains(why(good.substr(0, good.size() - 1)), "do not fit into"));
    std::string headless = good;
    headless[94] = '\0';
    EXPECT_TRUE(contains(why(headless), "the LAS header has 0 bytes"));
    EXPECT_FALSE(las_rows(headless, headless.size()));
    std::string laz = good;
    laz[104] = static_cast<char>(laz[104] | 0x80);
    EXPECT_TRUE(contains(why(laz), "pdal translate"));
    std::string many = good;
    many[110] = '\x7f';
    EXPECT_TRUE(contains(why(many), "do not fit into"));
    std::string format = good;
    format[104] = 11;
    EXPECT_TRUE(contains(why(format), "point format 11"));
    std::string narrow = good;
    narrow[105] = 20;
    EXPECT_TRUE(contains(why(narrow), "records have 20 bytes"));
    testing::for_each_mutation(good, 5000, 11, [](const std::string& bytes) {
        const auto cloud = parse_las(bytes, "damaged.las");
        if (cloud.ok()) {
            EXPECT_FALSE(cloud->problem().has_value());
        }
    });
}

TEST(Las, RealFiles) {
    const std::string simple = data_path("clouds/simple.las");
    if (!simple.empty()) {
        const auto cloud = read_cloud(simple);
        ASSERT_TRUE(cloud.ok()) << cloud.error().message;
        EXPECT_EQ(cloud->points_m.size(), 1065U);
        // The header's own bounds, of x.
        Eigen::Vector3d low_m = cloud->points_m.front();
        Eigen::Vector3d high_m = low_m;
        for (const auto& p_m : cloud->points_m) {
            low_m = low_m.cwiseMin(p_m);
            high_m = high_m.cwiseMax(p_m);
        }
        const auto bytes = read_file(simple);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(high_m[axis], load_le<double>(bytes->data() + 179 + 16 * axis), 1e-9);
            EXPECT_NEAR(low_m[axis], load_le<double>(bytes->data() + 187 + 16 * axis), 1e-9);
        }
    }
    const std::string coloured = data_path("clouds/1.2-with-color.las");
    if (!coloured.empty()) {
        const auto cloud = read_cloud(coloured);
        ASSERT_TRUE(cloud.ok());
        EXPECT_EQ(cloud->colours.size(), cloud->points_m.size());
    }
    const std::string laz = data_path("clouds/simple.laz");
    if (!laz.empty()) {
        EXPECT_TRUE(contains(read_cloud(laz).error().message, "LAZ is not supported"));
    }
}

TEST(Vtk, ReadsPointsOverAnyLines) {
    const std::string head = "# vtk DataFile Version 3.0\nby hand\nASCII\nDATASET POLYDATA\n";
    const auto cloud = parse_vtk(head + "POINTS 2 float\n1 2\n3 4 5 6\nVERTICES 1 2\n", "a.vtk");
    ASSERT_TRUE(cloud.ok()) << cloud.error().message;
    EXPECT_EQ(cloud->points_m.at(1), Eigen::Vector3d(4, 5, 6));
    const auto why = [](const std::string& bytes) {
        const auto bad = parse_vtk(bytes, "a.vtk");
        return bad.ok() ? std::string("accepted") : bad.error().message;
    };
    EXPECT_TRUE(contains(why("ply\n"), "a.vtk:1: not a VTK file"));
    EXPECT_TRUE(contains(why("# vtk DataFile Version 3.0\nx\nBINARY\n"), "'BINARY'"));
    EXPECT_TRUE(contains(why(head), "has no line POINTS"));
    EXPECT_TRUE(contains(why(head + "POINTS 9999999999 float\n1 2 3\n"), "do not fit"));
    EXPECT_TRUE(contains(why(head + "POINTS 1 float\n1 2    x   \n"), "'x' is not a number"));
    EXPECT_TRUE(contains(why(head + "POINTS -1 float\n"), "POINTS count type"));
    testing::for_each_mutation(
        head + "POINTS 3 float\n1 2 3 4 5 6 7 8 9\n", 3000, 12, [](const std::string& b) {
            const auto damaged = parse_vtk(b, "damaged.vtk");
            if (damaged.ok()) {
                EXPECT_FALSE(damaged->problem().has_value());
            }
        });
    const std::string real = data_path("clouds/icp_tutorial_cloud_0.vtk");
    if (real.empty()) return;
    const auto room = read_cloud(real);
    ASSERT_TRUE(room.ok()) << room.error().message;
    EXPECT_EQ(room->points_m.size(), 36674U);
}

}  // namespace
}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/clouds/point_cloud.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "surefoot/io/bytes.hpp"
#include "surefoot/io/clouds/lzf.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

using testing::contains;
using testing::data_path;

/// Random points with colours and one scalar; coordinates are floats, so that both precisions hold.
PointCloud random_cloud(std::size_t count, std::uint64_t seed) {
    Rng rng(seed);
    PointCloud cloud;
    cloud.scalars.push_back({"intensity", {}});
    for (std::size_t i = 0; i < count; ++i) {
        const auto coordinate = [&] {
            return static_cast<double>(static_cast<float>(10.0 * rng.normal()));
        };
        cloud.points_m.emplace_back(coordinate(), coordinate(), coordinate());
        const auto channel = [&] { return static_cast<std::uint8_t>(rng.below(256)); };
        cloud.colours.push_back({channel(), channel(), channel()});
        cloud.scalars[0].floats().push_back(static_cast<float>(rng.uniform()));
    }
    cloud.width = static_cast<int>(count);
    return cloud;
}

void expect_equal(const PointCloud& a, const PointCloud& b, const std::string& what) {
    ASSERT_EQ(a.points_m.size(), b.points_m.size()) << what;
    EXPECT_EQ(a.width, b.width) << what;
    EXPECT_EQ(a.height, b.height) << what;
    EXPECT_EQ(a.colours, b.colours) << what;
    for (std::size_t i = 0; i < a.points_m.size(); ++i) {
        // Text keeps all digits that are written, so compare what a float can hold.
        ASSERT_EQ(a.points_m[i].cast<float>().eval(), b.points_m[i].cast<float>().eval())
            << what << ", point " << i;
    }
    ASSERT_EQ(a.scalars.size(), b.scalars.size()) << what;
    for (std::size_t i = 0; i < a.scalars.size(); ++i) {
        EXPECT_EQ(a.scalars[i].name, b.scalars[i].name) << what;
        ASSERT_EQ(a.scalars[i].size(), b.scalars[i].size()) << what;
        for (std::size_t k = 0; k < a.scalars[i].size(); ++k) {
            // Text keeps all digits that are written; a float is what it was.
            ASSERT_EQ(static_cast<float>(a.scalars[i].at(k)),
                      static_cast<float>(b.scalars[i].at(k)))
                << what << ", point " << k;
        }
    }
}

std::string message(const Result<PointCloud>& cloud) {
    return cloud.ok() ? "accepted" : cloud.error().message;
}

TEST(Ply, RoundTripsInEveryEncoding) {
    const PointCloud cloud = random_cloud(257, 1);
    for (const bool binary : {false, true}) {
        for (const bool wide : {false, true}) {
            const auto copy = parse_ply(format_ply(cloud, {binary, wide}), "a.ply");
            ASSERT_TRUE(copy.ok()) << message(copy);
            expect_equal(*copy, cloud, binary ? "binary" : "ascii");
        }
    }
    PointCloud empty;
    EXPECT_TRUE(parse_ply(format_ply(empty), "empty.ply").ok());
}

TEST(Ply, ReadsBigEndianListsAndOtherElements) {
    std::string bytes =
        "ply\r\nformat binary_big_endian 1.0\ncomment made by hand\nelement camera 2\n"
        "property uchar id\nproperty list uchar short marks\nelement vertex 1\nproperty double x\n"
        "property short y\nproperty uint z\nelement face 5\nproperty list uchar int "
        "vertex_indices\n"
        "end_header\n";
    const auto put = [&](auto value) { store(bytes, value, std::endian::big); };
    for (int camera = 0; camera < 2; ++camera) {
        put(std::uint8_t{7});
        put(std::uint8_t{2});
        put(std::int16_t{-1});
        put(std::int16_t{-2});
    }
    put(1.5);
    put(std::int16_t{-3});
    put(std::uint32_t{4000000000U});
    const auto cloud = parse_ply(bytes, "big.ply");
    ASSERT_TRUE(cloud.ok()) << message(cloud);
    EXPECT_EQ(cloud->points_m.at(0), Eigen::Vector3d(1.5, -3.0, 4e9));
}

TEST(Ply, RefusesWhatIsDamagedWithFileAndReason) {
    const std::string good = format_ply(random_cloud(10, 2));
    EXPECT_TRUE(
        contains(message(parse_ply(good.substr(0, good.size() - 1), "a.ply")), "a.ply: trunc"));
    EXPECT_TRUE(contains(message(parse_ply("plx\n", "a.ply")), "a.ply:1: not a PLY file"));
    EXPECT_TRUE(contains(message(parse_ply("ply\nformat ascii 1.0\n", "a.ply")), "'end_header'"));
    // A count of a thousand billion points in a small file must be refused.
    EXPECT_TRUE(contains(message(parse_ply("ply\nformat ascii 1.0\nelement vertex 1000000000000\n"
                                           "property float x\nproperty float y\nproperty float z\n"
                                           "end_header\n1 2 3\n",
                                           "a.ply")),
                         "announces 1000000000000 'vertex'"));
    EXPECT_TRUE(contains(
        message(parse_ply("ply\nelement vertex 1\nproperty float x\nend_header\n1\n", "a.ply")),
        "must have each of x, y and z"));
    EXPECT_TRUE(contains(
        message(parse_ply("ply\nelement vertex 1\nproperty half x\nend_header\n1\n", "a.ply")),
        "a.ply:3: unknown property type 'half'"));
}

TEST(Ply, SurvivesDamagedFiles) {
    for (const bool binary : {false, true}) {
        testing::for_each_mutation(format_ply(random_cloud(20, 3), {binary, false}),
                                   3000,
                                   5,
                                   [](const std::string& bytes) {
                                       const auto cloud = parse_ply(bytes, "damaged.ply");
                                       if (cloud.ok()) {
                                           EXPECT_FALSE(cloud->problem().has_value());
                                       }
                                   });
    }
}

TEST(Pcd, RoundTripsAndKeepsTheShape) {
    PointCloud cloud = random_cloud(12, 4);
    cloud.width = 4;
    cloud.height = 3;
    cloud.T_cloud_sensor = Pose{Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), {1.0, 2.0, 3.0}};
    for (const bool binary : {false, true}) {
        for (const bool wide : {false, true}) {
            const auto copy = parse_pcd(format_pcd(cloud, {binary, wide}), "a.pcd");
            ASSERT_TRUE(copy.ok()) << message(copy);
            expect_equal(*copy, cloud, binary ? "binary" : "ascii");
            EXPECT_TRUE(copy->organised());
            EXPECT_EQ(copy->T_cloud_sensor->translation_m, cloud.T_cloud_sensor->translation_m);
        }
    }
}

std::string compressed_pcd(std::size_t points, std::string_view data) {
    std::string bytes =
        "VERSION .7\nFIELDS x y _ z\nSIZE 4 4 1 8\nTYPE F F U F\nCOUNT 1 1 3 1\nWIDTH " +
        std::to_string(points) + "\nHEIGHT 1\nPOINTS " + std::to_string(points) +
        "\nDATA binary_compressed\n";
    const std::string packed = pack_lzf(data);
    store_le(bytes, static_cast<std::uint32_t>(packed.size()));
    store_le(bytes, static_cast<std::uint32_t>(data.size()));
    return bytes + packed;
}

TEST(Pcd, ReadsCompressedFieldsWithPaddingInsideAndBehind) {
    std::string data;  // field by field: all x, all y, all padding, all z
    for (const float x : {1.0F, 2.0F}) store_le(data, x);
    for (const float y : {3.0F, 4.0F}) store_le(data, y);
    data += "......";
    for (const double z : {5.0, 6.0}) store_le(data, z);
    const auto cloud = parse_pcd(compressed_pcd(2, data) + "trailing bytes", "c.pcd");
    ASSERT_TRUE(cloud.ok()) << message(cloud);
    EXPECT_EQ(cloud->points_m.at(0), Eigen::Vector3d(1.0, 3.0, 5.0));
    EXPECT_EQ(cloud->points_m.at(1), Eigen::Vector3d(2.0, 4.0, 6.0));
    EXPECT_TRUE(cloud->scalars.empty());
}

TEST(Pcd, RefusesWhatIsDamagedWithFileAndReason) {
    const auto header = [](const std::string& points, const std::string& data) {
        return "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + points +
               "\nHEIGHT 1\nPOINTS " + points + "\nDATA " + data + "\n";
    };
    EXPECT_TRUE(contains(message(parse_pcd(header("1000000000000", "binary"), "a.pcd")),
                         "a.pcd:5: WIDTH must be a whole number from 0 to "));
    EXPECT_TRUE(contains(message(parse_pcd(header("1000000000", "binary") + "abc", "a.pcd")),
                         "need 12000000000 bytes, but only 3 follow the header"));
    EXPECT_TRUE(
        contains(message(parse_pcd(header("2", "ascii") + "1 2 3\n", "a.pcd")), "truncated"));
    EXPECT_TRUE(contains(message(parse_pcd(header("1", "ascii") + "1 2 x    \n", "a.pcd")),
                         "a.pcd:9: 'x' is not a number"));
    EXPECT_TRUE(contains(message(parse_pcd("FIELDS x y\n", "a.pcd")), "'DATA' is missing"));
    EXPECT_TRUE(contains(
        message(parse_pcd("FIELDS x x y\nSIZE 4 4 4\nTYPE F F F\nWIDTH 0\nDATA ascii\n", "a.pcd")),
        "each of the fields x, y and z exactly once"));
    std::string bomb = header("357913941", "binary_compressed");
    store_le(bomb, std::uint32_t{4});
    store_le(bomb, std::uint32_t{4294967292U});
    EXPECT_TRUE(contains(message(parse_pcd(bomb + "abcd", "a.pcd")), "damaged compressed"));
}

TEST(Pcd, SurvivesDamagedFiles) {
    std::string data;
    for (int i = 0; i < 20; ++i) store_le(data, static_cast<float>(i % 3));
    data += std::string(30, '.');
    for (int i = 0; i < 10; ++i) store_le(data, 1.0 * i);
    const PointCloud cloud = random_cloud(20, 6);
    for (const std::string& valid :
         {format_pcd(cloud), format_pcd(cloud, {false, true}), compressed_pcd(10, data)}) {
        ASSERT_TRUE(parse_pcd(valid, "valid.pcd").ok());
        testing::for_each_mutation(valid, 3000, 7, [](const std::string& bytes) {
            const auto damaged = parse_pcd(bytes, "damaged.pcd");
            if (damaged.ok()) {
                EXPECT_FALSE(damaged->problem().has_value());
            }
        });
    }
}

TEST(Lzf, PacksAndUnpacksAnything) {
    Rng rng(8);
    for (int round = 0; round < 200; ++round) {
        std::string data;
        const std::uint64_t symbols = 1 + rng.below(256);
        const std::uint64_t size = rng.below(3000);
        for (std::uint64_t i = 0; i < size; ++i) data += static_cast<char>(rng.below(symbols));
        const auto copy = unpack_lzf(pack_lzf(data), data.size());
        ASSERT_TRUE(copy.has_value()) << "round " << round;
        ASSERT_EQ(*copy, data) << "round " << round;
    }
    EXPECT_LT(pack_lzf(std::string(10000, 'a')).size(), 200U);
    EXPECT_FALSE(unpack_lzf("\x20\x05", 3).has_value()) << "a copy from before the beginning";
    EXPECT_FALSE(unpack_lzf("\x05"
                            "ab",
                            6)
                     .has_value())
        << "literals that are cut off";
}

TEST(TextCloud, ReadsHeadsCommentsAndSeparators) {
    const auto cloud =
        parse_text_cloud("//X Y Z C2C dist\n1 2 3\t4 5\n\n# note\n6 7 8 9 nan\n", "a.asc");
    ASSERT_TRUE(cloud.ok()) << message(cloud);
    EXPECT_EQ(cloud->points_m.at(1), Eigen::Vector3d(6, 7, 8));
    EXPECT_EQ(cloud->scalar("C2C")->at(1), 9.0);
    EXPECT_TRUE(std::isnan(cloud->scalar("dist")->at(1)));
    EXPECT_TRUE(contains(message(parse_text_cloud("1 2 3\n1 2\n", "a.asc")),
                         "a.asc:2: the line has 2 numbers"));
    EXPECT_TRUE(
        contains(message(parse_text_cloud("1 2 z\n", "a.asc")), "a.asc:1: 'z' is not a number"));
    EXPECT_TRUE(contains(message(parse_text_cloud("1 2\n", "a.asc")), "x y z"));
    EXPECT_TRUE(contains(message(parse_text_cloud("", "a.asc")), "no points"));
    PointCloud original = random_cloud(50, 9);
    original.colours.clear();
    const auto copy = parse_text_cloud(format_text_cloud(original), "b.xyz");
    ASSERT_TRUE(copy.ok());
    expect_equal(*copy, original, "text");
    testing::for_each_mutation(format_text_cloud(original), 2000, 10, [](const std::string& text) {
        const auto damaged = parse_text_cloud(text, "damaged.xyz");
        if (damaged.ok()) {
            EXPECT_FALSE(damaged->problem().has_value());
        }
    });
}

TEST(Cloud, ReadsRealFiles) {
    const struct {
        const char* name;
        std::size_t points;
        const char* scalar;
    } files[] = {{"clouds/room_scan1.pcd", 112586, nullptr},
                 {"clouds/samp11-utm.pcd", 38010, nullptr},
                 {"clouds/capture0001.pcd", 307200, nullptr},
                 {"clouds/maze.ply", 25809, "scalar_intensity"},
                 {"clouds/source.ply", 69792, "scalar_intensity"},
                 {"terrain/lidar_steps.ply", 100000, nullptr},
                 {"conformance/clouds/c2c_e2_vs_e1.asc", 18000, "C2C_absolute_distances"}};
    for (const auto& file : files) {
        const std::string path = data_path(file.name);
        if (path.empty()) continue;
        const auto cloud = read_cloud(path);
        ASSERT_TRUE(cloud.ok()) << message(cloud);
        EXPECT_EQ(cloud->points_m.size(), file.points) << path;
        EXPECT_FALSE(cloud->problem().has_value()) << path;
        if (file.scalar != nullptr) {
            EXPECT_NE(cloud->scalar(file.scalar), nullptr) << path;
        }
    }
}

TEST(Cloud, OrganisedKinectViewHasHolesAndMetres) {
    const std::string path = data_path("clouds/capture0001.pcd");
    if (path.empty()) return;
    const auto cloud = read_cloud(path);
    ASSERT_TRUE(cloud.ok()) << message(cloud);
    EXPECT_EQ(cloud->width, 640);
    EXPECT_EQ(cloud->height, 480);
    std::size_t holes = 0;
    std::size_t plausible = 0;
    for (const Eigen::Vector3d& p_m : cloud->points_m) {
        if (!p_m.allFinite()) ++holes;
        // A Kinect sees 0.4 to 10 m.
        if (p_m.z() > 0.4 && p_m.z() < 10.0) ++plausible;
    }
    EXPECT_GT(holes, 1000U);
    EXPECT_EQ(plausible + holes, cloud->points_m.size());
}

TEST(Cloud, SamePointsInTextAndBinary) {
    // The c2c file lists the points of ref_e2.ply with 9 decimals.
    const std::string text = data_path("conformance/clouds/c2c_e2_vs_e1.asc");
    const std::string binary = data_path("conformance/clouds/ref_e2.ply");
    if (text.empty() || binary.empty()) return;
    const auto a = read_cloud(text);
    const auto b = read_cloud(binary);
    ASSERT_TRUE(a.ok() && b.ok());
    constexpr double kPrinted_m = 1e-9;
    for (std::size_t i = 0; i < a->points_m.size(); ++i) {
        ASSERT_LT((a->points_m[i] - b->points_m[i]).cwiseAbs().maxCoeff(), kPrinted_m) << i;
    }
}

TEST(Cloud, UnknownFormatsAreNamed) {
    EXPECT_TRUE(contains(message(read_cloud("/x/a.e57")), "unknown cloud format '.e57'"));
    EXPECT_TRUE(contains(message(read_cloud("/x/a.laz")), "convert it"));
    EXPECT_TRUE(contains(message(read_cloud("/x/a.ply")), "/x/a.ply: cannot read"));
    PointCloud broken = random_cloud(3, 1);
    broken.colours.pop_back();
    EXPECT_TRUE(contains(write_ply("/tmp/never.ply", broken).error().message, "2 colours for 3"));
    EXPECT_TRUE(
        contains(write_pcd("/dev/full", random_cloud(3, 1)).error().message, "No space left"));
}

}  // namespace
}  // namespace surefoot::io

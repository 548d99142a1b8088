// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/clouds/text_cloud.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/io/clouds/cloud_stream.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

using testing::contains;
using testing::TemporaryFolder;

std::string why(const std::string& text, const std::string& file = "a.txt") {
    const auto cloud = parse_text_cloud(text, file);
    return cloud.ok() ? "accepted" : cloud.error().message;
}

/// Files of other programs, with their points.
struct Sample {
    const char* file;
    std::string text;
    std::vector<Eigen::Vector3d> points_m;
};

std::vector<Sample> samples() {
    const std::vector<Eigen::Vector3d> square = {
        {0, 0, 0.1}, {1, 0, 0.2}, {0, 1, 0.3}, {1, 1, 0.4}};
    const std::string rows = "0,0,0.1,0\n1,0,0.2,1\n0,1,0.3,2\n1,1,0.4,3\n";
    return {
        {"plain_header.csv", "X,Y,Z,Intensity\n" + rows, square},
        {"quoted_header.csv", "\"X\",\"Y\",\"Z\",\"Intensity\"\n" + rows, square},
        {"pandas_index.csv", ",x,y,z\n0,0,0,0.1\n1,1,0,0.2\n", {{0, 0, 0.1}, {1, 0, 0.2}}},
        {"paraview.csv", "\"Points:0\",\"Points:1\",\"Points:2\"\n0,0,0.1\n", {{0, 0, 0.1}}},
        {"order_yxz.csv",
         "//Y,X,Z\n0,0,0.1\n0,1,0.2\n5,0,0.3\n",
         {{0, 0, 0.1}, {1, 0, 0.2}, {0, 5, 0.3}}},
        {"yxz.txt",
         "//Y X Z\n0 0 0.1\n0 5 0.2\n5 0 0.3\n",
         {{0, 0, 0.1}, {5, 0, 0.2}, {0, 5, 0.3}}},
        {"id_first.txt",
         "# id x y z\n1 0.0 0.0 0.1\n2 1.0 0.0 0.2\n3 0.0 1.0 0.3\n4 1.0 1.0 0.4\n",
         square},
        {"units.txt", "# x [m] y [m] z [m]\n0 0 0.1\n", {{0, 0, 0.1}}},
        {"bom.txt",
         "\xef\xbb\xbf"
         "0 0 0.1\n1 0 0.2\n",
         {{0, 0, 0.1}, {1, 0, 0.2}}},
        {"cc_with_count.txt",
         "//X;Y;Z;Rf;Gf;Bf\n2\n0;0;0.1;1;0.5;0.25\n1;0;0.2;1;0.5;0.25\n",
         {{0, 0, 0.1}, {1, 0, 0.2}}},
        {"potree.pts",
         "2\n0 0 0.1 -255 10 20 30\n1 0 0.2 -255 10 20 30\n",
         {{0, 0, 0.1}, {1, 0, 0.2}}},
        {"two_scans.pts", "1\n0 0 0.1\n1\n1 0 0.2\n", {{0, 0, 0.1}, {1, 0, 0.2}}},
        {"mac.txt", "0 0 0.1\r1 0 0.2\r", {{0, 0, 0.1}, {1, 0, 0.2}}},
        {"comment.txt", "# the format is x y z\n0 0 0.1\n", {{0, 0, 0.1}}},
        {"appended.csv", "x,y,z\n0,0,0.1\nx,y,z\n1,0,0.2\n", {{0, 0, 0.1}, {1, 0, 0.2}}},
        {"comma_at_the_end.csv", "x,y,z\n0,0,0.1,\n1,0,0.2,\n", {{0, 0, 0.1}, {1, 0, 0.2}}},
        {"blanks_and_commas.csv", "0, 0, 0.1\n1 , 0 , 0.2\n", {{0, 0, 0.1}, {1, 0, 0.2}}},
    };
}

TEST(TextCloud, ColumnsAreFoundByTheirNames) {
    for (const Sample& sample : samples()) {
        const auto cloud = parse_text_cloud(sample.text, sample.file);
        ASSERT_TRUE(cloud.ok()) << sample.file << ": " << cloud.error().message;
        EXPECT_EQ(cloud->points_m, sample.points_m) << sample.file;
    }
    const auto id = parse_text_cloud("# id x y z\n7 0 0 0.1\n", "a.txt");
    EXPECT_EQ(id->scalar("id")->at(0), 7.0);
    const auto pts = parse_text_cloud("1\n0 0 0.1 -255 10 20 30\n", "a.pts");
    EXPECT_EQ(pts->scalar("intensity")->at(0), -255.0);
    EXPECT_EQ(pts->scalar("b")->at(0), 30.0);
}

TEST(TextCloud, EmptyFieldsAreNanInTheirOwnColumn) {
    for (const char* text : {"//X,Y,Z,dist,uncertainty\n0,0,0.1,,5\n1,0,0.2,,6\n",
                             "//X,Y,Z,dist,uncertainty\n0,0,0.1,null,5\n1,0,0.2,,6\n",
                             "x\ty\tz\tdist\tuncertainty\n0\t0\t0.1\t\t5\n1\t0\t0.2\t\t6\n"}) {
        const auto cloud = parse_text_cloud(text, "a.csv");
        ASSERT_TRUE(cloud.ok()) << text << cloud.error().message;
        EXPECT_EQ(cloud->points_m.at(1), Eigen::Vector3d(1, 0, 0.2)) << text;
        EXPECT_TRUE(std::isnan(cloud->scalar("dist")->at(0))) << text;
        EXPECT_TRUE(std::isnan(cloud->scalar("dist")->at(1))) << text;
        EXPECT_EQ(cloud->scalar("uncertainty")->at(1), 6.0) << text;
    }
    const auto filled = parse_text_cloud("//X,Y,Z,d\n0,0,0.1,1\n1,0,0.2,\n,,,\n", "a.csv");
    ASSERT_TRUE(filled.ok()) << filled.error().message;
    EXPECT_TRUE(std::isnan(filled->scalar("d")->at(1)));
    EXPECT_TRUE(std::isnan(filled->points_m.at(2).x())) << "no place is no point, not the origin";
}

TEST(TextCloud, WhatIsMistakenForAnotherPlaceIsRefused) {
    // Decimal commas were read as twice as many columns.
    EXPECT_TRUE(contains(why("0,0 0,0 0,1\n1,0 0,0 0,2\n"), "a.txt:1: commas and blanks"));
    EXPECT_TRUE(contains(why("0,0;0,0;0,1\n"), "a.txt:1: '0,0' has a decimal comma"));
    EXPECT_TRUE(contains(why("0\t0\t0.1\n0,5\t1\t2\n"), "a.txt:2: commas and blanks"));
    EXPECT_TRUE(contains(why("x,y,z\n0,0,0,0,0,1\n"), "accepted")) << "x y z come first";
    EXPECT_TRUE(contains(why("id,x,y,z\n0,0,0,0,0,1\n"),
                         "a.txt:2: the line has 6 numbers, but line 1 names 4"));
    EXPECT_TRUE(contains(why("# point id x y z\n1 0 0 0.1\n"), "names 5 columns"));
    EXPECT_TRUE(contains(why("easting,northing,up\n1,2,3\n"), "does not name x, y and z"));
    EXPECT_TRUE(contains(why("x [mm],y [mm],z [mm]\n1,2,3\n"), "is in 'mm'"));
    EXPECT_TRUE(contains(why("x,y,z\n0,0,1\ny,x,z\n0,0,1\n"), "a.txt:3: the columns change here"));
    EXPECT_TRUE(contains(why("3\n0 0 1\n1 0 1\n"), "announces 3 points, but has only 2"));
    EXPECT_TRUE(contains(why("0 0 1\n1 0 1\n5\n"), "a.txt:3: the line has 1 number"));
    EXPECT_TRUE(contains(why(std::string("\xff\xfe"
                                         "0\0",
                                         4)),
                         "UTF-16"));
}

TEST(TextCloud, LongWholeNumbersKeepEveryDigit) {
    const auto cloud = parse_text_cloud(
        "//X Y Z time_ns id time_s\n0 0 1 1403636579049999872 4000000399 1688000000.03\n", "a.txt");
    ASSERT_TRUE(cloud.ok()) << cloud.error().message;
    EXPECT_EQ(std::get<std::vector<std::int64_t>>(cloud->scalar("time_ns")->values).at(0),
              1403636579049999872);
    EXPECT_EQ(cloud->scalar("id")->at(0), 4000000399.0);
    EXPECT_EQ(cloud->scalar("time_s")->at(0), 1688000000.03);
    EXPECT_TRUE(
        contains(format_text_cloud(*cloud), "1403636579049999872 4000000399 1688000000.03"));
    // A column that begins with small numbers holds doubles; a note reports rounded values.
    const auto rounded = parse_text_cloud("0 0 1 5\n0 0 1 9007199254740993\n", "a.txt");
    ASSERT_TRUE(rounded.ok());
    EXPECT_TRUE(contains(rounded->notes.at(0), "1 whole numbers beyond 2^53 are rounded"));
    EXPECT_TRUE(contains(why("0 0 1 1403636579049999872\n0 0 1 0.5\n"), "whole number of 64 bits"));
}

TEST(TextCloud, PiecesAreTheFile) {
    for (const Sample& sample : samples()) {
        const auto whole = parse_text_cloud(sample.text, sample.file);
        TextCloudParser parser(sample.file);
        PointCloud all;
        for (std::size_t at = 0; at < sample.text.size();) {  // a line at a time
            const std::size_t end =
                std::min(sample.text.find('\n', at), sample.text.size() - 1) + 1;
            const auto piece = parser.parse(std::string_view(sample.text).substr(at, end - at));
            ASSERT_TRUE(piece.ok()) << sample.file << ": " << piece.error().message;
            all.points_m.insert(all.points_m.end(), piece->points_m.begin(), piece->points_m.end());
            if (!piece->points_m.empty()) {
                EXPECT_EQ(piece->scalars.size(), whole->scalars.size()) << sample.file;
            }
            at = end;
        }
        EXPECT_TRUE(parser.finish().ok()) << sample.file;
        EXPECT_EQ(all.points_m, whole->points_m) << sample.file;
    }
    // Line numbers continue through the whole file, and the header is valid for every piece.
    const TemporaryFolder folder;
    std::string text = "# id x y z\n";
    constexpr int kRows = 500000;  // more than a block of the stream
    for (int i = 0; i < kRows; ++i) text += std::to_string(i) + " 1 2 3\n";
    ASSERT_TRUE(write_file(folder / "a.txt", text + "oops 1 2 3\n").ok());
    auto stream = CloudStream::open(folder / "a.txt");
    ASSERT_TRUE(stream.ok());
    const auto status = stream->each_block([](const PointCloud& block) {
        EXPECT_EQ(block.points_m.back(), Eigen::Vector3d(1, 2, 3));
        return Status();
    });
    ASSERT_FALSE(status.ok());
    EXPECT_TRUE(contains(status.error().message, "a.txt:500002: 'oops' is not a number"))
        << status.error().message;
}

}  // namespace
}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/clouds/ply_stream.hpp"

#include <gtest/gtest.h>

#include "surefoot/io/clouds/point_cloud.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

using testing::contains;
using testing::TemporaryFolder;

TEST(PlyStream, CanBeReadAfterEveryPiece) {
    const TemporaryFolder folder;
    const std::string path = folder / "scan.ply";
    auto stream = PlyStream::create(path, {"station", "mixed"});
    ASSERT_TRUE(stream.ok()) << stream.error().message;
    EXPECT_EQ(read_cloud(path)->points_m.size(), 0U);
    // Cover the numbers of points at which the count gains a digit.
    for (int i = 0; i < 12; ++i) {
        const auto x = static_cast<float>(i);
        const float values[] = {x, 2.0F, 3.0F, 1.0F, 0.0F};
        ASSERT_TRUE(stream->add(values).ok());
        const auto cloud = read_cloud(path);
        ASSERT_TRUE(cloud.ok()) << cloud.error().message;
        ASSERT_EQ(cloud->points_m.size(), static_cast<std::size_t>(i + 1));
        EXPECT_EQ(cloud->points_m.back(), Eigen::Vector3d(i, 2.0, 3.0));
        EXPECT_EQ(cloud->points_m.front(), Eigen::Vector3d(0.0, 2.0, 3.0));
        EXPECT_EQ(cloud->scalar("station")->floats().back(), 1.0F);
    }
    EXPECT_EQ(stream->points(), 12);
    EXPECT_TRUE(stream->close().ok());
    EXPECT_TRUE(contains(stream->add({}).error().message, "closed already"));
}

TEST(PlyStream, SaysWhyItCannotWrite) {
    const auto nowhere = PlyStream::create("/proc/nowhere/scan.ply", {});
    ASSERT_FALSE(nowhere.ok());
    EXPECT_TRUE(contains(nowhere.error().message, "/proc/nowhere/scan.ply: cannot write"));
    EXPECT_EQ(nowhere.error().code, ErrorCode::output);
}

}  // namespace
}  // namespace surefoot::io

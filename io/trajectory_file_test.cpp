// SPDX-License-Identifier: Apache-2.0
#include "io/trajectory_file.hpp"

#include <gtest/gtest.h>

#include "io/file.hpp"
#include "io/io_testing.hpp"
#include "io/raw_floats.hpp"

namespace surefoot::io {
namespace {

using testing::contains;
using testing::data_path;

template <typename T>
std::string message(const Result<T>& result) {
    return result.ok() ? "accepted" : result.error().message;
}

TEST(TrajectoryFile, TumRoundTripKeepsStampsExactlyAndPosesToANanometre) {
    Rng rng(1);
    Trajectory original;
    std::int64_t time_ns = 1403715273262142976;
    for (int i = 0; i < 100; ++i) {
        time_ns += 1 + static_cast<std::int64_t>(rng.below(1'000'000'000));
        const Eigen::Vector3d turn(rng.normal(), rng.normal(), rng.normal());
        original.push_back({time_ns, {exp_so3(turn), {rng.normal(), rng.normal(), rng.normal()}}});
    }
    const auto copy = parse_tum_trajectory(format_tum_trajectory(original), "a.tum");
    ASSERT_TRUE(copy.ok()) << message(copy);
    ASSERT_EQ(copy->size(), original.size());
    for (std::size_t i = 0; i < original.size(); ++i) {
        EXPECT_EQ((*copy)[i].time_ns, original[i].time_ns);
        const Vector6 error = difference(original[i].T_world_body, (*copy)[i].T_world_body);
        // Nine decimals round by at most 5e-10; a rotation doubles that.
        EXPECT_LT(error.cwiseAbs().maxCoeff(), 3e-9) << i;
    }
}

TEST(TrajectoryFile, BadLinesAreNamed) {
    const auto tum = [](const char* text) { return message(parse_tum_trajectory(text, "a.tum")); };
    EXPECT_TRUE(contains(tum("1 0 0 0 0 0 0\n"), "a.tum:1: 7 numbers; 8 belong in a line"));
    EXPECT_TRUE(contains(tum("2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"),
                         "a.tum:2: stamp 1.000000000 s does not grow: 2.000000000 s came before"));
    EXPECT_TRUE(contains(tum("2 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n"), "does not grow"));
    EXPECT_TRUE(contains(tum("1 nan 0 0 0 0 0 1\n"), "a.tum:1: 'nan' is not a finite number"));
    EXPECT_TRUE(contains(tum("1 0 0 0 0 0 0 2\n"), "quaternion has length 2.0000"));
    EXPECT_TRUE(contains(tum("# only a comment\n"), "no poses"));
    const auto kitti = [](const char* text) { return message(parse_kitti_poses(text, "p.txt")); };
    EXPECT_TRUE(
        contains(kitti("1 0 0 0 0 1 0 0 0 0 2 0\n"), "p.txt:1: its left 3x3 is no rotation"));
    EXPECT_TRUE(contains(kitti("1 0 0 0 0 1 0 0 0 0 -1 0\n"), "no rotation"));
    EXPECT_TRUE(
        contains(write_tum_trajectory("/dev/full", {{1, Pose{}}}).error().message, "No space"));
}

TEST(TrajectoryFile, ReadsRealTruth) {
    const struct {
        const char* name;
        std::size_t poses;
    } files[] = {{"sequences/kitti_city/poses.txt", 51},
                 {"sequences/euroc_still/groundtruth.tum", 30}};
    for (const auto& file : files) {
        const std::string path = data_path(file.name);
        if (path.empty()) continue;
        const auto trajectory = read_trajectory(path);
        ASSERT_TRUE(trajectory.ok()) << message(trajectory);
        EXPECT_EQ(trajectory->size(), file.poses);
    }
    const std::string path = data_path("sequences/kitti_city/poses.txt");
    if (path.empty()) return;
    const auto trajectory = read_trajectory(path);
    EXPECT_EQ(trajectory->at(1).time_ns, 100'000'000) << "from times.txt";
    double length_m = 0.0;
    for (std::size_t i = 1; i < trajectory->size(); ++i) {
        length_m += ((*trajectory)[i].T_world_body.translation_m -
                     (*trajectory)[i - 1].T_world_body.translation_m)
                        .norm();
    }
    EXPECT_NEAR(length_m, 59.9, 0.1) << "the path length that its description gives";
}

TEST(TrajectoryFile, SurvivesDamagedFiles) {
    const std::string tum = format_tum_trajectory({{1000, Pose{}}, {2000, Pose{}}});
    testing::for_each_mutation(tum, 3000, 3, [](const std::string& text) {
        const auto trajectory = parse_tum_trajectory(text, "damaged");
        if (!trajectory.ok()) return;
        for (const StampedPose& pose : *trajectory) EXPECT_TRUE(pose.T_world_body.all_finite());
    });
    testing::for_each_mutation("1 0 0 0.5 0 1 0 0 0 0 1 0\n", 3000, 4, [](const std::string& text) {
        const auto poses = parse_kitti_poses(text, "damaged");
        if (!poses.ok()) return;
        for (const Pose& pose : *poses) EXPECT_TRUE(pose.all_finite());
    });
    testing::for_each_mutation("0.0\n1.036224e-01\n0.2\n", 2000, 5, [](const std::string& text) {
        (void)parse_times(text, "damaged").ok();
    });
}

TEST(RawFloats, RoundTripAndRefuseWrongSizes) {
    const testing::TemporaryFolder folder;
    const std::vector<float> values{1.0F, -0.0F, 3e-40F};
    ASSERT_TRUE(write_floats(folder / "a.f32", values).ok());
    EXPECT_EQ(*read_floats(folder / "a.f32", 3), values);
    EXPECT_TRUE(
        contains(message(read_floats(folder / "a.f32", 4)), "3 float32 values; 4 are expected"));
    EXPECT_TRUE(
        contains(message(parse_floats("abc", "a.f32")), "a.f32: 3 bytes are no whole number"));
    const std::string path = data_path("conformance/traversability/elevation.f32");
    if (!path.empty()) {
        EXPECT_EQ(read_floats(path)->size(), 230400U / 4U);
    }
}

}  // namespace
}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/recordings/trajectory_file.hpp"

#include <gtest/gtest.h>

#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"
#include "surefoot/io/raw_floats.hpp"

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
    const auto file = parse_trajectory(format_tum_trajectory(original), "a.tum");
    ASSERT_TRUE(file.ok()) << message(file);
    EXPECT_EQ(file->format, "TUM");
    EXPECT_TRUE(file->notes().empty());
    const Trajectory& copy = file->poses;
    ASSERT_EQ(copy.size(), original.size());
    for (std::size_t i = 0; i < original.size(); ++i) {
        EXPECT_EQ(copy[i].time_ns, original[i].time_ns);
        const Vector6 error = difference(original[i].T_world_body, copy[i].T_world_body);
        // Nine decimals round by at most 5e-10; a rotation doubles that.
        EXPECT_LT(error.cwiseAbs().maxCoeff(), 3e-9) << i;
    }
}

TEST(TrajectoryFile, BadLinesAreNamed) {
    const auto why = [](const std::string& text) {
        return message(parse_trajectory(text, "a.tum"));
    };
    const std::string good = "1 0 0 0 0 0 0 1\n";
    EXPECT_TRUE(contains(why("1 0 0 0 0 0 0\n"),
                         "a.tum:1: the line has 7 numbers. A line of a trajectory has 8"));
    EXPECT_TRUE(
        contains(why(good + "2 0 0 0 0 0 0\n"), "a.tum:2: the line has 7 numbers, but needs 8"));
    EXPECT_TRUE(contains(why(good + "2 1 2 3 0 0 0 0\n"), "a.tum:2: quaternion has length 0.0000"));
    EXPECT_TRUE(contains(why("1 0 0 0 0 0 0 2\n"), "quaternion has length 2.0000"));
    // `eval trajectory --plot` broke an invariant.
    EXPECT_TRUE(contains(why(good + "2 0 -1e200 0 0 0 0 1\n"),
                         "a.tum:2: a coordinate of the position is 1e+200 m; at most 1e+09 m"));
    EXPECT_TRUE(contains(why(good + "2 0 x 0 0 0 0 1\n"), "a.tum:2: 'x' is not a number"));
    EXPECT_TRUE(contains(why("1,5 0,1 0,2 0,3 0 0 0 1\n"), "a.tum:1: commas and blanks"));
    EXPECT_TRUE(contains(why("1,5;0,1;0;0;0;0;0;1\n"), "'1,5' has a decimal comma"));
    EXPECT_TRUE(contains(why("# only a comment\n"), "no poses"));
    EXPECT_TRUE(contains(why("1 nan 0 0 0 0 0 1\n"), "no poses in this trajectory (1 rows"));
    EXPECT_TRUE(contains(why("a b c d e f g h\n" + good), "the header line begins with 'a'"));
    EXPECT_TRUE(contains(why(std::string("\xff\xfe") + "1"), "a.tum:1: is text in UTF-16"));
    EXPECT_TRUE(
        contains(why("1403636579000000000,0,0,0,1,0,0,0\n"), "is the quaternion qw,qx,qy,qz"));
    EXPECT_TRUE(contains(why("1 0 0 0 0 1 0 0 0 0 2 0\n"),
                         "a.tum:1: the left 3x3 part of the matrix is not a rotation"));
    EXPECT_TRUE(contains(why("1 0 0 0 0 1 0 0 0 0 -1 0\n"), "not a rotation"));
    EXPECT_TRUE(
        contains(write_tum_trajectory("/dev/full", {{1, Pose{}}}).error().message, "No space"));
}

TEST(TrajectoryFile, RowsThatAreOnlyOddAreLeftOutOrSortedAndCounted) {
    // A stamp that is there twice, as in the ground truth of TUM fr2/desk; the second row is 1 mm
    // off.
    const auto twice = parse_trajectory(
        "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n2 1.001 0 0 0 0 0 1\n3 2 0 0 0 0 0 1\n", "a.tum");
    ASSERT_TRUE(twice.ok()) << message(twice);
    EXPECT_EQ(twice->repeated, 1);
    ASSERT_EQ(twice->poses.size(), 3U);
    EXPECT_EQ(twice->poses[1].T_world_body.translation_m.x(), 1.0) << "the first is kept";
    EXPECT_TRUE(contains(twice->notes().at(0), "1 rows with a repeated time stamp are left out"));
    EXPECT_TRUE(contains(twice->notes().at(0), "at most 0.0010 m"));

    const auto unsorted = parse_trajectory("2 1 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", "a.tum");
    ASSERT_TRUE(unsorted.ok());
    EXPECT_TRUE(unsorted->sorted);
    EXPECT_EQ(unsorted->poses.front().time_ns, 1'000'000'000);

    const auto holes = parse_trajectory(
        "1 NaN NaN NaN NaN NaN NaN NaN\n2 0 0 0 0 0 0 1\nnan 0 0 0 0 0 0 1\n3 inf 0 0 0 0 0 1\n",
        "a.tum");
    ASSERT_TRUE(holes.ok()) << message(holes);
    EXPECT_EQ(holes->not_finite, 3);
    EXPECT_EQ(holes->poses.size(), 1U);
}

TEST(TrajectoryFile, ColumnsAndUnitsAreThoseOfTheHead) {
    const std::string tail = "0.5,1,2,3,0.6,0,0,0.8\n";
    const struct {
        const char* what;
        std::string text;
        const char* format;
        const char* stamps;
        std::int64_t time_ns;
    } files[] = {
        {"plain head",
         "timestamp tx ty tz qx qy qz qw\n0.5 1 2 3 0.6 0 0 0.8\n",
         "TUM",
         "s",
         500'000'000},
        {"quoted head, mark of UTF-8",
         "\xef\xbb\xbf\"t\",\"x\",\"y\",\"z\",\"qx\",\"qy\",\"qz\",\"qw\"\n" + tail,
         "TUM",
         "s",
         500'000'000},
        {"a column before",
         "num, t, x, y, z, qx, qy, qz, qw\n0, " + tail,
         "columns by name",
         "s",
         500'000'000},
        {"EuRoC",
         "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
         "q_RS_z [], v_RS_R_x [m s^-1]\n1403636579049999872,1,2,3,0.8,0.6,0,0,9\n",
         "EuRoC csv",
         "ns",
         1403636579049999872},
        {"EuRoC without a head",
         "1403636579049999872,1,2,3,0.8,0.6,0,0,9,9,9,9,9,9,9,9,9\n",
         "EuRoC csv",
         "ns",
         1403636579049999872},
        {"unit in the head",
         "#timestamp [ns],px,py,pz,qw,qx,qy,qz\n500,1,2,3,0.8,0.6,0,0\n",
         "columns by name",
         "ns",
         500},
        {"ORB-SLAM3",
         "1403636579049999872.000000 1 2 3 0.6 0 0 0.8\n",
         "TUM",
         "ns",
         1403636579049999872},
        {"microseconds", "1403636579049999 1 2 3 0.6 0 0 0.8\n", "TUM", "us", 1403636579049999000},
        {"milliseconds", "1403636579049.5 1 2 3 0.6 0 0 0.8\n", "TUM", "ms", 1403636579049500000},
        {"old Mac line ends", "# a comment\r0.5 1 2 3 0.6 0 0 0.8\r", "TUM", "s", 500'000'000},
    };
    for (const auto& file : files) {
        const auto read = parse_trajectory(file.text, "a.csv");
        ASSERT_TRUE(read.ok()) << file.what << ": " << message(read);
        EXPECT_EQ(read->format, file.format) << file.what;
        EXPECT_EQ(read->stamps, file.stamps) << file.what;
        ASSERT_EQ(read->poses.size(), 1U) << file.what;
        EXPECT_EQ(read->poses[0].time_ns, file.time_ns) << file.what;
        const Pose& pose = read->poses[0].T_world_body;
        EXPECT_EQ(pose.translation_m, Eigen::Vector3d(1, 2, 3)) << file.what;
        EXPECT_NEAR(pose.rotation.x(), 0.6, 1e-12) << file.what;
        EXPECT_NEAR(pose.rotation.w(), 0.8, 1e-12) << file.what;
    }
    // Nanoseconds from another origin are recognised by their steps.
    const auto relative = parse_trajectory("0 0 0 0 0 0 0 1\n50000000 1 0 0 0 0 0 1\n", "a.tum");
    ASSERT_TRUE(relative.ok());
    EXPECT_EQ(relative->stamps, "ns");
}

TEST(TrajectoryFile, KittiPosesGetTheirStamps) {
    const std::string row = "1 0 0 5 0 1 0 6 0 0 1 7\n";
    auto kitti = parse_trajectory(row + "nan 0 0 0 0 1 0 0 0 0 1 0\n" + row, "p.txt");
    ASSERT_TRUE(kitti.ok()) << message(kitti);
    EXPECT_EQ(kitti->format, "KITTI poses");
    EXPECT_FALSE(kitti->has_stamps());
    EXPECT_EQ(kitti->rows, 3U);
    ASSERT_EQ(kitti->poses.size(), 2U);
    EXPECT_EQ(kitti->poses[1].time_ns, 200'000'000) << "a row that is left out keeps its time";
    EXPECT_EQ(kitti->poses[0].T_world_body.translation_m, Eigen::Vector3d(5, 6, 7));
    const std::vector<std::int64_t> times_ns{10, 20, 30};
    EXPECT_FALSE(give_stamps(std::span(times_ns).first(2), "t.txt", *kitti).ok());
    ASSERT_TRUE(give_stamps(times_ns, "t.txt", *kitti).ok());
    EXPECT_EQ(kitti->poses[1].time_ns, 30);
    EXPECT_EQ(kitti->stamps, "t.txt");
    EXPECT_EQ(parse_times("1403636579049999872\n1403636579099999872\n", "t")->at(0),
              1403636579049999872);
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
        EXPECT_EQ(trajectory->poses.size(), file.poses);
    }
    const std::string path = data_path("sequences/kitti_city/poses.txt");
    if (path.empty()) return;
    const auto trajectory = read_trajectory(path);
    EXPECT_EQ(trajectory->poses.at(1).time_ns, 100'000'000) << "from times.txt";
    double length_m = 0.0;
    for (std::size_t i = 1; i < trajectory->poses.size(); ++i) {
        length_m += (trajectory->poses[i].T_world_body.translation_m -
                     trajectory->poses[i - 1].T_world_body.translation_m)
                        .norm();
    }
    EXPECT_NEAR(length_m, 59.9, 0.1) << "the path length that its description gives";
}

TEST(TrajectoryFile, SurvivesDamagedFiles) {
    for (const std::string& valid : {format_tum_trajectory({{1000, Pose{}}, {2000, Pose{}}}),
                                     std::string("1 0 0 0.5 0 1 0 0 0 0 1 0\n"),
                                     std::string("num,t,x,y,z,qx,qy,qz,qw\n0,1,2,3,4,0,0,0,1\n")}) {
        testing::for_each_mutation(valid, 3000, 3, [](const std::string& text) {
            const auto trajectory = parse_trajectory(text, "damaged");
            if (!trajectory.ok()) return;
            std::int64_t last_ns = std::numeric_limits<std::int64_t>::min();
            for (const StampedPose& pose : trajectory->poses) {
                EXPECT_TRUE(pose.T_world_body.all_finite());
                EXPECT_GT(pose.time_ns, last_ns);
                last_ns = pose.time_ns;
            }
        });
    }
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
        contains(message(parse_floats("abc", "a.f32")), "a.f32: 3 bytes are not a multiple of 4"));
    const std::string path = data_path("conformance/traversability/elevation.f32");
    if (!path.empty()) {
        EXPECT_EQ(read_floats(path)->size(), 230400U / 4U);
    }
}

}  // namespace
}  // namespace surefoot::io

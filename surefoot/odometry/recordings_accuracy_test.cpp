// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <numeric>

#include "surefoot/odometry/odometry.hpp"
#include "surefoot/odometry/recordings_testing.hpp"

namespace surefoot::odometry {
namespace {

using testing::Recording;

/// Positions of the left camera in odom.
std::vector<Eigen::Vector3d> follow(const Recording& recording) {
    const auto rectifier = camera::Rectifier::make(recording.rig);
    EXPECT_TRUE(rectifier.ok());
    Odometry odometry({}, *rectifier);
    Serial serial;
    std::vector<Eigen::Vector3d> positions;
    for (int i = 0; i < recording.frames; ++i) {
        const MotionEstimate m = odometry.update(recording.frame(i), serial);
        EXPECT_NE(m.health, Health::lost) << "frame " << i << " " << to_string(m.reason);
        positions.push_back((m.T_odom_body * recording.rig.body_from_left()).translation_m);
    }
    return positions;
}

std::vector<Eigen::Vector3d> truth_positions(const Recording& recording) {
    std::vector<Eigen::Vector3d> positions;
    for (const Pose& T : recording.T_world_camera) positions.push_back(T.translation_m);
    return positions;
}

bool missing(const std::optional<Recording>& recording, const char* name) {
    if (!recording) std::printf("skipped 1 check: recording %s is not there\n", name);
    return !recording;
}

TEST(Recordings, KittiCityFollowsTheTruth) {
    const auto recording = testing::kitti_city();
    if (missing(recording, "sequences/kitti_city")) return;
    const double ate_m = testing::aligned_rmse_m(follow(*recording), truth_positions(*recording));
    std::printf("kitti_city ATE %.3f m\n", ate_m);
    EXPECT_LT(ate_m, 0.135);  // the requirement is 0.15 m; libviso2 has 0.120 m
}

TEST(Recordings, ZedOfficeStepsAreTenCentimetres) {
    const auto recording = testing::zed_office();
    if (missing(recording, "sequences/zed_office")) return;
    const auto positions = follow(*recording);
    std::vector<double> steps_mm;
    for (std::size_t i = 1; i < positions.size(); ++i)
        steps_mm.push_back(1e3 * (positions[i] - positions[i - 1]).norm());
    const double n = static_cast<double>(steps_mm.size());
    const double mean_mm = std::accumulate(steps_mm.begin(), steps_mm.end(), 0.0) / n;
    double square = 0.0;
    for (const double step : steps_mm) square += (step - mean_mm) * (step - mean_mm);
    const double spread_mm = std::sqrt(square / (n - 1.0));
    std::printf("zed_office steps %.1f +- %.1f mm\n", mean_mm, spread_mm);
    EXPECT_GT(mean_mm, 98.0);  // the requirement is 95 to 108 mm
    EXPECT_LT(mean_mm, 107.0);
    EXPECT_LT(spread_mm, 6.0);  // the requirement is 8 mm
}

TEST(Recordings, EurocStillDoesNotDrift) {
    const auto recording = testing::euroc_still();
    if (missing(recording, "sequences/euroc_still")) return;
    const auto positions = follow(*recording);
    double worst_m = 0.0;
    for (const auto& p : positions) worst_m = std::max(worst_m, (p - positions.front()).norm());
    std::printf("euroc_still farthest %.2f mm\n", 1e3 * worst_m);
    EXPECT_LT(worst_m, 1e-3);  // the requirement is 5 mm
}

TEST(Recordings, RenderedRoomFollowsTheTruth) {
    const char* folder = std::getenv("SUREFOOT_RENDERED_ROOM");  // written by render_room.py
    if (folder == nullptr) {
        std::printf("skipped 1 check: SUREFOOT_RENDERED_ROOM is not set\n");
        return;
    }
    const auto recording = testing::rendered_room(folder);
    if (missing(recording, folder)) return;
    const double ate_m = testing::aligned_rmse_m(follow(*recording), truth_positions(*recording));
    std::printf("rendered room ATE %.4f m\n", ate_m);
    EXPECT_LT(ate_m, 2e-3);  // the requirement is 20 mm
}

}  // namespace
}  // namespace surefoot::odometry

// SPDX-License-Identifier: Apache-2.0
#include <Eigen/SVD>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "surefoot/odometry/visual/pose_solver.hpp"

namespace surefoot::odometry {
namespace {

/// The search stops early when one sample is free of outliers with this probability.
constexpr double kConfidence = 0.9999;

struct Consensus {
    int points = 0;
    double votes = 0.0;
};

Consensus count_agreeing(const camera::RectifiedRig& rig,
                         std::span<const PointMatch> matches,
                         const Pose& T_world_camera,
                         double threshold_px,
                         std::vector<std::uint8_t>& inlier) {
    const Eigen::Matrix3d R_camera_world = T_world_camera.R().transpose();
    Consensus agreeing;
    for (std::size_t i = 0; i < matches.size(); ++i) {
        const Eigen::Vector3d p =
            R_camera_world * (matches[i].p_world_m - T_world_camera.translation_m);
        inlier[i] = 0;
        if (p.z() <= 0.0) continue;
        const Eigen::Vector2d error = (project_stereo(rig, p) - matches[i].pixel_px).head<2>();
        if (error.squaredNorm() > threshold_px * threshold_px) continue;
        inlier[i] = 1;
        agreeing.points += 1;
        agreeing.votes += matches[i].vote;
    }
    return agreeing;
}

std::array<std::size_t, 3> three_different(std::size_t n, Rng& rng) {
    std::array<std::size_t, 3> index{};
    index[0] = rng.below(n);
    do index[1] = rng.below(n);
    while (index[1] == index[0]);
    do index[2] = rng.below(n);
    while (index[2] == index[0] || index[2] == index[1]);
    return index;
}

/// Up to four camera poses that map three points exactly to their observations.
std::vector<Pose> three_point_poses(const camera::RectifiedRig& rig,
                                    std::span<const PointMatch> matches,
                                    const std::array<std::size_t, 3>& sample) {
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> pixels;
    for (const std::size_t i : sample) {
        const Eigen::Vector3d& p = matches[i].p_world_m;
        points.emplace_back(p.x(), p.y(), p.z());
        pixels.emplace_back((matches[i].pixel_px.x() - rig.cx_px) / rig.fx_px,
                            (matches[i].pixel_px.y() - rig.cy_px) / rig.fy_px);
    }
    std::vector<cv::Mat> rotations;
    std::vector<cv::Mat> translations;
    cv::solveP3P(points,
                 pixels,
                 cv::Matx33d::eye(),
                 cv::noArray(),
                 rotations,
                 translations,
                 cv::SOLVEPNP_P3P);
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < rotations.size(); ++i) {
        const double* r = rotations[i].ptr<double>();
        const double* t = translations[i].ptr<double>();
        const Pose T_camera_world{exp_so3({r[0], r[1], r[2]}), {t[0], t[1], t[2]}};
        if (T_camera_world.all_finite()) poses.push_back(T_camera_world.inverse());
    }
    return poses;
}

int rounds_needed(int agreeing, std::size_t n, int most) {
    const double ratio = static_cast<double>(agreeing) / static_cast<double>(n);
    const double all_good = ratio * ratio * ratio;
    if (all_good < 1e-6) return most;
    if (all_good > 0.999) return 1;
    const double rounds = std::log(1.0 - kConfidence) / std::log(1.0 - all_good);
    return rounds < most ? static_cast<int>(rounds) + 1 : most;
}

}  // namespace

PoseSolution find_pose(const camera::RectifiedRig& rig,
                       const PoseSolverConfig& config,
                       std::span<const PointMatch> matches,
                       const Pose& T_world_camera_predicted,
                       Rng rng) {
    PoseSolution best;
    best.T_world_camera = T_world_camera_predicted;
    best.inlier.assign(matches.size(), 0);
    if (matches.size() < static_cast<std::size_t>(kMinimalPoseMatches)) return best;
    Consensus most =
        count_agreeing(rig, matches, best.T_world_camera, config.ransac_threshold_px, best.inlier);
    std::vector<std::uint8_t> inlier(matches.size());
    int rounds = rounds_needed(most.points, matches.size(), config.ransac_rounds);
    for (int round = 0; round < rounds; ++round) {
        const auto sample = three_different(matches.size(), rng);
        for (const Pose& T : three_point_poses(rig, matches, sample)) {
            const Consensus agreeing =
                count_agreeing(rig, matches, T, config.ransac_threshold_px, inlier);
            if (agreeing.votes <= most.votes) continue;
            most = agreeing;
            best.T_world_camera = T;
            best.inlier.swap(inlier);
            rounds = rounds_needed(agreeing.points, matches.size(), config.ransac_rounds);
        }
    }
    best.inliers = most.points;
    best.found = best.inliers >= kMinimalPoseMatches;
    return best;
}

}  // namespace surefoot::odometry

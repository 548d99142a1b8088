// SPDX-License-Identifier: Apache-2.0
#include "studies/board_calibration/rendered_boards.hpp"

#include <algorithm>
#include <numbers>

#include "surefoot/calibration/boards/board_print.hpp"

namespace surefoot::app {
namespace {

constexpr double kMostTilt_rad = std::numbers::pi / 4.5;
constexpr double kMostRoll_rad = std::numbers::pi / 9.0;
/// Limits of the distance, divided by the longer side of the board. At the smallest distance this
/// side spans nearly the width of the image of a 60 deg lens. At the largest distance it spans
/// about half of the width.
constexpr double kNearest = 0.9;
constexpr double kFarthest = 1.7;
constexpr double kBorder_px = 4.0;

/// Returns true if a camera sees the whole sheet at least kBorder_px inside the image.
bool sees(const BoardCamera& camera,
          const PrintedSheet::Rectangle& paper,
          const Pose& T_left_board) {
    const Pose T_camera_board = camera.T_left_camera.inverse() * T_left_board;
    constexpr int kSteps = 8;  // samples along each side: straight edges bend in a fisheye
    for (int i = 0; i <= kSteps; ++i) {
        const double s = static_cast<double>(i) / kSteps;
        const double x_m = paper.left_m + s * (paper.right_m - paper.left_m);
        const double y_m = paper.top_m + s * (paper.bottom_m - paper.top_m);
        for (const Eigen::Vector3d& p_m : {Eigen::Vector3d(x_m, paper.top_m, 0.0),
                                           Eigen::Vector3d(x_m, paper.bottom_m, 0.0),
                                           Eigen::Vector3d(paper.left_m, y_m, 0.0),
                                           Eigen::Vector3d(paper.right_m, y_m, 0.0)}) {
            const auto pixel = camera::project(camera.camera.model, T_camera_board * p_m);
            if (!pixel || pixel->x() < kBorder_px || pixel->y() < kBorder_px ||
                pixel->x() > camera.camera.width - 1 - kBorder_px ||
                pixel->y() > camera.camera.height - 1 - kBorder_px)
                return false;
        }
    }
    return true;
}

}  // namespace

std::vector<BoardCamera> cameras_of(const camera::StereoRig& rig) {
    std::vector<BoardCamera> cameras = {{rig.left, Pose{}}};
    if (rig.right) cameras.push_back({*rig.right, rig.T_left_right});
    return cameras;
}

std::vector<Pose> shown_poses(const calibration::Board& board,
                              std::span<const BoardCamera> cameras,
                              int count,
                              Rng& rng) {
    const auto sheet = calibration::print_of(board);
    if (!sheet || cameras.empty()) return {};
    const auto& paper = sheet->paper;
    const Eigen::Vector3d middle_m(
        0.5 * (paper.left_m + paper.right_m), 0.5 * (paper.top_m + paper.bottom_m), 0.0);
    const double size_m = std::max(paper.right_m - paper.left_m, paper.bottom_m - paper.top_m);
    const camera::Camera& left = cameras.front().camera;
    std::vector<Pose> poses;
    constexpr int kTriesPerPose = 400;
    for (int tries = 0; tries < count * kTriesPerPose && std::ssize(poses) < count; ++tries) {
        const Eigen::Vector2d pixel(rng.uniform(0.0, left.width), rng.uniform(0.0, left.height));
        const double distance_m = size_m * rng.uniform(kNearest, kFarthest);
        const Eigen::Vector3d turn_rad(rng.uniform(-kMostTilt_rad, kMostTilt_rad),
                                       rng.uniform(-kMostTilt_rad, kMostTilt_rad),
                                       rng.uniform(-kMostRoll_rad, kMostRoll_rad));
        const auto ray = camera::unproject(left.model, pixel);
        if (!ray) continue;
        // The board first faces the camera and is then turned.
        const Eigen::Quaterniond facing =
            Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), *ray);
        Pose T_left_board{facing * exp_so3(turn_rad), Eigen::Vector3d::Zero()};
        T_left_board.translation_m = distance_m * *ray - T_left_board.rotation * middle_m;
        const bool seen =
            std::all_of(cameras.begin(), cameras.end(), [&](const BoardCamera& camera) {
                return sees(camera, paper, T_left_board);
            });
        if (seen) poses.push_back(T_left_board);
    }
    return poses;
}

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
// Are the errors of a calibrated stereo rig with wide lenses consistent with its stated
// uncertainty, and does the calibration suggest the correct lens model if another one was chosen?
// Input: rendered pictures of chessboards under six conditions, found by our finder.
// Usage: wide_rigs OUT_FOLDER FIRST_SEED SEEDS
//
// Writes into OUT_FOLDER:
// rigs.csv, one line per rig: seed, lens, pairs used, pairs shown, noise of a corner coordinate
//   [px], error of the baseline and its sigma [mm], error of the depth of a point 1 m ahead and its
//   sigma [mm], squared Mahalanobis distance of the right camera's pose (six degrees of freedom).
// advice.csv, one line per chosen model: seed, lens, true model, chosen model, calibrated (1 =
//   succeeded), suggested model (empty = none), rms [px] of the suggested and of the chosen model,
//   message.
#include <fmt/format.h>
#include <fmt/os.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core/utility.hpp>

#include "surefoot/calibration/boards/detect_board.hpp"
#include "surefoot/calibration/boards/wide_boards_testing.hpp"
#include "surefoot/calibration/lenses/lens_advice.hpp"
#include "surefoot/calibration/lenses/rectified_errors.hpp"
#include "surefoot/calibration/stereo_calibration.hpp"
#include "surefoot/camera/rectifier.hpp"

namespace surefoot {
namespace {

using calibration::BoardView;
using calibration::LensKind;
using calibration::testing::WideProfile;

constexpr calibration::ImageSize kSize{640, 480};
constexpr int kPairs = 12;
constexpr double kMostTilt_deg = 45.0;
constexpr double kLeastStep_px = 7.0;
constexpr double kDistance_m = 1.0;
constexpr double kMillimetres = 1e3;
const calibration::Board board_9x6{.columns = 9, .rows = 6, .spacing_m = 0.03};

struct Lens {
    std::string name;
    LensKind kind;
    camera::Camera camera;
};

std::vector<Lens> lenses() {
    const auto wide = [](WideProfile profile, double fov_deg) {
        return Lens{
            fmt::format("{:.0f} deg {}",
                        fov_deg,
                        calibration::testing::kWideProfileNames[static_cast<std::size_t>(profile)]),
            profile == WideProfile::rational ? LensKind::rational : LensKind::fisheye,
            calibration::testing::wide_camera(profile, fov_deg, kSize)};
    };
    const Lens usual{
        "67 deg pinhole5",
        LensKind::pinhole5,
        {camera::PinholeRadTan{480.0, 480.8, 325.0, 236.0, -0.28, 0.11, 4e-4, -2e-4, -0.02},
         kSize.width,
         kSize.height}};
    return {usual,
            wide(WideProfile::rational, 100.0),
            wide(WideProfile::rational, 120.0),
            wide(WideProfile::equidistant, 100.0),
            wide(WideProfile::stereographic, 120.0),
            wide(WideProfile::bought, 140.0),
            wide(WideProfile::equisolid, 160.0),
            wide(WideProfile::equidistant, 170.0)};
}

camera::StereoRig rig_of(const Lens& lens) {
    camera::StereoRig rig;
    rig.left = lens.camera;
    rig.right = lens.camera;
    rig.T_left_right = {exp_so3({0.008, -0.012, 0.005}), {0.08, 0.0007, -0.0004}};
    return rig;
}

struct Pairs {
    std::vector<BoardView> left;
    std::vector<BoardView> right;
};

/// Returns true if all inner corners of the board lie at least kBorder_px inside the image of a
/// camera.
bool is_whole(const camera::Camera& camera, const Pose& T_camera_board) {
    constexpr double kBorder_px = 0.5 * kLeastStep_px;
    const auto corners =
        calibration::testing::true_corners(board_9x6, camera, T_camera_board, kLeastStep_px);
    return corners && std::all_of(corners->begin(), corners->end(), [&](const auto& p) {
               return p.x() > kBorder_px && p.y() > kBorder_px &&
                      p.x() < camera.width - 1 - kBorder_px &&
                      p.y() < camera.height - 1 - kBorder_px;
           });
}

Pairs seen_pairs(const camera::StereoRig& rig, std::uint64_t seed) {
    Pairs pairs;
    Rng rng(seed);
    while (std::ssize(pairs.left) < kPairs) {
        const Pose T_left_board =
            calibration::testing::wide_pose(board_9x6, rig.left, kMostTilt_deg, kLeastStep_px, rng);
        const Pose T_right_board = rig.T_left_right.inverse() * T_left_board;
        if (!is_whole(*rig.right, T_right_board)) continue;
        const auto i = pairs.left.size();
        const auto& look = calibration::testing::kWideLooks[i % 6];
        const auto found =
            [&](const camera::Camera& camera, const Pose& T, std::uint64_t this_camera) {
                const auto image = calibration::testing::wide_picture(
                    board_9x6, camera, T, look, mix_seed(seed, 2 * i + this_camera));
                return calibration::detect_board(board_9x6, image.view()).view;
            };
        pairs.left.push_back(found(rig.left, T_left_board, 0));
        pairs.right.push_back(found(*rig.right, T_right_board, 1));
        if (!pairs.left.back().ids.empty() && !pairs.right.back().ids.empty())
            pairs.right.back() =
                calibration::turned_like(board_9x6, pairs.left.back(), pairs.right.back());
    }
    return pairs;
}

/// Returns the depth error of a point straight ahead. The true cameras take the pictures; the
/// estimated rig rectifies and measures them.
double depth_error_m(const camera::StereoRig& truth, const camera::StereoRig& found) {
    const camera::Rectification plan = camera::plan_rectification(
        found, camera::RectificationConfig{}, camera::Rectifier::kVirtualBaseline_m);
    const Eigen::Vector3d p_m =
        plan.left.R_rectified_raw.transpose() * Eigen::Vector3d(0.0, 0.0, kDistance_m);
    const auto left = camera::project(truth.left.model, p_m);
    const auto right = camera::project(truth.right->model, truth.T_left_right.inverse() * p_m);
    if (!left || !right) return std::nan("");
    const auto l = calibration::rectified_direction(plan.left, *left);
    const auto r = calibration::rectified_direction(*plan.right, *right);
    if (!l || !r) return std::nan("");
    return plan.rig.baseline_m / (l->x() - r->x()) - kDistance_m;
}

void compare_rig(const Lens& lens, std::uint64_t seed, const Pairs& pairs, fmt::ostream& out) {
    const camera::StereoRig truth = rig_of(lens);
    const auto estimate =
        calibration::calibrate_stereo(board_9x6, pairs.left, pairs.right, kSize, lens.kind);
    if (!estimate) {
        fmt::print("{} seed {}: {}\n", lens.name, seed, estimate.error().message);
        return;
    }
    for (const calibration::RejectedView& pair : estimate->rejected)
        fmt::print("{} seed {} pair {}: {}\n", lens.name, seed, pair.index, pair.reason);
    const Pose& found = estimate->rig.T_left_right;
    const Eigen::Matrix<double, 6, 6> covariance =
        estimate->covariance.bottomRightCorner<6, 6>().eval();
    const Eigen::Vector3d along = found.R().transpose() * found.translation_m.normalized();
    const double sigma_m = std::sqrt(along.dot(covariance.topLeftCorner<3, 3>() * along));
    const Vector6 error = difference(truth.T_left_right, found);
    out.print("{},{},{},{},{:.4f},{:.5f},{:.5f},{:.4f},{:.4f},{:.2f}\n",
              seed,
              lens.name,
              estimate->pairs.size(),
              pairs.left.size(),
              estimate->sigma_px,
              kMillimetres * (found.translation_m.norm() - truth.T_left_right.translation_m.norm()),
              kMillimetres * sigma_m,
              kMillimetres * depth_error_m(truth, estimate->rig),
              kMillimetres * estimate->depth_errors[1].sigma_m,
              error.dot(covariance.ldlt().solve(error)));
    out.flush();
}

void compare_advice(const Lens& lens, std::uint64_t seed, const Pairs& pairs, fmt::ostream& out) {
    const auto name = [](LensKind kind) {
        return calibration::kLensKindNames[static_cast<std::size_t>(kind)];
    };
    for (const LensKind chosen :
         {LensKind::pinhole4, LensKind::pinhole5, LensKind::rational, LensKind::fisheye}) {
        const auto estimate = calibration::calibrate_mono(board_9x6, pairs.left, kSize, chosen);
        const auto advice = calibration::advise_lens(board_9x6, pairs.left, kSize, chosen);
        const std::string message = estimate ? "" : estimate.error().message;
        out.print("{},{},{},{},{},{},{:.4f},{:.4f},\"{}\"\n",
                  seed,
                  lens.name,
                  name(lens.kind),
                  name(chosen),
                  estimate ? 1 : 0,
                  advice ? name(advice->better.kind) : "",
                  advice ? advice->better.rms_px : 0.0,
                  advice ? advice->chosen.rms_px : 0.0,
                  message);
        out.flush();
    }
}

int measure(const std::filesystem::path& folder, std::uint64_t first, std::uint64_t seeds) {
    std::filesystem::create_directories(folder);
    fmt::ostream rigs = fmt::output_file((folder / "rigs.csv").string());
    rigs.print(
        "seed,lens,pairs,shown,noise_px,baseline_mm,baseline_sigma_mm,depth_mm,depth_sigma_mm,"
        "mahalanobis_sq\n");
    fmt::ostream advice = fmt::output_file((folder / "advice.csv").string());
    advice.print("seed,lens,kind,chosen,calibrated,suggested,better_px,chosen_px,message\n");
    for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
        for (const Lens& lens : lenses()) {
            const Pairs pairs = seen_pairs(rig_of(lens), seed);
            compare_rig(lens, seed, pairs, rigs);
            compare_advice(lens, seed, pairs, advice);
        }
    }
    return 0;
}

}  // namespace
}  // namespace surefoot

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    if (argc != 4) {
        fmt::print(stderr, "usage: wide_rigs OUT_FOLDER FIRST_SEED SEEDS\n");
        return 2;
    }
    cv::setNumThreads(1);  // The surefoot program uses the same setting.
    return surefoot::measure(
        argv[1], std::strtoull(argv[2], nullptr, 10), std::strtoull(argv[3], nullptr, 10));
}

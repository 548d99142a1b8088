// SPDX-License-Identifier: Apache-2.0
// Are the errors of calibrated lenses and stereo rigs consistent with their stated uncertainty? The
// views are simulated: each board type and lens model, boards in ten random poses, blur and noise.
// Usage: calibration_truth OUT_FOLDER [FIRST_SEED [SEEDS [LENS [BOARD]]]]
//   FIRST_SEED  default 1; SEEDS: number of seeds, default 3
//   LENS        only this lens model (pinhole4, pinhole5, rational or fisheye)
//   BOARD       only boards whose description begins with this text; rigs are then left out
//
// lenses.csv, one line per calibration: seed, board, lens, noise_px (of a corner coordinate),
//   median_px and largest_px (mapping error over the image), pixels (number of compared pixels),
//   beyond (pixels with an error beyond 3 sigma), without (pixels that the estimate does not map),
//   mean_square (of the error in standard deviations; 2 is expected), largest_sigmas (largest error
//   in standard deviations).
// rigs.csv, one line per stereo calibration with one chessboard: seed, lens, pairs (used),
//   baseline_mm (error) and its sigma, turn_mrad (largest rotation error of the right camera) and
//   the sigma of that rotation, mahalanobis_sq (all six degrees of freedom: 6 is expected, 20.06 is
//   3 sigma), row_px (rms row error).
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "studies/board_calibration/rendered_calibration_testing.hpp"

namespace surefoot {
namespace {

using app::testing::MappingErrors;
using app::testing::RigErrors;
using calibration::LensKind;

constexpr int kViews = 10;
constexpr int kScale = 2;  ///< 640 x 480 px, large enough to read the markers of ChArUco boards
constexpr const char* kBoards[] = {"chessboard:8x5:0.03",
                                   "circles:8x5:0.03",
                                   "asymmetric_circles:4x9:0.05",
                                   "charuco:8x5:0.03:0.022"};
constexpr LensKind kLenses[] = {
    LensKind::pinhole4, LensKind::pinhole5, LensKind::rational, LensKind::fisheye};

const char* name_of(LensKind kind) {
    return calibration::kLensKindNames[static_cast<std::size_t>(kind)];
}

/// Writes one line of lenses.csv. If the calibration fails, prints the error to stdout instead.
void compare_lens(const std::string& board_text,
                  LensKind kind,
                  std::uint64_t seed,
                  fmt::ostream& out) {
    const calibration::Board board = calibration::parse_board(board_text).value();
    const camera::Camera truth = app::testing::camera_of(kind, kScale);
    const auto views = app::testing::seen_boards(board, truth, kViews, seed, 1000 * seed);
    const auto estimate =
        calibration::calibrate_mono(board, views, {truth.width, truth.height}, kind);
    if (!estimate) {
        fmt::print(
            "{} {} seed {}: {}\n", name_of(kind), board_text, seed, estimate.error().message);
        return;
    }
    MappingErrors errors = app::testing::mapping_errors(truth, *estimate);
    std::sort(errors.lengths_px.begin(), errors.lengths_px.end());
    double sum = 0.0;
    double largest = 0.0;
    int beyond = 0;
    for (const double square : errors.squares) {
        sum += square;
        largest = std::max(largest, square);
        beyond += square > app::testing::kThreeSigma_sq ? 1 : 0;
    }
    const auto seen = static_cast<int>(errors.squares.size());
    const auto without = static_cast<int>(errors.without_image.size());
    out.print("{},{},{},{:.4f},{:.4f},{:.4f},{},{},{},{:.3f},{:.2f}\n",
              seed,
              board_text,
              name_of(kind),
              estimate->sigma_px,
              seen == 0 ? 0.0 : errors.lengths_px[errors.lengths_px.size() / 2],
              seen == 0 ? 0.0 : errors.lengths_px.back(),
              seen + without,
              beyond,
              without,
              seen == 0 ? 0.0 : sum / seen,
              std::sqrt(largest));
    fmt::print(
        "{} {} seed {}: {} of {} pixels beyond 3 sigma, {} not mapped, mean square {:.2f} (2 is "
        "expected)\n",
        name_of(kind),
        board_text,
        seed,
        beyond,
        seen + without,
        without,
        seen == 0 ? 0.0 : sum / seen);
}

/// Writes one line of rigs.csv.
void compare_rig(LensKind kind, std::uint64_t seed, fmt::ostream& out) {
    const calibration::Board board = calibration::parse_board(kBoards[0]).value();
    const camera::StereoRig truth = app::testing::rig_of(kind, kScale);
    const auto pairs = app::testing::seen_pairs(board, truth, kViews, seed, 1000 * seed);
    const auto estimate = calibration::calibrate_stereo(
        board, pairs.left, pairs.right, {truth.left.width, truth.left.height}, kind);
    if (!estimate) {
        fmt::print("{} rig seed {}: {}\n", name_of(kind), seed, estimate.error().message);
        return;
    }
    const RigErrors errors = app::testing::rig_errors(truth, *estimate);
    Eigen::Index turn = 0;
    (void)errors.errors.tail<3>().cwiseAbs().maxCoeff(&turn);
    out.print("{},{},{},{:.5f},{:.5f},{:.5f},{:.5f},{:.2f},{:.4f}\n",
              seed,
              name_of(kind),
              estimate->pairs.size(),
              1e3 * errors.baseline_m,
              1e3 * errors.baseline_sigma_m,
              1e3 * std::abs(errors.errors[3 + turn]),
              1e3 * errors.sigmas[3 + turn],
              errors.mahalanobis_sq,
              estimate->row_rms_px);
    fmt::print(
        "{} rig seed {}: baseline error {:+.3f} mm, sigma {:.3f} mm, Mahalanobis^2 {:.1f} (6 is "
        "expected)\n",
        name_of(kind),
        seed,
        1e3 * errors.baseline_m,
        1e3 * errors.baseline_sigma_m,
        errors.mahalanobis_sq);
}

int measure(const std::filesystem::path& folder,
            std::uint64_t first_seed,
            std::uint64_t seeds,
            const std::string& only_lens,
            const std::string& only_board) {
    std::filesystem::create_directories(folder);
    fmt::ostream lenses = fmt::output_file((folder / "lenses.csv").string());
    lenses.print(
        "seed,board,lens,noise_px,median_px,largest_px,pixels,beyond,without,mean_square,"
        "largest_sigmas\n");
    fmt::ostream rigs = fmt::output_file((folder / "rigs.csv").string());
    rigs.print(
        "seed,lens,pairs,baseline_mm,baseline_sigma_mm,turn_mrad,turn_sigma_mrad,"
        "mahalanobis_sq,row_px\n");
    for (const LensKind kind : kLenses) {
        if (!only_lens.empty() && only_lens != name_of(kind)) continue;
        for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed) {
            for (const std::string board : kBoards)
                if (board.starts_with(only_board)) compare_lens(board, kind, seed, lenses);
            if (only_board.empty()) compare_rig(kind, seed, rigs);
        }
    }
    return 0;
}

}  // namespace
}  // namespace surefoot

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    if (argc < 2) {
        fmt::print(stderr,
                   "usage: calibration_truth OUT_FOLDER [FIRST_SEED [SEEDS [LENS [BOARD]]]]\n");
        return 2;
    }
    const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
    const std::uint64_t seeds = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 3;
    return surefoot::measure(
        argv[1], first, seeds, argc > 4 ? argv[4] : "", argc > 5 ? argv[5] : "");
}

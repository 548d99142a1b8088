// SPDX-License-Identifier: Apache-2.0
// Does a lens calibrated from pictures of a board lie within the uncertainty that it states? Every
// kind of board, a rational and a fisheye lens, boards in ten random places with blur and noise.
// Usage: calibration_truth OUT.csv [FIRST_SEED [SEEDS]]
//
// A line a calibration: seed, board, lens, noise of a coordinate and its rms, error of the mapping
// (median and largest over the image), pixels of the mapping compared, of which beyond 3 sigma, of
// which without an image in the estimate, mean square in standard deviations (2 is right).
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cstdlib>

#include "apps/surefoot/rendered_calibration_for_test.hpp"

namespace surefoot {
namespace {

using app::testing::MappingErrors;
using calibration::LensKind;

constexpr int kViews = 10;
constexpr int kScale = 2;  ///< 640 x 480 px, so that the markers of ChArUco boards can be read
constexpr const char* kBoards[] = {"chessboard:8x5:0.03",
                                   "circles:8x5:0.03",
                                   "asymmetric_circles:4x9:0.05",
                                   "charuco:8x5:0.03:0.022"};

struct Totals {
    int pixels = 0;
    int beyond = 0;
    int without = 0;
    double sum = 0.0;
};

/// One line of the table; false where the views did not determine the lens.
bool compare(
    const char* board_text, LensKind kind, std::uint64_t seed, fmt::ostream& out, Totals& totals) {
    const calibration::Board board = calibration::parse_board(board_text).value();
    const camera::Camera truth = app::testing::camera_of(kind, kScale);
    const auto views = app::testing::seen_boards(board, truth, kViews, seed, 1000 * seed);
    const auto estimate =
        calibration::calibrate_mono(board, views, {truth.width, truth.height}, kind);
    if (!estimate) {
        fmt::print("seed {} {}: {}\n", seed, board_text, estimate.error().message);
        return false;
    }
    MappingErrors errors = app::testing::mapping_errors(truth, *estimate);
    std::sort(errors.lengths_px.begin(), errors.lengths_px.end());
    double sum = 0.0;
    int beyond = 0;
    for (const double square : errors.squares) {
        sum += square;
        beyond += square > app::testing::kThreeSigma_sq ? 1 : 0;
    }
    const auto seen = static_cast<int>(errors.squares.size());
    const auto without = static_cast<int>(errors.without_image.size());
    out.print("{},{},{},{:.4f},{:.4f},{:.4f},{},{},{},{:.3f}\n",
              seed,
              board_text,
              calibration::kLensKindNames[static_cast<std::size_t>(kind)],
              estimate->sigma_px,
              seen == 0 ? 0.0 : errors.lengths_px[errors.lengths_px.size() / 2],
              seen == 0 ? 0.0 : errors.lengths_px.back(),
              seen + without,
              beyond,
              without,
              seen == 0 ? 0.0 : sum / seen);
    totals.pixels += seen + without;
    totals.beyond += beyond;
    totals.without += without;
    totals.sum += sum;
    return true;
}

int measure(const std::string& path, std::uint64_t first_seed, std::uint64_t seeds) {
    fmt::ostream out = fmt::output_file(path);
    out.print("seed,board,lens,noise_px,median_px,largest_px,pixels,beyond,without,mean_square\n");
    for (const LensKind kind : {LensKind::rational, LensKind::fisheye}) {
        for (const char* board : kBoards) {
            Totals totals;
            std::uint64_t done = 0;
            for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed)
                if (compare(board, kind, seed, out, totals)) ++done;
            const double all = std::max(1, totals.pixels);
            fmt::print(
                "{} {}: {} of {} calibrated, {:.2f} % of {} pixels beyond 3 sigma, {} "
                "without an image, mean square {:.2f} of 2\n",
                calibration::kLensKindNames[static_cast<std::size_t>(kind)],
                board,
                done,
                seeds,
                100.0 * totals.beyond / all,
                totals.pixels,
                totals.without,
                totals.sum / std::max(1, totals.pixels - totals.without));
        }
    }
    return 0;
}

}  // namespace
}  // namespace surefoot

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    if (argc < 2) {
        fmt::print(stderr, "usage: calibration_truth OUT.csv [FIRST_SEED [SEEDS]]\n");
        return 2;
    }
    const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
    const std::uint64_t seeds = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 3;
    return surefoot::measure(argv[1], first, seeds);
}

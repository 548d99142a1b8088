// SPDX-License-Identifier: Apache-2.0
// How accurate are the depth and the lengths that a real calibrated rig measures? The chessboards
// for the measurement are not used for the calibration. The calibration with all images selects the
// usable pairs. Every second pair calibrates a rig, and this rig measures the boards of the other
// half. Then the two halves swap their roles.
// Usage: held_out_boards OUT.csv FOLDER BOARD LENS
//   FOLDER  stereo images of the board; BOARD: board description with the size of a square
//   LENS    lens model to calibrate (pinhole4, pinhole5, rational or fisheye)
//
// Writes OUT.csv, one line per pair: calibrated half, pair, points, distance, axial (depth error),
// axial_std (scatter of the depths about their plane), lateral and lateral_std (mean error and
// scatter of the sides of squares), lengths (number of sides). Lengths are in the unit of BOARD.
#include <fmt/format.h>
#include <fmt/os.h>

#include <cstring>
#include <string>
#include <vector>

#include "studies/board_calibration/board_images.hpp"
#include "surefoot/calibration/boards/board_measures.hpp"
#include "surefoot/calibration/boards/detect_board.hpp"
#include "surefoot/calibration/stereo_calibration.hpp"

namespace surefoot {
namespace {

using calibration::BoardView;
using calibration::LensKind;

struct Pairs {
    std::vector<std::string> names;
    std::vector<BoardView> left;
    std::vector<BoardView> right;
    calibration::ImageSize size;
};

Result<Pairs> pairs_in(const std::string& folder, const calibration::Board& board) {
    Pairs pairs;
    const auto opened =
        app::for_board_images(folder, true, "left", [&](const app::BoardImages& images) {
            auto left = calibration::detect_board(board, images.left.view());
            auto right = calibration::detect_board(board, images.right.view());
            if (left.found() && right.found())
                right.view = calibration::turned_like(board, left.view, right.view);
            pairs.names.push_back(images.name);
            pairs.left.push_back(left.view);
            pairs.right.push_back(right.view);
            pairs.size = {images.left.width(), images.left.height()};
        });
    if (!opened) return opened.error();
    return pairs;
}

/// Returns every second element of `kept`, starting at `first`.
std::vector<std::size_t> half_of(const std::vector<std::size_t>& kept, std::size_t first) {
    std::vector<std::size_t> half;
    for (std::size_t i = first; i < kept.size(); i += 2) half.push_back(kept[i]);
    return half;
}

std::vector<BoardView> chosen(const std::vector<BoardView>& views,
                              const std::vector<std::size_t>& indices) {
    std::vector<BoardView> result;
    result.reserve(indices.size());
    for (const std::size_t i : indices) result.push_back(views[i]);
    return result;
}

Status measure(const std::string& out_path,
               const std::string& folder,
               const calibration::Board& board,
               LensKind kind) {
    const auto pairs = pairs_in(folder, board);
    if (!pairs) return pairs.error();
    const auto all = calibrate_stereo(board, pairs->left, pairs->right, pairs->size, kind);
    if (!all) return all.error();
    std::vector<std::size_t> kept;
    kept.reserve(all->pairs.size());
    for (const calibration::PairFit& pair : all->pairs) kept.push_back(pair.index);
    fmt::ostream out = fmt::output_file(out_path);
    out.print("half,pair,points,distance,axial,axial_std,lateral,lateral_std,lengths\n");
    for (const std::size_t half : {0U, 1U}) {
        const auto own = half_of(kept, half);
        const auto rig = calibrate_stereo(
            board, chosen(pairs->left, own), chosen(pairs->right, own), pairs->size, kind);
        if (!rig) return rig.error();
        fmt::print("half {}: {} of {} pairs, rms {:.3f} px, baseline {:.5f}\n",
                   half,
                   rig->pairs.size(),
                   own.size(),
                   rig->rms_px,
                   rig->rig.T_left_right.translation_m.norm());
        for (const std::size_t i : half_of(kept, 1 - half)) {
            const auto found = measure_board(board, pairs->left[i], pairs->right[i], rig->rig);
            if (!found) {
                fmt::print("{}: not measured\n", pairs->names[i]);
                continue;
            }
            out.print("{},{},{},{:.6f},{:.7f},{:.7f},{:.7f},{:.7f},{}\n",
                      half,
                      pairs->names[i],
                      found->points,
                      found->distance_m,
                      found->axial_m,
                      found->axial_std_m,
                      found->lateral_m,
                      found->lateral_std_m,
                      found->lengths);
        }
    }
    return {};
}

}  // namespace
}  // namespace surefoot

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    using namespace surefoot;
    const auto board = argc == 5 ? calibration::parse_board(argv[3]) : std::nullopt;
    std::optional<calibration::LensKind> kind;
    for (std::size_t i = 0; argc == 5 && i < std::size(calibration::kLensKindNames); ++i)
        if (std::strcmp(calibration::kLensKindNames[i], argv[4]) == 0)
            kind = static_cast<calibration::LensKind>(i);
    if (!board || !kind) {
        fmt::print(stderr, "usage: held_out_boards OUT.csv FOLDER BOARD LENS\n");
        return 2;
    }
    const Status measured = measure(argv[1], argv[2], *board, *kind);
    if (measured) return 0;
    fmt::print(stderr, "{}\n", measured.error().message);
    return 1;
}

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/board_corners.hpp"

#include <algorithm>
#include <optional>

#include "surefoot/calibration/boards/corner_fit.hpp"

namespace surefoot::calibration {
namespace {

/// Number of rounds. The first round refines the neighbours of a corner. The second round takes
/// curvatures and steps from the refined neighbours.
constexpr int kRounds = 2;
/// Largest move of a corner, as a share of the shorter step to a neighbour. A corner that moved
/// farther is another corner or no corner.
constexpr double kMostMove = 0.4;

using Found = std::vector<std::optional<Eigen::Vector2d>>;  ///< by point id; nullopt = unknown

/// The row or column of board points that contains one point. Successive ids differ by `stride`.
struct Line {
    int place = 0;   ///< position of the point in the line
    int length = 0;  ///< number of points
    int first = 0;   ///< id of the first point
    int stride = 1;

    [[nodiscard]] std::optional<Eigen::Vector2d> at(const Found& found, int i) const {
        if (i < 0 || i >= length) return std::nullopt;
        return found[static_cast<std::size_t>(first + stride * i)];
    }
};

/// Returns the step to the next point of the line [px]: the mean over both neighbours, or the step
/// of the only neighbour. Returns nullopt without a neighbour.
std::optional<Eigen::Vector2d> step_px(const Line& line, const Found& found) {
    const auto here = line.at(found, line.place);
    const auto before = line.at(found, line.place - 1);
    const auto after = line.at(found, line.place + 1);
    if (before && after) return Eigen::Vector2d(0.5 * (*after - *before));
    if (after) return Eigen::Vector2d(*after - *here);
    if (before) return Eigen::Vector2d(*here - *before);
    return std::nullopt;
}

/// Returns the curvature [1/px] of the parabola through the point and its two neighbours. At either
/// end of a line, the parabola goes through the three points at this end. Returns 0 if one of these
/// points is unknown.
double bend_per_px(const Line& line, const Found& found) {
    const int middle = std::clamp(line.place, 1, std::max(1, line.length - 2));
    const auto before = line.at(found, middle - 1);
    const auto here = line.at(found, middle);
    const auto after = line.at(found, middle + 1);
    if (!before || !here || !after) return 0.0;
    const Eigen::Vector2d along = (*after - *before).normalized();
    const Eigen::Vector2d normal(-along.y(), along.x());
    const Eigen::Vector2d back_px = *before - *here;
    const Eigen::Vector2d on_px = *after - *here;
    const double slope_back = normal.dot(back_px) / along.dot(back_px);
    const double slope_on = normal.dot(on_px) / along.dot(on_px);
    return 2.0 * (slope_on - slope_back) / along.dot(on_px - back_px);
}

std::optional<CornerGuess> guess_of(const Board& board, const Found& found, int id) {
    const int row = id / board.columns;
    const int column = id % board.columns;
    const Line along_row{column, board.columns, row * board.columns, 1};
    const Line along_column{row, board.rows, column, board.columns};
    const auto row_step_px = step_px(along_row, found);
    const auto column_step_px = step_px(along_column, found);
    if (!row_step_px || !column_step_px) return std::nullopt;
    CornerGuess guess;
    guess.pixel = *found[static_cast<std::size_t>(id)];
    guess.along_row_px = *row_step_px;
    guess.along_column_px = *column_step_px;
    guess.row_bend_per_px = bend_per_px(along_row, found);
    guess.column_bend_per_px = bend_per_px(along_column, found);
    return guess;
}

std::optional<Eigen::Vector2d> fitted(ImageView<const std::uint8_t> image,
                                      const CornerGuess& guess) {
    auto pixel = fit_corner(image, guess);
    const double room_px = std::min(guess.along_row_px.norm(), guess.along_column_px.norm());
    if (!pixel || (*pixel - guess.pixel).norm() > kMostMove * room_px) return std::nullopt;
    // At the image border only half of a corner is visible; the fit may end outside the image.
    const bool inside = pixel->x() >= 0.0 && pixel->y() >= 0.0 && pixel->x() <= image.width - 1 &&
                        pixel->y() <= image.height - 1;
    return inside ? pixel : std::nullopt;
}

}  // namespace

void fit_corners(const Board& board, ImageView<const std::uint8_t> image, BoardView& view) {
    Found found(static_cast<std::size_t>(board.columns * board.rows));
    for (std::size_t i = 0; i < view.ids.size(); ++i)
        found[static_cast<std::size_t>(view.ids[i])] = view.pixels[i];
    BoardView fitted_view;
    for (int round = 0; round < kRounds; ++round) {
        const Found before = found;  // a point without a fit keeps its rough position
        fitted_view = {};
        for (const int id : view.ids) {
            const auto guess = guess_of(board, before, id);
            if (!guess) continue;
            const auto pixel = fitted(image, *guess);
            if (!pixel) continue;
            found[static_cast<std::size_t>(id)] = pixel;
            fitted_view.ids.push_back(id);
            fitted_view.pixels.push_back(*pixel);
        }
    }
    view = std::move(fitted_view);
}

}  // namespace surefoot::calibration

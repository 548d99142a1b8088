// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/board_order.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "surefoot/calibration/boards/detect_board.hpp"
#include "surefoot/core/nearest_pixel.hpp"

namespace surefoot::calibration {
namespace {

using Points = std::vector<Eigen::Vector2d>;

/// Least share of pairs of neighbouring squares in which the white square must be brighter. Light
/// may be weak and uneven, but glints and shadows do not lie on every square.
constexpr double kLeastAlternating = 0.8;

std::vector<Eigen::Vector2d> places_of(const Board& board) {
    std::vector<Eigen::Vector2d> places_m;
    for (const Eigen::Vector3d& point_m : board.points_m()) places_m.push_back(point_m.head<2>());
    return places_m;
}

std::size_t index_of(const Board& board, int column, int row) {
    return static_cast<std::size_t>(row * board.columns + column);
}

/// Returns the mean direction of the rows in the image: a unit vector, or zero.
Eigen::Vector2d row_direction(const Board& board, const BoardView& view) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (std::size_t i = 1; i < view.ids.size(); ++i) {
        const bool neighbours =
            view.ids[i] == view.ids[i - 1] + 1 && view.ids[i] % board.columns != 0;
        if (neighbours) sum += view.pixels[i] - view.pixels[i - 1];
    }
    return sum.norm() > 0.0 ? Eigen::Vector2d(sum.normalized()) : sum;
}

BoardView whole_view(Points pixels) {
    BoardView view;
    for (std::size_t i = 0; i < pixels.size(); ++i) view.ids.push_back(static_cast<int>(i));
    view.pixels = std::move(pixels);
    return view;
}

/// Returns the points in every order in which a detector may have walked through the grid.
std::vector<Points> readings_of(const Board& board, const Points& found) {
    std::vector<Points> readings;
    for (int variant = 0; variant < (board.columns == board.rows ? 8 : 4); ++variant) {
        Points points;
        for (int row = 0; row < board.rows; ++row) {
            for (int column = 0; column < board.columns; ++column) {
                int c = (variant & 1) != 0 ? board.columns - 1 - column : column;
                int r = (variant & 2) != 0 ? board.rows - 1 - row : row;
                if ((variant & 4) != 0) std::swap(c, r);
                points.push_back(found[index_of(board, c, r)]);
            }
        }
        readings.push_back(std::move(points));
    }
    return readings;
}

/// Returns the mean of the 3 x 3 pixels around a position; nullopt at the border.
std::optional<double> brightness(ImageView<const std::uint8_t> image, const Eigen::Vector2d& at) {
    const auto middle = nearest_pixel(at.x(), at.y(), image.width, image.height, 1);
    if (!middle) return std::nullopt;
    double sum = 0.0;
    for (int dv = -1; dv <= 1; ++dv) {
        for (int du = -1; du <= 1; ++du) sum += image.row(middle->v + dv)[middle->u + du];
    }
    return sum / 9.0;
}

/// Returns true if the squares that should be black are darker than their neighbours, in at least
/// kLeastAlternating of the pairs.
bool black_where_it_should_be(const Board& board,
                              const Points& points,
                              ImageView<const std::uint8_t> image) {
    const int columns = board.columns - 1;
    const int rows = board.rows - 1;
    std::vector<std::optional<double>> squares;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            squares.push_back(brightness(image,
                                         0.25 * (points[index_of(board, column, row)] +
                                                 points[index_of(board, column + 1, row)] +
                                                 points[index_of(board, column, row + 1)] +
                                                 points[index_of(board, column + 1, row + 1)])));
        }
    }
    int right = 0;
    int compared = 0;
    const auto compare = [&](int here, int there, bool black_here) {
        const auto a = squares[static_cast<std::size_t>(here)];
        const auto b = squares[static_cast<std::size_t>(there)];
        if (!a || !b) return;
        ++compared;
        right += black_here == (*a < *b) && *a != *b ? 1 : 0;
    };
    for (int i = 0; i < rows * columns; ++i) {
        const bool black = (i / columns + i % columns) % 2 == 0;
        if (i % columns + 1 < columns) compare(i, i + 1, black);
        if (i / columns + 1 < rows) compare(i, i + columns, black);
    }
    return compared > 0 && right >= kLeastAlternating * compared;
}

/// Returns true if rows and columns change gently from point to point. Two successive steps may
/// differ by a factor of 2.5 in length and by 45 deg in direction. Perspective and wide lenses
/// change steps by up to half their length and by 30 deg at the image border. A grid with a wrong
/// point jumps back and forth.
bool is_smooth(const Board& board, const Points& points) {
    constexpr double kMostRatio = 2.5;
    constexpr double kLeastCosine = 0.7;
    const bool staggered = board.kind == BoardKind::asymmetric_circles;
    const auto smooth = [&](std::size_t a, std::size_t b, std::size_t c) {
        const Eigen::Vector2d first = points[b] - points[a];
        const Eigen::Vector2d second = points[c] - points[b];
        return first.dot(second) > kLeastCosine * first.norm() * second.norm() &&
               first.norm() < kMostRatio * second.norm() &&
               second.norm() < kMostRatio * first.norm();
    };
    const int step = staggered ? 2 : 1;
    for (int row = 0; row < board.rows; ++row) {
        for (int column = 0; column < board.columns; ++column) {
            const std::size_t here = index_of(board, column, row);
            if (column > 0 && column + 1 < board.columns && !smooth(here - 1, here, here + 1))
                return false;
            if (row < step || row + step >= board.rows) continue;
            if (!smooth(
                    index_of(board, column, row - step), here, index_of(board, column, row + step)))
                return false;
        }
    }
    return true;
}

}  // namespace

std::optional<LocalMap> fit_local_map(const std::vector<Eigen::Vector2d>& places_m,
                                      const std::vector<Eigen::Vector2d>& pixels) {
    const auto count = static_cast<Eigen::Index>(places_m.size());
    if (count < 6) return std::nullopt;
    double scale_m = 0.0;  // scales the unknowns to similar size, for any unit of the board
    for (const auto& place_m : places_m) scale_m = std::max(scale_m, place_m.norm());
    Eigen::MatrixXd A(count, 6);
    Eigen::MatrixXd b(count, 2);
    for (Eigen::Index i = 0; i < count; ++i) {
        const Eigen::Vector2d x = places_m[static_cast<std::size_t>(i)] / scale_m;
        A.row(i) << 1.0, x.x(), x.y(), 0.5 * x.x() * x.x(), x.x() * x.y(), 0.5 * x.y() * x.y();
        b.row(i) = pixels[static_cast<std::size_t>(i)];
    }
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
    if (qr.rank() < 6) return std::nullopt;
    const Eigen::MatrixXd k = qr.solve(b);
    LocalMap map;
    map.rms_px = (A * k - b).norm() / std::sqrt(static_cast<double>(count));
    map.pixel = k.row(0);
    map.J_px_m << k(1, 0), k(2, 0), k(1, 1), k(2, 1);
    map.H_u << k(3, 0), k(4, 0), k(4, 0), k(5, 0);
    map.H_v << k(3, 1), k(4, 1), k(4, 1), k(5, 1);
    map.J_px_m /= scale_m;
    map.H_u /= scale_m * scale_m;
    map.H_v /= scale_m * scale_m;
    return map;
}

std::vector<std::vector<int>> turns_of(const Board& board) {
    const std::vector<Eigen::Vector2d> places_m = places_of(board);
    const auto count = static_cast<int>(places_m.size());
    std::vector<int> identity;
    identity.reserve(places_m.size());
    for (int id = 0; id < count; ++id) identity.push_back(id);
    std::vector<std::vector<int>> turns = {identity};
    if (board.kind == BoardKind::charuco) return turns;
    Eigen::Vector2d low = places_m.front();
    Eigen::Vector2d high = places_m.front();
    for (const auto& place_m : places_m) {
        low = low.cwiseMin(place_m);
        high = high.cwiseMax(place_m);
    }
    const Eigen::Vector2d middle_m = 0.5 * (low + high);
    for (int quarter = 1; quarter < 4; ++quarter) {
        const bool checked = board.kind == BoardKind::chessboard;
        // A half turn keeps the colours of the squares if columns and rows are both even or both
        // odd. A quarter turn of a board with as many columns as rows keeps the colours if their
        // number is even.
        if (checked && quarter == 2 && (board.columns + board.rows) % 2 != 0) continue;
        if (checked && quarter != 2 && board.columns % 2 != 0) continue;
        Eigen::Matrix2d R;
        const int cosine = quarter == 2 ? -1 : 0;
        const int sine = quarter == 1 ? 1 : quarter == 3 ? -1 : 0;
        R << cosine, -sine, sine, cosine;
        std::vector<int> turn;
        for (const auto& place_m : places_m) {
            const Eigen::Vector2d turned_m = R * (place_m - middle_m) + middle_m;
            const auto same = std::find_if(places_m.begin(), places_m.end(), [&](const auto& p_m) {
                return (p_m - turned_m).norm() < 1e-6 * board.spacing_m;
            });
            if (same == places_m.end()) break;
            turn.push_back(static_cast<int>(same - places_m.begin()));
        }
        if (static_cast<int>(turn.size()) == count) turns.push_back(std::move(turn));
    }
    return turns;
}

BoardView turned_like(const Board& board, const BoardView& reference, const BoardView& view) {
    const Eigen::Vector2d wanted = row_direction(board, reference);
    BoardView best = view;
    double best_cosine = -2.0;
    for (const std::vector<int>& turn : turns_of(board)) {
        std::vector<std::pair<int, Eigen::Vector2d>> points;
        for (std::size_t i = 0; i < view.ids.size(); ++i)
            points.emplace_back(turn[static_cast<std::size_t>(view.ids[i])], view.pixels[i]);
        std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
            return a.first < b.first;
        });
        BoardView turned;
        turned.disc_radius_m = view.disc_radius_m;
        for (const auto& [id, pixel] : points) {
            turned.ids.push_back(id);
            turned.pixels.push_back(pixel);
        }
        const double cosine = wanted.dot(row_direction(board, turned));
        if (cosine > best_cosine) {
            best_cosine = cosine;
            best = std::move(turned);
        }
    }
    return best;
}

std::optional<std::vector<Eigen::Vector2d>> ordered_points(
    const Board& board,
    const std::vector<Eigen::Vector2d>& found,
    ImageView<const std::uint8_t> image) {
    const std::vector<Eigen::Vector2d> places_m = places_of(board);
    std::vector<Eigen::Vector2d> centred_m;
    centred_m.reserve(places_m.size());
    for (const auto& place_m : places_m)
        centred_m.push_back(place_m - 0.5 * (places_m.front() + places_m.back()));
    std::optional<Points> best;
    double best_rms_px = 0.0;
    double best_right = 0.0;
    for (Points& points : readings_of(board, found)) {
        const auto map = fit_local_map(centred_m, points);
        if (!map || map->J_px_m.determinant() <= 0.0) continue;  // order of a mirrored board
        if (!is_smooth(board, points)) continue;
        if (board.kind == BoardKind::chessboard && !black_where_it_should_be(board, points, image))
            continue;
        // If the rows of asymmetric circles are shifted in the wrong direction, the fit error grows
        // by almost half the point spacing (boards with five or more rows). All correct orders fit
        // equally well: choose the order whose rows point farthest to the right in the image.
        const double tolerance_px = 0.1 * board.spacing_m * std::sqrt(map->J_px_m.determinant());
        const double right = row_direction(board, whole_view(points)).x();
        const bool better = !best || map->rms_px < best_rms_px - tolerance_px ||
                            (map->rms_px < best_rms_px + tolerance_px && right > best_right);
        if (!better) continue;
        best_rms_px = map->rms_px;
        best_right = right;
        best = std::move(points);
    }
    return best;
}

}  // namespace surefoot::calibration

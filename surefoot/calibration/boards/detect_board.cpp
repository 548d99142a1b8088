// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/detect_board.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "surefoot/calibration/boards/board_corners.hpp"
#include "surefoot/calibration/boards/board_order.hpp"
#include "surefoot/calibration/boards/charuco.hpp"
#include "surefoot/calibration/boards/chess_corners.hpp"
#include "surefoot/calibration/boards/chess_grid.hpp"
#include "surefoot/calibration/boards/circle_centres.hpp"
#include "surefoot/calibration/boards/circle_grid.hpp"

namespace surefoot::calibration {
namespace {

using Points = std::vector<Eigen::Vector2d>;

/// Least number of pixels of the shorter image side for each point along the shorter board side. A
/// smaller image is not searched for the board. An image for a ChArUco board needs only 8 px on its
/// shorter side.
constexpr int kFewestPixelsPerPoint = 4;
/// Largest half window of the corner refinement [px], as in OpenCV's samples and in the published
/// figures that we compare with.
constexpr int kMostHalfWindow_px = 5;
constexpr int kLeastHalfWindow_px = 2;
/// Least percentage of clear corners. Reflections may hide single corners. A board with fewer clear
/// corners is rejected.
constexpr int kLeastPercent = 75;
/// Largest number of halvings of the image. Boards whose blur exceeds 2 px are found at half or a
/// quarter of the size.
constexpr int kMostHalvings = 2;
/// Largest number of dark spots. With more spots the search for the grid would take minutes.
constexpr std::size_t kMostBlobs = 600;
/// Larger images are not enlarged to find small circles: this would take seconds.
constexpr std::size_t kMostPixelsEnlarged = 1280 * 1024;

Points points_of(const std::vector<cv::Point2f>& found) {
    Points points;
    for (const cv::Point2f& p : found)
        points.emplace_back(static_cast<double>(p.x), static_cast<double>(p.y));
    return points;
}

BoardSighting not_found(std::string why) {
    return {{}, std::move(why)};
}

BoardSighting whole_board(const Points& points) {
    BoardSighting sighting;
    for (std::size_t i = 0; i < points.size(); ++i)
        sighting.view.ids.push_back(static_cast<int>(i));
    sighting.view.pixels = points;
    return sighting;
}

/// Returns the distance of a point to its nearest neighbour in row and column [px]; infinity
/// without neighbours.
double nearest_px(const Board& board, const BoardView& view, std::size_t index) {
    double nearest = std::numeric_limits<double>::infinity();
    const int id = view.ids[index];
    for (std::size_t other = 0; other < view.ids.size(); ++other) {
        const int columns = std::abs(view.ids[other] % board.columns - id % board.columns);
        const int rows = std::abs(view.ids[other] / board.columns - id / board.columns);
        if (columns + rows == 1)
            nearest = std::min(nearest, (view.pixels[other] - view.pixels[index]).norm());
    }
    return nearest;
}

/// Moves corners to the point where the surrounding edges meet. The half window is the share
/// `reach` of the distance to the nearest corner, but at least 2 px and at most 5 px. Returns false
/// if a corner moved too far.
bool refine_corners(const Board& board, const cv::Mat& image, double reach, BoardView& view) {
    const BoardView rough = view;
    const cv::TermCriteria until(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-3);
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
        const double room_px = nearest_px(board, rough, i);
        // in range: 2 to 5; distances between the corners of a view are not NaN
        const int half = static_cast<int>(
            std::clamp(reach * room_px, 1.0 * kLeastHalfWindow_px, 1.0 * kMostHalfWindow_px));
        std::vector<cv::Point2f> one = {cv::Point2d(rough.pixels[i].x(), rough.pixels[i].y())};
        cv::cornerSubPix(image, one, cv::Size(half, half), cv::Size(-1, -1), until);
        view.pixels[i] = points_of(one).front();
        if ((view.pixels[i] - rough.pixels[i]).norm() > 0.4 * room_px) return false;
    }
    return true;
}

/// OpenCV's sector method. It finds boards that our method misses, and noise does not slow it down.
/// The older cv::findChessboardCorners can need a minute in noise.
Points sector_corners(const Board& board, const cv::Mat& image, int more) {
    std::vector<cv::Point2f> corners;
    const cv::Size size(board.columns, board.rows);
    if (!cv::findChessboardCornersSB(image, size, corners, cv::CALIB_CB_NORMALIZE_IMAGE | more))
        return {};
    return points_of(corners);
}

/// Grows a chessboard from single corners, in an image whose sides are halved `halvings` times.
GrownChessboard grown_corners(const Board& board,
                              const cv::Mat& image,
                              ImageView<const std::uint8_t> view,
                              int halvings) {
    const int times = 1 << halvings;
    cv::Mat reduced = image;
    if (times > 1) cv::resize(image, reduced, image.size() / times, 0.0, 0.0, cv::INTER_AREA);
    std::vector<ChessCorner> corners =
        chess_corners({reduced.data, reduced.cols, reduced.rows, static_cast<int>(reduced.step)});
    for (ChessCorner& corner : corners)  // (0, 0) is a pixel centre in both images
        corner.pixel = times * (corner.pixel + Eigen::Vector2d::Constant(0.5)) -
                       Eigen::Vector2d::Constant(0.5);
    return grown_chessboard(board, corners, view);
}

/// Orders and refines rough corners of a chessboard. Reports a problem if they do not form the
/// board, or if too few corners are clear.
BoardSighting refined_chessboard(const Board& board,
                                 const Points& corners,
                                 ImageView<const std::uint8_t> view) {
    const auto points = ordered_points(board, corners, view);
    if (!points)
        return not_found(
            "the corners in the image do not form this chessboard; check its size and show the "
            "whole board");
    BoardSighting sighting = whole_board(*points);
    fit_corners(board, view, sighting.view);
    if (100 * std::ssize(sighting.view.ids) < kLeastPercent * board.columns * board.rows)
        return not_found(
            "the corners of the chessboard are not clear, perhaps the image is blurred; hold the "
            "board still");
    return sighting;
}

BoardSighting find_chessboard(const Board& board,
                              const cv::Mat& image,
                              ImageView<const std::uint8_t> view) {
    std::string problem;
    const auto tried = [&](const Points& corners) {
        BoardSighting sighting = refined_chessboard(board, corners, view);
        if (!sighting.found() && problem.empty()) problem = sighting.problem;
        return sighting;
    };
    for (int halvings = 0; halvings <= kMostHalvings; ++halvings) {
        const GrownChessboard grown = grown_corners(board, image, view, halvings);
        if (!grown.points.empty()) {
            if (BoardSighting sighting = tried(grown.points); sighting.found()) return sighting;
        } else if (problem.empty()) {
            problem = grown.problem;
        }
    }
    for (const int more : {0, int{cv::CALIB_CB_EXHAUSTIVE}}) {
        const Points corners = sector_corners(board, image, more);
        if (corners.empty()) continue;
        if (BoardSighting sighting = tried(corners); sighting.found()) return sighting;
    }
    if (!problem.empty()) return not_found(problem);
    return not_found(
        fmt::format("no chessboard of {} x {} inner corners is fully visible; show the whole "
                    "board, or give its true size",
                    board.columns,
                    board.rows));
}

cv::SimpleBlobDetector::Params blob_params(const Board& board, const cv::Mat& image) {
    cv::SimpleBlobDetector::Params params;
    params.minArea = 12.0F;  // radius 2 px
    // A board that fills the image has circles no larger than the cells of the grid.
    params.maxArea =
        0.7F * static_cast<float>(image.total()) / static_cast<float>(board.columns * board.rows);
    params.minDistBetweenBlobs = kFewestPixelsPerPoint;
    return params;
}

/// Finds the centres of the grid in an image that is `enlarged` times the original. Returns the
/// centres in pixels of the original and in the order of the board; nullopt without a grid.
std::optional<Points> find_grid(const Board& board,
                                const cv::Mat& image,
                                double enlarged,
                                ImageView<const std::uint8_t> original) {
    const auto detector = cv::SimpleBlobDetector::create(blob_params(board, image));
    std::vector<cv::KeyPoint> blobs;
    detector->detect(image, blobs);
    if (std::ssize(blobs) < board.columns * board.rows || blobs.size() > kMostBlobs)
        return std::nullopt;
    const auto in_order = [&](Points points) {
        for (Eigen::Vector2d& point : points)  // (0, 0) is a pixel centre in both images
            point = (point + Eigen::Vector2d::Constant(0.5)) / enlarged -
                    Eigen::Vector2d::Constant(0.5);
        return ordered_points(board, points, original);
    };
    Points spots;
    for (const cv::KeyPoint& blob : blobs)
        spots.emplace_back(static_cast<double>(blob.pt.x), static_cast<double>(blob.pt.y));
    if (const auto grid = grown_grid(board, spots)) {
        if (auto points = in_order(*grid)) return points;
    }
    // OpenCV's search is more tolerant of spots beside the board than grown_grid.
    const int kind = board.kind == BoardKind::circles ? cv::CALIB_CB_SYMMETRIC_GRID
                                                      : cv::CALIB_CB_ASYMMETRIC_GRID;
    const cv::Size size(board.columns, board.rows);
    for (const int flags : {kind | cv::CALIB_CB_CLUSTERING, kind}) {
        std::vector<cv::Point2f> centres;
        if (!cv::findCirclesGrid(image, size, centres, flags, detector)) continue;
        if (auto points = in_order(points_of(centres))) return points;
    }
    return std::nullopt;
}

BoardSighting find_circles(const Board& board,
                           const cv::Mat& image,
                           ImageView<const std::uint8_t> view) {
    auto points = find_grid(board, image, 1.0, view);
    if (!points && image.total() <= kMostPixelsEnlarged) {
        constexpr double kEnlarged = 2.0;  // small circles are blobs of too few pixels
        cv::Mat large;
        cv::resize(image, large, cv::Size(), kEnlarged, kEnlarged, cv::INTER_CUBIC);
        points = find_grid(board, large, kEnlarged, view);
    }
    if (points) {
        const DiscImages discs = measured_discs(board, *points, view);
        BoardSighting sighting = whole_board(discs.centroids);
        sighting.view.disc_radius_m = discs.radius_m;
        return sighting;
    }
    return not_found(
        fmt::format("no {} of {} x {} dark circles on white is fully visible; show the whole "
                    "board, or give its true size",
                    board.kind == BoardKind::circles ? "grid" : "staggered grid",
                    board.columns,
                    board.rows));
}

/// Returns true if all points lie on one line of the board: such points do not determine the plane.
bool on_one_line(const Board& board, const std::vector<int>& ids) {
    const int first_row = ids.front() / board.columns;
    const int first_column = ids.front() % board.columns;
    Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
    for (const int id : ids) {
        const Eigen::Vector2d d(id % board.columns - first_column, id / board.columns - first_row);
        scatter += d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(scatter);
    return eigen.eigenvalues()[0] < 0.5;
}

BoardSighting find_charuco(const Board& board, const cv::Mat& image) {
    const auto dictionary = dictionary_of(board);
    if (!dictionary) return not_found(dictionary.error().message);
    const auto charuco = cv::aruco::CharucoBoard::create(squares(board.columns),
                                                         squares(board.rows),
                                                         static_cast<float>(board.spacing_m),
                                                         static_cast<float>(board.marker_m),
                                                         *dictionary);
    std::vector<std::vector<cv::Point2f>> markers;
    std::vector<int> marker_ids;
    cv::aruco::detectMarkers(image, *dictionary, markers, marker_ids);
    std::vector<cv::Point2f> corners;
    std::vector<int> ids;
    if (!marker_ids.empty())
        cv::aruco::interpolateCornersCharuco(markers, marker_ids, image, charuco, corners, ids);
    if (static_cast<int>(ids.size()) < kFewestCharucoPoints) {
        return not_found(
            fmt::format("the image shows {} markers of {} and {} corners between them; at least {} "
                        "corners are needed: show more of the board",
                        marker_ids.size(),
                        board.dictionary,
                        ids.size(),
                        kFewestCharucoPoints));
    }
    if (on_one_line(board, ids))
        return not_found(
            "all corners in the image lie on one line of the board; show more of the board");
    BoardSighting sighting;
    sighting.view.ids = ids;
    sighting.view.pixels = points_of(corners);
    // This share of a square ends before the marker beside the corner.
    const double margin = 0.5 * (board.spacing_m - board.marker_m) / board.spacing_m;
    if (!refine_corners(board, image, margin, sighting.view))
        return not_found(
            "the corners of the ChArUco board are not clear, perhaps the image is blurred; hold "
            "the board still");
    return sighting;
}

}  // namespace

Status check_detectable(const Board& board) {
    if (const auto problem = board.problem()) return usage_error(*problem);
    if (board.kind != BoardKind::charuco) return {};
    const auto dictionary = dictionary_of(board);
    return dictionary ? Status{} : Status(dictionary.error());
}

BoardSighting detect_board(const Board& board, ImageView<const std::uint8_t> image) {
    if (const Status status = check_detectable(board); !status)
        return not_found(status.error().message);
    const int shorter = std::min(image.width, image.height);
    const int needed = kFewestPixelsPerPoint * std::min(board.columns, board.rows);
    if (shorter < needed && board.kind != BoardKind::charuco) {
        return not_found(fmt::format(
            "the image of {} x {} px is too small for a board of {} x {} points; use larger images",
            image.width,
            image.height,
            board.columns,
            board.rows));
    }
    if (shorter < kFewestPixelsPerPoint * 2)
        return not_found(
            fmt::format("the image of {} x {} px is too small to show a board; use larger images",
                        image.width,
                        image.height));
    const cv::Mat pixels(image.height,
                         image.width,
                         CV_8UC1,
                         const_cast<std::uint8_t*>(image.data),  // only read
                         static_cast<std::size_t>(image.stride));
    try {
        switch (board.kind) {
            case BoardKind::chessboard: return find_chessboard(board, pixels, image);
            case BoardKind::circles:
            case BoardKind::asymmetric_circles: return find_circles(board, pixels, image);
            case BoardKind::charuco: return find_charuco(board, pixels);
        }
    } catch (const cv::Exception& error) {
        return not_found(fmt::format("OpenCV failed: {}", error.err));
    }
    return not_found(
        "the kind of board is unknown; use chessboard, circles, asymmetric_circles or charuco");
}

}  // namespace surefoot::calibration

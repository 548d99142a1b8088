// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/bundle/coverage.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/calibration/boards/board_order.hpp"

namespace surefoot::calibration {
namespace {

// ASSUMPTION for all four limits and kEnoughTilt_deg. Handbooks of calibration tools ask for ten or
// more views, tilts of 20 to 45 deg, the whole image and two distances. The covariance of the
// result shows whether the views were enough.
constexpr int kEnoughViews = 10;
constexpr double kEnoughDistances =
    1.5;                              ///< least ratio of the largest to the smallest point spacing
constexpr double kFilledShare = 0.5;  ///< least share of the parts of a region that contain points
constexpr double kNearView = 0.4;     ///< share of the image that a near view fills

constexpr const char* kRegionNames[3][3] = {{"top left", "top", "top right"},
                                            {"left", "middle", "right"},
                                            {"bottom left", "bottom", "bottom right"}};

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (i > 0) text += i + 1 == words.size() ? " and " : ", ";
        text += words[i];
    }
    return text;
}

ViewShape shape_of(const Board& board,
                   const std::vector<Eigen::Vector3d>& board_m,
                   const BoardView& view) {
    ViewShape shape;
    if (view.ids.size() != view.pixels.size() || view.ids.empty()) return shape;
    Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
    std::vector<Eigen::Vector2d> places_m;
    for (const int id : view.ids) {
        if (id < 0 || id >= std::ssize(board_m)) return shape;
        places_m.emplace_back(board_m[static_cast<std::size_t>(id)].head<2>());
        middle_m += places_m.back();
    }
    for (const Eigen::Vector2d& pixel : view.pixels) {
        if (!pixel.allFinite()) return shape;
    }
    middle_m /= static_cast<double>(places_m.size());
    for (auto& place_m : places_m) place_m -= middle_m;
    const auto map = fit_local_map(places_m, view.pixels);
    if (!map) return shape;
    const Eigen::JacobiSVD<Eigen::Matrix2d> svd(map->J_px_m);
    const Eigen::Vector2d& scales_px_m = svd.singularValues();
    if (!(scales_px_m[1] > 0.0)) return shape;
    shape.spacing_px = board.spacing_m * std::sqrt(scales_px_m[0] * scales_px_m[1]);
    shape.tilt_deg =
        std::acos(std::min(1.0, scales_px_m[1] / scales_px_m[0])) * 180.0 / std::numbers::pi;
    // The image of a square grows towards the near side. This direction is the gradient of log det
    // J, mapped from the board into the image.
    const Eigen::Matrix2d inverse = map->J_px_m.inverse();
    Eigen::Vector2d growth_m;
    for (Eigen::Index k = 0; k < 2; ++k) {
        Eigen::Matrix2d slope;
        slope.row(0) = map->H_u.row(k);
        slope.row(1) = map->H_v.row(k);
        growth_m[k] = (inverse * slope).trace();
    }
    const Eigen::Vector2d growth_px = inverse.transpose() * growth_m;
    if (std::abs(growth_px.x()) > std::abs(growth_px.y())) {
        shape.near_side = growth_px.x() > 0.0 ? NearSide::right : NearSide::left;
    } else {
        shape.near_side = growth_px.y() > 0.0 ? NearSide::bottom : NearSide::top;
    }
    return shape;
}

void advise_views(int usable, Coverage& coverage) {
    if (usable >= kEnoughViews) return;
    coverage.advice.push_back(fmt::format(
        "{} usable view{}: show the board at least {} times, each time in a different pose.",
        usable,
        usable == 1 ? "" : "s",
        kEnoughViews));
}

void advise_regions(Coverage& coverage) {
    std::vector<std::string> missing;
    for (int region_row = 0; region_row < 3; ++region_row) {
        for (int region_column = 0; region_column < 3; ++region_column) {
            constexpr int kWide = Coverage::kColumns / 3;
            constexpr int kHigh = Coverage::kRows / 3;
            int seen = 0;
            for (int row = 0; row < kHigh; ++row) {
                for (int column = 0; column < kWide; ++column) {
                    seen += coverage.points.at(region_column * kWide + column,
                                               region_row * kHigh + row) > 0
                                ? 1
                                : 0;
                }
            }
            if (seen < kFilledShare * kWide * kHigh)
                missing.emplace_back(kRegionNames[region_row][region_column]);
        }
    }
    if (missing.empty()) return;
    coverage.advice.push_back(
        fmt::format("Too few points in the {} of the image: bring the board there, until it almost "
                    "leaves the image. Where no board was seen, the lens model is "
                    "only extrapolated.",
                    joined(missing)));
}

void advise_tilts(Coverage& coverage) {
    std::vector<std::string> missing;
    for (const NearSide side : {NearSide::left, NearSide::right, NearSide::top, NearSide::bottom}) {
        const bool shown =
            std::any_of(coverage.views.begin(), coverage.views.end(), [&](const ViewShape& view) {
                return view.tilt_deg >= kEnoughTilt_deg && view.near_side == side;
            });
        if (!shown) missing.emplace_back(kNearSideNames[static_cast<std::size_t>(side)]);
    }
    if (missing.empty()) return;
    coverage.advice.push_back(fmt::format(
        "Missing tilts: turn the board by {:.0f} to 45 deg, so that one side comes nearer "
        "(still missing: {}). Without tilts, focal length and distance cannot be separated.",
        kEnoughTilt_deg,
        joined(missing)));
}

void advise_distances(int width, int height, const Board& board, Coverage& coverage) {
    double smallest_px = 1e9;
    double largest_px = 0.0;
    for (const ViewShape& view : coverage.views) {
        if (view.spacing_px <= 0.0) continue;
        smallest_px = std::min(smallest_px, view.spacing_px);
        largest_px = std::max(largest_px, view.spacing_px);
    }
    if (largest_px <= 0.0 || largest_px >= kEnoughDistances * smallest_px) return;
    const double near_px =
        std::sqrt(kNearView * width * height / ((board.columns + 1.0) * (board.rows + 1.0)));
    coverage.advice.push_back(
        fmt::format("The board is about equally far away in all views (neighbouring points {:.0f} "
                    "to {:.0f} px apart): show the board {} too.",
                    smallest_px,
                    largest_px,
                    largest_px < near_px ? "nearer" : "further away"));
}

}  // namespace

Coverage coverage_of(const Board& board, std::span<const BoardView> views, int width, int height) {
    Coverage coverage;
    const auto board_m = board.points_m();
    int usable = 0;
    for (const BoardView& view : views) {
        coverage.views.push_back(shape_of(board, board_m, view));
        usable += coverage.views.back().spacing_px > 0.0 ? 1 : 0;
        for (const Eigen::Vector2d& pixel : view.pixels) {
            const double column = std::floor((pixel.x() + 0.5) / width * Coverage::kColumns);
            const double row = std::floor((pixel.y() + 0.5) / height * Coverage::kRows);
            if (column >= 0.0 && row >= 0.0 && column < Coverage::kColumns && row < Coverage::kRows)
                ++coverage.points.at(static_cast<int>(column), static_cast<int>(row));
        }
    }
    const auto seen = std::count_if(coverage.points.data(),
                                    coverage.points.data() + coverage.points.size(),
                                    [](int count) { return count > 0; });
    coverage.seen_share = static_cast<double>(seen) / static_cast<double>(coverage.points.size());
    advise_views(usable, coverage);
    if (usable == 0) return coverage;
    advise_regions(coverage);
    advise_tilts(coverage);
    advise_distances(width, height, board, coverage);
    return coverage;
}

}  // namespace surefoot::calibration

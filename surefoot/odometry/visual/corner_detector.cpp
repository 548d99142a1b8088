// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/corner_detector.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::odometry {
namespace {

constexpr int kBlock_px = 7;
/// cv::cornerMinEigenVal scales derivatives by 1/(2^(3-1) * block * 255) and sums over the block.
/// For a mean squared gradient g^2 (Sobel gives 8 g) it therefore returns g^2 times this factor.
constexpr double kEigenvaluePerGradientSq =
    64.0 * kBlock_px * kBlock_px / ((4.0 * kBlock_px * 255.0) * (4.0 * kBlock_px * 255.0));

struct Cell {
    int u0, v0, u1, v1;  ///< half open
};

Cell cell_bounds(int index, int width, int height, const CornerConfig& config) {
    const int column = index % config.grid_columns;
    const int row = index / config.grid_columns;
    const int margin = config.border_px;
    return {std::max(column * width / config.grid_columns, margin),
            std::max(row * height / config.grid_rows, margin),
            std::min((column + 1) * width / config.grid_columns, width - margin),
            std::min((row + 1) * height / config.grid_rows, height - margin)};
}

/// Finds the best corners of one cell, at most `wanted`. The corners keep `min_distance_px` from
/// each other and from `taken`.
void detect_in_cell(const cv::Mat& image,
                    const Cell& cell,
                    int wanted,
                    const CornerConfig& config,
                    const std::vector<Eigen::Vector2d>& taken,
                    std::vector<Eigen::Vector2d>& corners) {
    cv::Mat strength;
    cv::cornerMinEigenVal(image(cv::Rect(cell.u0, cell.v0, cell.u1 - cell.u0, cell.v1 - cell.v0)),
                          strength,
                          kBlock_px,
                          3,
                          cv::BORDER_REFLECT_101);
    const double least = config.min_gradient * config.min_gradient * kEigenvaluePerGradientSq;
    const int radius = saturated_integer<int>(std::ceil(config.min_distance_px));
    for (const Eigen::Vector2d& p : taken) {
        const cv::Point at(saturated_integer<int>(std::floor(p.x() - cell.u0)),
                           saturated_integer<int>(std::floor(p.y() - cell.v0)));
        cv::circle(strength, at, radius, cv::Scalar(0), cv::FILLED);
    }
    while (wanted > 0) {
        double best = 0.0;
        cv::Point at;
        cv::minMaxLoc(strength, nullptr, &best, nullptr, &at);
        if (best < least) return;
        corners.emplace_back(cell.u0 + at.x, cell.v0 + at.y);
        cv::circle(strength, at, radius, cv::Scalar(0), cv::FILLED);
        wanted -= 1;
    }
}

}  // namespace

void detect_corners(ImageView<const std::uint8_t> image,
                    std::span<const Eigen::Vector2d> occupied,
                    const CornerConfig& config,
                    Executor& executor,
                    std::vector<Eigen::Vector2d>& corners) {
    corners.clear();
    if (image.empty()) return;
    const cv::Mat wrapped(image.height,
                          image.width,
                          CV_8UC1,
                          const_cast<std::uint8_t*>(image.data),
                          static_cast<std::size_t>(image.stride));
    const int cells = config.grid_columns * config.grid_rows;
    std::vector<std::vector<Eigen::Vector2d>> found(static_cast<std::size_t>(cells));
    executor.parallel_for(cells, [&](int index) {
        const Cell cell = cell_bounds(index, image.width, image.height, config);
        // The shares of all cells sum to `most` exactly.
        const int share = (index + 1) * config.most / cells - index * config.most / cells;
        if (cell.u1 - cell.u0 < kBlock_px || cell.v1 - cell.v0 < kBlock_px) return;
        std::vector<Eigen::Vector2d> near;  // points in the cell or within `min_distance_px`
        int inside = 0;
        for (const Eigen::Vector2d& p : occupied) {
            const double out_u = std::max({cell.u0 - p.x(), p.x() - cell.u1, 0.0});
            const double out_v = std::max({cell.v0 - p.y(), p.y() - cell.v1, 0.0});
            if (out_u == 0.0 && out_v == 0.0) inside += 1;
            if (std::max(out_u, out_v) <= config.min_distance_px) near.push_back(p);
        }
        if (inside < share)
            detect_in_cell(wrapped,
                           cell,
                           share - inside,
                           config,
                           near,
                           found[static_cast<std::size_t>(index)]);
    });
    for (const auto& of_cell : found) corners.insert(corners.end(), of_cell.begin(), of_cell.end());
}

}  // namespace surefoot::odometry

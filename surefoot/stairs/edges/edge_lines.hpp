// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/stairs/edges/edge_points.hpp"

namespace surefoot::stairs {

/// A straight line through edge points. From `from_m` to `to_m` the lower ground is on the right.
struct EdgeLine {
    Eigen::Vector2d from_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d to_m = Eigen::Vector2d::Zero();
    int points = 0;
    double rms_m = 0.0;  ///< scatter of the points across the line

    [[nodiscard]] double length_m() const { return (to_m - from_m).norm(); }
    [[nodiscard]] Eigen::Vector2d along() const { return (to_m - from_m).normalized(); }
    [[nodiscard]] Eigen::Vector2d down() const {
        const Eigen::Vector2d a = along();
        return {a.y(), -a.x()};
    }
};

/// Groups edge points into straight lines. Touching points of nearly equal upper height form a
/// chain. Each chain is cut into its longest unbroken lines, one after the other. Method: RANSAC
/// (Fischler and Bolles 1981) on pairs of near points; the draws depend only on the number of
/// points. Then pieces of one line are joined across gaps.
class EdgeLineFinder {
  public:
    explicit EdgeLineFinder(const StairsConfig& config) : config_(config) {}
    /// `points` must have the order of EdgePointFinder. Writes the longest line first.
    void find(const grid::GridGeometry& grid,
              std::span<const EdgePoint> points,
              std::vector<EdgeLine>& out);

  private:
    struct Piece {
        EdgeLine line;
        std::vector<std::int32_t> members;
        double upper_m = 0.0;  ///< median of `upper_m` of the members
        double lower_m = 0.0;
    };
    void chain(const grid::GridGeometry& grid, std::span<const EdgePoint> points);
    [[nodiscard]] std::int32_t root_of(std::int32_t point);
    void take_lines(std::span<const EdgePoint> points, std::span<const std::int32_t> chain);
    [[nodiscard]] bool fit(std::span<const EdgePoint> points, Piece& piece) const;
    void keep_longest_run(const Eigen::Vector2d& at_m,
                          const Eigen::Vector2d& along,
                          std::size_t least_points);
    void join(std::span<const EdgePoint> points);
    [[nodiscard]] bool belong_together(const Piece& a, const Piece& b) const;

    StairsConfig config_;
    double resolution_m_ = 0.0;
    Image<std::int32_t> first_;  ///< first point of a cell, -1 = none
    std::vector<std::int32_t> parent_;
    std::vector<std::int32_t> order_;  ///< indices of the points, chain by chain
    /// A point that belongs to no line yet.
    struct Left {
        float x_m = 0.0F;
        float y_m = 0.0F;
        float down_x = 0.0F;
        float down_y = 0.0F;
        std::int32_t point = 0;
    };
    std::vector<Left> left_;
    struct Placed {
        float t_m;
        std::int32_t point;
    };
    std::vector<Placed> run_;
    std::vector<Piece> pieces_;
};

}  // namespace surefoot::stairs

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "surefoot/stairs/stairs_config.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Direction from a cell to the lower ground.
enum class Side : std::uint8_t { plus_x, minus_x, plus_y, minus_y };

/// The last cell of upper ground in a row or column, before the ground falls.
struct EdgePoint {
    Eigen::Vector2f at_m;  ///< middle of the cell's border towards the lower ground
    std::int16_t ix = 0;   ///< column of the upper cell
    std::int16_t iy = 0;
    Side side = Side::plus_x;
    bool lower_seen = false;  ///< false: `lower_m` is an upper bound or an assumption
    float upper_m = 0.0F;
    float lower_m = 0.0F;
};

/// Finds points where the ground falls, along all rows and columns, in both directions. For a cell,
/// `top` is the highest cell up to `smear_m` before it, and `low` is the lowest cell up to
/// `smear_m` behind it. If unknown cells begin within `smear_m`, two more values count for `low`:
/// the next known cell, if it lies within the occluded region of an edge of this height, and the
/// free-space bound of the unknown cells up to `smear_m`. The cell is an edge point if top - low
/// reaches the least height and exceeds the noise, the cell lies above the middle of both, and the
/// next cell lies below the middle or is unknown.
///
/// If nothing is known behind the cell although the camera would see continuing ground there
/// (Terrain::view), the ground ends. It may fall too steeply to be visible.
class EdgePointFinder {
  public:
    explicit EdgePointFinder(const StairsConfig& config) : config_(config) {}
    /// Sorts the points by iy, ix, side. Allocates only until the largest map was processed.
    void find(const Terrain& terrain, std::vector<EdgePoint>& out);

  private:
    /// Every n-th element of a layer, or a default value if the layer is empty.
    struct Strided {
        const float* first = nullptr;
        std::ptrdiff_t step = 0;
        [[nodiscard]] float at(int cell, float otherwise) const {
            return first == nullptr ? otherwise : first[cell * step];
        }
    };
    /// A row or a column, walked in one direction.
    struct Line {
        int cells = 0;
        const float* height_m = nullptr;  ///< heights, copied to consecutive memory
        Strided var_m2;                   ///< variances, read for few cells only
        Strided free_above_m;
    };
    struct Found {
        int cell = 0;
        float upper_m = 0.0F;
        float lower_m = 0.0F;
        bool lower_seen = false;
        bool ends = false;  ///< the ground behind the edge is unknown
    };
    void scan(const Line& line);
    [[nodiscard]] bool falls_at(const Line& line, int cell, Found& found) const;
    void take_line(const Terrain& terrain, Side side, int index);

    StairsConfig config_;
    int window_cells_ = 1;
    int reach_cells_ = 1;
    double resolution_m_ = 0.0;
    std::vector<float> height_m_;  ///< heights of the line that is being scanned
    std::vector<float> low_m_;     ///< lowest height of the next known cells within the window
    std::vector<Found> found_;
};

}  // namespace surefoot::stairs

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "surefoot/stairs/stairs_config.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Where the lower ground lies from a cell.
enum class Side : std::uint8_t { plus_x, minus_x, plus_y, minus_y };

/// The last cell of a piece of ground along a row or a column, before it falls.
struct EdgePoint {
    Eigen::Vector2f at_m;  ///< middle of the cell's border on that side
    std::int16_t ix = 0;   ///< of the upper cell
    std::int16_t iy = 0;
    Side side = Side::plus_x;
    bool lower_seen = false;  ///< else the ground is only known to lie no higher than `lower_m`
    float upper_m = 0.0F;
    float lower_m = 0.0F;
};

/// Finds where the ground falls, along all rows and columns, both ways. Of a cell and what follows
/// it let `top` be the highest of the cells up to `smear_m` before it, `low` the lowest of those up
/// to `smear_m` behind it. Where the known ground ends there, the next known cell counts too, if it
/// lies no further than the shadow of such an edge, and so does the bound that lines of sight have
/// left for the ground in between. It is an edge point if top - low reaches the least height and
/// stands out of the noise of both a little, the cell lies above the middle of them and the next
/// one below it, or is unknown.
///
/// Where nothing is known of what lies behind, though ground that goes on would be seen there
/// (Terrain::view), the ground ends: it may go down so steeply that nothing of it is in sight.
class EdgePointFinder {
  public:
    explicit EdgePointFinder(const StairsConfig& config) : config_(config) {}
    /// Sorted by iy, then ix, then side. No allocation once the largest map has been seen.
    void find(const Terrain& terrain, std::vector<EdgePoint>& out);

  private:
    /// Every n-th element of a layer; nothing where there is no layer.
    struct Strided {
        const float* first = nullptr;
        std::ptrdiff_t step = 0;
        [[nodiscard]] float at(int cell, float otherwise) const {
            return first == nullptr ? otherwise : first[cell * step];
        }
    };
    /// A row or a column, walked one way.
    struct Line {
        int cells = 0;
        const float* height_m = nullptr;  ///< a copy without gaps
        Strided var_m2;                   ///< few cells are asked for these
        Strided free_above_m;
    };
    struct Found {
        int cell = 0;
        float upper_m = 0.0F;
        float lower_m = 0.0F;
        bool lower_seen = false;
        bool ends = false;  ///< nothing at all is known of what lies behind
    };
    void scan(const Line& line);
    [[nodiscard]] bool falls_at(const Line& line, int cell, Found& found) const;
    void take_line(const Terrain& terrain, Side side, int index);

    StairsConfig config_;
    int window_cells_ = 1;
    int reach_cells_ = 1;
    double resolution_m_ = 0.0;
    std::vector<float> height_m_;  ///< of the line that is scanned
    std::vector<float> low_m_;     ///< lowest of the known cells that follow, within the window
    std::vector<Found> found_;
};

}  // namespace surefoot::stairs

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "surefoot/stairs/edges/edge_border.hpp"
#include "surefoot/stairs/edges/edge_lines.hpp"
#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/stairs_config.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Level ground on one side of an edge. Distances count from the edge.
struct Level {
    double height_m = 0.0;
    double sigma_m = 0.0;
    double scatter_m = 0.0;  ///< robust standard deviation of one cell
    double begin_m = 0.0;    ///< distance of the near end from the edge
    double end_m = 0.0;      ///< distance at which the ground falls, rises or becomes unknown
    bool ends_unknown = false;
    double slope = 0.0;     ///< rise over run, away from the edge
    double middle_m = 0.0;  ///< middle of the ground that `height_m` averages
};

/// Measures the ground along an edge in slices. A slice is one cell deep and as long as the
/// edge; its height is the mean of the cells near their median, so single wrong cells have no
/// effect.
class EdgeProfiler {
  public:
    explicit EdgeProfiler(const StairsConfig& config) : config_(config) {}

    /// Returns the edge with its levels, or nothing if the upper ground is unknown. If
    /// nothing shows that the ground falls, the edge has height 0 and keeps the position of
    /// the line.
    [[nodiscard]] std::optional<Edge> measure(const Terrain& terrain, const EdgeLine& line);

    struct Slice {
        double height_m = 0.0;
        double scatter_m = 0.0;  ///< robust standard deviation of one cell
        double sigma_m = 0.0;    ///< rms of the sigmas that the map states for the cells
        double known_share = 0.0;
        double free_above_m = 0.0;  ///< lowest free-space bound of unknown cells; infinite = none
    };
    /// The slices from `upper_m` before a line to `lower_m` behind it. Slice borders lie at whole
    /// cells from the line. Valid until the next call.
    struct Slices {
        std::span<const Slice> slices;
        double begin_m = 0.0;  ///< begin of the first slice, from the line; negative = upper side
        double cell_m = 0.0;

        [[nodiscard]] int count() const { return static_cast<int>(slices.size()); }
        [[nodiscard]] const Slice& at(int slice) const {
            return slices[static_cast<std::size_t>(slice)];
        }
        [[nodiscard]] bool known(int slice) const;
        /// Number of slices, from `slice` on in direction `way`, of a narrow strip between two
        /// occluded regions: the visible part of a lower tread. 0 = there is no such strip.
        [[nodiscard]] int strip(int slice, int way) const;
    };
    [[nodiscard]] Slices slices(const Terrain& terrain,
                                const EdgeLine& line,
                                double upper_m,
                                double lower_m);

  private:
    struct Sample {
        int slice = 0;
        float height_m = 0.0F;
        float var_m2 = 0.0F;
    };
    void slice(const Terrain& terrain, const EdgeLine& line, double upper_m, double lower_m);
    void gather(const Terrain& terrain, const EdgeLine& line);
    void measure_slice(std::span<const Sample> samples, int cells, Slice& slice);
    [[nodiscard]] Level level_from(int first, int step) const;
    [[nodiscard]] bool ground_ends(const Terrain& terrain,
                                   const EdgeLine& line,
                                   const Level& upper) const;
    double place(const Terrain& terrain, const EdgeLine& line, const Level& upper, Edge& edge);
    [[nodiscard]] double slope_of(int begin, int step, int count) const;
    [[nodiscard]] const Slice& at(int slice) const {
        return slices_[static_cast<std::size_t>(slice)];
    }

    StairsConfig config_;
    double resolution_m_ = 0.0;
    double length_m_ = 0.0;
    int upper_slices_ =
        0;  ///< number of slices before the edge; slice k begins (k - upper_slices_) cells from it
    std::vector<Slice> slices_;
    std::vector<int> cells_;  ///< number of cells of each slice
    std::vector<BorderPoint> borders_;
    std::vector<Sample> samples_;
    std::vector<Sample> sorted_;
    std::vector<std::size_t> first_;  ///< index of each slice's first sample in `sorted_`
    std::vector<std::size_t> next_;
    std::vector<float> values_;
};

}  // namespace surefoot::stairs

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/stairs/classes/patch_walk.hpp"
#include "surefoot/stairs/classes/planar_patches.hpp"
#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/stairs_config.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Class of the ground in a cell. "Reachable" means reachable from the stance over patches whose
/// planes meet within `max_step_m`, or over the steps of a flight that was found.
enum class GroundClass : std::uint8_t {
    unknown,  ///< not measured, or too uncertain
    floor,    ///< level and reachable; includes landings and the tops of kerbs
    tread,    ///< between two consecutive edges of a flight, at the level of the tread
    riser,    ///< a cell on the edge of a step, or beside it at a height between both levels
    ramp,     ///< a reachable plane that is steeper than level ground
    kerb,     ///< like a riser, but at a single edge that is no higher than a kerb
    sill,     ///< a raised cell between the jambs of a door
    drop,     ///< ground more than stairs.drop_m below any ramp from reachable ground. Also unknown
              ///< cells that rays prove to be so low, or just behind a drop with unseen bottom.
    wall,     ///< higher than a step, and steep, narrow, on no plane or higher than a table
    table,    ///< a plane no steeper than a ramp, higher than a step and not reachable.
              ///< Examples: table tops, and platforms seen from below.
    tunnel,   ///< ground with an object lower than `headroom_m` above it
};
inline constexpr std::array<const char*, 11> kGroundClassNames{"unknown",
                                                               "floor",
                                                               "tread",
                                                               "riser",
                                                               "ramp",
                                                               "kerb",
                                                               "sill",
                                                               "drop",
                                                               "wall",
                                                               "table",
                                                               "tunnel"};

/// The class of every cell, and the levels of the treads as separate layers. The measured heights
/// stay unchanged.
struct GroundClasses {
    Image<GroundClass> of_cell;
    /// Level of the tread that the cell belongs to, fitted over the whole tread; NaN = the cell is
    /// on no tread. Map frame.
    grid::Layer tread_height_m;
    grid::Layer tread_sigma_m;  ///< one sigma of that level; NaN = the cell is on no tread
};

/// Assigns a class to each cell. Uncertain ground is never floor: this holds for a patch that may
/// not be level, a cell on no plane and a cell with a large sigma. A single cell that lies low near
/// reachable ground becomes a drop.
///
/// Owns the working memory: maps of one size and number of features allocate nothing after the
/// first few calls. The same map gives the same result. Not thread-safe.
class GroundClassifier {
  public:
    explicit GroundClassifier(const StairsConfig& config) : config_(config), walk_(config) {}
    /// `features` and `patches` must come from the same terrain.
    void classify(const Terrain& terrain,
                  const TerrainFeatures& features,
                  const PatchMap& patches,
                  GroundClasses& out);

  private:
    /// Four corners in order around the quadrilateral.
    using Quad = std::array<Eigen::Vector2d, 4>;
    void name_patches(const PatchMap& patches);
    /// Height above (+) or below (-) the range that a ramp from the near ground can reach; else 0.
    [[nodiscard]] double off_the_way_m(const NearGround& ground, double height_m) const;
    [[nodiscard]] GroundClass walked_class(const PlanarPatch& patch) const;
    [[nodiscard]] GroundClass other_class(const PlanarPatch& patch, double above_m) const;
    [[nodiscard]] GroundClass unseen_class(const NearGround& ground, float free_above_m) const;
    void name_cells(const Terrain& terrain, const PatchMap& patches, GroundClasses& out) const;
    void name_treads(const Terrain& terrain, const Flight& flight, GroundClasses& out);
    void name_tread(const Terrain& terrain,
                    const Quad& quad,
                    double expected_m,
                    GroundClasses& out);
    void name_edge(const Terrain& terrain,
                   const Eigen::Vector2d& from_m,
                   const Eigen::Vector2d& to_m,
                   std::pair<double, double> levels_m,
                   GroundClass name,
                   GroundClasses& out) const;
    void name_sill(const Terrain& terrain, const LineFeature& sill, GroundClasses& out) const;
    void name_unseen_drop(const Terrain& terrain,
                          const LineFeature& line,
                          GroundClasses& out) const;
    void name_tunnels(const Terrain& terrain, GroundClasses& out) const;

    StairsConfig config_;
    PatchWalk walk_;
    std::vector<GroundClass> class_;  ///< class of each patch
    std::vector<double> above_m_;     ///< sum of off_the_way_m over the blocks of a patch
    std::vector<int> above_count_;
    std::vector<float> heights_m_;
    std::vector<float> sorted_m_;
};

/// Computes patches and classes in one call, without kept memory. Allocates.
[[nodiscard]] GroundClasses classify_ground(const StairsConfig& config,
                                            const Terrain& terrain,
                                            const TerrainFeatures& features);

/// Number of cells of each class, in the order of kGroundClassNames.
[[nodiscard]] std::array<int, kGroundClassNames.size()> count_classes(const GroundClasses& classes);

}  // namespace surefoot::stairs

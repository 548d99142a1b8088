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

/// What the ground is at a cell. "Walked to": from the stance over patches whose planes meet within
/// `max_step_m`, or over the steps of a flight that was found.
enum class GroundClass : std::uint8_t {
    unknown,  ///< nothing is known, or nothing is sure
    floor,    ///< level ground that can be walked to, landings and the tops of kerbs too
    tread,    ///< between two neighbouring edges of a flight, on the level of its tread
    riser,    ///< a cell that the edge of a step crosses, or beside it between both levels
    ramp,     ///< a plane that can be walked to and is steeper than level ground
    kerb,     ///< as a riser, of a single edge that is no higher than a kerb
    sill,     ///< what stands up between the jambs of a door
    drop,     ///< ground below ground that can be walked to, further than any ramp would lead, and
              ///< not to be stepped down to; unknown ground that lines of sight show to be so low
    wall,     ///< what stands higher than a step, and is steep, narrow or on no plane at all
    table,    ///< a level plane that stands higher than a step and cannot be walked to: table
              ///< tops, platforms seen from below
    tunnel,   ///< one could stand there but for what hangs lower than `headroom_m` above it
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

/// A class for every cell of a map, and its treads as a layer of their own: the heights that were
/// measured stay as they are.
struct GroundClasses {
    Image<GroundClass> of_cell;
    /// Level of the tread that a known cell belongs to: one height for all of its cells, fitted
    /// over the tread; NaN where there is none. In the frame of the map.
    grid::Layer tread_height_m;
    grid::Layer tread_sigma_m;  ///< one sigma of that level; NaN likewise
};

/// Names the cells of a map. What is unsure is never floor: a patch whose slope is not sure to be
/// level, a cell on no plane and one whose own sigma is large are unknown; single cells that lie
/// low beside ground to walk on are drops.
///
/// Holds the working memory: maps of one size and number of features allocate nothing after the
/// first few. The same result for the same map.
class GroundClassifier {
  public:
    explicit GroundClassifier(const StairsConfig& config) : config_(config), walk_(config) {}
    /// `features` and `patches` are those of the same terrain.
    void classify(const Terrain& terrain,
                  const TerrainFeatures& features,
                  const PatchMap& patches,
                  GroundClasses& out);

  private:
    /// Four corners, in order around.
    using Quad = std::array<Eigen::Vector2d, 4>;
    void name_patches(const PatchMap& patches);
    /// Of a height over the near ground, what no ramp leads to.
    [[nodiscard]] double off_the_way_m(const NearGround& ground, double height_m) const;
    [[nodiscard]] GroundClass walked_class(const PlanarPatch& patch) const;
    [[nodiscard]] GroundClass other_class(const PlanarPatch& patch, double above_m) const;
    [[nodiscard]] GroundClass unseen_class(const NearGround& ground, float free_above_m) const;
    void name_cells(const Terrain& terrain, const PatchMap& patches, GroundClasses& out) const;
    void name_treads(const Terrain& terrain, const Flight& flight, GroundClasses& out);
    void name_tread(const Terrain& terrain, const Quad& quad, double told_m, GroundClasses& out);
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
    std::vector<GroundClass> class_;  ///< of each patch
    std::vector<double> above_m_;     ///< sums over blocks of a patch
    std::vector<int> above_count_;
    std::vector<float> heights_m_;
    std::vector<float> sorted_m_;
};

/// Patches and classes of a map, for who wants them once. Allocates.
[[nodiscard]] GroundClasses classify_ground(const StairsConfig& config,
                                            const Terrain& terrain,
                                            const TerrainFeatures& features);

/// How many cells have each class, in the order of kGroundClassNames.
[[nodiscard]] std::array<int, kGroundClassNames.size()> count_classes(const GroundClasses& classes);

}  // namespace surefoot::stairs

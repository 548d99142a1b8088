// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/stairs/classes/planar_patches.hpp"
#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/stairs_config.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// The reachable ground nearest to a block.
struct NearGround {
    float distance_m = 0.0F;  ///< distance; infinite = none within stairs.classes.reach_m
    float height_m = 0.0F;
};

/// Finds the patches that are reachable from the stance, and the distance of each block to them.
///
/// Compares the planes of patches where they meet, not neighbouring cells (as Reachability does). A
/// matcher can smear a kerb or a table over five cells. Then no step between cells remains, but the
/// planes keep their distance. Two patches connect where they lie within stairs.classes.max_step_m
/// over a foot's width, with only an edge and its occluded region between them. They also connect
/// along a flight of two or more steps. Other links lead only to carrying patches: no steeper
/// than stairs.classes.ramp_deg, with a slope sigma of at most 5 deg.
///
/// The machine stands on the lowest carrying patch near it that has a quarter of the carrying
/// blocks there, and on carrying patches of that level. If none is near, the nearest one counts.
class PatchWalk {
  public:
    explicit PatchWalk(const StairsConfig& config) : config_(config) {}
    /// `features` and `patches` must come from the same terrain.
    void find(const Terrain& terrain, const TerrainFeatures& features, const PatchMap& patches);

    [[nodiscard]] bool walked(std::size_t patch) const { return walked_[patch] != 0; }
    /// One entry per block, row by row.
    [[nodiscard]] std::span<const NearGround> near_ground() const { return near_; }

  private:
    /// Two successive patches of one row or column of blocks; blocks between them are on no patch.
    struct Contact {
        std::int32_t low = 0;  ///< the lower of the two patch numbers
        std::int32_t high = 0;
        float rise_m = 0.0F;  ///< height from `low` to `high`, at the middle between both
        float gap_m = 0.0F;
    };
    struct NearStance {
        int blocks = 0;
        double nearest_m = 0.0;  ///< distance to the nearest block of a walkable patch; inf = none
        Eigen::Vector2d nearest_at_m = Eigen::Vector2d::Zero();
    };
    struct Link {
        std::int32_t from = 0;
        std::int32_t to = 0;
        bool proven = false;  ///< a flight proves the link, whatever the slope of the patch
    };

    void find_contacts(const PatchMap& patches);
    void add_contacts(const PatchMap& patches, bool along_x, int line);
    NearStance count_near(const Eigen::Vector2d& stance_m,
                          double radius_m,
                          const PatchMap& patches);
    void find_stance(const Eigen::Vector2d& stance_m, const PatchMap& patches);
    [[nodiscard]] bool may_carry(const PlanarPatch& patch) const;
    void link_neighbours(double block_m);
    void link_flight(const grid::GridGeometry& grid, const Flight& flight, const PatchMap& patches);
    [[nodiscard]] static std::int32_t patch_beside(const grid::GridGeometry& grid,
                                                   const Edge& edge,
                                                   bool upper,
                                                   const PatchMap& patches);
    void walk(const PatchMap& patches);
    void find_near_ground(const PatchMap& patches);

    StairsConfig config_;
    std::vector<Contact> contacts_;
    std::vector<Link> links_;
    std::vector<int> near_stance_;  ///< number of blocks of each patch near the stance
    std::vector<std::uint8_t> walked_;
    std::vector<std::int32_t> waiting_;
    std::vector<NearGround> near_;
};

}  // namespace surefoot::stairs

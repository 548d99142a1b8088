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

/// Ground that can be walked to, nearest to a block.
struct NearGround {
    float distance_m = 0.0F;  ///< infinite = none within stairs.classes.reach_m
    float height_m = 0.0F;
};

/// Which patches can be walked to from the stance, and how far the rest of the map is from them.
///
/// Patches are asked where their planes meet, not neighbouring cells (as Reachability does): a kerb
/// or a table that a matcher has smeared over five cells has no steps between cells, but its planes
/// lie as far apart as ever. One goes from patch to patch where they lie within
/// stairs.classes.max_step_m of each other over a foot's width, with no more between them than an
/// edge and its shadow; and along every flight of two steps or more. What is steeper than
/// stairs.classes.ramp_deg, or of unknown slope, is not walked on.
///
/// The machine stands on the lowest of the patches near it that hold a quarter of what is known
/// there, and on those on its level; if nothing is known near it, near the nearest that is.
class PatchWalk {
  public:
    explicit PatchWalk(const StairsConfig& config) : config_(config) {}
    /// `features` and `patches` are those of the same terrain.
    void find(const Terrain& terrain, const TerrainFeatures& features, const PatchMap& patches);

    [[nodiscard]] bool walked(std::size_t patch) const { return walked_[patch] != 0; }
    /// For each block, row by row.
    [[nodiscard]] std::span<const NearGround> near_ground() const { return near_; }

  private:
    /// Two patches with nothing but unknown ground and borders between them.
    struct Contact {
        std::int32_t low = 0;  ///< the lower number of the two
        std::int32_t high = 0;
        float rise_m = 0.0F;  ///< from `low` to `high`, half way between
        float gap_m = 0.0F;
    };
    struct NearStance {
        int blocks = 0;
        double nearest_m = 0.0;  ///< block of a patch that may carry; infinite = none
        Eigen::Vector2d nearest_at_m = Eigen::Vector2d::Zero();
    };
    struct Link {
        std::int32_t from = 0;
        std::int32_t to = 0;
        bool proven = false;  ///< by a flight, whatever the patch looks like
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
    std::vector<int> near_stance_;  ///< blocks of each patch
    std::vector<std::uint8_t> walked_;
    std::vector<std::int32_t> waiting_;
    std::vector<NearGround> near_;
};

}  // namespace surefoot::stairs

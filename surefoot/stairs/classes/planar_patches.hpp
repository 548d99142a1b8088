// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

struct PatchConfig {
    double block_m = 0.075;  ///< three cells of 25 mm: a 250 mm tread holds a block at any yaw
    /// A cell lies on a plane within this distance or within `sigma_factor` times its sigma, but
    /// at most within `max_tolerance_m`: a larger difference is an edge (stairs.min_height_m).
    double tolerance_m = 0.015;
    double sigma_factor = 3.0;
    double max_tolerance_m = 0.04;
    double min_area_m2 = 0.02;  ///< smallest area of a patch

    void describe(ConfigVisitor& visitor);
    /// Returns the first reason why these settings are invalid, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// A connected piece of ground on one plane. Map frame.
struct PlanarPatch {
    Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();  ///< weighted middle, on the plane
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();  ///< dz / dx, dz / dy
    double slope_sigma_rad = 0.0;  ///< slope sigma along the narrower side; infinite = unknown
    double rms_m = 0.0;            ///< scatter of its cells about the plane
    double width_m = 0.0;  ///< smaller side of a rectangle with the same spread as the cells
    int cells = 0;

    [[nodiscard]] double slope_rad() const { return std::atan(gradient.norm()); }
    [[nodiscard]] double height_m(const Eigen::Vector2d& p_m) const {
        return middle_m.z() + gradient.dot(p_m - middle_m.head<2>());
    }
};

/// The patch of each cell.
struct PatchMap {
    std::vector<PlanarPatch> patches;
    Image<std::int32_t> of_cell;  ///< index in `patches`; kNone = unknown, or on no plane
    int block_cells = 1;          ///< side of a block, in cells
    double block_m = 0.0;
    Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();  ///< corner of block (0, 0)
    Image<std::int32_t> of_block;  ///< block (bx, by) begins at cell block_cells * (bx, by)

    static constexpr std::int32_t kNone = -1;
    [[nodiscard]] Eigen::Vector2d block_middle_m(int bx, int by) const {
        return origin_m + block_m * Eigen::Vector2d(bx + 0.5, by + 0.5);
    }
};

/// Divides the known ground into planes. The cells are summed block by block, weighted by their
/// variances. Regions grow from the flattest blocks over neighbours that lie on the region's
/// plane so far. Regions on one plane are joined, and border blocks move to the better plane.
/// Last, each cell takes the best plane of its block and the eight around it, so borders run
/// between cells. Growth from the best seed: Besl and Jain 1988. Sums over blocks: Feng, Taguchi
/// and Kamat 2014.
///
/// A block with less than half of its cells known is no seed. Owns the working memory: maps of
/// one size allocate nothing after the first few calls. The same map gives the same result.
class PatchFinder {
  public:
    explicit PatchFinder(const PatchConfig& config) : config_(config) {}
    /// Precondition: `config().problem()` is empty.
    void find(const Terrain& terrain, PatchMap& out);
    [[nodiscard]] const PatchConfig& config() const noexcept { return config_; }

  private:
    /// Weighted sums over cells; x and y count from the middle of the map.
    struct Sums {
        double w = 0.0, x = 0.0, y = 0.0, z = 0.0;
        double xx = 0.0, xy = 0.0, yy = 0.0, xz = 0.0, yz = 0.0, zz = 0.0;
        double cells = 0.0;
        void add(const Sums& other);
    };
    /// z = at_0_m + gx x + gy y.
    struct Plane {
        double at_0_m = 0.0, gx = 0.0, gy = 0.0;
    };
    struct Region {
        Sums sums;
        Plane plane;
    };

    [[nodiscard]] static Plane fit(const Sums& sums);
    /// Weighted mean of the squared residuals [m2].
    [[nodiscard]] static double mean_square_m2(const Sums& sums, const Plane& plane);
    [[nodiscard]] bool lies_on(const Sums& sums, const Plane& plane) const;

    void sum_blocks(const Terrain& terrain);
    void order_seeds();
    [[nodiscard]] Sums around(int bx, int by) const;
    void grow_all(PatchMap& out);
    void grow(std::int32_t seed, const Plane& start, PatchMap& out);
    void join_regions(PatchMap& out);
    void settle_borders(PatchMap& out);
    void refit(const PatchMap& out);
    void drop_small(double cell_m2, PatchMap& out);
    void assign_cells(const Terrain& terrain, PatchMap& out);
    void measure(const Terrain& terrain, PatchMap& out) const;

    PatchConfig config_;
    Eigen::Vector2d middle_m_ = Eigen::Vector2d::Zero();
    int block_cells_ = 1;
    int nbx_ = 0;
    int nby_ = 0;
    std::vector<Sums> blocks_;
    std::vector<std::uint8_t> quality_;  ///< quality of each seed; 0 = best
    std::vector<Plane> start_;           ///< start plane of each seed
    std::vector<std::int32_t> seeds_;
    std::vector<std::int32_t> waiting_;
    std::vector<Region> regions_;
    std::vector<std::int32_t> joined_to_;
    std::vector<double> square_m2_;  ///< sum of squared residuals over the cells of a patch
};

}  // namespace surefoot::stairs

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "surefoot/core/unknown.hpp"
#include "surefoot/elevation/elevation_map.hpp"
#include "surefoot/elevation/visibility/ray_endpoints.hpp"
#include "surefoot/elevation/visibility/visibility.hpp"

namespace surefoot::fuzz {

/// Reference implementation of elevation::ElevationMap, written for clarity: a dictionary from
/// lattice cells to their state, without layers, a sliding window, blocks or SIMD. It shares with
/// ElevationMap only functions that have their own reference tests: the points of a cloud or image,
/// the plain reduction of a cell, the height fusion, the noise of an image row, the viewpoint
/// history, the ray endpoints, and the lowest ray over a cell. It does not align heights.
class PlainMap {
  public:
    explicit PlainMap(const elevation::ElevationConfig& config);

    void follow(const Pose& T_odom_body, const Matrix6& relative_covariance);
    FusionCounts add(const camera::RectifiedRig& rig,
                     const Pose& T_odom_body,
                     const DepthImage& depth,
                     std::int64_t time_ns);
    FusionCounts add_points(std::span<const elevation::MeasuredPoint> points,
                            const Pose& T_body_sensor,
                            const Pose& T_odom_body,
                            std::int64_t time_ns);
    /// Inserts a remembered region and returns the number of filled cells; 0 if the map refuses the
    /// placement.
    std::int64_t insert(const grid::MapRegion& region,
                        const Pose& T_odom_body,
                        const Matrix6& placement_covariance);
    void clear() { cells_.clear(); }

    /// State of a cell, with the meaning and units of ElevationLayers.
    struct Known {
        float height_m = kNanF;
        float height_var_m2 = kNanF;
        std::uint32_t count = 0;
        std::int64_t seen_ns = 0;
        float horizontal_drift_m = kNanF;
        float highest_m = kNanF;
        float lowest_m = kNanF;
        float clearance_m = kNanF;
        float confidence = kNanF;
        float density_ratio = kNanF;
    };
    /// `ix`, `iy`: cell of the window.
    [[nodiscard]] Known known(int ix, int iy) const;
    /// All cells of the window as a region; only its layers are set.
    [[nodiscard]] grid::MapRegion layers() const;
    /// The layer that a region does not contain.
    [[nodiscard]] Image<float> free_above_m() const;
    [[nodiscard]] const grid::GridGeometry& geometry() const { return geometry_; }

  private:
    using Index = std::pair<std::int64_t, std::int64_t>;  ///< (iy, ix) on the lattice

    struct Cell : Known {
        float settled_var_m2 = kNanF;
        elevation::ViewpointHistory::Id view = elevation::ViewpointHistory::kNever;
        float overhead_m = kNanF;
        int overhead_trust = 0;
        bool overhead_hangs = false;
        float bottom_m = kNanF;      ///< lowest ray over an unknown cell
        float free_above_m = kNanF;  ///< second lowest ray over it
        int steady = 0;
        int seen_through = 0;
    };
    /// Measurement of one cell in one frame.
    struct CellObservation {
        elevation::CellMeasurement measured;
        float density_ratio = kNanF;
        float bottom_m = kNanF;
    };
    struct Heights {
        std::vector<float> z_m;
        std::vector<float> var_m2;
    };
    using Samples = std::map<Index, Heights>;

    [[nodiscard]] Index lattice_of(int ix, int iy) const {
        return {first_iy_ + iy, first_ix_ + ix};
    }
    [[nodiscard]] Samples samples_of(std::span<const elevation::GridPoint> points,
                                     FusionCounts& counts) const;
    /// Takes a cloud after the enabled cloud filters, which remove points from `points`.
    [[nodiscard]] Samples samples_of(std::vector<elevation::GridPoint>& points,
                                     FusionCounts& counts) const;
    void fuse(const Samples& samples,
              const Pose& T_odom_body,
              const Eigen::Vector3d& camera_m,
              const elevation::ExpectedPoints* expected,
              std::int64_t time_ns,
              FusionCounts& counts);
    void update(Cell& cell,
                const CellObservation& seen,
                std::int64_t time_ns,
                FusionCounts& counts);
    void start(Cell& cell, const CellObservation& seen, std::int64_t time_ns);
    void agree(Cell& cell,
               const elevation::Height& fused,
               const CellObservation& seen,
               std::int64_t time_ns);
    /// Upper bound of a measured height, at the sigmas of the visibility clean-up.
    [[nodiscard]] float not_above_m(const elevation::CellMeasurement& measured) const {
        return measured.z_m +
               static_cast<float>(config_.visibility.sigmas) * std::sqrt(measured.var_m2);
    }
    void look_overhead(const elevation::RayEndpoints& ends);
    void look_over_unknown(const elevation::FreeSpaceRays& lines);
    /// Cells whose surface is gone because rays passed through it (visibility clean-up).
    [[nodiscard]] std::vector<Index> find_gone(const elevation::RayEndpoints& ends,
                                               const elevation::FreeSpaceRays& lines,
                                               std::int64_t time_ns);
    [[nodiscard]] bool stands_beside(Index index, std::int64_t time_ns) const;
    static void see_over(Cell& cell, float line_z_m);
    static void set_confidence(Cell& cell, float confidence);
    static void forget(Cell& cell);
    static void see_above(Cell& cell, float z_m, int trust, bool hangs);
    static void see_no_more_above(Cell& cell);
    static void set_clearance(Cell& cell);
    void drop_what_touches(Cell& cell) const;

    elevation::ElevationConfig config_;
    grid::GridGeometry geometry_;
    std::int64_t first_ix_ = 0;
    std::int64_t first_iy_ = 0;
    elevation::ViewpointHistory views_;
    elevation::ViewpointHistory::Id view_ = elevation::ViewpointHistory::kNever;  ///< of this frame
    std::map<Index, Cell> cells_;
};

}  // namespace surefoot::fuzz

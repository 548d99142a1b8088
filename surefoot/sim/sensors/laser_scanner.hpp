// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/sim/rendering/imaging.hpp"
#include "surefoot/sim/scenes/scene.hpp"

namespace surefoot::sim {

/// A terrestrial laser scanner: a vertical fan of beams that turns about the z axis of the scanner.
/// Azimuth counts from x towards y, elevation from the horizon upward. Defaults: Faro Focus3D S120
/// (data sheet) at a quarter of its resolution.
///
/// Range noise: the signal falls with r^2 and with the return of a matt surface, reflectance times
/// cosine, so
///   sigma^2 = floor^2 + (growth r)^2 / (reflectance cos)
/// Both numbers are fitted (least largest error, 9 %) to the data sheet: 0.6 mm at 90 % reflectance
/// and 1.2 mm at 10 % in 10 m; 0.95 mm at 90 % and 2.2 mm at 10 % in 25 m.
struct LaserScannerConfig {
    double azimuth_min_deg = -180.0;  ///< azimuth of the first column
    double azimuth_max_deg = 180.0;   ///< azimuth at which the scan ends, itself excluded
    double elevation_min_deg =
        -62.5;  ///< elevation of the first row; the field of view is 305 deg, through the zenith
    double elevation_max_deg = 90.0;
    double step_deg = 0.036;     ///< beam spacing, 4 x 0.009 deg: 10 000 columns of 4237 points
    double min_range_m = 0.6;    ///< smallest range, along the beam
    double max_range_m = 120.0;  ///< largest range at 90 % reflectance, head-on; else shorter
    double noise_floor_m = 0.575e-3;
    double noise_growth = 2.94e-5;         ///< share of the range, on a white surface seen head-on
    double beam_exit_m = 0.003;            ///< diameter of the beam at the scanner
    double beam_divergence_rad = 0.19e-3;  ///< growth of the diameter per metre of range

    void describe(ConfigVisitor& visitor);
};

struct ScanPoint {
    Eigen::Vector3d point_scanner_m;  ///< NaN without a return
    std::int32_t surface = -1;        ///< truth: the surface that the middle of the beam hits
    bool mixed = false;               ///< truth: the beam met more than one surface
};

/// One vertical column of the scan, lowest elevation first.
struct ScanColumn {
    int index = 0;
    double azimuth_rad = 0.0;
    std::span<const ScanPoint> points;  ///< valid during the call only
};

/// Scans a scene from a station. Mirrors and glass return nothing (ASSUMPTION). A beam that hits
/// several surfaces measures the mean of their ranges, weighted by beam area and returned light.
/// Immutable after construction.
class LaserScanner {
  public:
    /// Fails if the angles or ranges select no beam. The scene must outlive the scanner.
    [[nodiscard]] static Result<LaserScanner> make(const Scene& scene,
                                                   const LaserScannerConfig& config,
                                                   std::uint64_t seed);
    [[nodiscard]] int columns() const noexcept { return columns_; }
    [[nodiscard]] int rows() const noexcept { return rows_; }
    /// Delivers the columns in order on the calling thread, until `take` returns false. Only a few
    /// columns are in memory. The executor does not change the result. `station` selects the
    /// noise.
    void scan(const Pose& T_world_scanner,
              int station,
              Executor& executor,
              const std::function<bool(const ScanColumn&)>& take) const;
    /// Range noise, one sigma; `return_share` = reflectance times cosine of incidence.
    [[nodiscard]] double sigma_m(double range_m, double return_share) const;

  private:
    LaserScanner(const Scene& scene, const LaserScannerConfig& config, std::uint64_t seed);
    /// Beams of the column that is being computed.
    struct Beams {
        std::vector<Eigen::Vector3d> directions_scanner;
        std::vector<Eigen::Vector3d> directions;  ///< world
        std::vector<RayHit> hits;
        std::vector<Eigen::Vector3d> ring;  ///< four rays per beam, one beam after another
        std::vector<RayHit> ring_hits;
    };
    void scan_column(const Pose& T_world_scanner,
                     int station,
                     int column,
                     Beams& beams,
                     std::span<ScanPoint> out) const;
    void aim(const Pose& T_world_scanner, int column, Beams& beams) const;
    void widen(Beams& beams) const;
    [[nodiscard]] double azimuth_rad(int column) const;
    [[nodiscard]] double range_m(const Pose& T_world_scanner,
                                 const Beams& beams,
                                 std::size_t row,
                                 ScanPoint& out,
                                 double& return_share) const;
    [[nodiscard]] double return_share(int surface,
                                      const Eigen::Vector3d& point_m,
                                      const Eigen::Vector3d& direction) const;

    const Scene* scene_;
    LaserScannerConfig config_;
    std::uint64_t seed_ = 0;
    int columns_ = 0;
    int rows_ = 0;
    PixelNoise noise_;
};

}  // namespace surefoot::sim

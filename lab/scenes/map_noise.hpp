// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lab/scenes/hazard_scene.hpp"
#include "lab/scenes/scene_sight.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/grid/map_snapshot.hpp"

/// Draws maps of a scene without rendering images: true heights plus random errors. The
/// distribution of the errors was measured on maps of whole runs.
namespace surefoot::experiments {

/// Distribution of map errors. Source: `map_noise_fit` on maps at the end of whole runs, seeds
/// 21-28. A trolley with the fitted ZED profile goes 1.3-2 m towards the hazard. Sample: 72 runs,
/// 192 348 cells of level ground. Both cameras see these cells from at least three poses, within
/// 0.9 m of the machine and 0.15 m from the hazard. Where runs differ, the constants take the value
/// that is harder for the gate. docs/lab/gate_scenes.md lists the figures.
struct MapNoise {
    /// `share` of the cells state a sigma of at most `sigma_m`. Most are near 3 mm, the minimum of
    /// the map. A cell above 6 mm has just rejected a measurement, which doubles sigma.
    struct Quantile {
        double share;
        double sigma_m;
    };
    static constexpr int kQuantiles = 15;
    std::array<Quantile, kQuantiles> sigma = {{{0.0, 3.00e-3},
                                               {0.1, 3.03e-3},
                                               {0.25, 3.07e-3},
                                               {0.5, 3.16e-3},
                                               {0.75, 3.63e-3},
                                               {0.9, 4.15e-3},
                                               {0.95, 4.93e-3},
                                               {0.98, 6.03e-3},
                                               {0.99, 6.36e-3},
                                               {0.995, 6.98e-3},
                                               {0.998, 8.07e-3},
                                               {0.999, 8.95e-3},
                                               {0.9995, 9.96e-3},
                                               {0.9999, 11.90e-3},
                                               {1.0, 17.00e-3}}};
    double error_share = 0.77;  ///< standard deviation of error / stated sigma; normal distribution
    double smooth_share =
        0.66;  ///< share of the error variance in the spatially correlated part (smooth_field)
    double tilt = 1.5e-3;                   ///< sd of the slope error of a run [m/m], per axis
    double outlier_share = 9.4e-5;          ///< share of outlier cells: 18 of 192 348 measured
    double outlier_least_m = 0.020;         ///< smallest |error| of an outlier
    double outlier_most_m = 0.042;          ///< largest |error|; small errors are more frequent
    double outlier_least_sigma_m = 4.5e-3;  ///< smallest stated sigma of an outlier [m]
    double outlier_most_sigma_m = 17e-3;    ///< largest stated sigma of an outlier [m]
    double drift_m = 2.2e-3;                ///< 90th percentile of the stated drift [m]
    /// Factor on the stated sigma if the machine did not walk: sigma of cells seen from one pose,
    /// divided by the sigma of cells seen from six poses.
    double once_factor = 1.25;

    /// true: the map states the smallest sigma everywhere, so that the gate never refuses because
    /// of noise. The errors keep their drawn size. This is harder than every measured map.
    bool overconfident = false;

    /// Returns a copy with errors and stated sigma multiplied by `factor`.
    [[nodiscard]] MapNoise times(double factor) const;
};

/// Distribution for doubled image noise; sample: 17 runs, seeds 31 and 32. The stated sigma is 2.4
/// times as large. It is too small in half of the runs: the errors have an sd of 0.8-1.4 sigma. One
/// run whose odom frame is 0.94 m too low is excluded.
[[nodiscard]] MapNoise doubled_image_noise();

/// True heights and visibility of the map cells within 1.1 m of the machine. Noise does not change
/// them, so they are computed once per scene.
class SceneCells {
  public:
    SceneCells(const HazardScene& scene, const Sight& sight);

    /// A map cell, described by 4 x 4 samples half a cell apart, over twice the width of the cell.
    struct Cell {
        float low_m = 0.0F;          ///< lowest sample [m]; voids do not count
        float high_m = 0.0F;         ///< highest sample [m]; overhangs do not count
        float highest_m = 0.0F;      ///< highest sample inside the cell [m]
        float under_m = 0.0F;        ///< underside of an overhang above the cell; NaN = none
        float top_m = 0.0F;          ///< top of this overhang [m]
        float share_high = 0.0F;     ///< share of samples nearer to high_m than to low_m
        bool ground = false;         ///< true: at least one sample is not a void
        bool seen = false;           ///< true: both cameras see at least one of 5 points in it
        bool beside_seen = false;    ///< true: the cell or one of its 8 neighbours is seen
        float beside_high_m = 0.0F;  ///< highest sample of these nine cells [m]
    };
    [[nodiscard]] const grid::GridGeometry& geometry() const noexcept { return geometry_; }
    [[nodiscard]] const Image<Cell>& cells() const noexcept { return cells_; }
    /// Returns true if the hazard goes down (negative relief).
    [[nodiscard]] bool falling() const noexcept { return falling_; }

  private:
    grid::GridGeometry geometry_;
    Image<Cell> cells_;
    bool falling_ = false;
};

/// The map layers that the gate reads.
struct MadeMap {
    grid::GridGeometry geometry;
    Image<float> height_m;
    Image<float> variance_m2;
    Image<float> drift_m;
    Image<float> clearance_m;
};

/// Returns a map without errors: the top of seen cells, and of tall cells beside them; sigma 1 mm.
[[nodiscard]] MadeMap clean_map(const SceneCells& scene);
/// Draws a map with errors. `once`: the machine did not walk, so all observations have one pose.
[[nodiscard]] MadeMap noisy_map(const SceneCells& scene,
                                const MapNoise& noise,
                                bool once,
                                Rng& rng);

/// Fills `out` with the map as a healthy, fresh snapshot of the pipeline. The layer with free space
/// over unknown cells stays empty. In a real snapshot this layer only adds evidence of drops.
[[nodiscard]] Status snapshot_of(const MadeMap& map,
                                 const Pose& T_odom_body,
                                 grid::MapSnapshot& out);

}  // namespace surefoot::experiments

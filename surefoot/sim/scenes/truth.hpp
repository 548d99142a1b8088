// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/sim/motion/motion_script.hpp"
#include "surefoot/sim/scenes/scene.hpp"

namespace surefoot::sim {

/// Ground truth of a simulated recording. The world frame equals odom if the run starts with the
/// first frame of the recording: the origin is the ground under the first base_link.
struct SceneTruth {
    Scene scene;
    camera::StereoRig rig;
    std::vector<StampedPose> trajectory;  ///< per frame; if commanded, only of the newest
    std::int64_t start_ns = 0;            ///< stamp of the motion's time 0
    std::vector<StepEvent> steps;         ///< steps of a walking machine
    std::vector<Stop> stops;              ///< stops of a trolley
};

/// Cells of a map. `origin_m` is the outer corner of cell (0, 0) in the world. Images are indexed
/// (ix, iy) with ix along +x and iy along +y.
struct Lattice {
    Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();
    int nx = 0;
    int ny = 0;
    double resolution_m = 0.025;

    [[nodiscard]] Eigen::Vector2d center_m(int ix, int iy) const {
        return origin_m + resolution_m * Eigen::Vector2d(ix + 0.5, iy + 0.5);
    }
};

enum class DemReduce : std::uint8_t {
    highest,  ///< highest point anywhere inside the cell, exact
    center,   ///< highest surface at the centre of the cell
};

/// Height of the highest surface of each cell [m, world]; NaN without ground. A primitive that
/// overlaps a cell by less than a micrometre does not count. So a riser on a cell border leaves the
/// cell in front of it at the height of the floor.
[[nodiscard]] Image<float> dem(const Scene& scene,
                               const Lattice& lattice,
                               DemReduce reduce = DemReduce::highest);

/// Truth of maps that separate surface and overhead objects. Returns `dem_m`; in cells with a known
/// `clearance_m` it returns the surface at the cell centre nearest to `height_m` [m, world].
[[nodiscard]] Image<float> dem_below_overhead(Image<float> dem_m,
                                              const Scene& scene,
                                              const Lattice& lattice,
                                              ImageView<const float> height_m,
                                              ImageView<const float> clearance_m);

/// Label of the highest surface at the centre of each cell.
[[nodiscard]] Image<Label> labels(const Scene& scene, const Lattice& lattice);

struct EdgeConfig {
    double jump_m =
        0.03;  ///< smallest jump between neighbours; a slope below jump / cell size is no edge
    int margin_cells = 2;  ///< cells at this distance are masked too (larger of |dx|, |dy|)
};

/// Returns 1 for a cell at or within the margin of a height discontinuity, or of the end of the
/// ground.
[[nodiscard]] Image<std::uint8_t> edge_mask(const Image<float>& dem_m,
                                            const EdgeConfig& config = {});

struct VisibilityConfig {
    double range_m = 2.5;    ///< largest straight distance from the left camera
    int min_frames = 1;      ///< smallest number of frames that must see a cell
    double margin_px = 0.0;  ///< width of the ignored image border
    int frame_stride = 1;    ///< use every n-th pose only
    std::int64_t until_ns = std::numeric_limits<std::int64_t>::max();  ///< ignores later poses
};

/// Returns 1 if both cameras see the highest surface at the cell's centre at once in at least
/// `min_frames` frames. Seen: inside both images, in range, not hidden.
[[nodiscard]] Image<std::uint8_t> visibility_mask(const SceneTruth& truth,
                                                  const Lattice& lattice,
                                                  const VisibilityConfig& config,
                                                  Executor& executor);

}  // namespace surefoot::sim

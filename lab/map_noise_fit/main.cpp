// SPDX-License-Identifier: Apache-2.0
// How large are the errors of the maps of whole runs, cell by cell? The constants of map_noise.hpp
// are fitted to this output.
// Usage: map_noise_fit OUT.csv SCRATCH [FIRST_SEED [SEEDS [NOISE]]]
//   SCRATCH: folder for scene files. FIRST_SEED: default 21. SEEDS: number of seeds, default 20.
//   NOISE: factor on the image noise, default 1.0.
//
// Each scene of gate_scenes except the unseen hazards is run with the fitted ZED profile on a
// trolley along the scene's path. The map at the end is compared with the true geometry. Writes
// OUT.csv, one line per cell with ground within 1.2 m of the machine:
//   kind,seed,relief_mm   scene
//   dx_m,dy_m             cell relative to base_link, in the axes of odom
//   along_m,across_m      from the near border of the hazard, into it and along the border
//   low_mm,high_mm        lowest and highest true height in the cell (5 x 5 points)
//   floor_mm              true height of the surface under hanging solids, in the cell's middle
//   looks,near_m          poses that see the middle (scene_sight.hpp), distance of the nearest one
//   map_mm,sigma_mm,clearance_mm,drift_mm,free_mm   content of the map; nan = unknown
#include <fmt/format.h>
#include <fmt/os.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "lab/scenes/scene_chain.hpp"
#include "lab/scenes/scene_sight.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/perception/settings.hpp"

namespace surefoot::experiments {
namespace {

constexpr double kReach_m = 1.2;

/// Computes the lowest and highest true height in a cell. Returns false over a void.
bool range_in(const HazardScene& scene,
              const Eigen::Vector2d& center_m,
              double side_m,
              double& low_m,
              double& high_m) {
    low_m = 1e9;
    high_m = -1e9;
    for (int i = 0; i < 25; ++i) {
        const int column = i % 5 - 2;
        const int row = i / 5 - 2;
        const Eigen::Vector2d at = center_m + side_m / 5.0 * Eigen::Vector2d(column, row);
        const Heights h = heights_at(scene, at);
        if (std::isnan(h.top_m)) return false;
        low_m = std::min(low_m, h.top_m);
        high_m = std::max(high_m, h.top_m);
    }
    return true;
}

void write_cells(const HazardScene& scene, const ChainRun& run, fmt::ostream& out) {
    const grid::GridGeometry& geometry = run.pipeline->map().geometry();
    const elevation::ElevationLayers& layers = run.pipeline->map().layers();
    const Sight sight(scene, run.pipeline->rig());
    const Eigen::Vector2d here_m = scene.T_world_body.translation_m.head<2>();
    const Eigen::Vector2d along(scene.normal);
    const Eigen::Vector2d across(-along.y(), along.x());
    for (int iy = 0; iy < geometry.ny; ++iy) {
        for (int ix = 0; ix < geometry.nx; ++ix) {
            const Eigen::Vector2d p = geometry.center_m({ix, iy});
            if ((p - here_m).norm() > kReach_m) continue;
            double low_m = 0.0;
            double high_m = 0.0;
            if (!range_in(scene, p, geometry.resolution_m, low_m, high_m)) continue;
            const Heights h = heights_at(scene, p);
            const Sight::Look look = sight.look({p.x(), p.y(), h.top_m}, 100);
            const auto mm = [&](const auto& layer) {
                return 1e3 * static_cast<double>(layer.at(ix, iy));
            };
            out.print(
                "{},{},{:.1f},{:.4f},{:.4f},{:.4f},{:.4f},{:.1f},{:.1f},{:.1f},{},{:.2f},{:.2f},{:."
                "2f},{:.1f},{:.2f},{:.1f}\n",
                kHazardNames[static_cast<int>(scene.asked)],
                scene.seed,
                1e3 * scene.relief_m,
                p.x() - here_m.x(),
                p.y() - here_m.y(),
                (p - scene.edge_m).dot(along),
                (p - scene.edge_m).dot(across),
                1e3 * low_m,
                1e3 * high_m,
                1e3 * h.floor_m,
                look.looks,
                look.nearest_m,
                mm(layers.height_m),
                1e3 * std::sqrt(static_cast<double>(layers.height_var_m2.at(ix, iy))),
                mm(layers.clearance_m),
                mm(layers.horizontal_drift_m),
                mm(layers.free_above_m));
        }
    }
    out.flush();
}

int measure(int argc, char** argv) {
    if (argc < 3)
        return app::report(
            usage_error("map_noise_fit OUT.csv SCRATCH [FIRST_SEED [SEEDS [NOISE]]]"));
    const std::uint64_t first = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 21;
    const std::uint64_t seeds = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 20;
    const double noise = argc > 5 ? std::atof(argv[5]) : 1.0;
    const auto machine = app::load_machine("rex");
    if (!machine) return app::report(machine.error());
    if (auto made = io::make_folder(argv[2]); !made) return app::report(made.error());
    const auto executor = surefoot::make_executor(1);
    auto out = fmt::output_file(argv[1]);
    out.print(
        "kind,seed,relief_mm,dx_m,dy_m,along_m,across_m,low_mm,high_mm,floor_mm,looks,near_m,map_"
        "mm,sigma_mm,clearance_mm,drift_mm,free_mm\n");
    for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
        for (int kind = 0; kind < kHazards; ++kind) {
            if (static_cast<Hazard>(kind) == Hazard::unseen) continue;
            const HazardScene scene = make_hazard_scene(
                static_cast<Hazard>(kind), false, seed, (*machine)->machine, Placing::on_way);
            const auto run = run_chain(scene, Look::images, noise, argv[2], *executor);
            if (!run) {
                fmt::print(stderr, "{} {}: {}\n", kHazardNames[kind], seed, run.error().message);
                continue;
            }
            write_cells(scene, *run, out);
        }
    }
    return 0;
}

}  // namespace
}  // namespace surefoot::experiments

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::experiments::measure(argc, argv);
}

// SPDX-License-Identifier: Apache-2.0
// How accurate is the map, and how often does it rate a foothold wrongly?
// Usage: terrain_truth OUT.csv SCENES [FIRST_SEED [SEEDS [PROFILES [NOISE]]]]
//   terrain_truth out/terrain.csv floor,demo_stairs 20001 3 ideal,zed 2
//   SCENES to PROFILES: see scene_cases.hpp. NOISE: factor on every noise amplitude of the images,
//   default 1.
//
// The whole pipeline runs on rendered images with true poses (sim.known_motion). At the end of the
// path the map is compared with the true geometry in the cells that were in view within 2.5 m. A
// foothold is rated for every yaw of the foot. So a cell is truly safe if sim::cell_safety accepts
// it at eight yaws, 22.5 deg apart (a rotation by 180 deg swaps heel and toe), and truly unsafe if
// it rejects one of them. The machine is the REX; reachability starts at the first base_link.
//
// Writes OUT.csv, one line per scene, seed and profile:
//   median_mm, p90_mm, coverage        median and 90th percentile of |height error|, known share
//   sigma_1, sigma_2, sigma_3          share of the errors within 1, 2 and 3 sigma, in cells more
//                                      than 2 cells from any surface edge, in view at any range
//   truly_unsafe                       number of truly unsafe cells
//   called_safe, cluster               truly unsafe cells that the map rates safe, and the largest
//                                      connected group of these cells
//   hazards, hazards_called_safe, hazard_cluster   the same three numbers for cells on which the
//                                      foot itself clearly cannot stand. The distance to drops is
//                                      not considered.
//   truly_safe                         number of truly safe cells
//   called_unsafe, unsure, unknown     truly safe cells that the map rates as unsafe; as unsure; as
//                                      unknown or unreachable
//   near_...                           all counts above for cells within 0.7 m of the body, in view
//                                      or not
// OUT.csv.wrong.csv contains each wrongly rated cell, one per line, in odom: truly unsafe cells
// rated safe and truly safe cells rated unsafe, with the true and the given rating.
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "lab/scenes/scene_cases.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "studies/runs/run_session.hpp"
#include "surefoot/eval/maps/maps.hpp"
#include "surefoot/eval/report/error_bins.hpp"
#include "surefoot/io/text.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/sim/safety_oracle/cell_safety.hpp"
#include "surefoot/sim/scene_source.hpp"
#include "surefoot/sim/scenes/truth.hpp"

namespace surefoot::app {
namespace {

constexpr int kYaws = 8;
constexpr double kRange_m = 2.5;
constexpr double kNear_m = 0.7;

using experiments::SceneCase;

/// Number of truly unsafe cells, number of these cells that the map rates safe, and size of the
/// largest connected group of such wrongly rated cells.
struct Missed {
    int truly_unsafe = 0;
    int called_safe = 0;
    int cluster = 0;
};

struct FootholdCounts {
    Missed all;
    Missed hazards;  ///< cells where the foot itself clearly cannot stand
    int truly_safe = 0;
    int called_unsafe = 0;
    int unsure = 0;
    int unknown = 0;
};

/// Returns true if a surface of one cell has no counterpart within `step_m` in the other cell. All
/// surfaces count, not only the highest. So floor under a table and the legs of a table also have
/// edges.
bool has_edge_towards(const std::vector<sim::SurfaceHeight>& here,
                      const std::vector<sim::SurfaceHeight>& there,
                      double step_m) {
    return std::any_of(here.begin(), here.end(), [&](const sim::SurfaceHeight& mine) {
        return std::none_of(there.begin(), there.end(), [&](const sim::SurfaceHeight& other) {
            return std::abs(other.z_m - mine.z_m) <= step_m;
        });
    });
}

/// Returns 1 for cells whose surfaces all continue beyond the margin in all directions. Distances
/// are those of eval::away_from_edges, which considers only the highest surfaces.
eval::CellMask away_from_all_edges(const sim::Scene& scene,
                                   const sim::Lattice& lattice,
                                   const grid::Layer& dem_m,
                                   const eval::EvalMapsConfig& config) {
    std::vector<std::vector<sim::SurfaceHeight>> surfaces;
    surfaces.reserve(dem_m.size());
    for (int iy = 0; iy < lattice.ny; ++iy) {
        for (int ix = 0; ix < lattice.nx; ++ix) {
            const Eigen::Vector2d p = lattice.center_m(ix, iy);
            surfaces.push_back(scene.surfaces_at(p.x(), p.y()));
        }
    }
    const auto at = [&](int ix, int iy) -> const std::vector<sim::SurfaceHeight>& {
        return surfaces[static_cast<std::size_t>(iy) * static_cast<std::size_t>(lattice.nx) +
                        static_cast<std::size_t>(ix)];
    };
    eval::CellMask away = eval::away_from_edges(dem_m, config);
    const int margin = config.edge_margin_cells;
    for (int iy = 0; iy + 1 < lattice.ny; ++iy) {
        for (int ix = 0; ix + 1 < lattice.nx; ++ix) {
            for (const auto& [jx, jy] : {std::pair{ix + 1, iy}, {ix, iy + 1}}) {
                if (!has_edge_towards(at(ix, iy), at(jx, jy), config.edge_step_m) &&
                    !has_edge_towards(at(jx, jy), at(ix, iy), config.edge_step_m)) {
                    continue;
                }
                for (int y = iy - margin; y <= jy + margin; ++y)
                    for (int x = ix - margin; x <= jx + margin; ++x)
                        if (away.contains(x, y)) away.at(x, y) = 0;
            }
        }
    }
    return away;
}

/// Returns the shares of the height errors within one, two and three stated sigmas. Uses only cells
/// whose highest surface both cameras had in view, near or far. The top of a wall is never in view.
eval::SigmaCoverage sigma_of_heights(const sim::SceneTruth& truth,
                                     const sim::Lattice& lattice,
                                     const elevation::ElevationLayers& layers,
                                     const grid::Layer& compared_m,
                                     const eval::EvalMapsConfig& config,
                                     Executor& executor) {
    constexpr double kAnyRange_m = 100.0;
    const eval::CellMask asked = eval::both(
        away_from_all_edges(truth.scene, lattice, sim::dem(truth.scene, lattice), config),
        sim::visibility_mask(truth, lattice, {.range_m = kAnyRange_m}, executor));
    const grid::Layer height_m = layers.height_m.copy();
    const grid::Layer var_m2 = layers.height_var_m2.copy();
    std::vector<float> error_m;
    std::vector<float> sigma_m;
    error_m.reserve(asked.size());
    sigma_m.reserve(asked.size());
    for (std::size_t i = 0; i < asked.size(); ++i) {
        if (asked.data()[i] == 0) continue;
        error_m.push_back(height_m.data()[i] - compared_m.data()[i]);
        sigma_m.push_back(std::sqrt(var_m2.data()[i]));
    }
    return eval::sigma_coverage(error_m, sigma_m);
}

/// Returns 1 for cells where a foot is safe at every yaw.
eval::CellMask safe_at_all_yaws(const sim::SceneTruth& truth,
                                const Machine& machine,
                                const sim::Lattice& lattice,
                                Executor& executor) {
    eval::CellMask safe(lattice.nx, lattice.ny, 1);
    sim::CellQuestion question;
    // Every scene begins on ground at world height 0. The machine ends on ground that it reached.
    const Pose& T_world_first = truth.trajectory.front().T_world_body;
    question.start_m = truth.trajectory.back().T_world_body.translation_m;
    question.start_m.z() -= T_world_first.translation_m.z();
    for (int k = 0; k < kYaws; ++k) {
        question.yaw_rad = std::numbers::pi * k / kYaws;
        const auto cells = sim::cell_safety(truth.scene, machine, lattice, question, executor);
        for (std::size_t i = 0; i < cells.size(); ++i)
            if (!cells.data()[i].safe) safe.data()[i] = 0;
    }
    return safe;
}

/// Returns a machine whose rules cover only the ground under the foot, without the drop band around
/// it. Applies the safety margin of the oracle: looser limits, by the limit share of the margin,
/// and a smaller foot, by the position margin on all sides.
Machine foot_alone(Machine machine) {
    const sim::SafetyMargin margin;
    const auto looser = [&](std::int32_t& limit) {
        limit = static_cast<std::int32_t>(std::lround(limit * (1.0 + margin.limit_share)));
    };
    GateLimits& limits = machine.limits;
    limits.drop_band_tenth_mm = 0;
    limits.min_normal_z = std::cos((1.0 + margin.limit_share) * std::acos(limits.min_normal_z));
    looser(limits.patch_residual_tenth_mm);
    looser(limits.drop_tenth_mm);
    const auto smaller = static_cast<std::int32_t>(std::lround(1e4 * margin.position_m));
    for (GroundBox* foot : {&machine.left_foot, &machine.right_foot}) {
        foot->length_tenth_mm -= 2 * smaller;
        foot->width_tenth_mm -= 2 * smaller;
    }
    return machine;
}

/// Returns the size of the largest 4-connected group of cells in the mask.
int largest_cluster(eval::CellMask mask) {
    int largest = 0;
    std::vector<std::pair<int, int>> open;
    for (int iy = 0; iy < mask.height(); ++iy) {
        for (int ix = 0; ix < mask.width(); ++ix) {
            int size = 0;
            open.emplace_back(ix, iy);
            while (!open.empty()) {
                const auto [x, y] = open.back();
                open.pop_back();
                if (!mask.contains(x, y) || mask.at(x, y) == 0) continue;
                mask.at(x, y) = 0;
                ++size;
                for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
                    open.emplace_back(x + dx, y + dy);
            }
            largest = std::max(largest, size);
        }
    }
    return largest;
}

/// Cells of a map on which a foot may truly stand.
struct TrulySafe {
    eval::CellMask all;    ///< by all rules for a foothold
    eval::CellMask alone;  ///< only by the rules for the ground under the foot; see `foot_alone`
};

/// Returns the truly unsafe cells in view that the map rates safe.
eval::CellMask missed_cells(const Image<traversability::Foothold>& found,
                            const eval::CellMask& truly_safe,
                            const eval::CellMask& visible) {
    eval::CellMask missed(found.width(), found.height(), 0);
    for (std::size_t i = 0; i < found.size(); ++i) {
        const bool truly_unsafe = visible.data()[i] != 0 && truly_safe.data()[i] == 0;
        if (truly_unsafe && found.data()[i] == traversability::Foothold::safe) missed.data()[i] = 1;
    }
    return missed;
}

bool is_called_unsafe(traversability::Foothold call) {
    return call > traversability::Foothold::unreachable;
}

Missed count_missed(const Image<traversability::Foothold>& found,
                    const eval::CellMask& truly_safe,
                    const eval::CellMask& visible) {
    Missed missed;
    for (std::size_t i = 0; i < found.size(); ++i)
        missed.truly_unsafe += visible.data()[i] != 0 && truly_safe.data()[i] == 0 ? 1 : 0;
    eval::CellMask cells = missed_cells(found, truly_safe, visible);
    missed.called_safe = static_cast<int>(std::count(cells.data(), cells.data() + cells.size(), 1));
    missed.cluster = largest_cluster(std::move(cells));
    return missed;
}

FootholdCounts compare(const Image<traversability::Foothold>& found,
                       const TrulySafe& truly_safe,
                       const eval::CellMask& visible) {
    using traversability::Foothold;
    FootholdCounts counts;
    counts.all = count_missed(found, truly_safe.all, visible);
    counts.hazards = count_missed(found, truly_safe.alone, visible);
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (visible.data()[i] == 0 || truly_safe.all.data()[i] == 0) continue;
        const Foothold call = found.data()[i];
        ++counts.truly_safe;
        counts.unknown += call == Foothold::unknown || call == Foothold::unreachable ? 1 : 0;
        counts.unsure += call == Foothold::unsure ? 1 : 0;
        counts.called_unsafe += is_called_unsafe(call) ? 1 : 0;
    }
    return counts;
}

void print(const FootholdCounts& counts, fmt::ostream& out) {
    for (const Missed& missed : {counts.all, counts.hazards})
        out.print(",{},{},{}", missed.truly_unsafe, missed.called_safe, missed.cluster);
    out.print(
        ",{},{},{},{}", counts.truly_safe, counts.called_unsafe, counts.unsure, counts.unknown);
}

/// Output files.
struct Results {
    fmt::ostream cases;
    fmt::ostream wrong;
};

void print_wrong(const SceneCase& now,
                 const grid::GridGeometry& geometry,
                 const Image<traversability::Foothold>& found,
                 const TrulySafe& truly_safe,
                 const eval::CellMask& visible,
                 fmt::ostream& out) {
    for (int iy = 0; iy < geometry.ny; ++iy) {
        for (int ix = 0; ix < geometry.nx; ++ix) {
            const auto call = found.at(ix, iy);
            const bool is_safe = truly_safe.all.at(ix, iy) != 0;
            const bool is_wrong =
                is_safe ? is_called_unsafe(call) : call == traversability::Foothold::safe;
            if (visible.at(ix, iy) == 0 || !is_wrong) continue;
            const Eigen::Vector2d at_m = geometry.center_m({ix, iy});
            out.print("{},{},{},{:.4f},{:.4f},{},{}\n",
                      now.scene,
                      now.seed,
                      now.profile,
                      at_m.x(),
                      at_m.y(),
                      is_safe                            ? "safe"
                      : truly_safe.alone.at(ix, iy) == 0 ? "hazard"
                                                         : "unsafe",
                      to_string(call));
        }
    }
    out.flush();
}

Status measure(const SceneCase& now,
               double noise,
               const io::MachineFile& machine,
               Executor& executor,
               Results& out) {
    auto settings = surefoot::load_settings();
    if (!settings) return settings.error();
    sim::SceneOptions& sim = settings->sim;
    if (Status seen = now.put_into(sim); !seen) return seen.error();
    sim.known_motion = true;
    sim.drift = {0.0, 0.0};
    sim.noise = noise;
    auto source = sim::open_scene(sim, &executor);
    if (!source) return source.error();
    auto pipeline =
        pipeline::Pipeline::make(settings->pipeline, (*source)->rig(), executor, steady_now_ns);
    if (!pipeline) return pipeline.error();
    RunSession session(*pipeline, **source, (*source)->rig(), 1, settings->maps);
    session.drive("");
    const RunRecord& record = session.record();
    if (record.error) return *record.error;

    const grid::GridGeometry& geometry = pipeline->map().geometry();
    const sim::Lattice lattice{geometry.origin_m, geometry.nx, geometry.ny, geometry.resolution_m};
    const sim::SceneTruth& truth = (*source)->truth();
    const auto visible = sim::visibility_mask(truth, lattice, {.range_m = kRange_m}, executor);
    const elevation::ElevationLayers& layers = pipeline->map().layers();
    const grid::Layer compared_m = sim::dem_below_overhead(sim::dem(truth.scene, lattice),
                                                           truth.scene,
                                                           lattice,
                                                           layers.height_m.view(),
                                                           layers.clearance_m.view());
    const auto heights =
        eval::elevation_errors(layers.height_m.copy(), compared_m, visible, settings->maps);
    const auto found = pipeline->footholds();
    const TrulySafe truly_safe{
        safe_at_all_yaws(truth, machine.machine, lattice, executor),
        safe_at_all_yaws(truth, foot_alone(machine.machine), lattice, executor)};
    const auto near =
        eval::within_radius(geometry, pipeline->T_odom_body().translation_m.head<2>(), kNear_m);
    const eval::SigmaCoverage sigma =
        sigma_of_heights(truth, lattice, layers, compared_m, settings->maps, executor);
    out.cases.print("{},{},{},{:.2f},{:.2f},{:.4f},{:.4f},{:.4f},{:.4f}",
                    now.scene,
                    now.seed,
                    now.profile,
                    1e3 * heights.median_abs_m,
                    1e3 * heights.p90_abs_m,
                    record.truth->coverage_within_2_5_m,
                    sigma.within_1_sigma,
                    sigma.within_2_sigma,
                    sigma.within_3_sigma);
    for (const eval::CellMask& where : {visible, near})
        print(compare(found, truly_safe, where), out.cases);
    out.cases.print("\n");
    out.cases.flush();
    print_wrong(now, geometry, found, truly_safe, visible, out.wrong);
    return {};
}

int measure_all(const std::vector<std::string>& words) {
    if (words.size() < 2)
        return report(
            usage_error("terrain_truth OUT.csv SCENES [FIRST_SEED [SEEDS [PROFILES [NOISE]]]]"));
    const auto noise = words.size() > 5 ? io::parse_double(words[5]) : std::optional(1.0);
    if (!noise || *noise < 0.0) return report(usage_error("no noise: " + words[5]));
    const auto machine = load_machine("rex");
    if (!machine) return report(machine.error());
    const auto executor = surefoot::make_executor();
    Results out{fmt::output_file(words[0]), fmt::output_file(words[0] + ".wrong.csv")};
    out.wrong.print("scene,seed,profile,x_m,y_m,truth,called\n");
    out.cases.print("scene,seed,profile,median_mm,p90_mm,coverage,sigma_1,sigma_2,sigma_3");
    for (const char* where : {"", "near_"}) {
        for (const char* what : {"truly_unsafe",
                                 "called_safe",
                                 "cluster",
                                 "hazards",
                                 "hazards_called_safe",
                                 "hazard_cluster",
                                 "truly_safe",
                                 "called_unsafe",
                                 "unsure",
                                 "unknown"}) {
            out.cases.print(",{}{}", where, what);
        }
    }
    out.cases.print("\n");
    for (const SceneCase& now : experiments::scene_cases({words.begin() + 1, words.end()})) {
        const auto done = measure(now, *noise, **machine, *executor, out);
        if (!done) return report(done.error());
    }
    return kExitOk;
}

}  // namespace
}  // namespace surefoot::app

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::app::measure_all({argv + 1, argv + argc});
}

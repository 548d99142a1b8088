// SPDX-License-Identifier: Apache-2.0
// Which false ground does semi-global matching create behind drop edges, and which filter rules
// keep it out of the map?
// Usage: invented_depth OUT_DIR [FIRST_SEED [SEEDS [NOISE [KEY=VALUE...]]]]
//   FIRST_SEED: default 1. SEEDS: number of seeds, default 4. NOISE: factor on the image noise,
//   default 1.0. KEY=VALUE: a setting of the matcher.
//
// The camera is 0.95 m above the upper level, 32 deg down, and looks over an edge at a given
// distance. Ground behind the edge that is occluded in at least one camera must stay unknown in the
// map. (The occluded region is drop * distance / 0.95 long if the camera looks straight over the
// edge.)
// Writes into OUT_DIR:
//   invented.csv  per motion (one frame, or ten on an approach), drop, distance, seed and rule:
//                 cells that are hidden; of these mapped (invented), wrong by more than 20 mm
//                 (invented_wrong), with a sigma of at most 10 mm (invented_sure); visible cells,
//                 and of these mapped (visible_known)
//   profile.csv   one row of cells straight ahead in one case: true and mapped height [m],
//                 visibility
#include <fmt/format.h>
#include <fmt/os.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "lab/drop_edges/drop_scene.hpp"
#include "lab/drop_edges/zed_bench.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/elevation/elevation_map.hpp"

namespace surefoot {
namespace {

using Eigen::Vector2d;
using elevation::ElevationConfig;

constexpr Drop kDrops[] = {{"kerb 75 mm", 0.075, 1},
                           {"kerb 100 mm", 0.100, 1},
                           {"kerb 150 mm", 0.150, 1},
                           {"stairs down 180/310", 0.180, 5}};

/// A rule that decides which pixels the map fuses.
struct Rule {
    std::string name;
    ElevationConfig config;
};

/// Returns the default rule and variants of it with one or a few changed settings.
std::vector<Rule> rules() {
    std::vector<Rule> all;
    const auto add = [&](const std::string& name, const auto& change) {
        Rule rule{name, {}};
        change(rule.config);
        all.push_back(rule);
    };
    const auto any_incidence = [](ElevationConfig& c) {
        c.pixels.max_incidence_deg = c.pixels.max_incidence_level_deg = 90.0;
    };
    add("every match", [](ElevationConfig& c) {
        c.pixels.surface_check = false;
        c.pixels.max_outlier_probability = 1.0;
        c.reduction.min_points = 2;
    });
    add("likely right", [](ElevationConfig& c) { c.pixels.surface_check = false; });
    add("no jumps", any_incidence);
    for (const double limit_deg : {80.0, 75.0, 72.0, 68.0, 65.0}) {
        add(fmt::format("incidence < {:.0f} deg", limit_deg),
            [&](ElevationConfig& c) { c.pixels.max_incidence_deg = limit_deg; });
    }
    add("default", [](ElevationConfig&) {});
    for (const int points : {2, 4}) {
        add(fmt::format("{} points", points),
            [&](ElevationConfig& c) { c.reduction.min_points = points; });
    }
    for (const double limit : {0.05, 0.02}) {
        add(fmt::format("outliers < {}", limit),
            [&](ElevationConfig& c) { c.pixels.max_outlier_probability = limit; });
    }
    add("reach 5 px", [](ElevationConfig& c) { c.pixels.reach_px = 5; });
    return all;
}

struct Cell {
    Vector2d center_m;
    float truth_m = 0.0F;
    Sight sight = Sight::partly;
};

/// Returns the cells around the edge, up to 0.5 m to either side of the camera.
std::vector<Cell> cells_around(const sim::Scene& scene,
                               const ZedBench& bench,
                               const std::vector<Pose>& poses,
                               double edge_x_m) {
    std::vector<Cell> cells;
    const double camera_y_m = bench.rig().body_from_left().translation_m.y();
    for (double x = edge_x_m - 1.0; x < edge_x_m + 1.2; x += kCellSize_m) {
        for (double y = camera_y_m - 0.5; y < camera_y_m + 0.5; y += kCellSize_m) {
            const Vector2d center((std::floor(x / kCellSize_m) + 0.5) * kCellSize_m,
                                  (std::floor(y / kCellSize_m) + 0.5) * kCellSize_m);
            const auto top = scene.height_at(center.x(), center.y());
            if (!top) continue;
            cells.push_back({center,
                             static_cast<float>(top->z_m),
                             sight_of_cell(scene, bench.rig(), poses, center)});
        }
    }
    return cells;
}

struct Counts {
    int hidden = 0;
    int invented = 0;
    int invented_wrong = 0;  ///< hidden cells mapped more than 20 mm off the true ground
    int invented_sure = 0;   ///< hidden cells mapped with a sigma of at most 10 mm
    int visible = 0;
    int visible_known = 0;
};

Counts count(const elevation::ElevationMap& map, const std::vector<Cell>& cells) {
    constexpr float kWrong_m = 0.02F;
    constexpr float kSureVar_m2 = 0.01F * 0.01F;
    Counts counts;
    for (const Cell& cell : cells) {
        const auto index = map.geometry().cell_at(cell.center_m.x(), cell.center_m.y());
        const bool inside = index.has_value();
        const float height_m = inside ? map.layers().height_m.at(index->ix, index->iy) : NAN;
        const bool known = !std::isnan(height_m);
        if (cell.sight == Sight::hidden) {
            ++counts.hidden;
            counts.invented += known ? 1 : 0;
            counts.invented_sure +=
                known && map.layers().height_var_m2.at(index->ix, index->iy) <= kSureVar_m2 ? 1 : 0;
            counts.invented_wrong += known && std::abs(height_m - cell.truth_m) > kWrong_m ? 1 : 0;
        } else if (cell.sight == Sight::seen) {
            ++counts.visible;
            counts.visible_known += known ? 1 : 0;
        }
    }
    return counts;
}

/// One frame in front of an edge, or ten frames on the last 0.9 m of an approach.
struct Look {
    const Drop& drop;
    double distance_m = 0.0;
    int seed = 0;
    int frames = 1;
};

/// The maps of all rules from the same frames, and the true cells.
struct Outcome {
    std::vector<elevation::ElevationMap> maps;
    std::vector<Cell> cells;
};

Outcome look_over_edge(ZedBench& bench, const Look& look, const std::vector<Rule>& rules) {
    Rng rng(mix_seed(static_cast<std::uint64_t>(look.seed),
                     static_cast<std::uint64_t>(1000.0 * look.distance_m)));
    const double yaw_rad = rng.uniform(-0.35, 0.35);
    const double edge_x_m = bench.camera_x_m() + look.distance_m;
    const sim::Scene scene = drop_scene(look.drop, edge_x_m, yaw_rad, rng);
    std::vector<Pose> poses;
    for (int i = look.frames - 1; i >= 0; --i) poses.push_back(bench.pose_over(-0.1 * i));
    Outcome outcome;
    outcome.cells = cells_around(scene, bench, poses, edge_x_m);
    for (const Rule& rule : rules) outcome.maps.emplace_back(rule.config);
    for (int i = 0; i < look.frames; ++i) {
        const Pose& T_world_body = poses[static_cast<std::size_t>(i)];
        bench.see(scene, T_world_body, i, rng.next_u64());
        for (auto& map : outcome.maps) {
            map.follow(T_world_body, 1e-8 * Matrix6::Identity());
            map.add(bench.rectified(), T_world_body, bench.depth(), 1 + i);
        }
    }
    return outcome;
}

/// Prints a row of cells straight ahead.
void print_profile(fmt::ostream& file, const Outcome& outcome, const std::vector<Rule>& rules) {
    const double row_y_m = (std::floor(0.19 / kCellSize_m) + 0.5) * kCellSize_m;
    for (std::size_t r = 0; r < rules.size(); ++r) {
        const auto& map = outcome.maps[r];
        for (const Cell& cell : outcome.cells) {
            if (std::abs(cell.center_m.y() - row_y_m) > 1e-6) continue;
            const auto index = map.geometry().cell_at(cell.center_m.x(), cell.center_m.y());
            file.print("\"{}\",{:.4f},{:.4f},{:.4f},{}\n",
                       rules[r].name,
                       cell.center_m.x(),
                       cell.truth_m,
                       map.layers().height_m.at(index->ix, index->iy),
                       static_cast<int>(cell.sight));
        }
    }
}

void measure_drops(ZedBench& bench, const std::string& out, int first_seed, int seeds) {
    auto file = fmt::output_file(out + "/invented.csv");
    file.print(
        "motion,drop,distance_m,seed,rule,hidden,invented,invented_wrong,invented_sure,visible,"
        "visible_known\n");
    auto profile = fmt::output_file(out + "/profile.csv");
    profile.print("rule,x_m,truth_m,height_m,sight\n");
    const auto all_rules = rules();
    const auto measure = [&](const Look& look) {
        const Outcome outcome = look_over_edge(bench, look, all_rules);
        for (std::size_t r = 0; r < all_rules.size(); ++r) {
            const Counts c = count(outcome.maps[r], outcome.cells);
            file.print("{},{},{:.2f},{},\"{}\",{},{},{},{},{},{}\n",
                       look.frames == 1 ? "one frame" : "approach",
                       look.drop.name,
                       look.distance_m,
                       look.seed,
                       all_rules[r].name,
                       c.hidden,
                       c.invented,
                       c.invented_wrong,
                       c.invented_sure,
                       c.visible,
                       c.visible_known);
        }
        const bool is_drawn = look.drop.rise_m == 0.15 && look.distance_m == 1.5;
        if (is_drawn && look.seed == first_seed && look.frames == 1)
            print_profile(profile, outcome, all_rules);
    };
    for (const Drop& drop : kDrops) {
        for (const double distance_m : kEdgeDistances_m) {
            for (int seed = first_seed; seed < first_seed + seeds; ++seed)
                for (const int frames : {1, 10}) measure({drop, distance_m, seed, frames});
            fmt::print(stderr, "{} at {:.2f} m done\n", drop.name, distance_m);
        }
    }
}

}  // namespace
}  // namespace surefoot

// An uncaught exception ends the experiment and prints its message. This is intended.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    const auto arguments = surefoot::bench_arguments(argc, argv);
    if (!arguments) {
        fmt::print(stderr, "{}\n", arguments.error().message);
        return 2;
    }
    surefoot::Serial executor;
    surefoot::ZedBench bench(arguments->noise, arguments->matcher, executor);
    surefoot::measure_drops(bench, arguments->out_dir, arguments->first_seed, arguments->seeds);
    return 0;
}

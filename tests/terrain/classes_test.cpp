// SPDX-License-Identifier: Apache-2.0
// What the cells of whole scenes are called, against what the scenes say they are.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "surefoot/core/rng.hpp"
#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/scenes/truth.hpp"
#include "surefoot/stairs/classes/ground_classes.hpp"
#include "surefoot/stairs/feature_finder.hpp"
#include "tests/terrain/scene_cameras.hpp"

namespace surefoot::terrain {
namespace {

using stairs::GroundClass;
constexpr std::size_t kClasses = stairs::kGroundClassNames.size();

/// Counts of cells: [true class][found class].
using Confusion = std::array<std::array<int, kClasses>, kClasses>;

std::size_t index(GroundClass name) {
    return static_cast<std::size_t>(name);
}

/// The flight of a scene in its own frame: first edge at x = 0, direction of travel +x.
struct TrueFlight {
    Eigen::Vector2d at_m = Eigen::Vector2d::Zero();
    double angle_rad = 0.0;
    double treads_m = 0.0;  ///< from the first edge to the last one
    double going_m = 0.0;
    double width_m = 0.0;

    [[nodiscard]] Eigen::Vector2d own(const Eigen::Vector2d& world_m) const {
        return Eigen::Rotation2Dd(-angle_rad) * (world_m - at_m);
    }
};

TrueFlight flight_of(const sim::ScriptedScene& scene) {
    TrueFlight flight;
    if (scene.info.name == "demo_stairs") {
        flight.at_m = {drawn(scene, "stair_x_m"), 0.0};
        flight.going_m = sim::demo_stairs::kGoing_m;
        flight.treads_m = 2.0 * flight.going_m;
        flight.width_m = 1.2;
    } else if (scene.info.name.starts_with("stairs_")) {
        flight.angle_rad = drawn(scene, "angle_deg") * std::numbers::pi / 180.0;
        flight.at_m =
            Eigen::Vector2d(drawn(scene, "distance_m"), 0.0) +
            Eigen::Rotation2Dd(flight.angle_rad) * Eigen::Vector2d(0.0, drawn(scene, "lateral_m"));
        flight.going_m = drawn(scene, "going_m");
        flight.treads_m = (drawn(scene, "steps") - 1.0) * flight.going_m;
        flight.width_m = drawn(scene, "width_m");
    }
    return flight;
}

/// True class of a cell; unknown = not judged. Ground to step onto is floor, whatever its label in
/// the scene. Ground deeper than one step is a drop.
GroundClass true_class(sim::Label label,
                       double z_m,
                       const TrueFlight& flight,
                       const Eigen::Vector2d& world_m,
                       double cell_m) {
    const double max_step_m = stairs::ClassConfig{}.max_step_m;
    const Eigen::Vector2d p_m = flight.own(world_m);
    if (flight.width_m > 0.0 && std::abs(p_m.y()) < 0.5 * flight.width_m - 2.0 * cell_m &&
        p_m.x() > -0.5 * cell_m && p_m.x() < flight.treads_m + 0.5 * cell_m) {
        const double step = p_m.x() / flight.going_m;
        const double off_m = std::abs(step - std::round(step)) * flight.going_m;
        if (off_m < 0.25 * cell_m) return GroundClass::riser;
        // A cell at the border may belong to either class.
        return off_m > 1.5 * cell_m ? GroundClass::tread : GroundClass::unknown;
    }
    switch (label) {
        case sim::Label::floor:
        case sim::Label::step: return GroundClass::floor;
        case sim::Label::ramp: return GroundClass::ramp;
        case sim::Label::table: return GroundClass::table;
        case sim::Label::wall: return GroundClass::wall;
        case sim::Label::drop:
            if (z_m < -max_step_m - 0.01) return GroundClass::drop;
            return z_m > -max_step_m + 0.01 ? GroundClass::floor : GroundClass::unknown;
        default: return GroundClass::unknown;
    }
}

/// Adds a scene around its features as a height map with noise, without occlusion.
void add_scene(const std::string& name, std::uint64_t seed, double sigma_m, Confusion& confusion) {
    const sim::ScriptedScene scene = sim::make_scene(name, seed).value();
    Rng rng(mix_seed(seed, 7));
    constexpr double kCell_m = 0.025;
    sim::Lattice lattice{
        {-0.9 + kCell_m * rng.uniform(0.0, 1.0), -2.5 + kCell_m * rng.uniform(0.0, 1.0)},
        260,
        200,
        kCell_m};
    const Image<float> exact_m = sim::dem(scene.scene, lattice);
    const Image<sim::Label> labels = sim::labels(scene.scene, lattice);
    const Image<std::uint8_t> edges = sim::edge_mask(exact_m);
    grid::Layer height_m = exact_m;
    for (std::size_t i = 0; i < height_m.size(); ++i)
        height_m.data()[i] += static_cast<float>(sigma_m * rng.normal());
    const grid::Layer var_m2(lattice.nx, lattice.ny, static_cast<float>(sigma_m * sigma_m));
    stairs::Terrain terrain;
    terrain.geometry = {kCell_m, lattice.nx, lattice.ny, lattice.origin_m};
    terrain.height_m = height_m.view();
    terrain.height_var_m2 = var_m2.view();
    stairs::TerrainFeatures features;
    stairs::FeatureFinder(stairs::StairsConfig{}).find(terrain, features);
    const stairs::GroundClasses classes = stairs::classify_ground({}, terrain, features);
    const TrueFlight flight = flight_of(scene);
    for (int iy = 0; iy < lattice.ny; ++iy) {
        for (int ix = 0; ix < lattice.nx; ++ix) {
            const GroundClass truth = true_class(labels.at(ix, iy),
                                                 static_cast<double>(exact_m.at(ix, iy)),
                                                 flight,
                                                 lattice.center_m(ix, iy),
                                                 kCell_m);
            const bool is_thin = truth == GroundClass::riser || truth == GroundClass::wall ||
                                 truth == GroundClass::tread;
            // Beside the ramp down, low ground is also reached over the ramp: not judged.
            if (truth == GroundClass::drop && name == "ramp_1_12_down") continue;
            if (truth == GroundClass::unknown || (!is_thin && edges.at(ix, iy) != 0)) continue;
            ++confusion[index(truth)][index(classes.of_cell.at(ix, iy))];
        }
    }
}

std::string table_of(const Confusion& confusion) {
    std::string text = fmt::format("{:>8}", "truth");
    for (const char* name : stairs::kGroundClassNames) text += fmt::format("{:>9}", name);
    for (std::size_t truth = 1; truth < kClasses; ++truth) {
        int all = 0;
        for (const int cells : confusion[truth]) all += cells;
        if (all == 0) continue;
        text += fmt::format("\n{:>8}", stairs::kGroundClassNames[truth]);
        for (const int cells : confusion[truth])
            text += fmt::format("{:>8.2f}%", 100.0 * cells / all);
        text += fmt::format("  of {} cells", all);
    }
    return text;
}

double share(const Confusion& confusion, GroundClass truth, GroundClass found) {
    int all = 0;
    for (const int cells : confusion[index(truth)]) all += cells;
    EXPECT_GT(all, 300) << stairs::kGroundClassNames[index(truth)];
    return confusion[index(truth)][index(found)] / static_cast<double>(std::max(1, all));
}

constexpr const char* kScenes[] = {"demo_stairs",
                                   "stairs_up_nz_common",
                                   "stairs_down_nz_accessible",
                                   "ramp_1_12_up",
                                   "ramp_1_12_down",
                                   "drop_edge",
                                   "table",
                                   "door_900",
                                   "kerb_down_150"};

// Exact heights, and heights with the noise of a map after several observations. Other seeds:
// docs/concepts/stairs.md.
TEST(Classes, HeightMapsOfScenesAreNamedAsTheScenesSay) {
    for (const double sigma_m : {0.0, 0.005}) {
        Confusion confusion{};
        for (const char* name : kScenes)
            for (const std::uint64_t seed : {31ULL, 32ULL})
                add_scene(name, seed, sigma_m, confusion);
        const std::string table = table_of(confusion);
        fmt::print("noise of {} m\n{}\n", sigma_m, table);
        for (const auto& [name, least] : {std::pair(GroundClass::floor, 0.98),
                                          std::pair(GroundClass::tread, 0.97),
                                          std::pair(GroundClass::riser, 0.85),
                                          std::pair(GroundClass::ramp, 0.93),
                                          std::pair(GroundClass::drop, 0.97),
                                          std::pair(GroundClass::wall, 0.95),
                                          std::pair(GroundClass::table, 0.97)})
            EXPECT_GE(share(confusion, name, name), least)
                << stairs::kGroundClassNames[index(name)] << '\n'
                << table;
        // Ground on which nobody may step is rarely called floor.
        for (const GroundClass name : {GroundClass::drop, GroundClass::table, GroundClass::wall})
            EXPECT_LE(share(confusion, name, GroundClass::floor), 0.002)
                << stairs::kGroundClassNames[index(name)] << '\n'
                << table;
    }
}

}  // namespace
}  // namespace surefoot::terrain

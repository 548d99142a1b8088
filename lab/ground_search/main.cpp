// SPDX-License-Identifier: Apache-2.0
// Does the ground search find the floor with a camera of unknown mounting, and is each accepted
// plane really the floor? Input: analytic depth of random rooms with a matcher's errors
// (surefoot/ground/ground_views_testing.hpp).
// Usage: ground_search OUT.csv [FIRST_SEED [VIEWS]]
//   FIRST_SEED: default 1. VIEWS: number of views, each with its own seed, default 1000.
//
// Writes OUT.csv, one line per view; the columns that need an explanation:
//   kind                 floor (camera 0.3-2 m above it, 0-60 deg down, rolled by up to 8 deg), or
//                        one of the decoys:
//                        table, bed (the camera is above their height; some floor visible), wall
//                        (no floor), full_table (a table fills the view; it cannot be distinguished
//                        from a floor)
//   pitch_deg, height_m, floor_share   true values
//   reason               result of the search
//   tilt_deg, height_mm  errors of an accepted plane against the floor; without a floor each
//                        accepted plane is wrong
//   wrong                1 = accepted, and off the floor by more than 3 deg, or by more than the
//                        larger of 5 % of the height and 30 mm
//   nees_tilt            squared tilt error divided by its stated covariance; 2 is expected
//   nees_height          squared height error divided by its stated variance; 1 is expected
#include <fmt/format.h>
#include <fmt/os.h>

#include <Eigen/LU>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>

#include "surefoot/ground/ground_search.hpp"
#include "surefoot/ground/ground_views_testing.hpp"

namespace surefoot::experiments {
namespace {

using ground::GroundSighting;
using ground::test::Block;
using ground::test::Camera;
using ground::test::Errors;
using ground::test::View;

struct Trial {
    std::string kind;
    std::vector<Block> blocks;
    bool has_floor = true;
    Camera camera;
    Errors errors;
};

double between(Rng& rng, double low, double high) {
    return rng.uniform(low, high);
}

Camera any_camera(Rng& rng) {
    constexpr double kFocals_px[] = {260.0, 350.0, 490.0, 700.0};
    Camera camera;
    camera.focal_px = kFocals_px[rng.below(4)];
    camera.baseline_m = between(rng, 0.05, 0.15);
    camera.pitch_deg = between(rng, 0.0, 60.0);
    camera.roll_deg = between(rng, -8.0, 8.0);
    // Draws log-uniformly: each ratio of heights is equally frequent.
    camera.height_m = 0.3 * std::pow(2.0 / 0.3, rng.uniform());
    return camera;
}

Errors any_errors(Rng& rng) {
    Errors errors;
    errors.white_px = between(rng, 0.05, 0.25);
    errors.together_px = between(rng, 0.05, 0.25);
    errors.matched_share = between(rng, 0.5, 0.95);
    errors.wrong_share = between(rng, 0.0, 0.03);
    return errors;
}

/// Adds furniture to the floor of a room. The furniture may hide nearly all of the floor.
void furnish(Rng& rng, std::vector<Block>& blocks) {
    ground::test::add_room(between(rng, 1.0, 6.0), between(rng, 0.6, 4.0), blocks);
    const auto count = rng.below(5);
    for (std::size_t i = 0; i < count; ++i) {
        const double height_m = between(rng, 0.05, 1.2);
        const bool is_table = rng.below(3) == 0;
        const double thick_m = is_table ? 0.03 : height_m;
        const double top_m = is_table ? between(rng, 0.4, 0.8) : height_m;
        blocks.push_back({{between(rng, 0.5, 4.0), between(rng, -1.5, 1.5), top_m - 0.5 * thick_m},
                          {between(rng, 0.2, 1.2), between(rng, 0.2, 1.2), thick_m},
                          between(rng, -0.8, 0.8)});
    }
}

Trial floor_trial(Rng& rng) {
    Trial trial{"floor", {}, true, any_camera(rng), any_errors(rng)};
    // Adds the relief of gravel or mulch, up to 2.5 % of the height of the camera.
    if (rng.below(3) == 0)
        trial.errors.relief_m = between(rng, 0.005, 0.025) * std::min(1.0, trial.camera.height_m);
    furnish(rng, trial.blocks);
    // In half of the views, a wall leaves only a strip of floor.
    if (rng.below(2) == 0) {
        const double share = between(rng, 0.04, 0.3);
        const Camera& camera = trial.camera;
        const double below_rad = camera.pitch_deg * std::numbers::pi / 180.0 +
                                 std::atan((0.5 - share) * camera.height / camera.focal_px);
        const double ahead_m = camera.height_m / std::tan(std::max(below_rad, 0.1));
        if (below_rad < 1.5) trial.blocks.push_back({{ahead_m + 0.5, 0.0, 1.5}, {1.0, 20.0, 3.0}});
    }
    return trial;
}

Trial table_trial(Rng& rng) {
    Trial trial{"table", {}, true, any_camera(rng), any_errors(rng)};
    ground::test::add_room(between(rng, 2.0, 5.0), between(rng, 1.5, 4.0), trial.blocks);
    const double top_m = between(rng, 0.65, 0.9);
    trial.camera.height_m = top_m + between(rng, 0.25, 0.9);
    trial.camera.pitch_deg = between(rng, 15.0, 60.0);
    trial.blocks.push_back({{between(rng, 0.3, 0.9), between(rng, -0.4, 0.4), top_m - 0.015},
                            {between(rng, 0.6, 1.0), between(rng, 0.8, 1.8), 0.03},
                            between(rng, -0.5, 0.5)});
    return trial;
}

Trial bed_trial(Rng& rng) {
    Trial trial{"bed", {}, true, any_camera(rng), any_errors(rng)};
    ground::test::add_room(between(rng, 2.0, 4.0), between(rng, 1.5, 3.0), trial.blocks);
    const double top_m = between(rng, 0.45, 0.65);
    trial.camera.height_m = top_m + between(rng, 0.4, 1.3);
    trial.camera.pitch_deg = between(rng, 10.0, 60.0);
    trial.blocks.push_back({{between(rng, 0.6, 1.6), between(rng, -0.6, 0.6), 0.5 * top_m},
                            {2.0, between(rng, 0.9, 1.8), top_m},
                            between(rng, -1.5, 1.5)});
    return trial;
}

Trial wall_trial(Rng& rng) {
    Trial trial{"wall", {}, false, any_camera(rng), any_errors(rng)};
    trial.camera.pitch_deg = between(rng, -20.0, 20.0);
    trial.camera.height_m = between(rng, 0.8, 1.8);
    const double ahead_m = between(rng, 0.6, 3.0);
    trial.blocks.push_back({{ahead_m + 0.5, 0.0, 0.0}, {1.0, 20.0, 40.0}, between(rng, -0.7, 0.7)});
    // Adds a shelf on the wall.
    trial.blocks.push_back({{ahead_m - 0.1, between(rng, -0.5, 0.5), between(rng, 0.3, 1.6)},
                            {between(rng, 0.1, 0.5), between(rng, 0.3, 1.5), 0.03}});
    return trial;
}

Trial full_table_trial(Rng& rng) {
    Trial trial{"full_table", {}, false, any_camera(rng), any_errors(rng)};
    trial.camera.height_m = 0.75 + between(rng, 0.3, 0.6);
    trial.camera.pitch_deg = between(rng, 35.0, 60.0);
    trial.blocks.push_back({{0.0, 0.0, 0.735}, {40.0, 40.0, 0.03}});
    return trial;
}

Trial trial_of(std::uint64_t seed) {
    Rng rng(seed);
    constexpr Trial (*kDecoys[])(Rng&) = {table_trial, bed_trial, wall_trial, full_table_trial};
    // On average, six of ten views are of kind floor, and each of the four decoys has one of ten.
    const auto kind = rng.below(10);
    return kind < 6 ? floor_trial(rng) : kDecoys[kind - 6](rng);
}

double nees_of_tilt(const GroundSighting& sighting, const Eigen::Vector3d& up) {
    const Eigen::Vector3d& n = sighting.observation.normal;
    Eigen::Matrix<double, 3, 2> across;
    across.col(0) = n.unitOrthogonal();
    across.col(1) = n.cross(across.col(0));
    const Eigen::Vector2d error = across.transpose() * up;
    const Eigen::Matrix2d covariance =
        across.transpose() * sighting.uncertainty.normal_covariance * across;
    return error.dot(covariance.inverse() * error);
}

void measure(std::uint64_t seed, fmt::ostream& out) {
    const Trial trial = trial_of(seed);
    const View view = ground::test::view_of(
        trial.blocks, trial.has_floor, trial.camera, trial.errors, mix_seed(seed, 99));
    const GroundSighting found = ground::search_ground({}, view.seen, 1);
    const auto& plane = found.observation;
    const double tilt_deg =
        std::atan2(plane.normal.cross(view.up).norm(), plane.normal.dot(view.up)) * 180.0 /
        std::numbers::pi;
    const double off_m = plane.height_m - trial.camera.height_m;
    const bool far =
        tilt_deg > 3.0 || std::abs(off_m) > std::max(0.05 * trial.camera.height_m, 0.03);
    const bool wrong = plane.accepted && (!trial.has_floor || far);
    out.print(
        "{},{},{:.1f},{:.2f},{:.4f},{},{:.4f},{},{:.3f},{:.1f},{},{:.3f},{:.3f},{:.3f},{:.1f}\n",
        seed,
        trial.kind,
        trial.camera.pitch_deg,
        trial.camera.height_m,
        view.floor_share,
        to_string(found.reason),
        found.image_share,
        plane.accepted ? 1 : 0,
        tilt_deg,
        1e3 * off_m,
        wrong ? 1 : 0,
        found.uncertainty.tilt_sigma_rad() * 180.0 / std::numbers::pi,
        nees_of_tilt(found, view.up),
        off_m * off_m / found.uncertainty.height_var_m2,
        1e3 * trial.errors.relief_m);
}

}  // namespace
}  // namespace surefoot::experiments

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    if (argc < 2) {
        fmt::print(stderr, "ground_search OUT.csv [FIRST_SEED [VIEWS]]\n");
        return 2;
    }
    const auto first = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
    const auto views = static_cast<std::uint64_t>(argc > 3 ? std::atoll(argv[3]) : 1000);
    auto out = fmt::output_file(argv[1]);
    out.print(
        "seed,kind,pitch_deg,height_m,floor_share,reason,image_share,accepted,tilt_deg,height_mm,"
        "wrong,tilt_sigma_deg,nees_tilt,nees_height,relief_mm\n");
    for (std::uint64_t seed = first; seed < first + views; ++seed)
        surefoot::experiments::measure(seed, out);
    return 0;
}

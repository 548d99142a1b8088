// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/board_view.hpp"

#include "surefoot/core/rng.hpp"
#include "surefoot/sim/sensors/calibration_error.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot::sim {
namespace {

constexpr double kCamera_m = 2.0;  ///< height of the camera; a board of up to 4 m stays above z = 0
constexpr double kThickness_m = 0.02;
constexpr double kWallBehind_m = 1.5;
constexpr double kWallHalf_m = 20.0;
constexpr std::uint64_t kTextureStream = 71;
constexpr std::uint64_t kNoiseStream = 72;

void add_slab(double near_x_m, double half_m, int material, Label label, Scene& scene) {
    const double far_x_m = near_x_m + kThickness_m;
    scene.add(
        Prism({{near_x_m, -half_m}, {far_x_m, -half_m}, {far_x_m, half_m}, {near_x_m, half_m}},
              kCamera_m - half_m,
              {.top_m = kCamera_m + half_m}),
        material,
        label);
}

Scene board_scene(const BoardView& view) {
    Scene scene;
    Lighting lighting;
    lighting.lamp_azimuth_deg = 180.0;  // behind the camera, so that it lights the board
    lighting.lamp_elevation_deg = 45.0;
    scene.light(lighting);
    Material board;
    board.pattern = Pattern::carpet;
    board.seed = mix_seed(view.seed, kTextureStream);
    Material wall = board;
    wall.pattern = Pattern::patches;
    wall.texel_m = 0.006;
    add_slab(view.distance_m, 0.5 * view.side_m, scene.add_material(board), Label::object, scene);
    add_slab(
        view.distance_m + kWallBehind_m, kWallHalf_m, scene.add_material(wall), Label::wall, scene);
    scene.scale_contrast(view.contrast * figures_of(view.profile).contrast);
    return scene;
}

}  // namespace

Result<SeenBoard> see_board(const BoardView& view,
                            const camera::StereoRig& rig,
                            const camera::RectifiedRig& rectified,
                            Executor& executor) {
    const Scene scene = board_scene(view);
    CameraConfig camera = view.camera;
    apply_profile(view.profile, view.noise, camera);
    const camera::StereoRig real =
        with_error(with_error(rig, figures_of(view.profile).calibration), view.calibration_error);
    const auto renderer = Renderer::make(scene, real, camera, mix_seed(view.seed, kNoiseStream));
    if (!renderer) return renderer.error();
    const Pose T_world_body =
        looking_down({0.0, 0.0, kCamera_m}, 0.0) * rig.body_from_left().inverse();
    RenderedPair pair;
    renderer->render(T_world_body, 0, executor, pair);
    SeenBoard seen;
    seen.frame.left = std::move(pair.left);
    seen.frame.right = std::move(pair.right);
    seen.disparity_px = rectified_disparity_px(scene, rectified, T_world_body, executor);
    return seen;
}

}  // namespace surefoot::sim

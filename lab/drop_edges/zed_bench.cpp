// SPDX-License-Identifier: Apache-2.0
#include "lab/drop_edges/zed_bench.hpp"

#include <cstdlib>

#include "surefoot/io/settings/config_yaml.hpp"
#include "surefoot/sim/sensors/camera_profile.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot {

constexpr double kCameraHeight_m = 0.95;

sim::Material zed_look(sim::Pattern pattern, std::uint64_t seed) {
    sim::Material material;
    material.pattern = pattern;
    material.seed = seed;
    material.contrast *= sim::figures_of(sim::CameraProfile::zed).contrast;
    return material;
}

ZedBench::ZedBench(double noise, const stereo::MatcherConfig& matcher, Executor& executor)
    : executor_(executor),
      rig_(*sim::rig_preset("zed_vga")),
      rectifier_(camera::Rectifier::make(rig_).value()),
      matcher_(stereo::make_matcher(matcher)) {
    sim::apply_profile(sim::CameraProfile::zed, noise, camera_);
}

void ZedBench::see(const sim::Scene& scene,
                   const Pose& T_world_body,
                   int frame,
                   std::uint64_t seed) {
    const auto real_rig =
        sim::with_error(rig_, sim::figures_of(sim::CameraProfile::zed).calibration);
    const auto renderer = sim::Renderer::make(scene, real_rig, camera_, seed);
    renderer->render(T_world_body, frame, executor_, pair_);
    matcher_->match(pair_.left.view(), pair_.right.view(), executor_, depth_);
}

Pose ZedBench::pose_over(double x_m) const {
    Pose T_world_body;
    T_world_body.translation_m = {
        x_m, 0.0, kCameraHeight_m - rig_.body_from_left().translation_m.z()};
    return T_world_body;
}

Result<BenchArguments> bench_arguments(int argc, char** argv) {
    if (argc < 2) {
        return usage_error(
            "usage: OUT_DIR [FIRST_SEED [SEEDS [NOISE [KEY=VALUE...]]]], keys of the matcher");
    }
    BenchArguments arguments;
    arguments.out_dir = argv[1];
    if (argc > 2) arguments.first_seed = std::atoi(argv[2]);
    if (argc > 3) arguments.seeds = std::atoi(argv[3]);
    if (argc > 4) arguments.noise = std::atof(argv[4]);
    for (int i = 5; i < argc; ++i) {
        if (auto set = io::override_config(argv[i], io::describe_config(arguments.matcher)); !set)
            return set.error();
    }
    if (const auto wrong = arguments.matcher.problem()) return usage_error(*wrong);
    return arguments;
}

}  // namespace surefoot

// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "service/console/log.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/nearest_names.hpp"
#include "surefoot/sim/scene_source.hpp"
#include "surefoot/sim/scenes/scenes.hpp"

namespace surefoot::app {
namespace {

/// The quick suite has a few short cases of every kind. It runs after every change of the code.
constexpr double kQuickTime_s = 2.0;
constexpr double kQuickWalk_s = 21.0;   ///< two steps, up to the stance before the third step
constexpr double kQuickDrive_s = 10.0;  ///< duration of the whole path of a trolley
/// The scenes of the quick suite. In the first seconds the trolley sees only ground ahead of it.
/// The gate then refuses every movement, because the ground under the feet is unknown. So the
/// scenes floor and platform_edge run to the end of the path: there the gate can allow movements,
/// and can refuse an edge for a better reason. The scene files keep these paths within
/// kQuickDrive_s.
struct QuickScene {
    const char* name;
    double time_s;
};
constexpr QuickScene kQuickScenes[] = {{"floor", kQuickDrive_s},
                                       {"walk_floor", kQuickWalk_s},
                                       {"platform_edge", kQuickDrive_s},
                                       {"demo_stairs", kQuickTime_s},
                                       {"table", kQuickTime_s},
                                       {"kerb_down_100", kQuickTime_s},
                                       {"kerb_up_75", kQuickTime_s},
                                       {"hole", kQuickTime_s}};
constexpr double kWalkRate_hz = 4.0;

/// A scene with its motion model.
struct SuiteScene {
    std::string name;
    sim::MotionModel motion_model = sim::MotionModel::trolley;
    double duration_s = 0.0;  ///< duration of the first seed; paths of other seeds differ
};

bool is_scene_file(const std::string& name) {
    const std::string file = name.substr(0, name.find('#'));
    return file.ends_with(".yaml");
}

std::vector<std::string> names_of(const std::vector<sim::SceneInfo>& scenes) {
    std::vector<std::string> names;
    names.reserve(scenes.size());
    for (const sim::SceneInfo& scene : scenes) names.push_back(scene.name);
    return names;
}

std::vector<std::string> chosen_names(const EvalSuiteOptions& options) {
    if (!options.scenes.empty()) return options.scenes;
    if (options.quick) {
        std::vector<std::string> names;
        for (const QuickScene& scene : kQuickScenes) names.emplace_back(scene.name);
        return names;
    }
    return names_of(sim::list_scenes());
}

Status check_name(const std::string& name) {
    const auto known = sim::list_scenes();
    const bool listed = std::any_of(known.begin(), known.end(), [&](const sim::SceneInfo& scene) {
        return scene.name == name;
    });
    if (listed || is_scene_file(name)) return {};
    const std::string likely = did_you_mean(name, names_of(known));
    return usage_error(
        fmt::format("--scenes {}: there is no such scene{} 'surefoot sim --list' shows all scenes",
                    name,
                    likely.empty() ? ";" : likely));
}

/// Adds the scene once for each motion model that can follow its path. Two names of the same motion
/// model count once.
Status add_motion_models(const std::string& name,
                         const EvalSuiteOptions& options,
                         std::vector<SuiteScene>& scenes) {
    std::set<sim::MotionModel> motion_models;
    for (const std::string& word : options.motion_models) {
        const auto asked = sim::motion_model_of(motion_model_choice(word));
        const auto scene = sim::make_scene(name, options.common.seed, asked);
        if (!scene && asked && sim::make_scene(name, options.common.seed)) {
            log_warning(fmt::format("scene {} with motion model {} is left out: {}",
                                    name,
                                    word,
                                    scene.error().message));
            continue;
        }
        if (!scene) return usage_error(scene.error().message);
        if (motion_models.insert(scene->script.motion_model).second)
            scenes.push_back({name, scene->script.motion_model, scene->motion->duration_s()});
    }
    return {};
}

Result<std::vector<SuiteScene>> open_scenes(const EvalSuiteOptions& options) {
    std::vector<SuiteScene> scenes;
    std::set<std::string> names;
    for (const std::string& name : chosen_names(options)) {
        if (auto status = check_name(name); !status) return status.error();
        if (!names.insert(name).second)
            return usage_error(
                fmt::format("--scenes: {} is given twice; give each scene once", name));
        if (auto status = add_motion_models(name, options, scenes); !status) return status.error();
    }
    if (scenes.empty())
        return usage_error(
            "--motion-models: none of these motion models can follow the paths of these scenes; "
            "give "
            "another motion model or scene");
    return scenes;
}

Status check_noise(const std::vector<double>& factors) {
    for (std::size_t i = 0; i < factors.size(); ++i) {
        if (std::find(factors.begin(),
                      factors.begin() + static_cast<std::ptrdiff_t>(i),
                      factors[i]) != factors.begin() + static_cast<std::ptrdiff_t>(i))
            return usage_error(
                fmt::format("--noise: {:g} is given twice; give each factor once", factors[i]));
    }
    return {};
}

/// Returns the duration of a scene in the quick suite.
double quick_time_s(const SuiteScene& scene) {
    for (const QuickScene& quick : kQuickScenes) {
        if (scene.name == quick.name) return std::min(quick.time_s, scene.duration_s);
    }
    return scene.motion_model == sim::MotionModel::rex ? kQuickWalk_s : kQuickTime_s;
}

PlannedCase planned(const SuiteScene& scene,
                    const EvalSuiteOptions& options,
                    const Settings& settings) {
    const bool walks = scene.motion_model == sim::MotionModel::rex;
    PlannedCase plan;
    plan.which.scene = scene.name;
    plan.which.motion_model = sim::kMotionModelNames[static_cast<std::size_t>(scene.motion_model)];
    plan.which.rate_hz =
        walks ? std::min(kWalkRate_hz, settings.sim.rate_hz) : settings.sim.rate_hz;
    const auto frames_in = [&](double time_s) {
        return saturated_integer<int>(std::floor(time_s * plan.which.rate_hz) + 1.0);
    };
    plan.frames = frames_in(scene.duration_s);
    const int limit = options.frames > 0 ? options.frames
                      : options.quick    ? frames_in(quick_time_s(scene))
                                         : settings.sim.frames;
    if (limit > 0) {
        plan.which.max_frames = limit;
        plan.frames = limit;  // The limit may exceed the path; the camera then stands still.
    }
    return plan;
}

}  // namespace

Result<std::vector<PlannedCase>> plan_suite(const EvalSuiteOptions& options,
                                            const Settings& settings) {
    if (auto status = check_noise(options.noise); !status) return status.error();
    const auto scenes = open_scenes(options);
    if (!scenes) return scenes.error();
    std::vector<PlannedCase> cases;
    for (int i = 0; i < options.seeds; ++i) {
        std::vector<PlannedCase> of_seed;
        for (const SuiteScene& scene : *scenes) {
            for (const double noise : options.noise) {
                PlannedCase plan = planned(scene, options, settings);
                plan.which.seed = options.common.seed + static_cast<std::uint64_t>(i);
                plan.which.noise = noise;
                of_seed.push_back(std::move(plan));
            }
        }
        std::stable_sort(of_seed.begin(), of_seed.end(), [](const auto& a, const auto& b) {
            return a.frames > b.frames;
        });
        cases.insert(cases.end(), of_seed.begin(), of_seed.end());
    }
    return cases;
}

}  // namespace surefoot::app

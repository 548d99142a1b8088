// SPDX-License-Identifier: Apache-2.0
#include "studies/simulation/scene_gallery.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/eval/report/picture.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/sim/scene_source.hpp"
#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/scenes/truth.hpp"

namespace surefoot::app {
namespace {

/// Returns the lattice of the ground and objects around the paths of the scenes.
sim::Lattice surroundings() {
    return {{-1.0, -2.5}, 280, 200, 0.025};
}

Status write_png(const std::string& path, const eval::Picture& picture) {
    const auto png = eval::encode_png(picture);
    return io::write_file(path, png);
}

/// Returns the time of a characteristic view. It is the start of the first turn of a walk, because
/// the machine still faces its target then. Without a turn, it is half of the duration of the path.
double telling_time_s(const sim::ScriptedScene& script) {
    constexpr int kFirstTurn = 25;  // joystick codes 25 and 26 are turns
    for (const sim::StepEvent& step : script.steps) {
        if (step.command >= kFirstTurn) return step.start_s;
    }
    return 0.5 * script.motion->duration_s();
}

Status write_view(const std::string& path,
                  const sim::SceneInfo& info,
                  const sim::ScriptedScene& script,
                  std::uint64_t seed,
                  Executor& executor) {
    sim::SceneOptions options;
    options.scene = info.name;
    options.seed = seed;
    constexpr double kLongest_s = 10.0;  // longest time between two frames of a source
    const double time_s = telling_time_s(script);
    const int frames = saturated_integer<int>(std::ceil(time_s / kLongest_s));
    options.rate_hz = frames / time_s;
    options.frames = frames + 1;
    auto source = sim::open_scene(options, &executor);
    if (!source) return source.error();
    GreyImage last;
    for (int frame = 0; frame <= frames; ++frame) {
        auto next = (*source)->next();
        if (!next) return next.error();
        if (*next) last = std::move((*next)->left);
    }
    return write_png(path, eval::render_camera_image(last, {info.name, info.description}));
}

/// Returns the colour range, which covers the ground but not the walls around it.
eval::ValueRange ground_range(const grid::Layer& heights_m, const Image<sim::Label>& labels) {
    eval::ValueRange range{-0.05, 0.05};
    for (std::size_t i = 0; i < heights_m.size(); ++i) {
        const sim::Label label = labels.data()[i];
        const double z_m = static_cast<double>(heights_m.data()[i]);
        if (label == sim::Label::wall || label == sim::Label::door || std::isnan(z_m)) continue;
        range.low = std::min(range.low, z_m);
        range.high = std::max(range.high, z_m);
    }
    return range;
}

Status write_heights(const std::string& path,
                     const sim::SceneInfo& info,
                     const sim::ScriptedScene& script) {
    constexpr double kStep_s = 0.25;
    const sim::Lattice around = surroundings();
    const grid::GridGeometry geometry{around.resolution_m, around.nx, around.ny, around.origin_m};
    const grid::Layer heights_m = sim::dem(script.scene, around);
    eval::LayerStyle style = eval::elevation_style();
    style.text = {info.name, "true heights and path"};
    style.range = ground_range(heights_m, sim::labels(script.scene, around));
    eval::Overlays overlays;
    overlays.T_odom_body = script.motion->at(0.5 * script.motion->duration_s()).T_world_body;
    for (double t_s = 0.0; t_s < script.motion->duration_s(); t_s += kStep_s) {
        const Pose T_world_body = script.motion->at(t_s).T_world_body;
        overlays.trajectory_m.emplace_back(T_world_body.translation_m.head<2>());
    }
    return write_png(path, eval::render_layer(geometry, heights_m, style, overlays));
}

std::string page(const std::vector<sim::SceneInfo>& scenes, std::uint64_t seed) {
    std::string html = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Scenes</title>\n"
        "<style>body{{font:16px sans-serif;margin:2em;max-width:80em}}"
        "figure{{margin:0 0 2em}}img{{max-width:49%;vertical-align:top}}</style></head><body>\n"
        "<h1>{} scenes, seed {}</h1>\n",
        scenes.size(),
        seed);
    for (const auto& scene : scenes) {
        html += fmt::format(
            "<figure><figcaption><b>{0}</b>: {1}</figcaption>\n"
            "<img src=\"{0}.png\" alt=\"{0}, left camera\" loading=\"lazy\">\n"
            "<img src=\"{0}_height.png\" alt=\"{0}, heights\" loading=\"lazy\"></figure>\n",
            scene.name,
            scene.description);
    }
    return html + "</body></html>\n";
}

}  // namespace

Status write_scene_gallery(const std::string& folder, std::uint64_t seed, Executor& executor) {
    if (auto status = io::make_folder(folder); !status) return status;
    const auto scenes = sim::list_scenes();
    for (const auto& info : scenes) {
        const auto script = sim::make_scene(info.name, seed);
        if (!script) return script.error();
        const std::string path = io::join_path(folder, info.name);
        if (auto status = write_view(path + ".png", info, *script, seed, executor); !status) {
            return status;
        }
        if (auto status = write_heights(path + "_height.png", info, *script); !status) {
            return status;
        }
    }
    return io::write_file(io::join_path(folder, "index.html"), page(scenes, seed));
}

}  // namespace surefoot::app

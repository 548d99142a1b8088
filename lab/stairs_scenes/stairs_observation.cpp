// SPDX-License-Identifier: Apache-2.0
#include "lab/stairs_scenes/stairs_observation.hpp"

#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "surefoot/io/images/pfm.hpp"
#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::experiments {
namespace {

/// Range of the columns and rows with known cells, plus a margin.
struct Box {
    int min_x = std::numeric_limits<int>::max();
    int min_y = std::numeric_limits<int>::max();
    int max_x = -1;
    int max_y = -1;
};

Box known_box(const Observation& observation) {
    constexpr int kRim = 4;
    Box box;
    for (int iy = 0; iy < observation.geometry.ny; ++iy) {
        for (int ix = 0; ix < observation.geometry.nx; ++ix) {
            if (std::isnan(observation.height_m.at(ix, iy)) &&
                std::isnan(observation.free_above_m.at(ix, iy)))
                continue;
            box.min_x = std::min(box.min_x, std::max(ix - kRim, 0));
            box.min_y = std::min(box.min_y, std::max(iy - kRim, 0));
            box.max_x = std::max(box.max_x, std::min(ix + kRim, observation.geometry.nx - 1));
            box.max_y = std::max(box.max_y, std::min(iy + kRim, observation.geometry.ny - 1));
        }
    }
    return box.max_x < 0 ? Box{0, 0, 0, 0} : box;
}

template <typename From>
grid::Layer cut(const Image<From>& layer, const Box& box) {
    grid::Layer part(box.max_x - box.min_x + 1, box.max_y - box.min_y + 1);
    for (int iy = 0; iy < part.height(); ++iy)
        for (int ix = 0; ix < part.width(); ++ix)
            part.at(ix, iy) = static_cast<float>(layer.at(box.min_x + ix, box.min_y + iy));
    return part;
}

/// Returns a layer of the size of the map that is unknown except for `part`. The first cell of
/// `part` is at `begin`.
grid::Layer whole(const grid::Layer& part, const grid::GridGeometry& map, const grid::Cell& begin) {
    grid::Layer layer(map.nx, map.ny, std::numeric_limits<float>::quiet_NaN());
    for (int iy = 0; iy < part.height(); ++iy)
        for (int ix = 0; ix < part.width(); ++ix)
            layer.at(begin.ix + ix, begin.iy + iy) = part.at(ix, iy);
    return layer;
}

/// Returns all numbers of truth.txt.
std::vector<std::pair<const char*, std::reference_wrapper<double>>> numbers(
    Observation& observation) {
    TrueFeature& truth = observation.truth;
    return {{"noise_px", observation.noise_px},
            {"bias_px", observation.bias_px},
            {"said_px", observation.said_px},
            {"riser_m", truth.riser_m},
            {"going_m", truth.going_m},
            {"width_m", truth.width_m},
            {"sill_m", truth.sill_m},
            {"middle_x_m", truth.middle_m.x()},
            {"middle_y_m", truth.middle_m.y()},
            {"yaw_rad", truth.yaw_rad},
            {"ahead_m", truth.ahead_m},
            {"stance_x_m", observation.stance_m.x()},
            {"stance_y_m", observation.stance_m.y()},
            {"camera_x_m", observation.view.T_map_camera.translation_m.x()},
            {"camera_y_m", observation.view.T_map_camera.translation_m.y()},
            {"camera_z_m", observation.view.T_map_camera.translation_m.z()},
            {"camera_qx", observation.view.T_map_camera.rotation.x()},
            {"camera_qy", observation.view.T_map_camera.rotation.y()},
            {"camera_qz", observation.view.T_map_camera.rotation.z()},
            {"camera_qw", observation.view.T_map_camera.rotation.w()},
            {"width_px", observation.view.width_px},
            {"height_px", observation.view.height_px},
            {"fx_px", observation.view.fx_px},
            {"fy_px", observation.view.fy_px},
            {"cx_px", observation.view.cx_px},
            {"cy_px", observation.view.cy_px},
            {"baseline_m", observation.view.baseline_m},
            {"unmapped_px", observation.view.unmapped_px},
            {"origin_x_m", observation.geometry.origin_m.x()},
            {"origin_y_m", observation.geometry.origin_m.y()}};
}

Status write_truth(Observation observation, const std::string& path) {
    auto out = fmt::output_file(path);
    out.print("scene {}\nseed {}\nmode {}\nframe {}\nkind {}\nsteps {}\nnx {}\nny {}\n",
              observation.scene,
              observation.seed,
              observation.mode,
              observation.frame,
              kTrueKindNames[static_cast<int>(observation.truth.kind)],
              observation.truth.steps,
              observation.geometry.nx,
              observation.geometry.ny);
    for (const auto& [name, value] : numbers(observation)) out.print("{} {}\n", name, value.get());
    return {};
}

Status read_truth(const std::string& path, Observation& observation) {
    std::ifstream file(path);
    std::map<std::string, std::string> words;
    for (std::string name, word; file >> name >> word;) words[name] = word;
    if (words.empty()) return input_error(path + " says nothing");
    observation.scene = words["scene"];
    observation.mode = words["mode"];
    observation.seed = static_cast<std::uint64_t>(io::parse_int64(words["seed"]).value_or(0));
    const auto integer = [&](const char* name) {
        return static_cast<int>(io::parse_int64(words[name]).value_or(0));
    };
    observation.frame = integer("frame");
    observation.truth.steps = integer("steps");
    observation.geometry.nx = integer("nx");
    observation.geometry.ny = integer("ny");
    for (int kind = 0; kind < static_cast<int>(std::size(kTrueKindNames)); ++kind)
        if (words["kind"] == kTrueKindNames[kind])
            observation.truth.kind = static_cast<TrueKind>(kind);
    for (const auto& [name, value] : numbers(observation)) {
        const auto number = io::parse_double(words[name]);
        if (!number) return input_error(fmt::format("{}: no {}", path, name));
        value.get() = *number;
    }
    return {};
}

}  // namespace

stairs::Terrain Observation::terrain() const {
    stairs::Terrain terrain;
    terrain.geometry = geometry;
    terrain.height_m = height_m.view();
    terrain.height_var_m2 = height_var_m2.view();
    terrain.free_above_m = free_above_m.view();
    terrain.clearance_m = clearance_m.view();
    terrain.density_ratio = density_ratio.view();
    terrain.observations = observations.view();
    terrain.stance_m = stance_m;
    terrain.view = view;
    terrain.disparity_px = disparity_px.view();
    return terrain;
}

std::string Observation::folder_name() const {
    return fmt::format("{}_{}_f{}", short_name(scene), seed, frame);
}

std::string short_name(const std::string& scene) {
    const std::string name = scene.substr(scene.find_last_of("#/") + 1);
    return name.substr(0, name.find('.'));
}

Status save_observation(const Observation& observation, const std::string& folder) {
    std::filesystem::create_directories(folder);
    const Box box = known_box(observation);
    grid::GridGeometry geometry = observation.geometry;
    geometry.origin_m += geometry.resolution_m * Eigen::Vector2d(box.min_x, box.min_y);
    geometry.nx = box.max_x - box.min_x + 1;
    geometry.ny = box.max_y - box.min_y + 1;
    const std::pair<const char*, grid::Layer> layers[] = {
        {"height", cut(observation.height_m, box)},
        {"variance", cut(observation.height_var_m2, box)},
        {"free_above", cut(observation.free_above_m, box)},
        {"clearance", cut(observation.clearance_m, box)},
        {"density", cut(observation.density_ratio, box)},
        {"looks", cut(observation.observations, box)}};
    for (const auto& [name, layer] : layers) {
        const auto path = fmt::format("{}/{}.asc", folder, name);
        if (Status written = io::write_esri_grid(path, geometry, layer); !written) return written;
    }
    const std::pair<const char*, const Image<float>*> images[] = {
        {"disparity", &observation.disparity_px},
        {"disparity_sigma", &observation.disparity_sigma_px}};
    for (const auto& [name, image] : images) {
        const auto path = fmt::format("{}/{}.pfm", folder, name);
        if (Status written = io::write_pfm(path, *image); !written) return written;
    }
    return write_truth(observation, folder + "/truth.txt");
}

Result<Observation> read_observation(const std::string& folder) {
    Observation observation;
    if (Status read = read_truth(folder + "/truth.txt", observation); !read) return read.error();
    grid::Layer observations;
    const std::pair<const char*, grid::Layer*> layers[] = {
        {"height", &observation.height_m},
        {"variance", &observation.height_var_m2},
        {"free_above", &observation.free_above_m},
        {"clearance", &observation.clearance_m},
        {"density", &observation.density_ratio},
        {"looks", &observations}};
    for (const auto& [name, layer] : layers) {
        auto dem = io::read_esri_grid(fmt::format("{}/{}.asc", folder, name));
        if (!dem) return dem.error();
        observation.geometry.resolution_m = dem->geometry.resolution_m;
        const auto begin = observation.geometry.cell_at(dem->geometry.center_m({0, 0}).x(),
                                                        dem->geometry.center_m({0, 0}).y());
        const grid::Cell last{dem->geometry.nx - 1, dem->geometry.ny - 1};
        if (!begin || !observation.geometry.contains({begin->ix + last.ix, begin->iy + last.iy}))
            return input_error(folder + ": lies beyond the map of truth.txt");
        *layer = whole(dem->values, observation.geometry, *begin);
    }
    const std::pair<const char*, Image<float>*> images[] = {
        {"disparity", &observation.disparity_px},
        {"disparity_sigma", &observation.disparity_sigma_px}};
    for (const auto& [name, image] : images) {
        auto read = io::read_pfm(fmt::format("{}/{}.pfm", folder, name));
        if (!read) return read.error();
        *image = std::move(*read);
    }
    observation.observations.resize(observations.width(), observations.height());
    std::transform(
        observations.data(),
        observations.data() + observations.size(),
        observation.observations.data(),
        [](float count) { return std::isnan(count) ? 0U : static_cast<std::uint32_t>(count); });
    return observation;
}

}  // namespace surefoot::experiments

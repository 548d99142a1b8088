// SPDX-License-Identifier: Apache-2.0
#include "lab/stairs_scenes/stairs_look.hpp"

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

/// Columns and rows that hold anything, with a rim.
struct Box {
    int min_x = std::numeric_limits<int>::max();
    int min_y = std::numeric_limits<int>::max();
    int max_x = -1;
    int max_y = -1;
};

Box known_box(const Look& look) {
    constexpr int kRim = 4;
    Box box;
    for (int iy = 0; iy < look.geometry.ny; ++iy) {
        for (int ix = 0; ix < look.geometry.nx; ++ix) {
            if (std::isnan(look.height_m.at(ix, iy)) && std::isnan(look.free_above_m.at(ix, iy)))
                continue;
            box.min_x = std::min(box.min_x, std::max(ix - kRim, 0));
            box.min_y = std::min(box.min_y, std::max(iy - kRim, 0));
            box.max_x = std::max(box.max_x, std::min(ix + kRim, look.geometry.nx - 1));
            box.max_y = std::max(box.max_y, std::min(iy + kRim, look.geometry.ny - 1));
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

/// The layer of a map in which `part` begins at a cell.
grid::Layer whole(const grid::Layer& part, const grid::GridGeometry& map, const grid::Cell& begin) {
    grid::Layer layer(map.nx, map.ny, std::numeric_limits<float>::quiet_NaN());
    for (int iy = 0; iy < part.height(); ++iy)
        for (int ix = 0; ix < part.width(); ++ix)
            layer.at(begin.ix + ix, begin.iy + iy) = part.at(ix, iy);
    return layer;
}

/// Every number of truth.txt.
std::vector<std::pair<const char*, std::reference_wrapper<double>>> numbers(Look& look) {
    TrueFeature& truth = look.truth;
    return {{"noise_px", look.noise_px},
            {"bias_px", look.bias_px},
            {"said_px", look.said_px},
            {"riser_m", truth.riser_m},
            {"going_m", truth.going_m},
            {"width_m", truth.width_m},
            {"sill_m", truth.sill_m},
            {"middle_x_m", truth.middle_m.x()},
            {"middle_y_m", truth.middle_m.y()},
            {"yaw_rad", truth.yaw_rad},
            {"ahead_m", truth.ahead_m},
            {"stance_x_m", look.stance_m.x()},
            {"stance_y_m", look.stance_m.y()},
            {"camera_x_m", look.view.T_map_camera.translation_m.x()},
            {"camera_y_m", look.view.T_map_camera.translation_m.y()},
            {"camera_z_m", look.view.T_map_camera.translation_m.z()},
            {"camera_qx", look.view.T_map_camera.rotation.x()},
            {"camera_qy", look.view.T_map_camera.rotation.y()},
            {"camera_qz", look.view.T_map_camera.rotation.z()},
            {"camera_qw", look.view.T_map_camera.rotation.w()},
            {"width_px", look.view.width_px},
            {"height_px", look.view.height_px},
            {"fx_px", look.view.fx_px},
            {"fy_px", look.view.fy_px},
            {"cx_px", look.view.cx_px},
            {"cy_px", look.view.cy_px},
            {"baseline_m", look.view.baseline_m},
            {"unmapped_px", look.view.unmapped_px},
            {"origin_x_m", look.geometry.origin_m.x()},
            {"origin_y_m", look.geometry.origin_m.y()}};
}

Status write_truth(Look look, const std::string& path) {
    auto out = fmt::output_file(path);
    out.print("scene {}\nseed {}\nmode {}\nframe {}\nkind {}\nsteps {}\nnx {}\nny {}\n",
              look.scene,
              look.seed,
              look.mode,
              look.frame,
              kTrueKindNames[static_cast<int>(look.truth.kind)],
              look.truth.steps,
              look.geometry.nx,
              look.geometry.ny);
    for (const auto& [name, value] : numbers(look)) out.print("{} {}\n", name, value.get());
    return {};
}

Status read_truth(const std::string& path, Look& look) {
    std::ifstream file(path);
    std::map<std::string, std::string> words;
    for (std::string name, word; file >> name >> word;) words[name] = word;
    if (words.empty()) return input_error(path + " says nothing");
    look.scene = words["scene"];
    look.mode = words["mode"];
    look.seed = static_cast<std::uint64_t>(io::parse_int64(words["seed"]).value_or(0));
    const auto integer = [&](const char* name) {
        return static_cast<int>(io::parse_int64(words[name]).value_or(0));
    };
    look.frame = integer("frame");
    look.truth.steps = integer("steps");
    look.geometry.nx = integer("nx");
    look.geometry.ny = integer("ny");
    for (int kind = 0; kind < static_cast<int>(std::size(kTrueKindNames)); ++kind)
        if (words["kind"] == kTrueKindNames[kind]) look.truth.kind = static_cast<TrueKind>(kind);
    for (const auto& [name, value] : numbers(look)) {
        const auto number = io::parse_double(words[name]);
        if (!number) return input_error(fmt::format("{}: no {}", path, name));
        value.get() = *number;
    }
    return {};
}

}  // namespace

stairs::Terrain Look::terrain() const {
    stairs::Terrain terrain;
    terrain.geometry = geometry;
    terrain.height_m = height_m.view();
    terrain.height_var_m2 = height_var_m2.view();
    terrain.free_above_m = free_above_m.view();
    terrain.clearance_m = clearance_m.view();
    terrain.density_ratio = density_ratio.view();
    terrain.looks = looks.view();
    terrain.stance_m = stance_m;
    terrain.view = view;
    terrain.disparity_px = disparity_px.view();
    return terrain;
}

std::string Look::folder_name() const {
    return fmt::format("{}_{}_f{}", short_name(scene), seed, frame);
}

std::string short_name(const std::string& scene) {
    const std::string name = scene.substr(scene.find_last_of("#/") + 1);
    return name.substr(0, name.find('.'));
}

Status save_look(const Look& look, const std::string& folder) {
    std::filesystem::create_directories(folder);
    const Box box = known_box(look);
    grid::GridGeometry geometry = look.geometry;
    geometry.origin_m += geometry.resolution_m * Eigen::Vector2d(box.min_x, box.min_y);
    geometry.nx = box.max_x - box.min_x + 1;
    geometry.ny = box.max_y - box.min_y + 1;
    const std::pair<const char*, grid::Layer> layers[] = {
        {"height", cut(look.height_m, box)},
        {"variance", cut(look.height_var_m2, box)},
        {"free_above", cut(look.free_above_m, box)},
        {"clearance", cut(look.clearance_m, box)},
        {"density", cut(look.density_ratio, box)},
        {"looks", cut(look.looks, box)}};
    for (const auto& [name, layer] : layers) {
        const auto path = fmt::format("{}/{}.asc", folder, name);
        if (Status written = io::write_esri_grid(path, geometry, layer); !written) return written;
    }
    const std::pair<const char*, const Image<float>*> images[] = {
        {"disparity", &look.disparity_px}, {"disparity_sigma", &look.disparity_sigma_px}};
    for (const auto& [name, image] : images) {
        const auto path = fmt::format("{}/{}.pfm", folder, name);
        if (Status written = io::write_pfm(path, *image); !written) return written;
    }
    return write_truth(look, folder + "/truth.txt");
}

Result<Look> read_look(const std::string& folder) {
    Look look;
    if (Status read = read_truth(folder + "/truth.txt", look); !read) return read.error();
    grid::Layer looks;
    const std::pair<const char*, grid::Layer*> layers[] = {{"height", &look.height_m},
                                                           {"variance", &look.height_var_m2},
                                                           {"free_above", &look.free_above_m},
                                                           {"clearance", &look.clearance_m},
                                                           {"density", &look.density_ratio},
                                                           {"looks", &looks}};
    for (const auto& [name, layer] : layers) {
        auto dem = io::read_esri_grid(fmt::format("{}/{}.asc", folder, name));
        if (!dem) return dem.error();
        look.geometry.resolution_m = dem->geometry.resolution_m;
        const auto begin = look.geometry.cell_at(dem->geometry.center_m({0, 0}).x(),
                                                 dem->geometry.center_m({0, 0}).y());
        const grid::Cell last{dem->geometry.nx - 1, dem->geometry.ny - 1};
        if (!begin || !look.geometry.contains({begin->ix + last.ix, begin->iy + last.iy}))
            return input_error(folder + ": lies beyond the map of truth.txt");
        *layer = whole(dem->values, look.geometry, *begin);
    }
    const std::pair<const char*, Image<float>*> images[] = {
        {"disparity", &look.disparity_px}, {"disparity_sigma", &look.disparity_sigma_px}};
    for (const auto& [name, image] : images) {
        auto read = io::read_pfm(fmt::format("{}/{}.pfm", folder, name));
        if (!read) return read.error();
        *image = std::move(*read);
    }
    look.looks.resize(looks.width(), looks.height());
    std::transform(looks.data(), looks.data() + looks.size(), look.looks.data(), [](float count) {
        return std::isnan(count) ? 0U : static_cast<std::uint32_t>(count);
    });
    return look;
}

}  // namespace surefoot::experiments

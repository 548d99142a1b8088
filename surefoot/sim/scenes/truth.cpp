// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/truth.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/unknown.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

/// A ray to a surface point ends this much before it, so that the surface does not hide itself.
constexpr double kSelf_m = 1e-6;

/// Pose of a camera at one time.
struct EyePoint {
    const camera::Camera* camera = nullptr;
    Pose T_world_camera;
    Pose T_camera_world;
};

EyePoint make_camera(const camera::Camera& camera, const Pose& T_world_camera) {
    return {&camera, T_world_camera, T_world_camera.inverse()};
}

bool in_image(const EyePoint& this_camera, const Vector3d& point_m, double margin_px) {
    const auto pixel =
        camera::project(this_camera.camera->model, this_camera.T_camera_world * point_m);
    // Pixel centres are at integers: the image ends half a pixel beyond the outer ones.
    return pixel && pixel->x() >= margin_px - 0.5 && pixel->y() >= margin_px - 0.5 &&
           pixel->x() <= this_camera.camera->width - 0.5 - margin_px &&
           pixel->y() <= this_camera.camera->height - 0.5 - margin_px;
}

bool unobstructed(const Scene& scene, const EyePoint& this_camera, const Vector3d& point_m) {
    const Vector3d way_m = point_m - this_camera.T_world_camera.translation_m;
    const double distance_m = way_m.norm();
    return !scene.blocked(
        this_camera.T_world_camera.translation_m, way_m / distance_m, distance_m - kSelf_m);
}

struct CameraPair {
    EyePoint left;
    EyePoint right;
};

std::vector<CameraPair> cameras_along(const SceneTruth& truth, const VisibilityConfig& config) {
    const auto stride = static_cast<std::size_t>(std::max(config.frame_stride, 1));
    std::vector<CameraPair> pairs;
    for (std::size_t i = 0; i < truth.trajectory.size(); i += stride) {
        if (truth.trajectory[i].time_ns > config.until_ns) break;
        const Pose T_world_left = truth.trajectory[i].T_world_body * truth.rig.body_from_left();
        pairs.push_back({make_camera(truth.rig.left, T_world_left),
                         make_camera(truth.rig.right ? *truth.rig.right : truth.rig.left,
                                     T_world_left * truth.rig.T_left_right)});
    }
    return pairs;
}

bool seen(const Scene& scene,
          const std::vector<CameraPair>& pairs,
          const Vector3d& point_m,
          const VisibilityConfig& config) {
    int frames = 0;
    for (const CameraPair& pair : pairs) {
        const double distance_m = (point_m - pair.left.T_world_camera.translation_m).norm();
        if (distance_m > config.range_m || distance_m <= kSelf_m) continue;
        if (!in_image(pair.left, point_m, config.margin_px) ||
            !in_image(pair.right, point_m, config.margin_px)) {
            continue;
        }
        if (!unobstructed(scene, pair.left, point_m) || !unobstructed(scene, pair.right, point_m)) {
            continue;
        }
        if (++frames >= config.min_frames) return true;
    }
    return false;
}

bool is_jump(float a, float b, double jump_m) {
    if (std::isnan(a) || std::isnan(b)) return std::isnan(a) != std::isnan(b);
    return std::abs(static_cast<double>(a) - static_cast<double>(b)) > jump_m;
}

void mark_around(Image<std::uint8_t>& mask, int ix, int iy, int margin) {
    for (int y = std::max(iy - margin, 0); y <= std::min(iy + margin, mask.height() - 1); ++y) {
        for (int x = std::max(ix - margin, 0); x <= std::min(ix + margin, mask.width() - 1); ++x) {
            mask.at(x, y) = 1;
        }
    }
}

}  // namespace

Image<float> dem(const Scene& scene, const Lattice& lattice, DemReduce reduce) {
    Image<float> heights_m(lattice.nx, lattice.ny, kNanF);
    for (int iy = 0; iy < lattice.ny; ++iy) {
        for (int ix = 0; ix < lattice.nx; ++ix) {
            const Eigen::Vector2d center_m = lattice.center_m(ix, iy);
            if (reduce == DemReduce::center) {
                if (const auto top = scene.height_at(center_m.x(), center_m.y())) {
                    heights_m.at(ix, iy) = static_cast<float>(top->z_m);
                }
                continue;
            }
            const Eigen::Array2d half_m = Eigen::Array2d::Constant(0.5 * lattice.resolution_m);
            const Rect cell{center_m.array() - half_m, center_m.array() + half_m};
            if (const auto top = scene.highest_over(cell)) {
                heights_m.at(ix, iy) = static_cast<float>(*top);
            }
        }
    }
    return heights_m;
}

Image<float> dem_below_overhead(Image<float> dem_m,
                                const Scene& scene,
                                const Lattice& lattice,
                                ImageView<const float> height_m,
                                ImageView<const float> clearance_m) {
    for (int iy = 0; iy < lattice.ny; ++iy) {
        for (int ix = 0; ix < lattice.nx; ++ix) {
            if (std::isnan(clearance_m.at(ix, iy))) continue;
            const float live_m = height_m.at(ix, iy);
            const Eigen::Vector2d center_m = lattice.center_m(ix, iy);
            float& nearest_m = dem_m.at(ix, iy);
            for (const SurfaceHeight& surface : scene.surfaces_at(center_m.x(), center_m.y())) {
                const auto z_m = static_cast<float>(surface.z_m);
                if (std::abs(z_m - live_m) < std::abs(nearest_m - live_m)) nearest_m = z_m;
            }
        }
    }
    return dem_m;
}

Image<Label> labels(const Scene& scene, const Lattice& lattice) {
    Image<Label> result(lattice.nx, lattice.ny, Label::none);
    for (int iy = 0; iy < lattice.ny; ++iy) {
        for (int ix = 0; ix < lattice.nx; ++ix) {
            const Eigen::Vector2d center_m = lattice.center_m(ix, iy);
            const auto top = scene.height_at(center_m.x(), center_m.y());
            if (!top) continue;
            result.at(ix, iy) = scene.surfaces()[static_cast<std::size_t>(top->surface)].label;
        }
    }
    return result;
}

Image<std::uint8_t> edge_mask(const Image<float>& dem_m, const EdgeConfig& config) {
    Image<std::uint8_t> mask(dem_m.width(), dem_m.height());
    const auto compare = [&](int ix, int iy, int jx, int jy) {
        if (!dem_m.contains(jx, jy)) return;
        if (!is_jump(dem_m.at(ix, iy), dem_m.at(jx, jy), config.jump_m)) return;
        mark_around(mask, ix, iy, config.margin_cells);
        mark_around(mask, jx, jy, config.margin_cells);
    };
    for (int iy = 0; iy < dem_m.height(); ++iy) {
        for (int ix = 0; ix < dem_m.width(); ++ix) {
            compare(ix, iy, ix + 1, iy);
            compare(ix, iy, ix, iy + 1);
        }
    }
    return mask;
}

Image<std::uint8_t> visibility_mask(const SceneTruth& truth,
                                    const Lattice& lattice,
                                    const VisibilityConfig& config,
                                    Executor& executor) {
    Image<std::uint8_t> mask(lattice.nx, lattice.ny);
    const auto pairs = cameras_along(truth, config);
    executor.parallel_for(lattice.ny, [&](int iy) {
        for (int ix = 0; ix < lattice.nx; ++ix) {
            const Eigen::Vector2d center_m = lattice.center_m(ix, iy);
            const auto top = truth.scene.height_at(center_m.x(), center_m.y());
            if (!top) continue;
            const Vector3d point_m(center_m.x(), center_m.y(), top->z_m);
            mask.row(iy)[ix] = seen(truth.scene, pairs, point_m, config) ? 1 : 0;
        }
    });
    return mask;
}

}  // namespace surefoot::sim

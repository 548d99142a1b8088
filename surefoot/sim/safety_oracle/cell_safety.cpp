// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/safety_oracle/cell_safety.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/sim/safety_oracle/foot_ground.hpp"
#include "surefoot/sim/safety_oracle/safety_figures.hpp"
#include "surefoot/sim/safety_oracle/swept_box.hpp"
#include "surefoot/sim/scenes/ground_field.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;

constexpr double kRounding = 1e-7;
/// Number of cells along x and along y of a block. The cells of a block share their ground samples.
constexpr int kBlock = 32;
/// Cells of a block share samples if their levels fall into the same bin of this size.
constexpr double kLevelBin_m = 0.05;

/// Walks from the start over the surfaces of the cells; each surface of a cell is a separate node.
/// A cell keeps its highest reached surface, or NaN if no surface is reached.
class Walk {
  public:
    Walk(const Scene& scene, const Lattice& lattice, double joined_m)
        : lattice_(lattice),
          joined_m_(joined_m),
          surfaces_(cells()),
          level_m_(lattice.nx, lattice.ny, kNanF) {
        for (int iy = 0; iy < lattice.ny; ++iy) {
            for (int ix = 0; ix < lattice.nx; ++ix) {
                const Vector2d p = lattice.center_m(ix, iy);
                for (const SurfaceHeight& surface : scene.surfaces_at(p.x(), p.y()))
                    surfaces_[index(ix, iy)].push_back({surface.z_m, false});
            }
        }
    }

    const Image<float>& from(const Eigen::Vector3d& start_m) {
        const Vector2d cell = (start_m.head<2>() - lattice_.origin_m) / lattice_.resolution_m;
        enter(saturated_integer<int>(std::floor(cell.x()), -1),
              saturated_integer<int>(std::floor(cell.y()), -1),
              start_m.z());
        while (!open_.empty()) {
            const Place here = open_.back();
            open_.pop_back();
            for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
                enter(here.ix + dx, here.iy + dy, here.z_m);
        }
        return level_m_;
    }

  private:
    struct Place {
        int ix = 0;
        int iy = 0;
        double z_m = 0.0;
    };
    struct Level {
        double z_m = 0.0;
        bool reached = false;
    };
    [[nodiscard]] std::size_t cells() const {
        return static_cast<std::size_t>(lattice_.nx) * static_cast<std::size_t>(lattice_.ny);
    }
    [[nodiscard]] std::size_t index(int ix, int iy) const {
        return static_cast<std::size_t>(iy) * static_cast<std::size_t>(lattice_.nx) +
               static_cast<std::size_t>(ix);
    }
    void enter(int ix, int iy, double from_z_m) {
        if (!level_m_.contains(ix, iy)) return;
        for (Level& level : surfaces_[index(ix, iy)]) {
            if (level.reached || std::abs(level.z_m - from_z_m) > joined_m_) continue;
            level.reached = true;
            open_.push_back({ix, iy, level.z_m});
            float& highest_m = level_m_.at(ix, iy);
            if (!(static_cast<double>(highest_m) >= level.z_m))
                highest_m = static_cast<float>(level.z_m);
        }
    }

    Lattice lattice_;
    double joined_m_;
    std::vector<std::vector<Level>> surfaces_;
    Image<float> level_m_;
    std::vector<Place> open_;
};

/// Returns the figures of the machine, with its left foot centred on the origin.
rules::Figures foot_figures(const Machine& machine) {
    rules::Figures figures = rules::figures_of(machine, Movement{});
    Rect& foot = figures.feet[0];
    const Vector2d half = 0.5 * (foot.max_m - foot.min_m);
    foot = {-half, half};
    return figures;
}

bool edge_near(const GroundField& field,
               const rules::Figures& figures,
               const PlanarPose& T_field_foot,
               double lowest_m) {
    const Rect& foot = figures.feet[0];
    const Rect band = SweptBox(grown(foot, figures.band_m), T_field_foot, PlanarPose()).bounds();
    const auto range = field.range_of(band);
    for (const GroundField::Tile& tile : field.tiles()) {
        if (tile.lowest_ground_m >= lowest_m) continue;
        const int max_i = std::min(range.max_i, tile.range.max_i);
        const int max_j = std::min(range.max_j, tile.range.max_j);
        for (int j = std::max(range.min_j, tile.range.min_j); j <= max_j; ++j) {
            for (int i = std::max(range.min_i, tile.range.min_i); i <= max_i; ++i) {
                if (field.at(i, j).ground_m >= lowest_m) continue;
                const Vector2d p = T_field_foot.inverse_times(GroundField::point_m(i, j));
                const Vector2d nearest = p.cwiseMax(foot.min_m).cwiseMin(foot.max_m);
                if ((p - nearest).norm() <= figures.band_m + kRounding) return true;
            }
        }
    }
    return false;
}

/// Height of the underside of the lowest solid over the foot.
double ceiling_over(const GroundField& field, const FootGround& under) {
    double ceiling_m = std::numeric_limits<double>::infinity();
    for (const SolePoint& p : under.points)
        ceiling_m = std::min(ceiling_m, field.at(p.i, p.j).underside_m);
    return ceiling_m;
}

CellSafety judge_cell(const GroundField& field,
                      const rules::Figures& figures,
                      const PlanarPose& T_field_foot,
                      double level_m) {
    const Rect& foot = figures.feet[0];
    const FootGround under = ground_under(field, foot, T_field_foot);
    if (under.void_at_m || under.points.empty()) return {false, Danger::no_ground};
    const auto [lowest, highest] = std::minmax_element(
        under.points.begin(), under.points.end(), [](auto& a, auto& b) { return a.z_m < b.z_m; });
    const double drop_m = figures.drop_m + kRounding;
    if (lowest->z_m < level_m - drop_m) return {false, Danger::drop_off};
    // A block under a part of the foot must not raise the reference height for edges.
    const double standing_m = std::min(under.mean_z_m, level_m);
    if (edge_near(field, figures, T_field_foot, standing_m - drop_m))
        return {false, Danger::edge_too_near};
    if (highest->z_m > level_m + drop_m) return {false, Danger::step_up};
    if (under.tilt_rad() > figures.tilt_rad + kRounding) return {false, Danger::tilt};
    const auto patch = under.worst_patch(foot.max_m - foot.min_m, figures.patch_side_m);
    if (patch.residual_m > figures.residual_m + kRounding) return {false, Danger::roughness};
    const double room_m = ceiling_over(field, under) - under.mean_z_m;
    if (room_m < figures.hips_m) return {false, Danger::body_hits};
    if (room_m < figures.height_m - kRounding) return {false, Danger::overhang_too_low};
    return {true, Danger::no_ground};
}

struct Block {
    int min_x = 0;
    int max_x = 0;
    int min_y = 0;
    int max_y = 0;
};

/// Judges one block of cells. The samples are in a frame turned like the foot, with its origin on
/// the first cell.
class BlockJudge {
  public:
    BlockJudge(const Scene& scene,
               const Lattice& lattice,
               const rules::Figures& figures,
               double yaw_rad,
               const Block& block)
        : scene_(scene), lattice_(lattice), figures_(figures), block_(block) {
        const Vector2d first = lattice.center_m(block.min_x, block.min_y);
        T_world_field_ = PlanarPose::of(first.x(), first.y(), yaw_rad);
        Rect cells{Vector2d::Zero(), Vector2d::Zero()};
        for (const int ix : {block.min_x, block.max_x}) {
            for (const int iy : {block.min_y, block.max_y}) {
                const Vector2d p = T_world_field_.inverse_times(lattice.center_m(ix, iy));
                cells.min_m = cells.min_m.cwiseMin(p);
                cells.max_m = cells.max_m.cwiseMax(p);
            }
        }
        const Vector2d around = figures.feet[0].max_m.array() + figures.band_m;
        region_ = {cells.min_m - around, cells.max_m + around};
    }

    void judge(const Image<float>& level_m, Image<CellSafety>& result) {
        for (int iy = block_.min_y; iy <= block_.max_y; ++iy) {
            for (int ix = block_.min_x; ix <= block_.max_x; ++ix) {
                const auto level = static_cast<double>(level_m.at(ix, iy));
                CellSafety& cell = result.at(ix, iy);
                if (std::isnan(level)) {
                    const Vector2d p = lattice_.center_m(ix, iy);
                    const bool ground = scene_.height_at(p.x(), p.y()).has_value();
                    cell = {false, ground ? Danger::disconnected : Danger::no_ground};
                    continue;
                }
                PlanarPose T_field_foot;
                T_field_foot.position_m = T_world_field_.inverse_times(lattice_.center_m(ix, iy));
                cell = judge_cell(field_at(level), figures_, T_field_foot, level);
            }
        }
    }

  private:
    const GroundField& field_at(double level_m) {
        const double level_bin = std::floor(level_m / kLevelBin_m);
        const int bin = saturated_integer<int>(level_bin);
        const auto found = fields_.find(bin);
        if (found != fields_.end()) return found->second;
        const LevelPlane level{kLevelBin_m * (level_bin + 1.0), Vector2d::Zero()};
        return fields_
            .try_emplace(bin, scene_, T_world_field_, region_, level, figures_.lower_edge_m)
            .first->second;
    }

    const Scene& scene_;
    const Lattice& lattice_;
    const rules::Figures& figures_;
    Block block_;
    PlanarPose T_world_field_;
    Rect region_;
    std::map<int, GroundField> fields_;
};

}  // namespace

Image<CellSafety> cell_safety(const Scene& scene,
                              const Machine& machine,
                              const Lattice& lattice,
                              const CellQuestion& question,
                              Executor& executor) {
    Image<CellSafety> result(lattice.nx, lattice.ny);
    if (result.empty()) return result;
    Walk walk(scene, lattice, question.joined_m);
    const Image<float>& level_m = walk.from(question.start_m);
    const rules::Figures figures = foot_figures(machine);
    const int across = (lattice.nx + kBlock - 1) / kBlock;
    const int along = (lattice.ny + kBlock - 1) / kBlock;
    executor.parallel_for(across * along, [&](int index) {
        const int ix = kBlock * (index % across);
        const int iy = kBlock * (index / across);
        const Block block{
            ix, std::min(ix + kBlock, lattice.nx) - 1, iy, std::min(iy + kBlock, lattice.ny) - 1};
        BlockJudge(scene, lattice, figures, question.yaw_rad, block).judge(level_m, result);
    });
    return result;
}

}  // namespace surefoot::sim

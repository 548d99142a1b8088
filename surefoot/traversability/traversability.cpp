// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/traversability.hpp"

#include <algorithm>

#include "surefoot/core/assert.hpp"
#include "surefoot/traversability/combine.hpp"
#include "surefoot/traversability/normals.hpp"
#include "surefoot/traversability/roughness.hpp"
#include "surefoot/traversability/slope.hpp"
#include "surefoot/traversability/step.hpp"

namespace surefoot::traversability {
namespace {

constexpr int kBlockRows = Traversability::kBlockRows;

/// Runs `work(rect)` for blocks of rows of `rect`. The closure that reaches the executor is one
/// reference, so that std::function needs no memory for it.
template <typename Work>
void for_row_blocks(Executor& executor, const CellRect& rect, const Work& work) {
    struct Job {
        const CellRect& rect;
        const Work& work;

        void run(int block) const {
            const int first = block * kBlockRows;
            work(CellRect{
                rect.ix0, rect.iy0 + first, rect.nx, std::min(kBlockRows, rect.ny - first)});
        }
    };
    const Job job{rect, work};
    executor.parallel_for((rect.ny + kBlockRows - 1) / kBlockRows,
                          [&job](int block) { job.run(block); });
}

}  // namespace

void TraversabilityLayers::resize(int nx, int ny) {
    for (grid::Layer* layer :
         {&normal_x, &normal_y, &normal_z, &slope, &step, &roughness, &traversability}) {
        layer->resize(nx, ny);
    }
}

bool TraversabilityLayers::has_size(int nx, int ny) const noexcept {
    const auto fits = [&](const grid::Layer& layer) {
        return layer.width() == nx && layer.height() == ny;
    };
    return fits(normal_x) && fits(normal_y) && fits(normal_z) && fits(slope) && fits(step) &&
           fits(roughness) && fits(traversability);
}

void Traversability::rate(ImageView<const float> height_m,
                          double resolution_m,
                          Executor& executor,
                          TraversabilityLayers& out) {
    rate(height_m, resolution_m, {0, 0, height_m.width, height_m.height}, executor, out);
}

void Traversability::rate(ImageView<const float> height_m,
                          double resolution_m,
                          const CellRect& region,
                          Executor& executor,
                          TraversabilityLayers& out) {
    SUREFOOT_ASSERT(resolution_m > 0.0);
    const int nx = height_m.width;
    const int ny = height_m.height;
    CellRect rect = region.clipped(nx, ny);
    if (!out.has_size(nx, ny)) {
        out.resize(nx, ny);
        rect = {0, 0, nx, ny};
    }
    if (rect.empty()) return;

    const int first_reach = Disc::reach_of(config_.step.first_radius_m, resolution_m);
    const int second_reach = Disc::reach_of(config_.step.second_radius_m, resolution_m);
    const int height_margin = std::max({Disc::reach_of(config_.normals.radius_m, resolution_m),
                                        first_reach,
                                        Disc::reach_of(config_.roughness.radius_m, resolution_m)});
    height_.reset(nx, ny, height_margin);
    step_height_.reset(nx, ny, second_reach);
    normals_disc_.build(config_.normals.radius_m, resolution_m, height_.stride());
    first_step_disc_.build(config_.step.first_radius_m, resolution_m, height_.stride());
    roughness_disc_.build(config_.roughness.radius_m, resolution_m, height_.stride());
    second_step_disc_.build(config_.step.second_radius_m, resolution_m, step_height_.stride());

    // Step heights are needed as far as the second disc reaches around the cells to be rated,
    // heights as far as the first disc reaches around those.
    const CellRect wide = rect.grown(second_reach).clipped(nx, ny);
    height_.load(height_m, wide.grown(height_margin).clipped(nx, ny));
    for_row_blocks(executor, wide, [&](const CellRect& block) {
        step_heights(height_, first_step_disc_, block, step_height_);
    });
    for_row_blocks(executor, rect, [&](const CellRect& block) {
        normals(height_, normals_disc_, block, out.normal_x, out.normal_y, out.normal_z);
        rate_slope(config_.slope, out.normal_z, block, out.slope);
        rate_step(config_.step, step_height_, second_step_disc_, block, out.step);
        rate_roughness(config_.roughness,
                       height_,
                       roughness_disc_,
                       out.normal_x,
                       out.normal_y,
                       out.normal_z,
                       block,
                       out.roughness);
        combine(config_.combine,
                config_.weights,
                out.slope,
                out.step,
                out.roughness,
                block,
                out.traversability);
    });
}

CellRect Traversability::affected_by(const CellRect& changed, double resolution_m) const noexcept {
    const int step_reach = Disc::reach_of(config_.step.first_radius_m, resolution_m) +
                           Disc::reach_of(config_.step.second_radius_m, resolution_m);
    return changed.grown(std::max({step_reach,
                                   Disc::reach_of(config_.normals.radius_m, resolution_m),
                                   Disc::reach_of(config_.roughness.radius_m, resolution_m)}));
}

void rate(const TraversabilityConfig& config,
          ImageView<const float> height_m,
          double resolution_m,
          Executor& executor,
          TraversabilityLayers& out) {
    Traversability(config).rate(height_m, resolution_m, executor, out);
}

}  // namespace surefoot::traversability

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/traversability.hpp"

#include <algorithm>

#include "surefoot/core/assert.hpp"
#include "surefoot/traversability/combine.hpp"
#include "surefoot/traversability/combine_rows.hpp"
#include "surefoot/traversability/normals.hpp"
#include "surefoot/traversability/roughness.hpp"
#include "surefoot/traversability/slope.hpp"
#include "surefoot/traversability/step.hpp"
#include "surefoot/traversability/step_rows.hpp"

namespace surefoot::traversability {
namespace {

constexpr int kBlockRows = Traversability::kBlockRows;

int blocks_of(const CellRect& rect) {
    return (rect.ny + kBlockRows - 1) / kBlockRows;
}

/// Runs `work(index, rect)` for blocks of rows of `rect`. The closure for the executor is a single
/// reference, so std::function needs no memory for it.
template <typename Work>
void for_row_blocks(Executor& executor, const CellRect& rect, const Work& work) {
    struct Job {
        const CellRect& rect;
        const Work& work;

        void run(int block) const {
            const int first = block * kBlockRows;
            work(static_cast<std::size_t>(block),
                 CellRect{
                     rect.ix0, rect.iy0 + first, rect.nx, std::min(kBlockRows, rect.ny - first)});
        }
    };
    const Job job{rect, work};
    executor.parallel_for(blocks_of(rect), [&job](int block) { job.run(block); });
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
    // Needs step heights within the second disc around the rated cells, and heights within the
    // first disc around these step heights.
    const CellRect wide = rect.grown(second_reach).clipped(nx, ny);
    const CellRect read = wide.grown(height_margin).clipped(nx, ny);
    height_.reset(read, height_margin);
    height_.load(height_m, read);
    step_height_.reset(wide, second_reach);
    if (way_ == Way::fast && fast_can(resolution_m)) {
        rate_fast(resolution_m, wide, rect, executor, out);
    } else {
        rate_plainly(resolution_m, wide, rect, executor, out);
    }
}

bool Traversability::fast_can(double resolution_m) const noexcept {
    const auto reach = [&](double radius_m) { return Disc::reach_of(radius_m, resolution_m); };
    const auto within = [](int cells) { return cells <= DiscRuns::kMaxReach; };
    return reach(config_.normals.radius_m) > 0 && reach(config_.step.first_radius_m) > 0 &&
           within(reach(config_.normals.radius_m)) && within(reach(config_.roughness.radius_m)) &&
           within(reach(config_.step.first_radius_m)) &&
           within(reach(config_.step.second_radius_m));
}

void Traversability::rate_fast(double resolution_m,
                               const CellRect& wide,
                               const CellRect& rect,
                               Executor& executor,
                               TraversabilityLayers& out) {
    normals_disc_.build(config_.normals.radius_m, resolution_m, height_.stride());
    surface_runs_.build(
        resolution_m,
        {{config_.normals.radius_m, normals_runs_}, {config_.roughness.radius_m, roughness_runs_}});
    first_runs_.build(resolution_m, {{config_.step.first_radius_m, first_step_runs_}});
    second_runs_.build(resolution_m, {{config_.step.second_radius_m, second_step_runs_}});
    const std::size_t step_ring = std::max(first_runs_.kept_runs(), second_runs_.kept_runs());
    const std::size_t surface_ring = surface_runs_.kept_runs();
    const auto blocks = static_cast<std::size_t>(blocks_of(wide));
    step_rings_.resize(std::max(step_rings_.size(), blocks * step_ring));
    surface_rings_.resize(std::max(surface_rings_.size(), blocks * surface_ring));

    for_row_blocks(executor, wide, [&](std::size_t index, const CellRect& block) {
        rows::step_heights(height_,
                           first_runs_,
                           first_step_runs_,
                           block,
                           step_rings_.data() + index * step_ring,
                           step_height_);
    });
    const rows::Surface surface{height_,
                                resolution_m,
                                surface_runs_,
                                normals_runs_,
                                roughness_runs_,
                                normals_disc_,
                                config_.slope,
                                config_.roughness};
    for_row_blocks(executor, rect, [&](std::size_t index, const CellRect& block) {
        rows::rate_step(config_.step,
                        step_height_,
                        second_runs_,
                        second_step_runs_,
                        block,
                        step_rings_.data() + index * step_ring,
                        out.step);
        rows::rate_surface(surface,
                           block,
                           surface_rings_.data() + index * surface_ring,
                           {out.normal_x, out.normal_y, out.normal_z, out.slope, out.roughness});
        rows::combine(config_.combine,
                      config_.weights,
                      out.slope,
                      out.step,
                      out.roughness,
                      block,
                      out.traversability);
    });
}

void Traversability::rate_plainly(double resolution_m,
                                  const CellRect& wide,
                                  const CellRect& rect,
                                  Executor& executor,
                                  TraversabilityLayers& out) {
    normals_disc_.build(config_.normals.radius_m, resolution_m, height_.stride());
    first_step_disc_.build(config_.step.first_radius_m, resolution_m, height_.stride());
    roughness_disc_.build(config_.roughness.radius_m, resolution_m, height_.stride());
    second_step_disc_.build(config_.step.second_radius_m, resolution_m, step_height_.stride());
    for_row_blocks(executor, wide, [&](std::size_t, const CellRect& block) {
        step_heights(height_, first_step_disc_, block, step_height_);
    });
    for_row_blocks(executor, rect, [&](std::size_t, const CellRect& block) {
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

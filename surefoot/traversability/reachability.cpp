// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/reachability.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::traversability {
namespace {

constexpr double kTenthMmPerM = 1e4;
/// Far below all heights, so no allowed step leads there.
constexpr std::int32_t kUnknown = -1'000'000'000;
constexpr std::int32_t kNobody = -1;
constexpr int kNeighbours = 4;

/// Rounds a height within kHighest_m, or a step of at most 1 m (see TraversabilityConfig::Reach),
/// to 0.1 mm.
std::int32_t tenth_mm(double length_m) noexcept {
    const double scaled = length_m * kTenthMmPerM;
    // in range: at most 10^7
    return static_cast<std::int32_t>(scaled < 0.0 ? scaled - 0.5 : scaled + 0.5);
}

}  // namespace

Reachability::Reachability(const TraversabilityConfig::Reach& config)
    : stance_radius_m_(config.stance_radius_m),
      max_step_(tenth_mm(config.max_step_m)),
      bucket_(static_cast<std::size_t>(max_step_) + 1 + kNeighbours, kNobody) {}

Stance Reachability::reach(const grid::GridGeometry& geometry,
                           ImageView<const float> height_m,
                           const Eigen::Vector2d& body_m,
                           grid::Layer& reach_step_m) {
    SUREFOOT_ASSERT(height_m.width == geometry.nx && height_m.height == geometry.ny);
    load(height_m);
    const Stance stance = find_stance(geometry, body_m);
    spread();
    write(reach_step_m);
    return stance;
}

void Reachability::load(ImageView<const float> height_m) {
    nx_ = height_m.width;
    ny_ = height_m.height;
    stride_ = nx_ + 2;
    const std::size_t cells = index(-1, ny_ + 1);
    // A value above every allowed step means "not reached".
    cells_.assign(cells, {kUnknown, max_step_ + 1});
    // A cell is visited once. Then it adds each neighbour to a bucket at most once.
    waiting_.resize((kNeighbours + 1) * cells);
    stance_.clear();
    stance_.reserve(cells);
    sorted_.reserve(cells);
    distance_m_.reserve(cells);
    for (int iy = 0; iy < ny_; ++iy) {
        const float* from = height_m.row(iy);
        Cell* to = cells_.data() + index(0, iy);
        for (int ix = 0; ix < nx_; ++ix) {
            const double z_m = static_cast<double>(from[ix]);
            to[ix].height = std::abs(z_m) <= kHighest_m ? tenth_mm(z_m) : kUnknown;
        }
    }
}

Stance Reachability::find_stance(const grid::GridGeometry& geometry,
                                 const Eigen::Vector2d& body_m) {
    Stance stance{.radius_m = stance_radius_m_};
    if (!body_m.allFinite()) return stance;
    gather(geometry, body_m, stance.radius_m);
    if (stance_.size() < kStanceCells) {
        stance.radius_m += distance_of_nearest(geometry, body_m);
        gather(geometry, body_m, stance.radius_m);
    }
    if (stance_.empty()) return stance;
    const std::int32_t lowest = lowest_surface();
    const std::int32_t highest = lowest + tenth_mm(kSurface_m);
    std::erase_if(stance_, [&](std::int32_t cell) {
        const std::int32_t height = cells_[static_cast<std::size_t>(cell)].height;
        return height < lowest || height > highest;
    });
    stance.cells = static_cast<int>(stance_.size());
    stance.lowest_m = lowest / kTenthMmPerM;
    return stance;
}

double Reachability::distance_of_nearest(const grid::GridGeometry& geometry,
                                         const Eigen::Vector2d& body_m) {
    distance_m_.clear();
    for (int iy = 0; iy < ny_; ++iy) {
        for (int ix = 0; ix < nx_; ++ix) {
            if (cells_[index(ix, iy)].height == kUnknown) continue;
            distance_m_.push_back((geometry.center_m({ix, iy}) - body_m).norm());
        }
    }
    if (distance_m_.empty()) return 0.0;
    const auto wanted = std::min<std::size_t>(kStanceCells, distance_m_.size());
    const auto last = distance_m_.begin() + static_cast<std::ptrdiff_t>(wanted) - 1;
    std::nth_element(distance_m_.begin(), last, distance_m_.end());
    return *last;
}

void Reachability::gather(const grid::GridGeometry& geometry,
                          const Eigen::Vector2d& body_m,
                          double radius_m) {
    stance_.clear();
    const Eigen::Vector2d middle = (body_m - geometry.origin_m) / geometry.resolution_m;
    const double reach = radius_m / geometry.resolution_m + 1.0;
    const auto clamped = [](double at, int n) { return clamped_integer<int>(at, 0, n); };
    const int last_ix = clamped(middle.x() + reach, nx_);
    const int last_iy = clamped(middle.y() + reach, ny_);
    for (int iy = clamped(middle.y() - reach, ny_); iy < last_iy; ++iy) {
        for (int ix = clamped(middle.x() - reach, nx_); ix < last_ix; ++ix) {
            if (cells_[index(ix, iy)].height == kUnknown) continue;
            const Eigen::Vector2d way_m = geometry.center_m({ix, iy}) - body_m;
            if (way_m.squaredNorm() > radius_m * radius_m) continue;
            stance_.push_back(static_cast<std::int32_t>(index(ix, iy)));
        }
    }
}

std::int32_t Reachability::lowest_surface() {
    sorted_.clear();
    for (const std::int32_t cell : stance_)
        sorted_.push_back(cells_[static_cast<std::size_t>(cell)].height);
    std::sort(sorted_.begin(), sorted_.end());
    const std::size_t wanted = (sorted_.size() + 3) / 4;
    const std::int32_t surface = tenth_mm(kSurface_m);
    std::size_t fullest = 0;
    std::size_t most = 0;
    std::size_t end = 0;  // index of the first height above the surface that begins at `begin`
    for (std::size_t begin = 0; begin < sorted_.size(); ++begin) {
        while (end < sorted_.size() && sorted_[end] <= sorted_[begin] + surface) ++end;
        if (end - begin >= wanted) return sorted_[begin];
        if (end - begin > most) {
            most = end - begin;
            fullest = begin;
        }
    }
    return sorted_[fullest];
}

void Reachability::spread() {
    std::fill(bucket_.begin(), bucket_.end(), kNobody);
    std::int32_t waiting = 0;
    for (const std::int32_t cell : stance_) {
        cells_[static_cast<std::size_t>(cell)].step = 0;
        waiting_[static_cast<std::size_t>(waiting)] = {cell, bucket_[0]};
        bucket_[0] = waiting++;
    }
    for (std::int32_t step = 0; step <= max_step_; ++step) {
        std::int32_t& first = bucket_[static_cast<std::size_t>(step)];
        while (first != kNobody) {
            const Waiting entry = waiting_[static_cast<std::size_t>(first)];
            first = entry.next;
            // The cell of an entry with another step is done: it was visited over a smaller step.
            if (cells_[static_cast<std::size_t>(entry.cell)].step == step) {
                waiting = visit(entry.cell, step, waiting);
            }
        }
    }
}

std::int32_t Reachability::visit(std::int32_t cell, std::int32_t step, std::int32_t waiting) {
    // No branches, because noise would make them unpredictable. A neighbour that gains nothing is
    // written to a slot that the next neighbour overwrites.
    Cell* const cells = cells_.data();
    Waiting* const places = waiting_.data();
    std::int32_t* const buckets = bucket_.data();
    const std::int32_t end = max_step_ + 1;
    const std::int32_t height = cells[cell].height;
    const auto look = [&](std::int32_t other, std::int32_t nobodys) {
        const std::int32_t needed = std::max(step, std::abs(cells[other].height - height));
        const std::int32_t least = cells[other].step;
        const std::int32_t gains = needed < least ? 1 : 0;
        const std::int32_t bucket = nobodys + (needed - nobodys) * gains;
        cells[other].step = std::min(needed, least);
        places[waiting] = {other, buckets[bucket]};
        buckets[bucket] = waiting;
        waiting += gains;
    };
    look(cell - 1, end);
    look(cell + 1, end + 1);
    look(cell - stride_, end + 2);
    look(cell + stride_, end + 3);
    return waiting;
}

void Reachability::write(grid::Layer& reach_step_m) const {
    reach_step_m.resize(nx_, ny_);
    for (int iy = 0; iy < ny_; ++iy) {
        const Cell* from = cells_.data() + index(0, iy);
        float* to = reach_step_m.row(iy);
        for (int ix = 0; ix < nx_; ++ix) {
            to[ix] = from[ix].step > max_step_ ? kNanF
                                               : static_cast<float>(from[ix].step / kTenthMmPerM);
        }
    }
}

}  // namespace surefoot::traversability

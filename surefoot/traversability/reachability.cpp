// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/reachability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/assert.hpp"

namespace surefoot::traversability {
namespace {

constexpr double kTenthMmPerM = 1e4;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
/// So far below all heights that no step leads there.
constexpr std::int32_t kUnknown = -1'000'000'000;
constexpr std::int32_t kNotReached = std::numeric_limits<std::int32_t>::max();
constexpr std::int32_t kNobody = -1;
constexpr int kNeighbours = 4;

std::int32_t tenth_mm(double length_m) noexcept {
    const double scaled = length_m * kTenthMmPerM;
    return static_cast<std::int32_t>(scaled < 0.0 ? scaled - 0.5 : scaled + 0.5);
}

}  // namespace

Reachability::Reachability(const TraversabilityConfig::Reach& config)
    : stance_radius_m_(config.stance_radius_m),
      max_step_(tenth_mm(config.max_step_m)),
      bucket_(static_cast<std::size_t>(max_step_) + 1, kNobody) {}

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
    height_.assign(cells, kUnknown);
    step_.assign(cells, kNotReached);
    // A cell is visited once, and then sends each neighbour to wait at most once.
    stack_.resize(cells);
    waiting_.resize(kNeighbours * cells);
    stance_.clear();
    stance_.reserve(cells);
    sorted_.reserve(cells);
    distance_m_.reserve(cells);
    for (int iy = 0; iy < ny_; ++iy) {
        const float* from = height_m.row(iy);
        std::int32_t* to = height_.data() + index(0, iy);
        for (int ix = 0; ix < nx_; ++ix) {
            const double z_m = static_cast<double>(from[ix]);
            to[ix] = std::abs(z_m) <= kHighest_m ? tenth_mm(z_m) : kUnknown;
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
        const std::int32_t height = height_[static_cast<std::size_t>(cell)];
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
            if (height_[index(ix, iy)] == kUnknown) continue;
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
    for (int iy = 0; iy < ny_; ++iy) {
        for (int ix = 0; ix < nx_; ++ix) {
            if (height_[index(ix, iy)] == kUnknown) continue;
            const Eigen::Vector2d way_m = geometry.center_m({ix, iy}) - body_m;
            if (way_m.squaredNorm() > radius_m * radius_m) continue;
            stance_.push_back(static_cast<std::int32_t>(index(ix, iy)));
        }
    }
}

std::int32_t Reachability::lowest_surface() {
    sorted_.clear();
    for (const std::int32_t cell : stance_)
        sorted_.push_back(height_[static_cast<std::size_t>(cell)]);
    std::sort(sorted_.begin(), sorted_.end());
    const std::size_t wanted = (sorted_.size() + 3) / 4;
    const std::int32_t surface = tenth_mm(kSurface_m);
    std::size_t fullest = 0;
    std::size_t most = 0;
    std::size_t end = 0;  // first that is above the surface that begins at `begin`
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
    Front front;
    for (const std::int32_t cell : stance_) {
        step_[static_cast<std::size_t>(cell)] = 0;
        stack_[front.open++] = cell;
    }
    for (std::int32_t step = 0; step <= max_step_; ++step) {
        for (std::int32_t i = bucket_[static_cast<std::size_t>(step)]; i != kNobody;) {
            const Waiting& entry = waiting_[static_cast<std::size_t>(i)];
            // Others have been reached over a smaller step since, and visited.
            if (step_[static_cast<std::size_t>(entry.cell)] == step) {
                stack_[front.open++] = entry.cell;
            }
            i = entry.next;
        }
        while (front.open > 0) visit(stack_[--front.open], step, front);
    }
}

void Reachability::visit(std::int32_t cell, std::int32_t step, Front& front) {
    const std::int32_t height = height_[static_cast<std::size_t>(cell)];
    for (const std::int32_t other : {cell - 1, cell + 1, cell - stride_, cell + stride_}) {
        const std::int32_t rise = std::abs(height_[static_cast<std::size_t>(other)] - height);
        const std::int32_t needed = std::max(step, rise);
        std::int32_t& least = step_[static_cast<std::size_t>(other)];
        if (needed >= least || needed > max_step_) continue;
        least = needed;
        if (needed == step) {
            stack_[front.open++] = other;
        } else {
            std::int32_t& first = bucket_[static_cast<std::size_t>(needed)];
            waiting_[front.waiting] = {other, first};
            first = static_cast<std::int32_t>(front.waiting++);
        }
    }
}

void Reachability::write(grid::Layer& reach_step_m) const {
    reach_step_m.resize(nx_, ny_);
    for (int iy = 0; iy < ny_; ++iy) {
        const std::int32_t* from = step_.data() + index(0, iy);
        float* to = reach_step_m.row(iy);
        for (int ix = 0; ix < nx_; ++ix) {
            to[ix] = from[ix] == kNotReached ? kNaN : static_cast<float>(from[ix] / kTenthMmPerM);
        }
    }
}

}  // namespace surefoot::traversability

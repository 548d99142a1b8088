// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/cell_groups.hpp"

#include <cmath>

#include "surefoot/core/assert.hpp"
#include "surefoot/elevation/fusion/group_samples.hpp"

namespace surefoot::elevation {

void CellSamples::reset(int blocks, std::size_t most) {
    stride_ = most + kSlack;
    counts_.assign(static_cast<std::size_t>(blocks), 0);
    const std::size_t all = stride_ * counts_.size();
    if (all <= cell_.size()) return;
    cell_.resize(all);
    z_m_.resize(all);
    var_m2_.resize(all);
}

CellSamples::Columns CellSamples::columns(int block) noexcept {
    const std::size_t begin = stride_ * static_cast<std::size_t>(block);
    return {cell_.data() + begin, z_m_.data() + begin, var_m2_.data() + begin};
}

void CellSamples::set_count(int block, std::size_t count) noexcept {
    SUREFOOT_ASSERT(count + kSlack <= stride_);
    counts_[static_cast<std::size_t>(block)] = count;
}

CellSamples::Block CellSamples::block(int block) const noexcept {
    const auto index = static_cast<std::size_t>(block);
    const std::size_t begin = stride_ * index;
    const std::size_t count = counts_[index];
    return {{cell_.data() + begin, count},
            {z_m_.data() + begin, count},
            {var_m2_.data() + begin, count}};
}

std::int64_t samples_from_points(std::span<const GridPoint> points,
                                 const grid::GridGeometry& geometry,
                                 CellSamples& samples) {
    const auto per_m = static_cast<float>(1.0 / geometry.resolution_m);
    const auto nx = static_cast<float>(geometry.nx);
    const auto ny = static_cast<float>(geometry.ny);
    samples.reset(1, points.size());
    const CellSamples::Columns to = samples.columns(0);
    std::size_t count = 0;
    for (const GridPoint& point : points) {
        const float fx = point.x_m * per_m;
        const float fy = point.y_m * per_m;
        if (!(fx >= 0.0F && fy >= 0.0F && fx < nx && fy < ny)) continue;  // NaN is outside
        if (!std::isfinite(point.z_m) || !std::isfinite(point.var_m2)) continue;
        // in range: 0 <= fx < nx and 0 <= fy < ny, as checked above
        to.cell[count] = static_cast<std::uint32_t>(fy) * static_cast<std::uint32_t>(geometry.nx) +
                         static_cast<std::uint32_t>(fx);  // in range: as fy
        to.z_m[count] = point.z_m;
        to.var_m2[count] = point.var_m2;
        ++count;
    }
    samples.set_count(0, count);
    return static_cast<std::int64_t>(points.size() - count);
}

void CellGroups::assign(const CellSamples& samples, std::size_t cells) {
    // The counts of cell c go to index c + 2, so the running sums put its begin at index c + 1.
    // Placing the samples of a cell moves this begin to the end of the cell, which is the begin of
    // the next cell.
    begin_.assign(cells + 2, 0);
    for (int b = 0; b < samples.blocks(); ++b) {
        const CellSamples::Block from = samples.block(b);
        count_samples(from.cell.data(), from.cell.size(), begin_.data() + 2);
    }
    std::uint32_t total = 0;
    for (std::uint32_t& begin : begin_) begin = total += begin;
    if (z_m_.size() < total + kSlack) {
        z_m_.resize(total + kSlack);
        var_m2_.resize(total + kSlack);
    }
    for (int b = 0; b < samples.blocks(); ++b) {
        const CellSamples::Block from = samples.block(b);
        place_samples(from.cell.data(),
                      from.z_m.data(),
                      from.var_m2.data(),
                      from.cell.size(),
                      {begin_.data() + 1, z_m_.data(), var_m2_.data()});
    }
}

}  // namespace surefoot::elevation

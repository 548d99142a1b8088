// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/classes/planar_patches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/grid/whole_cells.hpp"
#include "surefoot/stairs/edges/slice_mean.hpp"

namespace surefoot::stairs {
namespace {

/// The square of this sigma is added to the variance of each cell, so that no weight is infinite.
constexpr double kLeastSigma_m = 0.005;
/// One sigma of the prior slope of ground. Noise in nine cells must not create a slope.
constexpr double kSlopeSigma = 0.1;
/// A block lies on a plane if the weighted rms of its residuals is at most this share of the
/// tolerance of a cell.
constexpr double kBlockShare = 0.7;
constexpr int kQualities = 32;
constexpr double kQualityStep_m = 0.002;
constexpr int kBorderRounds = 2;
constexpr std::int32_t kNone = PatchMap::kNone;

double square(double value) {
    return value * value;
}

}  // namespace

void PatchConfig::describe(ConfigVisitor& visitor) {
    visitor.number("block_m",
                   block_m,
                   0.005,
                   1.0,
                   "side length of the blocks of cells to which planes are fitted");
    visitor.number("tolerance_m",
                   tolerance_m,
                   0.001,
                   0.2,
                   "distance from a plane within which every cell belongs to the plane, even if "
                   "its sigma is small");
    visitor.number("sigma_factor",
                   sigma_factor,
                   0.0,
                   10.0,
                   "distance from a plane within which a cell with a large sigma belongs to the "
                   "plane, as a multiple of "
                   "this sigma");
    visitor.number(
        "max_tolerance_m",
        max_tolerance_m,
        0.001,
        0.5,
        "largest distance of any cell from its plane, even if the sigma of the cell is very large");
    visitor.number("min_area_m2", min_area_m2, 0.0, 10.0, "smallest area of a planar patch");
}

std::optional<std::string> PatchConfig::problem() const {
    if (tolerance_m <= max_tolerance_m) return std::nullopt;
    return fmt::format(
        "stairs.patches.tolerance_m {} must not be above stairs.patches.max_tolerance_m {}",
        tolerance_m,
        max_tolerance_m);
}

void PatchFinder::Sums::add(const Sums& other) {
    w += other.w;
    x += other.x;
    y += other.y;
    z += other.z;
    xx += other.xx;
    xy += other.xy;
    yy += other.yy;
    xz += other.xz;
    yz += other.yz;
    zz += other.zz;
    cells += other.cells;
}

PatchFinder::Plane PatchFinder::fit(const Sums& s) {
    const double x = s.x / s.w, y = s.y / s.w, z = s.z / s.w;
    constexpr double kPrior = 1.0 / (kSlopeSigma * kSlopeSigma);
    const double a = s.xx - s.w * x * x + kPrior;
    const double b = s.xy - s.w * x * y;
    const double c = s.yy - s.w * y * y + kPrior;
    const double p = s.xz - s.w * x * z;
    const double q = s.yz - s.w * y * z;
    const double determinant = a * c - b * b;
    const double gx = (c * p - b * q) / determinant;
    const double gy = (a * q - b * p) / determinant;
    return {z - gx * x - gy * y, gx, gy};
}

double PatchFinder::mean_square_m2(const Sums& s, const Plane& plane) {
    const double c = plane.at_0_m, gx = plane.gx, gy = plane.gy;
    const double sum = s.zz + c * c * s.w + gx * gx * s.xx + gy * gy * s.yy -
                       2.0 * (c * s.z + gx * s.xz + gy * s.yz) +
                       2.0 * (c * gx * s.x + c * gy * s.y + gx * gy * s.xy);
    return std::max(0.0, sum / s.w);
}

bool PatchFinder::lies_on(const Sums& sums, const Plane& plane) const {
    const double var_m2 = sums.cells / sums.w - square(kLeastSigma_m);  // variance of the cells
    const double within_m2 = std::clamp(square(config_.sigma_factor) * var_m2,
                                        square(config_.tolerance_m),
                                        square(config_.max_tolerance_m));
    return mean_square_m2(sums, plane) <= square(kBlockShare) * within_m2;
}

void PatchFinder::find(const Terrain& terrain, PatchMap& out) {
    const grid::GridGeometry& grid = terrain.geometry;
    block_cells_ = std::max(2, grid::whole_cells(std::round(config_.block_m / grid.resolution_m)));
    nbx_ = (grid.nx + block_cells_ - 1) / block_cells_;
    nby_ = (grid.ny + block_cells_ - 1) / block_cells_;
    middle_m_ = grid.origin_m + 0.5 * grid.resolution_m * Eigen::Vector2d(grid.nx, grid.ny);
    out.block_cells = block_cells_;
    out.origin_m = grid.origin_m;
    out.block_m = block_cells_ * grid.resolution_m;
    out.of_block.resize(nbx_, nby_);
    out.of_block.fill(kNone);
    out.of_cell.resize(grid.nx, grid.ny);
    sum_blocks(terrain);
    order_seeds();
    grow_all(out);
    // The plane of a region that began beside another surface is tilted until its border is
    // correct.
    for (int round = 0; round < kBorderRounds; ++round) {
        join_regions(out);
        settle_borders(out);
        refit(out);
    }
    join_regions(out);
    drop_small(square(grid.resolution_m), out);
    assign_cells(terrain, out);
    measure(terrain, out);
}

void PatchFinder::sum_blocks(const Terrain& terrain) {
    const grid::GridGeometry& grid = terrain.geometry;
    const double cell_m = grid.resolution_m;
    blocks_.assign(static_cast<std::size_t>(nbx_) * static_cast<std::size_t>(nby_), Sums{});
    Sums* out = blocks_.data();
    for (int by = 0; by < nby_; ++by) {
        const int end_iy = std::min(grid.ny, (by + 1) * block_cells_);
        for (int bx = 0; bx < nbx_; ++bx, ++out) {
            const int begin_ix = bx * block_cells_;
            const int end_ix = std::min(grid.nx, begin_ix + block_cells_);
            Sums s;  // x and y in cells from the first cell of the block
            for (int iy = by * block_cells_; iy < end_iy; ++iy) {
                const float* height_m = terrain.height_m.row(iy);
                const float* var_m2 =
                    terrain.height_var_m2.empty() ? nullptr : terrain.height_var_m2.row(iy);
                const double y = iy - by * block_cells_;
                for (int ix = begin_ix; ix < end_ix; ++ix) {
                    const auto z = static_cast<double>(height_m[ix]);
                    if (!(z == z)) continue;
                    const double known_m2 =
                        var_m2 == nullptr ? 0.0 : static_cast<double>(var_m2[ix]);
                    const double w = 1.0 / (known_m2 + square(kLeastSigma_m));
                    const double x = ix - begin_ix;
                    s.w += w;
                    s.x += w * x;
                    s.y += w * y;
                    s.z += w * z;
                    s.xx += w * x * x;
                    s.xy += w * x * y;
                    s.yy += w * y * y;
                    s.xz += w * x * z;
                    s.yz += w * y * z;
                    s.zz += w * z * z;
                    s.cells += 1.0;
                }
            }
            if (s.cells == 0.0) continue;
            const Eigen::Vector2d first_m =
                grid.center_m({begin_ix, by * block_cells_}) - middle_m_;
            const double x0 = first_m.x(), y0 = first_m.y(), r = cell_m;
            out->w = s.w;
            out->x = x0 * s.w + r * s.x;
            out->y = y0 * s.w + r * s.y;
            out->z = s.z;
            out->xx = x0 * x0 * s.w + 2.0 * x0 * r * s.x + r * r * s.xx;
            out->xy = x0 * y0 * s.w + r * (x0 * s.y + y0 * s.x) + r * r * s.xy;
            out->yy = y0 * y0 * s.w + 2.0 * y0 * r * s.y + r * r * s.yy;
            out->xz = x0 * s.z + r * s.xz;
            out->yz = y0 * s.z + r * s.yz;
            out->zz = s.zz;
            out->cells = s.cells;
        }
    }
}

PatchFinder::Sums PatchFinder::around(int bx, int by) const {
    Sums sums;
    for (int y = std::max(0, by - 1); y <= std::min(nby_ - 1, by + 1); ++y)
        for (int x = std::max(0, bx - 1); x <= std::min(nbx_ - 1, bx + 1); ++x)
            sums.add(blocks_[static_cast<std::size_t>(y * nbx_ + x)]);
    return sums;
}

/// Sorts the seeds: first blocks that lie on one plane with the blocks around them, then the other
/// blocks. In both groups the flattest blocks come first. A block with less than half of its cells
/// known is no seed.
void PatchFinder::order_seeds() {
    const std::size_t count = blocks_.size();
    quality_.assign(count, 0);
    start_.resize(count);
    seeds_.resize(count);
    std::array<std::int32_t, kQualities + 1> begin{};
    const double least_cells = 0.5 * block_cells_ * block_cells_;
    for (std::size_t i = 0; i < count; ++i) {
        const Sums& own = blocks_[i];
        if (own.cells < least_cells) {
            quality_[i] = kQualities;
            continue;
        }
        const Sums sums = around(static_cast<int>(i) % nbx_, static_cast<int>(i) / nbx_);
        start_[i] = fit(sums);
        int quality = 0;
        double square_m2 = mean_square_m2(sums, start_[i]);
        if (!lies_on(sums, start_[i])) {
            start_[i] = fit(own);
            square_m2 = mean_square_m2(own, start_[i]);
            quality = kQualities / 2;
        }
        quality +=
            std::min(kQualities / 2 - 1,
                     saturated_integer<int>(std::sqrt(square_m2) / kQualityStep_m, kQualities));
        quality_[i] = static_cast<std::uint8_t>(quality);
        ++begin[static_cast<std::size_t>(quality) + 1];
    }
    for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
    seeds_.resize(static_cast<std::size_t>(begin.back()));
    for (std::size_t i = 0; i < count; ++i) {
        if (quality_[i] == kQualities) continue;
        seeds_[static_cast<std::size_t>(begin[quality_[i]]++)] = static_cast<std::int32_t>(i);
    }
}

void PatchFinder::grow_all(PatchMap& out) {
    regions_.clear();
    regions_.reserve(blocks_.size());
    waiting_.reserve(blocks_.size());
    for (const std::int32_t seed : seeds_) {
        if (out.of_block.data()[seed] != kNone) continue;
        const Sums& own = blocks_[static_cast<std::size_t>(seed)];
        Plane start = start_[static_cast<std::size_t>(seed)];
        if (!lies_on(own, start)) start = fit(own);
        if (lies_on(own, start)) grow(seed, start, out);
    }
}

void PatchFinder::grow(std::int32_t seed, const Plane& start, PatchMap& out) {
    /// Number of blocks up to which a region uses the plane of its seed.
    constexpr double kFirstBlocks = 4.0;
    constexpr double kMore = 1.5;
    const auto id = static_cast<std::int32_t>(regions_.size());
    Region region{{}, start};
    std::int32_t* const of_block = out.of_block.data();
    double refit_at = kFirstBlocks * block_cells_ * block_cells_;
    waiting_.clear();
    const auto take = [&](std::int32_t block) {
        of_block[block] = id;
        region.sums.add(blocks_[static_cast<std::size_t>(block)]);
        waiting_.push_back(block);
    };
    take(seed);
    for (std::size_t next = 0; next < waiting_.size(); ++next) {
        const std::int32_t block = waiting_[next];
        const int bx = block % nbx_, by = block / nbx_;
        const auto observation = [&](bool inside, std::int32_t other) {
            if (!inside || of_block[other] != kNone) return;
            const Sums& sums = blocks_[static_cast<std::size_t>(other)];
            if (sums.cells > 0.0 && lies_on(sums, region.plane)) take(other);
        };
        observation(bx > 0, block - 1);
        observation(bx + 1 < nbx_, block + 1);
        observation(by > 0, block - nbx_);
        observation(by + 1 < nby_, block + nbx_);
        if (region.sums.cells >= refit_at) {
            region.plane = fit(region.sums);
            refit_at = kMore * region.sums.cells;
        }
    }
    region.plane = fit(region.sums);
    regions_.push_back(region);
}

/// Joins two neighbouring regions if the smaller region lies on the plane of the larger region.
void PatchFinder::join_regions(PatchMap& out) {
    joined_to_.resize(regions_.size());
    for (std::size_t i = 0; i < joined_to_.size(); ++i)
        joined_to_[i] = static_cast<std::int32_t>(i);
    const auto root = [&](std::int32_t id) {
        while (joined_to_[static_cast<std::size_t>(id)] != id)
            id = joined_to_[static_cast<std::size_t>(id)];
        return id;
    };
    const auto meet = [&](std::int32_t one, std::int32_t other) {
        if (one == kNone || other == kNone || one == other) return;
        one = root(one);
        other = root(other);
        if (one == other) return;
        if (regions_[static_cast<std::size_t>(one)].sums.cells <
            regions_[static_cast<std::size_t>(other)].sums.cells)
            std::swap(one, other);
        Region& large = regions_[static_cast<std::size_t>(one)];
        const Region& small = regions_[static_cast<std::size_t>(other)];
        if (!lies_on(small.sums, large.plane)) return;
        large.sums.add(small.sums);
        large.plane = fit(large.sums);
        regions_[static_cast<std::size_t>(other)].sums = Sums{};
        joined_to_[static_cast<std::size_t>(other)] = one;
    };
    for (int by = 0; by < nby_; ++by) {
        const std::int32_t* row = out.of_block.row(by);
        const std::int32_t* above = by + 1 < nby_ ? out.of_block.row(by + 1) : nullptr;
        for (int bx = 0; bx < nbx_; ++bx) {
            if (bx + 1 < nbx_) meet(row[bx], row[bx + 1]);
            if (above != nullptr) meet(row[bx], above[bx]);
        }
    }
    std::int32_t* const of_block = out.of_block.data();
    for (std::size_t i = 0; i < out.of_block.size(); ++i)
        if (of_block[i] != kNone) of_block[i] = root(of_block[i]);
}

/// Gives each block at a border to the region beside it whose plane fits best. A block on no plane
/// gets no region.
void PatchFinder::settle_borders(PatchMap& out) {
    for (int by = 0; by < nby_; ++by) {
        for (int bx = 0; bx < nbx_; ++bx) {
            std::int32_t& own = out.of_block.row(by)[bx];
            const Sums& sums = blocks_[static_cast<std::size_t>(by * nbx_ + bx)];
            if (sums.cells == 0.0) continue;
            std::int32_t best = kNone;
            std::int32_t tried = kNone;
            double least_m2 = std::numeric_limits<double>::infinity();
            const auto observation = [&](std::int32_t id) {
                if (id == kNone || id == tried) return;
                tried = id;
                const Plane& plane = regions_[static_cast<std::size_t>(id)].plane;
                const double square_m2 = mean_square_m2(sums, plane);
                if (!(square_m2 < least_m2) || !lies_on(sums, plane)) return;
                least_m2 = square_m2;
                best = id;
            };
            bool alike = own != kNone;
            for (int y = std::max(0, by - 1); y <= std::min(nby_ - 1, by + 1) && alike; ++y)
                for (int x = std::max(0, bx - 1); x <= std::min(nbx_ - 1, bx + 1); ++x)
                    alike = alike && out.of_block.row(y)[x] == own;
            if (alike) continue;
            observation(own);
            for (int y = std::max(0, by - 1); y <= std::min(nby_ - 1, by + 1); ++y)
                for (int x = std::max(0, bx - 1); x <= std::min(nbx_ - 1, bx + 1); ++x)
                    observation(out.of_block.row(y)[x]);
            own = best;
        }
    }
}

void PatchFinder::refit(const PatchMap& out) {
    for (Region& region : regions_) region.sums = Sums{};
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
        const std::int32_t id = out.of_block.data()[i];
        if (id != kNone) regions_[static_cast<std::size_t>(id)].sums.add(blocks_[i]);
    }
    for (Region& region : regions_)
        if (region.sums.cells > 0.0) region.plane = fit(region.sums);
}

/// Removes small patches and renumbers the rest without gaps.
void PatchFinder::drop_small(double cell_m2, PatchMap& out) {
    const double least = std::max(3.0, config_.min_area_m2 / cell_m2);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < regions_.size(); ++i) {
        const bool keep = regions_[i].sums.cells >= least;
        joined_to_[i] = keep ? static_cast<std::int32_t>(kept) : kNone;
        if (keep) regions_[kept++] = regions_[i];
    }
    regions_.resize(kept);
    for (std::size_t i = 0; i < out.of_block.size(); ++i) {
        std::int32_t& id = out.of_block.data()[i];
        if (id != kNone) id = joined_to_[static_cast<std::size_t>(id)];
    }
}

void PatchFinder::assign_cells(const Terrain& terrain, PatchMap& out) {
    const grid::GridGeometry& grid = terrain.geometry;
    out.patches.assign(regions_.size(), PlanarPatch{});
    square_m2_.assign(regions_.size(), 0.0);
    out.of_cell.fill(kNone);
    const double tolerance_m2 = square(config_.tolerance_m);
    const double most_m2 = square(config_.max_tolerance_m);
    const double var_factor = square(config_.sigma_factor);
    std::array<std::int32_t, 9> ids{};
    for (int by = 0; by < nby_; ++by) {
        for (int bx = 0; bx < nbx_; ++bx) {
            std::size_t count = 0;
            for (int y = std::max(0, by - 1); y <= std::min(nby_ - 1, by + 1); ++y) {
                for (int x = std::max(0, bx - 1); x <= std::min(nbx_ - 1, bx + 1); ++x) {
                    const std::int32_t id = out.of_block.row(y)[x];
                    if (id == kNone) continue;
                    std::size_t k = 0;
                    while (k < count && ids[k] != id) ++k;
                    if (k == count) ids[count++] = id;
                }
            }
            if (count == 0) continue;
            const int end_ix = std::min(grid.nx, (bx + 1) * block_cells_);
            const int end_iy = std::min(grid.ny, (by + 1) * block_cells_);
            for (int iy = by * block_cells_; iy < end_iy; ++iy) {
                const float* height_m = terrain.height_m.row(iy);
                const float* var_m2 =
                    terrain.height_var_m2.empty() ? nullptr : terrain.height_var_m2.row(iy);
                std::int32_t* to = out.of_cell.row(iy);
                const double y = (iy + 0.5 - 0.5 * grid.ny) * grid.resolution_m;
                for (int ix = bx * block_cells_; ix < end_ix; ++ix) {
                    const auto z = static_cast<double>(height_m[ix]);
                    if (!(z == z)) continue;
                    const double x = (ix + 0.5 - 0.5 * grid.nx) * grid.resolution_m;
                    const double cell_var_m2 =
                        var_m2 == nullptr ? 0.0 : static_cast<double>(var_m2[ix]);
                    double least_m2 = std::clamp(var_factor * cell_var_m2, tolerance_m2, most_m2);
                    std::int32_t best = kNone;
                    for (std::size_t k = 0; k < count; ++k) {
                        const Plane& plane = regions_[static_cast<std::size_t>(ids[k])].plane;
                        const double off_m2 =
                            square(z - plane.at_0_m - plane.gx * x - plane.gy * y);
                        if (!(off_m2 <= least_m2)) continue;
                        least_m2 = off_m2;
                        best = ids[k];
                    }
                    if (best == kNone) continue;
                    to[ix] = best;
                    square_m2_[static_cast<std::size_t>(best)] += least_m2;
                    ++out.patches[static_cast<std::size_t>(best)].cells;
                }
            }
        }
    }
}

void PatchFinder::measure(const Terrain& terrain, PatchMap& out) const {
    const double cell_m2 = square(terrain.geometry.resolution_m);
    for (std::size_t i = 0; i < regions_.size(); ++i) {
        const Sums& s = regions_[i].sums;
        const Plane& plane = regions_[i].plane;
        PlanarPatch& patch = out.patches[i];
        const double x = s.x / s.w, y = s.y / s.w;
        patch.middle_m << middle_m_ + Eigen::Vector2d(x, y),
            plane.at_0_m + plane.gx * x + plane.gy * y;
        patch.gradient = {plane.gx, plane.gy};
        patch.rms_m = std::sqrt(square_m2_[i] / std::max(1, patch.cells));
        // Computes the smaller eigenvalue of the horizontal scatter of the cells.
        const double a = s.xx / s.w - x * x, b = s.xy / s.w - x * y, c = s.yy / s.w - y * y;
        const double narrow_m2 =
            std::max(0.0, 0.5 * (a + c) - std::sqrt(0.25 * square(a - c) + b * b));
        patch.width_m = std::sqrt(12.0 * narrow_m2);
        const double errors = std::max(1.0, s.cells * cell_m2 / square(kCorrelation_m));
        const double var_m2 = std::max(square(patch.rms_m), s.cells / s.w - square(kLeastSigma_m));
        patch.slope_sigma_rad = narrow_m2 > 0.0 ? std::sqrt(var_m2 / errors / narrow_m2)
                                                : std::numeric_limits<double>::infinity();
    }
}

}  // namespace surefoot::stairs

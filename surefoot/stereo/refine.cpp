// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/refine.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "surefoot/stereo/disparity_selection.hpp"
#include "surefoot/stereo/refine_rows.hpp"
#include "surefoot/stereo/row_blocks.hpp"

namespace surefoot::stereo {
namespace {

constexpr int kMaxWindowRadius_px = 16;
constexpr int kMaxSmoothRadius_px = 32;
/// Number of rows in a block. A block starts by summing a window of rows, so it should be higher
/// than the window.
constexpr int kSolvedRows = 64;

void smooth_image_row(ImageView<const std::uint8_t> in,
                      int v,
                      std::vector<std::uint16_t>& scratch,
                      std::int16_t* out) {
    const std::uint8_t* const lines[3] = {
        in.row(std::max(v - 1, 0)), in.row(v), in.row(std::min(v + 1, in.height - 1))};
    rows::smooth_image(lines, in.width, scratch.data(), out);
}

/// Column sums of a window that moves down, and scratch memory for the sums along a row.
struct WindowSums {
    WindowSums(int width, int radius) {
        const auto columns = static_cast<std::size_t>(width + rows::kPadding);
        const auto padded = columns + 2 * static_cast<std::size_t>(radius) + 1;
        sums.resize(rows::kSums * columns);
        prefixes.resize(rows::kSums * padded);
        for (std::size_t k = 0; k < rows::kSums; ++k) {
            column[k] = sums.data() + k * columns;
            prefix[k] = prefixes.data() + k * padded;
        }
    }
    std::vector<std::int32_t> sums;
    std::vector<std::int32_t> prefixes;
    std::int32_t* column[rows::kSums] = {};
    std::int32_t* prefix[rows::kSums] = {};
};

}  // namespace

void smooth_along(const float* row, int width, int radius_px, double same_surface_px, float* out) {
    SUREFOOT_ASSERT(radius_px <= kMaxSmoothRadius_px);
    const float* before[kMaxSmoothRadius_px];
    const float* after[kMaxSmoothRadius_px];
    for (int k = 0; k < radius_px; ++k) {
        before[k] = row - k - 1;
        after[k] = row + k + 1;
    }
    const auto same_px = static_cast<float>(same_surface_px);
    rows::smooth_along({row, before, after, radius_px, width, same_px, out});
}

void smooth_down(const Image<float>& in, int v, int radius_px, double same_surface_px, float* out) {
    SUREFOOT_ASSERT(radius_px <= kMaxSmoothRadius_px);
    const float* above[kMaxSmoothRadius_px];
    const float* below[kMaxSmoothRadius_px];
    const int steps = std::min({radius_px, v, in.height() - 1 - v});
    for (int k = 0; k < steps; ++k) {
        above[k] = in.row(v - k - 1);
        below[k] = in.row(v + k + 1);
    }
    const auto same_px = static_cast<float>(same_surface_px);
    rows::smooth_along({in.row(v), above, below, steps, in.width(), same_px, out});
}

SubpixelRefiner::SubpixelRefiner(const RefineConfig& config) : config_(config) {
    SUREFOOT_ASSERT(config.window_radius_px >= 1 && config.window_radius_px <= kMaxWindowRadius_px);
}

/// Filters a block of rows of the found disparities and smooths them along the row.
void SubpixelRefiner::smooth_block(int first,
                                   int last,
                                   const Image<float>& found_px,
                                   Filter filter) {
    const int width = found_px.width();
    const int radius = config_.smooth_along_px;
    std::vector<float> scratch;
    std::vector<float> padded(static_cast<std::size_t>(width + 2 * radius),
                              std::numeric_limits<float>::quiet_NaN());
    float* const row = padded.data() + radius;
    for (int v = first; v < last; ++v) {
        if (filter == Filter::median)
            median_of_row(found_px, v, scratch, row);
        else
            std::copy_n(found_px.row(v), width, row);
        smooth_along(row, width, radius, config_.same_surface_px, horizontal_.row(v));
    }
}

/// Smooths a block of rows down the columns and computes grey difference and gradient of every
/// pixel at its disparity.
void SubpixelRefiner::warp_block(int first,
                                 int last,
                                 ImageView<const std::uint8_t> left,
                                 ImageView<const std::uint8_t> right,
                                 const Image<std::uint8_t>& jump_distance_px,
                                 Image<float>& disparity_px) {
    const auto columns = static_cast<std::size_t>(left.width);
    std::vector<std::uint16_t> sums(columns + 2);
    std::vector<std::int16_t> smooth_left(columns);
    std::vector<std::int16_t> smooth_right(columns + 1);
    std::vector<std::int32_t> places(columns);
    std::vector<float> fractions(columns);
    std::vector<std::int32_t> pairs(2 * columns);
    rows::WarpRow row;
    row.left = smooth_left.data();
    row.right = smooth_right.data() + 1;
    row.jump_margin_px = config_.jump_margin_px;
    row.width = left.width;
    row.place = places.data();
    row.fraction = fractions.data();
    row.pairs = pairs.data();
    for (int v = first; v < last; ++v) {
        float* const disparity = disparity_px.row(v);
        smooth_down(horizontal_, v, config_.smooth_down_px, config_.same_surface_px, disparity);
        smooth_image_row(left, v, sums, smooth_left.data());
        smooth_image_row(right, v, sums, smooth_right.data() + 1);
        row.disparity_px = disparity;
        row.jump_distance_px = jump_distance_px.row(v);
        row.evidence = evidence_.row(v);
        rows::warp(row);
    }
}

/// Solves the windows of a block of rows. The sums move down the columns and along each row.
void SubpixelRefiner::solve_block(int first,
                                  int last,
                                  Image<float>& disparity_px,
                                  const RefinedRows& refined) const {
    const int width = evidence_.width();
    const int height = evidence_.height();
    const int r = config_.window_radius_px;
    WindowSums sums(width, r);
    const std::vector<std::int32_t> nothing(static_cast<std::size_t>(width), rows::kUnused);
    const auto evidence = [&](int v) {
        return v >= 0 && v < height ? evidence_.row(v) : nothing.data();
    };
    rows::SolveRow row;
    for (int k = 0; k < rows::kSums; ++k) {
        row.columns[k] = sums.column[k];
        row.prefix[k] = sums.prefix[k];
    }
    std::vector<float> learnt(3 * static_cast<std::size_t>(width));
    row.residual_grey = learnt.data();
    row.gradient_grey_px = row.residual_grey + width;
    row.shift_px = row.gradient_grey_px + width;
    row.radius_px = r;
    row.width = width;
    row.enough = 0.2F * static_cast<float>((2 * r + 1) * (2 * r + 1));
    row.correlation = static_cast<float>(config_.correlation);
    row.min_noise_grey = static_cast<float>(config_.min_noise_grey);
    row.prior_sigma_px = static_cast<float>(config_.prior_sigma_px);
    row.max_step_px = static_cast<float>(config_.max_step_px);
    for (int v = std::max(0, first - r); v < std::min(first + r, height); ++v)
        rows::slide(evidence(v), nothing.data(), width, sums.column);
    for (int v = first; v < last; ++v) {
        const bool begun = v > first;
        rows::slide(
            evidence(v + r), begun ? evidence(v - r - 1) : nothing.data(), width, sums.column);
        row.disparity_px = disparity_px.row(v);
        rows::solve(row);
        refined(v, {row.residual_grey, row.gradient_grey_px, row.shift_px});
    }
}

void SubpixelRefiner::refine(ImageView<const std::uint8_t> left,
                             ImageView<const std::uint8_t> right,
                             const Image<float>& found_px,
                             Filter filter,
                             const Image<std::uint8_t>& jump_distance_px,
                             Executor& executor,
                             Image<float>& disparity_px,
                             const RefinedRows& refined) {
    const int width = left.width;
    const int height = left.height;
    evidence_.resize(width, height);
    horizontal_.resize(width, height);
    for_row_blocks(executor, height, [&](int first, int last) {
        smooth_block(first, last, found_px, filter);
    });
    // The resize comes only here, because `disparity_px` may be the image `found_px`.
    disparity_px.resize(width, height);
    for_row_blocks(executor, height, [&](int first, int last) {
        warp_block(first, last, left, right, jump_distance_px, disparity_px);
    });
    for_row_blocks<kSolvedRows>(executor, height, [&](int first, int last) {
        solve_block(first, last, disparity_px, refined);
    });
}

}  // namespace surefoot::stereo

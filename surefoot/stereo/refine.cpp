// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/refine.hpp"

#include <algorithm>
#include <vector>

#include "surefoot/stereo/refine_rows.hpp"
#include "surefoot/stereo/row_blocks.hpp"

namespace surefoot::stereo {
namespace {

constexpr int kMaxWindowRadius_px = 16;
constexpr int kMaxSmoothRadius_px = 16;
/// Blocks that begin with a window of rows want to be higher than it.
constexpr int kSolvedRows = 64;

void smooth_image_row(ImageView<const std::uint8_t> in,
                      int v,
                      std::vector<std::uint16_t>& scratch,
                      std::vector<std::int16_t>& out) {
    const std::uint8_t* lines[5];
    for (int k = 0; k < 5; ++k) lines[k] = in.row(std::clamp(v + k - 2, 0, in.height - 1));
    rows::smooth_image(lines, in.width, scratch.data(), out.data());
}

/// Sums of the columns of a window that slides down, and scratch for its way along the row.
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

void smooth_along(const Image<float>& in,
                  int v,
                  bool down,
                  int radius_px,
                  double same_surface_px,
                  Image<float>& out) {
    SUREFOOT_ASSERT(radius_px <= kMaxSmoothRadius_px);
    const int width = in.width();
    const float* const center = in.row(v);
    const float* before[kMaxSmoothRadius_px];
    const float* after[kMaxSmoothRadius_px];
    const int steps =
        down ? std::min({radius_px, v, in.height() - 1 - v}) : std::min(radius_px, width);
    for (int k = 1; k <= steps; ++k) {
        before[k - 1] = down ? in.row(v - k) : center - k;
        after[k - 1] = down ? in.row(v + k) : center + k;
    }
    rows::smooth_along({center,
                        before,
                        after,
                        steps,
                        down ? 0 : 1,
                        width,
                        static_cast<float>(same_surface_px),
                        out.row(v)});
}

SubpixelRefiner::SubpixelRefiner(const RefineConfig& config) : config_(config) {
    SUREFOOT_ASSERT(config.window_radius_px >= 1 && config.window_radius_px <= kMaxWindowRadius_px);
}

/// Grey difference and gradient of every pixel of some rows at its disparity.
void SubpixelRefiner::warp_block(int first,
                                 int last,
                                 ImageView<const std::uint8_t> left,
                                 ImageView<const std::uint8_t> right,
                                 const Image<std::uint8_t>& jump_distance_px,
                                 const Image<float>& disparity_px) {
    const auto columns = static_cast<std::size_t>(left.width);
    std::vector<std::uint16_t> sums(columns + 4);
    std::vector<std::int16_t> smooth_left(columns);
    std::vector<std::int16_t> smooth_right(columns);
    std::vector<std::int32_t> places(columns);
    std::vector<float> fractions(columns);
    std::vector<std::int32_t> pairs(2 * columns);
    rows::WarpRow row;
    row.left = smooth_left.data();
    row.right = smooth_right.data();
    row.jump_margin_px = config_.jump_margin_px;
    row.width = left.width;
    row.place = places.data();
    row.fraction = fractions.data();
    row.pairs = pairs.data();
    for (int v = first; v < last; ++v) {
        smooth_image_row(left, v, sums, smooth_left);
        smooth_image_row(right, v, sums, smooth_right);
        row.disparity_px = disparity_px.row(v);
        row.jump_distance_px = jump_distance_px.row(v);
        row.evidence = evidence_.row(v);
        rows::warp(row);
    }
}

/// Solves the windows of some rows; sums slide down the columns and along each row.
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
                             const Image<std::uint8_t>& jump_distance_px,
                             Executor& executor,
                             Image<float>& disparity_px,
                             const RefinedRows& refined) {
    const int width = left.width;
    const int height = left.height;
    evidence_.resize(width, height);
    horizontal_.resize(width, height);
    const int radius = config_.smooth_radius_px;
    const double same = config_.same_surface_px;
    for_row_blocks(executor, height, [&](int first, int last) {
        for (int v = first; v < last; ++v)
            smooth_along(disparity_px, v, false, radius, same, horizontal_);
    });
    for_row_blocks(executor, height, [&](int first, int last) {
        for (int v = first; v < last; ++v)
            smooth_along(horizontal_, v, true, radius, same, disparity_px);
        warp_block(first, last, left, right, jump_distance_px, disparity_px);
    });
    for_row_blocks<kSolvedRows>(executor, height, [&](int first, int last) {
        solve_block(first, last, disparity_px, refined);
    });
}

}  // namespace surefoot::stereo

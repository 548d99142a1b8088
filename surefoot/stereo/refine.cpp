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

void smooth_image_row(ImageView<const std::uint8_t> in,
                      int v,
                      std::vector<int>& scratch,
                      Image<std::int16_t>& out) {
    const std::uint8_t* lines[5];
    for (int k = 0; k < 5; ++k) lines[k] = in.row(std::clamp(v + k - 2, 0, in.height - 1));
    rows::smooth_image(lines, in.width, scratch.data(), out.row(v));
}

/// Sums of the columns of a window that slides down, and scratch for its way along the row.
struct WindowSums {
    WindowSums(int width, int radius) {
        const auto columns = static_cast<std::size_t>(width);
        const auto padded = columns + 2 * static_cast<std::size_t>(radius) + 1;
        sums.resize(rows::kSums * columns);
        prefixes.resize(rows::kSums * padded);
        for (std::size_t k = 0; k < rows::kSums; ++k) {
            column[k] = sums.data() + k * columns;
            prefix[k] = prefixes.data() + k * padded;
        }
    }
    std::vector<std::int32_t> sums;
    std::vector<std::uint32_t> prefixes;
    std::int32_t* column[rows::kSums] = {};
    std::uint32_t* prefix[rows::kSums] = {};
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
                                 const Image<std::uint8_t>& jump_distance_px,
                                 const Image<float>& disparity_px) {
    const int width = left_.width();
    const auto columns = static_cast<std::size_t>(width);
    std::vector<std::int32_t> places(columns);
    std::vector<float> fractions(columns);
    const std::size_t padded = columns + rows::kTapPadding;
    std::vector<std::int16_t> taps(8 * padded);
    rows::WarpRow row;
    row.jump_margin_px = config_.jump_margin_px;
    row.width = width;
    row.place = places.data();
    row.fraction = fractions.data();
    for (std::size_t k = 0; k < 4; ++k) row.taps[k] = taps.data() + k * padded;
    row.fours = taps.data() + 4 * padded;
    for (int v = first; v < last; ++v) {
        row.left = left_.row(v);
        row.right = right_.row(v);
        row.disparity_px = disparity_px.row(v);
        row.jump_distance_px = jump_distance_px.row(v);
        row.gradient = gradient_.row(v);
        row.error = error_.row(v);
        row.used = used_.row(v);
        rows::warp(row);
    }
}

/// Solves the windows of some rows; sums slide down the columns and along each row.
void SubpixelRefiner::solve_block(int first,
                                  int last,
                                  Image<float>& disparity_px,
                                  Refinement& out) const {
    const int width = left_.width();
    const int height = left_.height();
    const int r = config_.window_radius_px;
    WindowSums sums(width, r);
    const auto slide = [&](int v, std::int32_t sign) {
        if (v < 0 || v >= height) return;
        rows::accumulate(gradient_.row(v), error_.row(v), used_.row(v), sign, width, sums.column);
    };
    rows::SolveRow row;
    for (int k = 0; k < rows::kSums; ++k) {
        row.columns[k] = sums.column[k];
        row.prefix[k] = sums.prefix[k];
    }
    row.radius_px = r;
    row.width = width;
    row.enough = 0.2F * static_cast<float>((2 * r + 1) * (2 * r + 1));
    row.correlation = static_cast<float>(config_.correlation);
    row.min_noise_grey = static_cast<float>(config_.min_noise_grey);
    row.prior_sigma_px = static_cast<float>(config_.prior_sigma_px);
    row.max_step_px = static_cast<float>(config_.max_step_px);
    for (int v = first - r; v < first + r; ++v) slide(v, 1);
    for (int v = first; v < last; ++v) {
        slide(v + r, 1);
        row.disparity_px = disparity_px.row(v);
        row.shift_px = out.shift_px.row(v);
        row.residual_grey = out.residual_grey.row(v);
        row.gradient_grey_px = out.gradient_grey_px.row(v);
        rows::solve(row);
        slide(v - r, -1);
    }
}

void SubpixelRefiner::refine(ImageView<const std::uint8_t> left,
                             ImageView<const std::uint8_t> right,
                             const Image<std::uint8_t>& jump_distance_px,
                             Executor& executor,
                             Image<float>& disparity_px,
                             Refinement& out) {
    const int width = left.width;
    const int height = left.height;
    for (Image<std::int16_t>* image : {&left_, &right_, &gradient_, &error_, &used_})
        image->resize(width, height);
    for (Image<float>* image :
         {&horizontal_, &out.shift_px, &out.residual_grey, &out.gradient_grey_px}) {
        image->resize(width, height);
    }
    const int radius = config_.smooth_radius_px;
    const double same = config_.same_surface_px;
    for_row_blocks(executor, height, [&](int first, int last) {
        std::vector<int> scratch(static_cast<std::size_t>(width) + 4);
        for (int v = first; v < last; ++v) {
            smooth_image_row(left, v, scratch, left_);
            smooth_image_row(right, v, scratch, right_);
            smooth_along(disparity_px, v, false, radius, same, horizontal_);
        }
    });
    for_row_blocks(executor, height, [&](int first, int last) {
        for (int v = first; v < last; ++v)
            smooth_along(horizontal_, v, true, radius, same, disparity_px);
        warp_block(first, last, jump_distance_px, disparity_px);
    });
    for_row_blocks(executor, height, [&](int first, int last) {
        solve_block(first, last, disparity_px, out);
    });
}

}  // namespace surefoot::stereo

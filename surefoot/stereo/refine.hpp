// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::stereo {

struct RefineConfig {
    int smooth_radius_px = 4;      ///< neighbours on the same surface are averaged over 9x9 pixels
    double same_surface_px = 1.5;  ///< largest difference to a neighbour on the same surface
    /// What was found in a row is what the surface has so many rows farther up: a search whose
    /// paths come down the image, but not up, follows slanted ground late.
    int lag_rows = 0;
    int window_radius_px = 12;    ///< 25x25 pixels share one correction, at most 16
    double prior_sigma_px = 0.2;  ///< how far the smoothed value is trusted, 1 sigma
    int jump_margin_px = 2;       ///< pixels this near to a jump show mixed surfaces: not used
    double max_step_px = 1.0;     ///< no correction is larger
    /// Least grey-level noise (1 sigma, after smoothing the image) that a window is believed to
    /// have.
    double min_noise_grey = 0.4;
    /// Neighbouring pixels share their noise after the smoothing: this many count as one.
    double correlation = 3.5;
};

/// What is done to the found disparities before anything else.
enum class Filter : std::uint8_t {
    none,
    median,  ///< of 3 x 3 pixels
};

/// What the refinement learnt about the pixels of a row besides their disparity; NaN = unknown.
struct RefinedRow {
    const float* residual_grey = nullptr;     ///< rms grey difference that no shift explains
    const float* gradient_grey_px = nullptr;  ///< rms slope along the row in the window
    const float* shift_px = nullptr;          ///< how far the smoothed value was moved
};
/// Is called once for each row `v` when it is refined, from any thread; what it is given ends with
/// the call. So it need not be written to memory.
using RefinedRows = std::function<void(int v, const RefinedRow&)>;

/// Sub-pixel refinement: smoothing along surfaces, then image registration (Lucas and Kanade 1981)
/// along the row.
///
/// A semi-global matcher draws its parabola through three costs and so prefers whole pixels,
/// scatters from pixel to pixel, and leans toward fronto-parallel surfaces where texture is weak.
/// Averaging over neighbours on the same surface removes the first two. For the third, the right
/// image is warped by the disparity field itself, so that slanted ground stays slanted, and each
/// window solves for the one shift that explains the grey differences left over: with e = L(u) -
/// R(u - d) and g the mean gradient of both images,
///   shift = -(sum g e / c s^2) / (sum g^2 / c s^2 + 1 / p^2)
/// where s is the residual noise, c the noise correlation and p the prior. The sums are free of
/// their means (cameras differ in brightness) and exact (integers): they do not depend on the
/// blocks. Taking the gradient from both images makes g and e uncorrelated under noise at every
/// fraction of a pixel. A second step would amplify the noise: the box window has negative
/// frequencies. Cost: O(1) per pixel for any window.
class SubpixelRefiner {
  public:
    explicit SubpixelRefiner(const RefineConfig& config);

    /// Makes `disparity_px` of what was found (NaN = unknown, and stays so); both may be the same
    /// image if there is no filter. `jump_distance_px` is the distance of every pixel from the
    /// nearest disparity jump.
    void refine(ImageView<const std::uint8_t> left,
                ImageView<const std::uint8_t> right,
                const Image<float>& found_px,
                Filter filter,
                const Image<std::uint8_t>& jump_distance_px,
                Executor& executor,
                Image<float>& disparity_px,
                const RefinedRows& refined);

  private:
    void smooth_block(int first, int last, const Image<float>& found_px, Filter filter);
    void warp_block(int first,
                    int last,
                    ImageView<const std::uint8_t> left,
                    ImageView<const std::uint8_t> right,
                    const Image<std::uint8_t>& jump_distance_px,
                    Image<float>& disparity_px);
    void solve_block(int first,
                     int last,
                     Image<float>& disparity_px,
                     const RefinedRows& refined) const;

    RefineConfig config_;
    Image<float> horizontal_;       ///< disparity, smoothed along the row alone
    Image<std::int32_t> evidence_;  ///< see rows::kUnused
};

/// Mean over the neighbours on the same surface along a row. They count in opposite pairs, so that
/// a slanted plane keeps its value. On either side of the row stand `radius_px` unknown pixels.
void smooth_along(const float* row, int width, int radius_px, double same_surface_px, float* out);
/// The same down the columns, for row `v`; near the ends fewer neighbours count. `lag_rows`: what
/// counts is the row so many farther down and its neighbours, where it differs by no more than half
/// of `same_surface_px` (edges stay where they are).
void smooth_down(
    const Image<float>& in, int v, int radius_px, double same_surface_px, int lag_rows, float* out);

}  // namespace surefoot::stereo

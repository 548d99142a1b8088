// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::stereo {

struct RefineConfig {
    // Averages neighbours on the same surface over 41 x 9 pixels. Creases of the ground (nosings,
    // the feet of risers) run more along the rows than across them, so a wide window rounds them
    // less than a high one. docs/lab/matching.md compares sizes.
    int smooth_along_px = 20;      ///< radius along the row, at most 32
    int smooth_down_px = 4;        ///< radius down the column, at most 32
    double same_surface_px = 1.5;  ///< largest difference to a neighbour on the same surface
    int window_radius_px = 12;     ///< 25x25 pixels share one correction; the radius is at most 16
    double prior_sigma_px = 0.1;   ///< prior standard deviation of the smoothed disparity
    int jump_margin_px = 2;        ///< skips pixels this near to a jump: they show mixed surfaces
    double max_step_px = 1.0;      ///< largest correction
    /// Lower limit of the grey-level noise of a window (1 sigma, after smoothing of the image). The
    /// limit prevents too much trust in a window.
    double min_noise_grey = 0.4;
    /// Smoothing correlates the noise of neighbouring pixels: this many pixels count as one.
    double correlation = 3.5;
};

/// Filter that runs on the found disparities before any other step.
enum class Filter : std::uint8_t {
    none,
    median,  ///< median of 3 x 3 pixels
};

/// Results of the refinement for one row, besides the disparities; NaN = unknown.
struct RefinedRow {
    const float* residual_grey = nullptr;     ///< rms grey difference that no shift explains
    const float* gradient_grey_px = nullptr;  ///< rms grey slope along the row in the window
    const float* shift_px = nullptr;          ///< change of the smoothed disparity
};
/// Called once for each refined row `v`, from any thread. The data are valid only during the call,
/// because no image stores them.
using RefinedRows = std::function<void(int v, const RefinedRow&)>;

/// Refines disparities to sub-pixels: smooths them along surfaces, then registers both images along
/// the row (Lucas and Kanade 1981).
///
/// A semi-global matcher draws its parabola through three costs. It therefore prefers whole pixels,
/// scatters from pixel to pixel, and leans toward fronto-parallel surfaces where texture is weak.
/// Averaging over neighbours on the same surface removes the first two errors. For the third, the
/// disparity field itself warps the right image, so that slanted ground stays slanted. Each window
/// then solves for the one shift that explains the remaining grey differences. With g the mean
/// gradient of both images and e = L(u) - R(u - d),
///   shift = -(sum g e / c s^2) / (sum g^2 / c s^2 + 1 / p^2)
/// where s is the residual noise, c the noise correlation and p the prior. The means are removed
/// from the sums (cameras differ in brightness). The sums are exact integers, so that the result
/// does not depend on the row blocks. The gradient comes from both images, which makes g and e
/// uncorrelated under noise at every fraction of a pixel. A second step would amplify the noise,
/// because the box window inverts some frequencies. Cost: O(1) per pixel for any window.
class SubpixelRefiner {
  public:
    explicit SubpixelRefiner(const RefineConfig& config);

    /// Computes `disparity_px` from `found_px` (NaN = unknown). Without a filter, unknown pixels
    /// stay unknown, and both may be the same image. `jump_distance_px` is the distance of every
    /// pixel from the nearest disparity jump.
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

/// Averages the neighbours on the same surface along a row. Neighbours count in opposite pairs, so
/// that a slanted plane keeps its value. `row` has `radius_px` unknown pixels before and after it.
void smooth_along(const float* row, int width, int radius_px, double same_surface_px, float* out);
/// Averages down the columns for row `v`; near the image border fewer neighbours count.
void smooth_down(const Image<float>& in, int v, int radius_px, double same_surface_px, float* out);

}  // namespace surefoot::stereo

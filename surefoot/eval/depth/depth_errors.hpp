// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/eval/depth/sparsification.hpp"
#include "surefoot/eval/report/error_bins.hpp"

namespace surefoot::eval {

/// A disparity image beside the truth [px]; NaN = unknown in both.
struct DepthPair {
    ImageView<const float> estimate_px;
    ImageView<const float> truth_px;
    ImageView<const std::uint8_t> mask;  ///< empty = everywhere; else only where it is not 0
    ImageView<const float> sigma_px;     ///< of the estimate; may be empty
};

/// Share of pixels with |error| above 0.5, 1 and 2 px [%].
struct BadPixels {
    double over_0_5_percent = 0.0;
    double over_1_percent = 0.0;
    double over_2_percent = 0.0;
};

/// Pixels count where the truth is known and the mask is set. Figures without pixels are NaN.
struct DepthErrors {
    /// Over all counted pixels; where the estimate is unknown it is filled first (see `filled`), so
    /// that a matcher cannot win by answering only where it is easy. A pixel that stays unknown is
    /// bad.
    BadPixels bad;
    BadPixels known_bad;           ///< over the counted pixels that the estimate knows
    double density_percent = 0.0;  ///< counted pixels that the estimate knows, of all counted
    ErrorFigures known;            ///< estimate - truth over the known ones [px]
    SigmaCoverage coverage;        ///< of the known ones; empty without sigma
    Sparsification sparsification;
    std::int64_t counted = 0;
    /// Median of truth / estimate where both are known and positive; about 1 when both are in
    /// pixels, NaN without such pixels.
    double truth_over_estimate = 0.0;
};

/// Unknown pixels take the smaller of the nearest known disparities to their left and right in the
/// row (the background of an occlusion), as Middlebury fills sparse results. A row without any
/// known pixel stays unknown.
[[nodiscard]] Image<float> filled(ImageView<const float> disparity_px);

/// By how much the truth is too large (4) or too small (1/16) to be in pixels: the factor, of those
/// with which data sets store disparities, that explains the ratio. Nothing when truth and estimate
/// agree within what a matcher may get wrong, or differ by no such factor.
[[nodiscard]] std::optional<double> suspected_factor(double truth_over_estimate) noexcept;

/// Errors: images of different sizes.
[[nodiscard]] Result<DepthErrors> depth_errors(const DepthPair& pair);

}  // namespace surefoot::eval

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/eval/depth/sparsification.hpp"
#include "surefoot/eval/report/error_bins.hpp"

namespace surefoot::eval {

/// A disparity image and its ground truth [px]; NaN = unknown in either image.
struct DepthPair {
    ImageView<const float> estimate_px;
    ImageView<const float> truth_px;
    ImageView<const std::uint8_t> mask;  ///< empty = all pixels; otherwise non-zero pixels count
    ImageView<const float> sigma_px;     ///< sigma of the estimate; may be empty
};

/// Share of pixels with |error| above 0.5, 1 and 2 px [%].
struct BadPixels {
    double over_0_5_percent = 0.0;
    double over_1_percent = 0.0;
    double over_2_percent = 0.0;
};

/// Errors of the pixels with known truth inside the mask. All are NaN (counts: 0) without them.
struct DepthErrors {
    /// Bad pixels among all counted pixels. Unknown estimates are filled first (see `filled`), so a
    /// matcher gains nothing if it answers only at easy pixels. A pixel that stays unknown counts
    /// as bad.
    BadPixels bad;
    BadPixels known_bad;           ///< bad pixels among the counted pixels with a known estimate
    double density_percent = 0.0;  ///< share of the counted pixels with a known estimate
    ErrorFigures known;            ///< estimate minus truth at the known estimates [px]
    SigmaCoverage coverage;        ///< sigma coverage of the known estimates; NaN without sigma
    Sparsification sparsification;
    std::int64_t counted = 0;
    /// Median of truth / estimate where both are known and positive. About 1 if both images are in
    /// pixels; NaN without such pixels.
    double truth_over_estimate = 0.0;
};

/// Fills an unknown pixel with the background of an occlusion, as Middlebury fills sparse results.
/// The background is the smaller of the nearest known disparities to the left and right in the row.
/// A row without any known pixel stays unknown.
[[nodiscard]] Image<float> filled(ImageView<const float> disparity_px);

/// Returns the factor by which the truth is probably scaled, for example 4 or 1/16. Data sets store
/// disparities with such factors. No value if no factor is within 12.5 % of the ratio, for example
/// if truth and estimate agree.
[[nodiscard]] std::optional<double> suspected_factor(double truth_over_estimate) noexcept;

/// Returns an error if the images differ in size.
[[nodiscard]] Result<DepthErrors> depth_errors(const DepthPair& pair);

}  // namespace surefoot::eval

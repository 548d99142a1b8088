// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/depth_image.hpp"
#include "surefoot/stereo/consistency.hpp"
#include "surefoot/stereo/refine.hpp"

namespace surefoot::stereo {

/// Evidence about one match, taken when its disparity is final.
struct MatchEvidence {
    float residual_grey = 0.0F;     ///< see RefinedRow
    float gradient_grey_px = 0.0F;  ///< see RefinedRow
    float shift_px = 0.0F;          ///< see RefinedRow
    int jump_distance_px = 255;     ///< distance to the nearest disparity jump
    float unknown_share = 0.0F;     ///< share of the 9x9 neighbours, [0, 1]
};

/// One sigma [px] of the disparity of a correct match. The squares of five terms add up: errors
/// that texture does not show (interpolation, curved surfaces, rows that do not match exactly),
/// grey noise over texture slope, a share of the applied correction, and jumps and holes nearby:
///   sigma^2 = floor^2 + (gain residual / gradient)^2 + (share shift)^2 + (jump nearness)^2
///             + (hole unknown_share)^2, at most kMaxSigma_px.
/// Fitted to Middlebury cones and cloth3 and to four scenes of the simulated ZED at one and two
/// times its noise (lab/sigma_fit/main.cpp): likelihood of Student's t, with 68 and 95 % of every
/// image within one and two sigma, and a fixed share of the shift. All coefficients were then
/// multiplied by 1.02, so that 68 % lie within one sigma on average, and rounded.
/// docs/lab/matching.md has other pairs and the held-out data. Images of an ideal camera scatter
/// two to three times less than this.
[[nodiscard]] float match_sigma_px(const MatchEvidence& evidence) noexcept;

inline constexpr float kSigmaFloor_px = 0.134F;
inline constexpr float kSigmaGain = 0.182F;
inline constexpr float kSigmaShiftShare = 0.46F;
inline constexpr float kSigmaJump_px = 0.40F;
inline constexpr float kSigmaHole_px = 0.92F;
inline constexpr float kMaxSigma_px = 1.5F;
/// The nearness falls from 1 at a jump to 0 at this distance.
inline constexpr float kJumpReach_px = 12.0F;
/// Beside a jump the nearer surface spreads (foreground fattening). One pixel in eight is wrong
/// there, always toward the nearer side. By policy no pixel in this zone is trusted.
inline constexpr int kJumpZone_px = 3;
inline constexpr float kJumpOutlierProbability = 0.6F;

/// Upper limit of the ratio of noise to texture slope, for pixels without texture.
inline constexpr float kMaxNoisePerPixel_px = 100.0F;
// Logistic regression on Middlebury cones and cloth3 and four rendered scenes, rounded. Area under
// the ROC curve before rounding: 0.91-0.92 on the two pairs, 0.88-0.99 on the rendered scenes. On
// held-out pairs: teddy 0.87 (2.6 % wrong expected, 4.4 % found) and adirondack 0.69 (its truth is
// rounded to whole pixels).
inline constexpr float kScoreConstant = -8.5F;
inline constexpr float kScoreNearJump = 7.0F;
inline constexpr float kScoreNoise = 0.18F;
inline constexpr float kScoreShift = 1.1F;
inline constexpr float kScoreUnknown = 1.9F;

/// Probability that the match is wrong by more than 1 px: a logistic function of the evidence, but
/// at least kJumpOutlierProbability in the jump zone.
[[nodiscard]] float outlier_probability(const MatchEvidence& evidence) noexcept;

/// Fills row `v` of sigma [px] and outlier probability in `depth` from its disparity. Pixels
/// without disparity get sigma NaN and probability 1.
void rate_matches(int v,
                  const RefinedRow& refined,
                  const Image<std::uint8_t>& jump_distance_px,
                  const UnknownCounts& unknown,
                  DepthImage& depth);

}  // namespace surefoot::stereo

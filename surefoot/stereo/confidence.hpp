// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/depth_image.hpp"
#include "surefoot/stereo/consistency.hpp"
#include "surefoot/stereo/refine.hpp"

namespace surefoot::stereo {

/// What is known about one match when its disparity is settled.
struct MatchEvidence {
    float residual_grey = 0.0F;     ///< see RefinedRow
    float gradient_grey_px = 0.0F;  ///< see RefinedRow
    float shift_px = 0.0F;          ///< see RefinedRow
    int jump_distance_px = 255;     ///< to the nearest disparity jump
    float unknown_share = 0.0F;     ///< of the 9x9 neighbours, [0, 1]
};

/// 1 sigma of a disparity that is right: a floor for what texture cannot tell (interpolation,
/// curved surfaces, rows that do not match exactly), the noise of the grey levels over the slope of
/// the texture, part of the correction that was needed, and what jumps and holes nearby do,
///   sigma^2 = floor^2 + (gain residual / gradient)^2 + (share shift)^2 + (jump nearness)^2
///             + (hole unknown_share)^2, at most kMaxSigma_px.
/// Fitted to Middlebury cones and cloth3 and to four scenes seen by the simulated ZED at one and
/// two times its noise (lab/sigma_fit/main.cpp: likelihood of Student's t, and of every image 68
/// and 95 % within one and two sigma; the share of the shift was held), then all coefficients times
/// 1.02, so that 68 % lie within one sigma on average; rounded. Other pairs and scenes, and what
/// was held out: docs/lab/matching.md. Images of an ideal camera scatter two to three times
/// less than it says.
[[nodiscard]] float match_sigma_px(const MatchEvidence& evidence) noexcept;

inline constexpr float kSigmaFloor_px = 0.134F;
inline constexpr float kSigmaGain = 0.182F;
inline constexpr float kSigmaShiftShare = 0.46F;
inline constexpr float kSigmaJump_px = 0.40F;
inline constexpr float kSigmaHole_px = 0.92F;
inline constexpr float kMaxSigma_px = 1.5F;
/// Nearness is 1 at a jump and 0 from here on.
inline constexpr float kJumpReach_px = 12.0F;
/// Next to a jump the nearer surface spreads (foreground fattening). One pixel in eight is wrong
/// there, and always to the same side: by policy none is trusted.
inline constexpr int kJumpZone_px = 3;
inline constexpr float kJumpOutlierProbability = 0.6F;

/// Noise over texture slope of a pixel without texture.
inline constexpr float kMaxNoisePerPixel_px = 100.0F;
// Logistic regression on Middlebury cones and cloth3 and four rendered scenes, rounded. Areas under
// the ROC curve of the unrounded fit: 0.91-0.92 on these two, 0.88-0.99 rendered; left out: teddy
// 0.87, with 2.6 % wrong expected and 4.4 % found, and adirondack 0.69, whose truth is rounded to
// whole pixels.
inline constexpr float kScoreConstant = -8.5F;
inline constexpr float kScoreNearJump = 7.0F;
inline constexpr float kScoreNoise = 0.18F;
inline constexpr float kScoreShift = 1.1F;
inline constexpr float kScoreUnknown = 1.9F;

/// Probability that the match is wrong by more than 1 px: a logistic function of the evidence, but
/// at least kJumpOutlierProbability in the jump zone.
[[nodiscard]] float outlier_probability(const MatchEvidence& evidence) noexcept;

/// Fills row `v` of sigma and outlier probability of `depth` from its disparity; unknown pixels get
/// NaN and 1.
void rate_matches(int v,
                  const RefinedRow& refined,
                  const Image<std::uint8_t>& jump_distance_px,
                  const UnknownCounts& unknown,
                  DepthImage& depth);

}  // namespace surefoot::stereo

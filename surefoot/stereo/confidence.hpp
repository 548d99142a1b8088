// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/core/depth_image.hpp"
#include "surefoot/stereo/consistency.hpp"
#include "surefoot/stereo/refine.hpp"

namespace surefoot::stereo {

/// Evidence about one match, computed after its disparity is final.
struct MatchEvidence {
    float residual_grey = 0.0F;     ///< see RefinedRow
    float gradient_grey_px = 0.0F;  ///< see RefinedRow
    float shift_px = 0.0F;          ///< see RefinedRow
    int jump_distance_px = 255;     ///< distance to the nearest disparity jump
    float unknown_share = 0.0F;     ///< share of unknown pixels in the 9x9 window, [0, 1]
    /// Refined disparity minus the smallest found disparity of the 5 x 5 pixels around it [px].
    float nearer_by_px = 0.0F;
};

/// Returns one sigma [px] of the disparity of a correct match. The squares of five terms add up:
/// errors that texture does not show (interpolation, curved surfaces, row errors), grey noise
/// divided by texture slope, a share of the applied correction, jumps nearby, and holes nearby:
///   sigma^2 = floor^2 + (gain residual / gradient)^2 + (share shift)^2 + (jump nearness)^2
///             + (hole unknown_share)^2, at most kMaxSigma_px.
/// Fitted to Middlebury cones and cloth3 and to four scenes of the simulated ZED at one and two
/// times its noise (lab/sigma_fit/main.cpp). Criterion: likelihood of Student's t, with a fixed
/// share of the shift, and 68 % (95 %) of every image within one (two) sigma. All coefficients
/// were then multiplied by 1.003, so that on average 68 % lie within one sigma, and rounded.
/// docs/lab/matching.md has other pairs and the held-out data. With an ideal camera, the scatter of
/// the disparities is a third to a half of this sigma.
[[nodiscard]] float match_sigma_px(const MatchEvidence& evidence) noexcept;

inline constexpr float kSigmaFloor_px = 0.147F;
inline constexpr float kSigmaGain = 0.121F;
inline constexpr float kSigmaShiftShare = 0.45F;
inline constexpr float kSigmaJump_px = 0.30F;
inline constexpr float kSigmaHole_px = 1.41F;
inline constexpr float kMaxSigma_px = 1.5F;
/// Distance at which the nearness to a jump is 0; it is 1 at the jump.
inline constexpr float kJumpReach_px = 12.0F;
/// On the near side of a jump the nearer surface spreads (foreground fattening): 15 to 50 % of the
/// pixels beside a jump of cones, cloth3 and simulated scenes are wrong there. By policy a pixel
/// that is nearer than a neighbour by more than kNearSideStep_px has at least this probability.
inline constexpr float kNearSideStep_px = 2.0F;
inline constexpr float kNearSideOutlierProbability = 0.5F;

/// Upper limit of the ratio of noise to texture slope, for pixels without texture.
inline constexpr float kMaxNoisePerPixel_px = 100.0F;
// Rounded result of a logistic regression (lab/trust/main.cpp) on cones, cloth3, three Bumblebee
// pairs, six frames of garden_walk, and ten scenes of the simulated ZED at one and two times its
// noise. A real image has the weight of three simulated ones. docs/lab/matching.md has the
// reliability of these and of held-out images.
inline constexpr float kScoreConstant = -5.7F;
inline constexpr float kScoreNearJump = 3.05F;
inline constexpr float kScoreNoise = 0.19F;
inline constexpr float kScoreShift = 1.14F;
inline constexpr float kScoreUnknown = 3.6F;

/// Returns the probability that the match is wrong by more than 1 px. It is a logistic function of
/// the evidence, and at least kNearSideOutlierProbability on the near side of a jump.
[[nodiscard]] float outlier_probability(const MatchEvidence& evidence) noexcept;

/// Where most pixels have no match, a match with the largest sigma (no texture, or too few matches
/// around it for a refinement) has at least this probability. In a scene without texture, two of
/// three trusted matches were such matches, and half of them were wrong by more than 2 px
/// (docs/lab/matching.md).
inline constexpr float kIsolatedOutlierProbability = 0.5F;
/// A block is the square of pixels that are judged together, by the matches of 3 x 3 blocks.
inline constexpr int kIsolationBlock_px = 32;
/// Smallest share of matched pixels in 3 x 3 blocks whose matches are not isolated. Chosen on the
/// images of the fit and on look_white_wall with seeds 21-22.
inline constexpr double kLeastMatchedShare = 0.5;

/// Raises the outlier probability of isolated matches. Keeps its memory between images.
class IsolatedMatches {
  public:
    /// `depth` must hold disparity, sigma and outlier probability of every pixel.
    void doubt(DepthImage& depth);

  private:
    std::vector<int> matched_;  ///< number of matched pixels of each block
};

/// Fills row `v` of sigma [px] and outlier probability in `depth` from its disparity. Pixels
/// without disparity get sigma NaN and probability 1. `smallest_px`: see smallest_nearby.
void rate_matches(int v,
                  const RefinedRow& refined,
                  const Image<std::uint8_t>& jump_distance_px,
                  const UnknownCounts& unknown,
                  const Image<float>& smallest_px,
                  DepthImage& depth);

}  // namespace surefoot::stereo

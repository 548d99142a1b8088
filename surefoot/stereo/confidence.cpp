// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/confidence.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/stereo/refine_rows.hpp"

namespace surefoot::stereo {
namespace {

/// Returns the ratio of noise to texture slope. It is the error [px] that a single pixel would
/// have.
float noise_per_pixel(const MatchEvidence& evidence) noexcept {
    return has_texture(evidence) ? evidence.residual_grey / evidence.gradient_grey_px
                                 : kMaxNoisePerPixel_px;
}

float nearness_to_jump(const MatchEvidence& evidence) noexcept {
    return std::max(0.0F, 1.0F - static_cast<float>(evidence.jump_distance_px) / kJumpReach_px);
}

}  // namespace

bool has_texture(const MatchEvidence& evidence) noexcept {
    return evidence.gradient_grey_px > evidence.residual_grey / kMaxNoisePerPixel_px;
}

float match_sigma_px(const MatchEvidence& evidence) noexcept {
    const float terms_px[] = {kSigmaFloor_px,
                              kSigmaGain * noise_per_pixel(evidence),
                              kSigmaShiftShare * evidence.shift_px,
                              kSigmaJump_px * nearness_to_jump(evidence),
                              kSigmaHole_px * evidence.unknown_share};
    float variance = 0.0F;
    for (const float term_px : terms_px) variance += term_px * term_px;
    return std::min(kMaxSigma_px, std::sqrt(variance));
}

float outlier_probability(const MatchEvidence& evidence) noexcept {
    const float score = kScoreConstant + kScoreNearJump * nearness_to_jump(evidence) +
                        kScoreNoise * std::log(noise_per_pixel(evidence)) +
                        kScoreShift * std::abs(evidence.shift_px) +
                        kScoreUnknown * evidence.unknown_share;
    float probability = 1.0F / (1.0F + std::exp(-score));
    if (evidence.nearer_by_px > kNearSideStep_px)
        probability = std::max(probability, kNearSideOutlierProbability);
    if (!has_texture(evidence)) probability = std::max(probability, kNoTextureOutlierProbability);
    return probability;
}

void rate_matches(int v,
                  const RefinedRow& refined,
                  const Image<std::uint8_t>& jump_distance_px,
                  const UnknownCounts& unknown,
                  const Image<float>& smallest_px,
                  DepthImage& depth) {
    rows::RateRow row;
    row.disparity_px = depth.disparity_px.row(v);
    row.residual_grey = refined.residual_grey;
    row.gradient_grey_px = refined.gradient_grey_px;
    row.shift_px = refined.shift_px;
    row.jump_distance_px = jump_distance_px.row(v);
    row.smallest_px = smallest_px.row(v);
    row.unknown_count = unknown.pixels.row(v);
    row.unknown_radius_px = unknown.radius_px;
    row.unknown_rows = window_span(v, unknown.radius_px, depth.disparity_px.height());
    row.width = depth.disparity_px.width();
    row.sigma_px = depth.sigma_px.row(v);
    row.outlier_probability = depth.outlier_probability.row(v);
    rows::rate(row);
}

}  // namespace surefoot::stereo

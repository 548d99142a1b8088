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
    if (!(evidence.gradient_grey_px > evidence.residual_grey / kMaxNoisePerPixel_px))
        return kMaxNoisePerPixel_px;
    return evidence.residual_grey / evidence.gradient_grey_px;
}

float nearness_to_jump(const MatchEvidence& evidence) noexcept {
    return std::max(0.0F, 1.0F - static_cast<float>(evidence.jump_distance_px) / kJumpReach_px);
}

}  // namespace

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
    const float probability = 1.0F / (1.0F + std::exp(-score));
    return evidence.nearer_by_px > kNearSideStep_px
               ? std::max(kNearSideOutlierProbability, probability)
               : probability;
}

void IsolatedMatches::doubt(DepthImage& depth) {
    constexpr int kSide = kIsolationBlock_px;
    const int width = depth.disparity_px.width();
    const int height = depth.disparity_px.height();
    const int columns = (width + kSide - 1) / kSide;
    const int rows = (height + kSide - 1) / kSide;
    matched_.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
    const auto block_at = [&](int x, int y) -> int& {
        return matched_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                        static_cast<std::size_t>(x)];
    };
    for (int v = 0; v < height; ++v) {
        const float* const disparity_px = depth.disparity_px.row(v);
        for (int x = 0; x < columns; ++x) {
            int matched = 0;
            for (int u = x * kSide; u < std::min(width, (x + 1) * kSide); ++u)
                matched += disparity_px[u] == disparity_px[u] ? 1 : 0;
            block_at(x, v / kSide) += matched;
        }
    }
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            int matched = 0;
            for (int j = std::max(0, y - 1); j <= std::min(rows - 1, y + 1); ++j)
                for (int i = std::max(0, x - 1); i <= std::min(columns - 1, x + 1); ++i)
                    matched += block_at(i, j);
            const int area = (std::min(width, (x + 2) * kSide) - std::max(0, (x - 1) * kSide)) *
                             (std::min(height, (y + 2) * kSide) - std::max(0, (y - 1) * kSide));
            if (matched >= kLeastMatchedShare * area) continue;
            for (int v = y * kSide; v < std::min(height, (y + 1) * kSide); ++v) {
                float* const probability = depth.outlier_probability.row(v);
                const float* const sigma_px = depth.sigma_px.row(v);
                for (int u = x * kSide; u < std::min(width, (x + 1) * kSide); ++u) {
                    if (sigma_px[u] >= kMaxSigma_px)
                        probability[u] = std::max(probability[u], kIsolatedOutlierProbability);
                }
            }
        }
    }
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

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lab/stereo_pairs/stereo_pairs.hpp"
#include "surefoot/stereo/confidence.hpp"
#include "surefoot/stereo/consistency.hpp"

namespace surefoot::experiments {

/// Data of the refinement and of its neighbourhood for every match of the pipeline's matcher,
/// collected as in stereo::Finisher.
struct PairEvidence {
    explicit PairEvidence(const TruePair& pair);
    [[nodiscard]] stereo::MatchEvidence at(int u, int v) const;
    /// Outlier probability of every pixel, as the matcher states it.
    [[nodiscard]] Image<float> outlier_probability() const;

    Image<float> disparity_px;  ///< NaN = unknown
    Image<float> residual_grey, gradient_grey_px, shift_px, smallest_px;
    Image<std::uint8_t> jump_distance_px;
    stereo::UnknownCounts unknown;
};

}  // namespace surefoot::experiments

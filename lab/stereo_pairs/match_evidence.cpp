// SPDX-License-Identifier: Apache-2.0
#include "lab/stereo_pairs/match_evidence.hpp"

#include <algorithm>
#include <cmath>

#include "lab/stereo_pairs/rival_matchers.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/stereo/finisher.hpp"
#include "surefoot/stereo/refine.hpp"

namespace surefoot::experiments {

PairEvidence::PairEvidence(const TruePair& pair) {
    const Image<float> found_px = selected_px({}, pair);
    Serial serial;
    Image<std::uint8_t> jumps;
    stereo::mark_jumps(serial, found_px, stereo::kJump_px, jumps);
    stereo::distance_to_marks(serial, jumps, jump_distance_px);
    stereo::smallest_nearby(serial, found_px, smallest_px);
    stereo::count_unknown(serial, found_px, stereo::kNeighbourhoodRadius_px, unknown);
    for (Image<float>* image : {&disparity_px, &residual_grey, &gradient_grey_px, &shift_px})
        image->resize(found_px.width(), found_px.height());
    const auto keep = [&](int v, const stereo::RefinedRow& row) {
        std::copy_n(row.residual_grey, found_px.width(), residual_grey.row(v));
        std::copy_n(row.gradient_grey_px, found_px.width(), gradient_grey_px.row(v));
        std::copy_n(row.shift_px, found_px.width(), shift_px.row(v));
    };
    stereo::SubpixelRefiner({}).refine(pair.left.view(),
                                       pair.right.view(),
                                       found_px,
                                       stereo::Filter::median,
                                       jump_distance_px,
                                       serial,
                                       disparity_px,
                                       keep);
}

stereo::MatchEvidence PairEvidence::at(int u, int v) const {
    const int area = stereo::window_span(u, unknown.radius_px, disparity_px.width()) *
                     stereo::window_span(v, unknown.radius_px, disparity_px.height());
    return {residual_grey.at(u, v),
            gradient_grey_px.at(u, v),
            shift_px.at(u, v),
            jump_distance_px.at(u, v),
            static_cast<float>(unknown.pixels.at(u, v)) / static_cast<float>(area),
            disparity_px.at(u, v) - smallest_px.at(u, v)};
}

Image<float> PairEvidence::outlier_probability() const {
    DepthImage depth;
    depth.disparity_px = disparity_px;
    depth.sigma_px = Image<float>(disparity_px.width(), disparity_px.height(), kNanF);
    depth.outlier_probability = Image<float>(disparity_px.width(), disparity_px.height(), 1.0F);
    for (int v = 0; v < disparity_px.height(); ++v) {
        for (int u = 0; u < disparity_px.width(); ++u) {
            if (std::isnan(disparity_px.at(u, v))) continue;
            depth.sigma_px.at(u, v) = stereo::match_sigma_px(at(u, v));
            depth.outlier_probability.at(u, v) = stereo::outlier_probability(at(u, v));
        }
    }
    stereo::IsolatedMatches().doubt(depth);
    return depth.outlier_probability;
}

}  // namespace surefoot::experiments

// SPDX-License-Identifier: Apache-2.0
#include "experiments/rival_matchers.hpp"

#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "surefoot/stereo/matcher.hpp"
#include "surefoot/stereo/speckles.hpp"

namespace surefoot::experiments {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// With a wider left border: OpenCV leaves it without a match.
cv::Mat padded(const GreyImage& image, int left_px) {
    const cv::Mat in(
        image.height(), image.width(), CV_8UC1, const_cast<std::uint8_t*>(image.data()));
    cv::Mat out;
    cv::copyMakeBorder(in, out, 0, 0, left_px, 0, cv::BORDER_REPLICATE);
    return out;
}

Image<float> opencv_disparities(cv::StereoMatcher& matcher, const TruePair& pair) {
    cv::Mat steps;
    matcher.compute(
        padded(pair.left, pair.disparities), padded(pair.right, pair.disparities), steps);
    Image<float> disparity_px(pair.left.width(), pair.left.height(), kNan);
    for (int v = 0; v < disparity_px.height(); ++v) {
        const auto* const row = steps.ptr<std::int16_t>(v) + pair.disparities;
        for (int u = 0; u < disparity_px.width(); ++u) {
            if (row[u] > 0) disparity_px.at(u, v) = static_cast<float>(row[u]) / 16.0F;
        }
    }
    return disparity_px;
}

}  // namespace

Match chain() {
    return [](const TruePair& pair) {
        stereo::MatcherConfig config;
        config.disparities = pair.disparities;
        Serial serial;
        DepthImage depth;
        stereo::make_matcher(config)->match(pair.left.view(), pair.right.view(), serial, depth);
        return depth.disparity_px;
    };
}

Match our_search(const stereo::SemiGlobalConfig& search) {
    return [=](const TruePair& pair) {
        stereo::SemiGlobalConfig config = search;
        config.disparities = pair.disparities;
        Serial serial;
        stereo::Winners winners;
        stereo::SemiGlobalSearch(config).search(
            pair.left.view(), pair.right.view(), serial, winners);
        Image<float> settled_px;
        stereo::settle({}, winners, serial, settled_px);
        stereo::SpeckleFilter().remove(
            stereo::kSpeckleSize_px, stereo::kSpeckleRange_px, settled_px);
        Image<float> disparity_px(settled_px.width(), settled_px.height());
        std::vector<float> scratch;
        for (int v = 0; v < settled_px.height(); ++v)
            stereo::median_of_row(settled_px, v, scratch, disparity_px.row(v));
        return disparity_px;
    };
}

Match opencv_sgbm(const SgbmSettings& settings) {
    return [=](const TruePair& pair) {
        constexpr int kBlock = 3;
        const auto matcher =
            cv::StereoSGBM::create(0,
                                   pair.disparities,
                                   kBlock,
                                   static_cast<int>(settings.slope * kBlock * kBlock),
                                   static_cast<int>(settings.jump * kBlock * kBlock),
                                   1,
                                   settings.prefilter_cap,
                                   10,
                                   100,
                                   2,
                                   settings.mode);
        return opencv_disparities(*matcher, pair);
    };
}

std::vector<Candidate> candidates() {
    Candidate ours{"our search alone", {}};
    for (const int slope : {3, 5, 8, 11})
        for (const int jump : {30, 42, 54})
            for (const int least : {6, 12, 20})
                ours.settings.push_back(our_search(
                    {.slope_penalty = slope, .jump_penalty = jump, .min_jump_penalty = least}));
    std::vector<Candidate> all = {ours};
    for (const auto& [name, mode] :
         {std::pair{"OpenCV SGBM 3-way", static_cast<int>(cv::StereoSGBM::MODE_SGBM_3WAY)},
          std::pair{"OpenCV SGBM HH4", static_cast<int>(cv::StereoSGBM::MODE_HH4)}}) {
        Candidate theirs{name, {}};
        for (const double slope : {2.0, 4.0, 8.0, 14.0})
            for (const double jump : {20.0, 32.0, 60.0})
                for (const int cap : {15, 31, 63})
                    theirs.settings.push_back(opencv_sgbm({mode, slope, jump, cap}));
        all.push_back(theirs);
    }
    return all;
}

}  // namespace surefoot::experiments

// SPDX-License-Identifier: Apache-2.0
#include "lab/stereo_pairs/rival_matchers.hpp"

#include <fmt/format.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "surefoot/core/unknown.hpp"
#include "surefoot/stereo/finisher.hpp"
#include "surefoot/stereo/matcher.hpp"
#include "surefoot/stereo/speckles.hpp"

namespace surefoot::experiments {
namespace {

constexpr int kLeftRight_px = 1;  ///< limit of OpenCV's left-right check, equal to our limit [px]

/// Adds borders to an image, because OpenCV finds no match for pixels near the border.
cv::Mat padded(const GreyImage& image, int left_px, int margin_px) {
    const cv::Mat in(
        image.height(), image.width(), CV_8UC1, const_cast<std::uint8_t*>(image.data()));
    cv::Mat out;
    cv::copyMakeBorder(
        in, out, margin_px, margin_px, left_px + margin_px, margin_px, cv::BORDER_REPLICATE);
    return out;
}

Image<float> opencv_disparities(cv::StereoMatcher& matcher, const TruePair& pair, int margin_px) {
    cv::Mat steps;
    matcher.compute(padded(pair.left, pair.disparities, margin_px),
                    padded(pair.right, pair.disparities, margin_px),
                    steps);
    Image<float> disparity_px(pair.left.width(), pair.left.height(), kNanF);
    for (int v = 0; v < disparity_px.height(); ++v) {
        const auto* const row =
            steps.ptr<std::int16_t>(v + margin_px) + pair.disparities + margin_px;
        for (int u = 0; u < disparity_px.width(); ++u) {
            if (row[u] > 0) disparity_px.at(u, v) = static_cast<float>(row[u]) / 16.0F;
        }
    }
    return disparity_px;
}

// The ranges of SGBM were shifted once, because the best setting on the tuning images was at the
// border of the range.
std::vector<Setting> settings_of_ours(Match (*match)(const OurSettings&)) {
    std::vector<Setting> all;
    for (const int slope : {9, 11, 14})
        for (const int jump : {42, 50, 60})
            for (const int least : {5, 10})
                for (const int unique : {2, 5})
                    all.push_back(
                        {fmt::format(
                             "penalties {} / {} / {}; uniqueness {} %", slope, jump, least, unique),
                         match({.search = {.slope_penalty = slope,
                                           .jump_penalty = jump,
                                           .min_jump_penalty = least},
                                .selection = {.uniqueness_percent = unique}})});
    return all;
}

std::vector<Setting> settings_of_sgbm(int mode) {
    constexpr double kPenalties[][2] = {{8.0, 32.0}, {14.0, 60.0}, {24.0, 96.0}};
    std::vector<Setting> all;
    for (const int block : {3, 5, 7})
        for (const auto& [slope, jump] : kPenalties)
            for (const int cap : {8, 15})
                for (const int unique : {5, 10})
                    all.push_back({fmt::format("block {}; penalties {} / {}; prefilter {}; "
                                               "uniqueness {} %",
                                               block,
                                               slope,
                                               jump,
                                               cap,
                                               unique),
                                   opencv_sgbm({mode, block, slope, jump, cap, unique})});
    return all;
}

std::vector<Setting> settings_of_bm() {
    std::vector<Setting> all;
    for (const int block : {9, 13, 17, 21})
        for (const int cap : {15, 31, 63})
            for (const int unique : {5, 10, 15})
                all.push_back(
                    {fmt::format("block {}; prefilter {}; uniqueness {} %", block, cap, unique),
                     opencv_bm({block, cap, unique})});
    return all;
}

}  // namespace

Image<float> selected_px(const OurSettings& settings, const TruePair& pair) {
    stereo::SemiGlobalConfig config = settings.search;
    config.disparities = pair.disparities;
    Serial serial;
    stereo::Winners winners;
    stereo::SemiGlobalSearch(config).search(pair.left.view(), pair.right.view(), serial, winners);
    Image<float> selected_px;
    stereo::select_disparities(settings.selection, winners, serial, selected_px);
    stereo::SpeckleFilter().remove(
        serial, stereo::kSpeckleSize_px, stereo::kSpeckleRange_px, selected_px);
    return selected_px;
}

DepthImage chain_depth(const TruePair& pair) {
    stereo::MatcherConfig config;
    config.disparities = pair.disparities;
    Serial serial;
    DepthImage depth;
    stereo::make_matcher(config)->match(pair.left.view(), pair.right.view(), serial, depth);
    return depth;
}

Match chain() {
    return [](const TruePair& pair) { return chain_depth(pair).disparity_px; };
}

Match trusted_chain() {
    return [](const TruePair& pair) {
        DepthImage depth = chain_depth(pair);
        for (std::size_t i = 0; i < depth.disparity_px.size(); ++i) {
            if (depth.outlier_probability.data()[i] > kTrustedOutlierProbability)
                depth.disparity_px.data()[i] = kNanF;
        }
        return depth.disparity_px;
    };
}

Match our_search(const OurSettings& settings) {
    return [=](const TruePair& pair) {
        const Image<float> found_px = selected_px(settings, pair);
        Image<float> disparity_px(found_px.width(), found_px.height());
        std::vector<float> scratch;
        for (int v = 0; v < found_px.height(); ++v)
            stereo::median_of_row(found_px, v, scratch, disparity_px.row(v));
        return disparity_px;
    };
}

Match our_whole(const OurSettings& settings) {
    return [=](const TruePair& pair) {
        const Image<float> found_px = selected_px(settings, pair);
        Serial serial;
        DepthImage depth;
        depth.resize(found_px.width(), found_px.height());
        stereo::Finisher().finish(
            pair.left.view(), pair.right.view(), found_px, stereo::Filter::median, serial, depth);
        return depth.disparity_px;
    };
}

Match opencv_sgbm(const SgbmSettings& settings) {
    return [=](const TruePair& pair) {
        const int block_px2 = settings.block * settings.block;
        const auto matcher = cv::StereoSGBM::create(0,
                                                    pair.disparities,
                                                    settings.block,
                                                    static_cast<int>(settings.slope * block_px2),
                                                    static_cast<int>(settings.jump * block_px2),
                                                    kLeftRight_px,
                                                    settings.prefilter_cap,
                                                    settings.uniqueness_percent,
                                                    stereo::kSpeckleSize_px,
                                                    stereo::kSpeckleRange_px,
                                                    settings.mode);
        return opencv_disparities(*matcher, pair, 0);
    };
}

Match opencv_bm(const BmSettings& settings) {
    return [=](const TruePair& pair) {
        const auto matcher = cv::StereoBM::create(pair.disparities, settings.block);
        matcher->setPreFilterType(cv::StereoBM::PREFILTER_XSOBEL);
        matcher->setPreFilterCap(settings.prefilter_cap);
        matcher->setUniquenessRatio(settings.uniqueness_percent);
        matcher->setDisp12MaxDiff(kLeftRight_px);
        matcher->setSpeckleWindowSize(stereo::kSpeckleSize_px);
        matcher->setSpeckleRange(stereo::kSpeckleRange_px);
        // The border is half a window plus one pixel on every side, because OpenCV needs images
        // larger than its window.
        return opencv_disparities(*matcher, pair, settings.block / 2 + 1);
    };
}

std::vector<Candidate> candidates() {
    std::vector<Candidate> all = {
        {"our whole matcher", chain(), settings_of_ours(our_whole)},
        {"our search alone", our_search({}), settings_of_ours(our_search)},
    };
    for (const auto& [name, mode] :
         {std::pair{"OpenCV SGBM 3-way", static_cast<int>(cv::StereoSGBM::MODE_SGBM_3WAY)},
          std::pair{"OpenCV SGBM HH4", static_cast<int>(cv::StereoSGBM::MODE_HH4)},
          std::pair{"OpenCV SGBM HH", static_cast<int>(cv::StereoSGBM::MODE_HH)},
          std::pair{"OpenCV SGBM 5-path", static_cast<int>(cv::StereoSGBM::MODE_SGBM)}})
        all.push_back({name, opencv_sgbm({.mode = mode}), settings_of_sgbm(mode)});
    all.push_back({"OpenCV BM", opencv_bm({}), settings_of_bm()});
    return all;
}

}  // namespace surefoot::experiments

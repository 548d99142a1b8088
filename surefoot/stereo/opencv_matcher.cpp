// SPDX-License-Identifier: Apache-2.0
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "surefoot/core/unknown.hpp"
#include "surefoot/stereo/clipped.hpp"
#include "surefoot/stereo/consistency.hpp"
#include "surefoot/stereo/finisher.hpp"
#include "surefoot/stereo/matcher.hpp"
#include "surefoot/stereo/row_blocks.hpp"
#include "surefoot/stereo/speckles.hpp"

namespace surefoot::stereo {
namespace {

/// OpenCV's disparities are integers in sixteenths of a pixel.
constexpr float kPixelPerStep = 1.0F / 16.0F;
constexpr int kSgbmPrefilterCap = 63;

/// Runs one of OpenCV's searches and converts its disparities.
class OpenCvMatcher final : public Matcher {
  public:
    /// `margin_px`: width of the border of an image in which `search` finds no match.
    OpenCvMatcher(const MatcherConfig& config, cv::Ptr<cv::StereoMatcher> search, int margin_px)
        : left_right_tolerance_px_(config.left_right_tolerance_px),
          margin_px_(margin_px),
          left_margin_px_(config.disparities + margin_px),
          search_(std::move(search)) {}

    void match(ImageView<const std::uint8_t> left,
               ImageView<const std::uint8_t> right,
               Executor& executor,
               DepthImage& depth) override {
        SUREFOOT_ASSERT(left.width == right.width && left.height == right.height && !left.empty());
        depth.resize(left.width, left.height);
        pad(left, padded_left_);
        pad(right, padded_right_);
        search_->compute(padded_left_, padded_right_, steps_);
        read_steps(executor, depth.disparity_px);
        clipped_.remove(left, executor, depth.disparity_px);
        drop_hidden(executor, left_right_tolerance_px_, depth.disparity_px);
        finisher_.finish(left, right, depth.disparity_px, Filter::none, executor, depth);
    }

  private:
    /// Makes copies with wider borders, because OpenCV gives border pixels no match.
    void pad(ImageView<const std::uint8_t> image, cv::Mat& padded) const {
        const cv::Mat source(image.height,
                             image.width,
                             CV_8UC1,
                             const_cast<std::uint8_t*>(image.data),
                             static_cast<std::size_t>(image.stride));
        cv::copyMakeBorder(source,
                           padded,
                           margin_px_,
                           margin_px_,
                           left_margin_px_,
                           margin_px_,
                           cv::BORDER_REPLICATE);
    }

    void read_steps(Executor& executor, Image<float>& disparity_px) const {
        for_row_blocks(executor, disparity_px.height(), [&](int first, int last) {
            for (int v = first; v < last; ++v) {
                const std::int16_t* const steps =
                    steps_.ptr<std::int16_t>(v + margin_px_) + left_margin_px_;
                float* const d = disparity_px.row(v);
                for (int u = 0; u < disparity_px.width(); ++u) {
                    // Disparity 0 is infinitely far away; negative values mean "no match".
                    d[u] = steps[u] > 0 ? static_cast<float>(steps[u]) * kPixelPerStep : kNanF;
                }
            }
        });
    }

    double left_right_tolerance_px_;
    int margin_px_;
    int left_margin_px_;
    cv::Ptr<cv::StereoMatcher> search_;
    ClippedFilter clipped_;
    Finisher finisher_;
    // These images stay between frames, so that a frame of the same size allocates nothing.
    cv::Mat padded_left_;
    cv::Mat padded_right_;
    cv::Mat steps_;
};

int opencv_mode(SgbmMode mode) {
    switch (mode) {
        case SgbmMode::three_way: return cv::StereoSGBM::MODE_SGBM_3WAY;
        case SgbmMode::hh4: return cv::StereoSGBM::MODE_HH4;
        case SgbmMode::hh: return cv::StereoSGBM::MODE_HH;
    }
    return cv::StereoSGBM::MODE_SGBM_3WAY;
}

}  // namespace

std::unique_ptr<Matcher> make_sgbm_matcher(const MatcherConfig& config) {
    SUREFOOT_ASSERT(!config.problem());
    const int block_px2 = config.block_size * config.block_size;
    return std::make_unique<OpenCvMatcher>(config,
                                           cv::StereoSGBM::create(0,
                                                                  config.disparities,
                                                                  config.block_size,
                                                                  8 * block_px2,
                                                                  32 * block_px2,
                                                                  -1,  // off: we have our own check
                                                                  kSgbmPrefilterCap,
                                                                  config.uniqueness_percent,
                                                                  kSpeckleSize_px,
                                                                  kSpeckleRange_px,
                                                                  opencv_mode(config.sgbm_mode)),
                                           0);
}

std::unique_ptr<Matcher> make_bm_matcher(const MatcherConfig& config) {
    SUREFOOT_ASSERT(!config.problem());
    const auto search = cv::StereoBM::create(config.disparities, config.bm_block_size);
    search->setPreFilterType(cv::StereoBM::PREFILTER_XSOBEL);
    search->setPreFilterCap(config.bm_prefilter_cap);
    search->setUniquenessRatio(config.uniqueness_percent);
    search->setDisp12MaxDiff(-1);  // off: we have our own left-right check
    search->setSpeckleWindowSize(kSpeckleSize_px);
    search->setSpeckleRange(kSpeckleRange_px);
    // The margin is half a window plus one on every side, because OpenCV requires images larger
    // than the window.
    return std::make_unique<OpenCvMatcher>(config, search, config.bm_block_size / 2 + 1);
}

}  // namespace surefoot::stereo

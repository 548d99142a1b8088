// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "surefoot/stereo/consistency.hpp"
#include "surefoot/stereo/finisher.hpp"
#include "surefoot/stereo/matcher.hpp"
#include "surefoot/stereo/row_blocks.hpp"

namespace surefoot::stereo {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
/// OpenCV's disparities are integers in sixteenths of a pixel.
constexpr float kPixelPerStep = 1.0F / 16.0F;
constexpr int kPreFilterCap = 63;
/// Islands below this size that differ by more than kSpeckleRange_px from their surroundings go.
constexpr int kSpeckleSize_px = 100;
constexpr int kSpeckleRange_px = 2;

class SgbmMatcher final : public Matcher {
  public:
    explicit SgbmMatcher(const MatcherConfig& config)
        : config_(config),
          sgbm_(cv::StereoSGBM::create(0,
                                       config.disparities,
                                       config.block_size,
                                       8 * config.block_size * config.block_size,
                                       32 * config.block_size * config.block_size,
                                       -1,  // our own left-right check
                                       kPreFilterCap,
                                       config.uniqueness_percent,
                                       kSpeckleSize_px,
                                       kSpeckleRange_px,
                                       cv::StereoSGBM::MODE_SGBM_3WAY)) {}

    void match(ImageView<const std::uint8_t> left,
               ImageView<const std::uint8_t> right,
               Executor& executor,
               camera::DepthImage& depth) override {
        SUREFOOT_ASSERT(left.width == right.width && left.height == right.height && !left.empty());
        depth.resize(left.width, left.height);
        pad(left, padded_left_);
        pad(right, padded_right_);
        sgbm_->compute(padded_left_, padded_right_, steps_);
        read_steps(executor, depth.disparity_px);
        drop_hidden(executor, config_.left_right_tolerance_px, depth.disparity_px);
        finisher_.finish(left, right, depth.disparity_px, executor, depth);
    }

  private:
    /// Copies with `disparities` columns in front: OpenCV leaves the first ones without a match.
    void pad(ImageView<const std::uint8_t> image, cv::Mat& padded) const {
        const cv::Mat source(image.height,
                             image.width,
                             CV_8UC1,
                             const_cast<std::uint8_t*>(image.data),
                             static_cast<std::size_t>(image.stride));
        cv::copyMakeBorder(source, padded, 0, 0, config_.disparities, 0, cv::BORDER_REPLICATE);
    }

    void read_steps(Executor& executor, Image<float>& disparity_px) const {
        for_row_blocks(executor, disparity_px.height(), [&](int first, int last) {
            for (int v = first; v < last; ++v) {
                const std::int16_t* const steps = steps_.ptr<std::int16_t>(v) + config_.disparities;
                float* const d = disparity_px.row(v);
                for (int u = 0; u < disparity_px.width(); ++u) {
                    // 0 would be infinitely far away, below it stands "no match".
                    d[u] = steps[u] > 0 ? static_cast<float>(steps[u]) * kPixelPerStep : kNan;
                }
            }
        });
    }

    MatcherConfig config_;
    cv::Ptr<cv::StereoSGBM> sgbm_;
    Finisher finisher_;
    // Kept between frames, so that nothing is allocated anew.
    cv::Mat padded_left_;
    cv::Mat padded_right_;
    cv::Mat steps_;
};

}  // namespace

std::unique_ptr<Matcher> make_sgbm_matcher(const MatcherConfig& config) {
    SUREFOOT_ASSERT(!config.problem());
    return std::make_unique<SgbmMatcher>(config);
}

}  // namespace surefoot::stereo

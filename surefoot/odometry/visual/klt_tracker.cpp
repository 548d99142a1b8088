// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/klt_tracker.hpp"

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>

namespace surefoot::odometry {
namespace {

constexpr int kLevels = 4;  ///< full size and four halvings: about 50 px of unpredicted motion
constexpr int kWindow_px = 15;
constexpr int kSharpnessLevel = 2;
constexpr int kBlock = 64;  ///< points per task of the executor

/// OpenCV's derivatives are 32 times the grey step per pixel (Scharr: 3 + 10 + 3, twice).
constexpr double kDerivativeScale = 32.0;

}  // namespace

struct ImagePyramid::Impl {
    std::vector<cv::Mat> levels;  ///< per level: the image, then its derivatives
    int top = 0;
    int width = 0;
    int height = 0;
};

ImagePyramid::ImagePyramid() : impl_(std::make_unique<Impl>()) {}
ImagePyramid::~ImagePyramid() = default;
ImagePyramid::ImagePyramid(ImagePyramid&&) noexcept = default;
ImagePyramid& ImagePyramid::operator=(ImagePyramid&&) noexcept = default;

void ImagePyramid::build(ImageView<const std::uint8_t> image) {
    impl_->width = image.width;
    impl_->height = image.height;
    if (image.empty()) return;
    const cv::Mat wrapped(image.height,
                          image.width,
                          CV_8UC1,
                          const_cast<std::uint8_t*>(image.data),  // OpenCV has no const view
                          static_cast<std::size_t>(image.stride));
    impl_->top = cv::buildOpticalFlowPyramid(wrapped,
                                             impl_->levels,
                                             cv::Size(kWindow_px, kWindow_px),
                                             kLevels,
                                             true,
                                             cv::BORDER_REFLECT_101,
                                             cv::BORDER_CONSTANT,
                                             false);
}

bool ImagePyramid::empty() const noexcept {
    return impl_->width == 0 || impl_->levels.empty();
}

ImageView<const std::uint8_t> ImagePyramid::image() const noexcept {
    if (empty()) return {};
    const cv::Mat& full = impl_->levels[0];
    return {full.ptr<std::uint8_t>(), full.cols, full.rows, static_cast<int>(full.step[0])};
}

double ImagePyramid::sharpness() const {
    if (empty()) return 0.0;
    const int level = std::min(kSharpnessLevel, impl_->top);
    const cv::Mat& derivatives = impl_->levels[static_cast<std::size_t>(2 * level + 1)];
    std::int64_t sum = 0;
    for (int v = 0; v < derivatives.rows; ++v) {
        const auto* row = derivatives.ptr<std::int16_t>(v);
        for (int i = 0; i < 2 * derivatives.cols; ++i)
            sum += static_cast<std::int64_t>(row[i]) * row[i];
    }
    const double pixels = static_cast<double>(derivatives.rows) * derivatives.cols;
    return static_cast<double>(sum) / (pixels * kDerivativeScale * kDerivativeScale);
}

namespace {

/// Tracks one block in one direction. `points` holds the start positions and receives the results.
void track_block(const ImagePyramid& from,
                 const ImagePyramid& to,
                 const std::vector<cv::Point2f>& origins,
                 int top_level,
                 const KltConfig& config,
                 std::vector<cv::Point2f>& points,
                 std::vector<std::uint8_t>& found) {
    const int levels = std::min({top_level, from.impl().top, to.impl().top});
    cv::calcOpticalFlowPyrLK(
        from.impl().levels,
        to.impl().levels,
        origins,
        points,
        found,
        cv::noArray(),
        cv::Size(kWindow_px, kWindow_px),
        levels,
        cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, config.iterations, 0.02),
        cv::OPTFLOW_USE_INITIAL_FLOW,
        1e-4);
}

void track_there_and_back(const ImagePyramid& from,
                          const ImagePyramid& to,
                          std::span<const KltRequest> requests,
                          const KltConfig& config,
                          std::span<KltResult> results) {
    std::vector<cv::Point2f> origins;
    std::vector<cv::Point2f> points;
    for (const KltRequest& request : requests) {
        origins.emplace_back(request.from_px.x(), request.from_px.y());
        points.emplace_back(request.start_px.x(), request.start_px.y());
    }
    std::vector<std::uint8_t> found;
    std::vector<std::uint8_t> returned;
    track_block(from, to, origins, kLevels, config, points, found);
    // Tracks back from the result. The original position is a good start, so the full size and one
    // halving are enough.
    std::vector<cv::Point2f> back = origins;
    track_block(to, from, points, 1, config, back, returned);
    const auto limit_px = static_cast<float>(config.forward_backward_px);
    for (std::size_t i = 0; i < requests.size(); ++i) {
        const cv::Point2f error = back[i] - origins[i];
        const bool inside = points[i].x >= 0.0F && points[i].y >= 0.0F &&
                            points[i].x <= static_cast<float>(to.impl().width - 1) &&
                            points[i].y <= static_cast<float>(to.impl().height - 1);
        results[i].px = {points[i].x, points[i].y};
        results[i].found =
            found[i] != 0 && returned[i] != 0 && inside && error.dot(error) <= limit_px * limit_px;
    }
}

}  // namespace

void track_points(const ImagePyramid& from,
                  const ImagePyramid& to,
                  std::span<const KltRequest> requests,
                  const KltConfig& config,
                  Executor& executor,
                  std::vector<KltResult>& results) {
    results.assign(requests.size(), KltResult{Eigen::Vector2f::Zero(), false});
    if (requests.empty() || from.empty() || to.empty()) return;
    const int count = static_cast<int>(requests.size());
    const int blocks = (count + kBlock - 1) / kBlock;
    executor.parallel_for(blocks, [&](int block) {
        const auto begin = static_cast<std::size_t>(block * kBlock);
        const auto size = std::min(static_cast<std::size_t>(kBlock), requests.size() - begin);
        track_there_and_back(from,
                             to,
                             requests.subspan(begin, size),
                             config,
                             std::span(results).subspan(begin, size));
    });
}

}  // namespace surefoot::odometry

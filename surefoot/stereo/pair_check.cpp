// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/pair_check.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "surefoot/geometry/statistics.hpp"
#include "surefoot/stereo/window_shift.hpp"

namespace surefoot::stereo {
namespace {

constexpr int kHalf_px = kShiftHalf_px;  ///< half size of the window around a corner
constexpr int kMaxCorners = 300;
/// Smallest quality of a corner relative to the best corner.
constexpr double kCornerQuality = 0.01;
constexpr double kMinCorrelation = 0.9;
/// Largest ratio of the second best correlation to the best one. If a second position fits nearly
/// as well (a fence, a tiled floor), the match is ambiguous.
constexpr double kMaxSecond = 0.95;

cv::Mat as_mat(ImageView<const std::uint8_t> image) {
    // cv::Mat has no view of constant pixels. The callers only read the pixels.
    return {image.height,
            image.width,
            CV_8UC1,
            const_cast<std::uint8_t*>(image.data),
            static_cast<std::size_t>(image.stride)};
}

/// Returns the whole-pixel shift of a corner with the best normalised correlation.
std::optional<WindowShift> whole_shift_of(const cv::Mat& left,
                                          const cv::Mat& right,
                                          const cv::Point& corner,
                                          const PairSearch& search) {
    const cv::Rect window(
        corner.x - kHalf_px, corner.y - kHalf_px, 2 * kHalf_px + 1, 2 * kHalf_px + 1);
    const cv::Rect all(0, 0, left.cols, left.rows);
    if ((window & all) != window) return std::nullopt;
    const cv::Rect strip = all & cv::Rect(window.x - search.disparity_px,
                                          window.y - search.rows_px,
                                          window.width + 2 * search.disparity_px,
                                          window.height + 2 * search.rows_px);
    cv::Mat score;
    cv::matchTemplate(right(strip), left(window), score, cv::TM_CCOEFF_NORMED);
    double best = 0.0;
    cv::Point at;
    cv::minMaxLoc(score, nullptr, &best, nullptr, &at);
    // If the maximum lies in the first or last row of the search area, the true maximum may lie
    // beyond the area.
    if (!(best >= kMinCorrelation) || at.y == 0 || at.y == score.rows - 1) return std::nullopt;
    const cv::Rect peak(at.x - kHalf_px / 2, at.y - kHalf_px / 2, kHalf_px, kHalf_px);
    score(peak & cv::Rect(0, 0, score.cols, score.rows)).setTo(-1.0);
    double second = 0.0;
    cv::minMaxLoc(score, nullptr, &second);
    if (second > kMaxSecond * best) return std::nullopt;
    return WindowShift{static_cast<double>(strip.x + at.x - window.x),
                       static_cast<double>(strip.y + at.y - window.y)};
}

}  // namespace

Corners match_corners(ImageView<const std::uint8_t> left,
                      ImageView<const std::uint8_t> right,
                      const PairSearch& search) {
    SUREFOOT_ASSERT(left.width == right.width && left.height == right.height);
    Corners corners;
    if (left.width <= 2 * kHalf_px + 2 || left.height <= 2 * kHalf_px + 2) return corners;
    const cv::Mat left_mat = as_mat(left);
    const cv::Mat right_mat = as_mat(right);
    std::vector<cv::Point2f> places;
    // Smallest distance between two corners. It grows with the image size and spreads the corners
    // over the image.
    const double distance_px = std::max(6.0, std::sqrt(left.width * (left.height / 1200.0)));
    cv::goodFeaturesToTrack(left_mat, places, kMaxCorners, kCornerQuality, distance_px);
    corners.found = static_cast<int>(places.size());
    for (const cv::Point2f& place : places) {
        const cv::Point corner(place);
        const auto whole = whole_shift_of(left_mat, right_mat, corner, search);
        if (!whole) continue;
        if (const auto shift = refine_shift(left, right, corner.x, corner.y, *whole)) {
            corners.matched.push_back({static_cast<double>(corner.x),
                                       static_cast<double>(corner.y),
                                       shift->columns_px,
                                       shift->rows_px});
        }
    }
    return corners;
}

PairCheck check_pair(ImageView<const std::uint8_t> left,
                     ImageView<const std::uint8_t> right,
                     const PairSearch& search) {
    const Corners corners = match_corners(left, right, search);
    PairCheck check;
    check.corners = corners.found;
    check.matched = static_cast<int>(corners.matched.size());
    if (corners.matched.empty()) return check;
    std::vector<double> rows_px;
    std::vector<double> absolute_px;
    for (const CornerShift& corner : corners.matched) {
        rows_px.push_back(corner.rows_px);
        absolute_px.push_back(std::abs(corner.rows_px));
        check.backward += corner.columns_px > 1.0 ? 1 : 0;
    }
    check.row_offset_px = upper_median(std::move(rows_px));
    check.row_error_px = upper_median(std::move(absolute_px));
    return check;
}

}  // namespace surefoot::stereo

// SPDX-License-Identifier: Apache-2.0
#include "service/live/measured_pair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/io/images/image_file.hpp"
#include "surefoot/stereo/matcher.hpp"

namespace surefoot::app {
namespace {

/// Largest disparity of the corner search; it limits the run time. If the disparity range of the
/// matcher is smaller, the search uses the range of the matcher.
constexpr int kMaxCornerDisparity_px = 256;
/// Number of rows to search up and down: unrectified images of real rigs differ by tens of rows.
constexpr int kFarRows_px = 32;
/// Largest acceptable median row difference. If the difference is larger, a matcher that searches
/// along rows loses accuracy and matches.
constexpr double kMaxRowError_px = 0.5;

std::string size_text(const GreyImage& image) {
    return fmt::format("{}x{}", image.width(), image.height());
}

Status check_sizes(const StereoFrame& frame, const std::optional<camera::StereoRig>& rig) {
    if (frame.left.width() != frame.right.width() || frame.left.height() != frame.right.height()) {
        return input_error(
            fmt::format("the images differ in size: the left image has {} px, the right image {} "
                        "px; give two images of one size",
                        size_text(frame.left),
                        size_text(frame.right)));
    }
    if (!rig) return {};
    if (!rig->right) {
        return input_error(fmt::format(
            "rig '{}' has one camera, but depth needs two; give a calibration of two cameras",
            rig->name));
    }
    if (frame.left.width() != rig->left.width || frame.left.height() != rig->left.height) {
        return input_error(
            fmt::format("the images have {} px, but rig '{}' was calibrated for {}x{} px; give "
                        "images of this size, or the calibration for the size of the images",
                        size_text(frame.left),
                        rig->name,
                        rig->left.width,
                        rig->left.height));
    }
    return {};
}

}  // namespace

stereo::PairCheck check_rows(const camera::RectifiedPair& pair, int disparities) {
    stereo::PairSearch search;
    search.disparity_px = std::min(disparities, kMaxCornerDisparity_px);
    const stereo::PairCheck near = check_pair(pair.left.view(), pair.right.view(), search);
    if (near.enough() || near.corners < stereo::PairCheck::kEnough) return near;
    search.rows_px = kFarRows_px;
    return check_pair(pair.left.view(), pair.right.view(), search);
}

Status refuse_swapped(const stereo::PairCheck& check) {
    if (!check.swapped()) return {};
    return input_error(
        fmt::format("left and right camera seem to be swapped: {} of {} corners lie farther right "
                    "in the right image than in the left image; swap the two images",
                    check.backward,
                    check.matched));
}

std::string row_problem(const stereo::PairCheck& check, bool has_rig) {
    if (!check.enough()) {
        return fmt::format(
            "only {} of {} corners of the left image were found in the right image within {} rows. "
            "So the rectification of the pair cannot be checked; use a scene with more texture",
            check.matched,
            check.corners,
            kFarRows_px);
    }
    if (check.row_error_px <= kMaxRowError_px) return {};
    return fmt::format(
        "rows differ by {:.2f} px (median over {} corners; signed median {:+.2f} px; limit {} px): "
        "{}. Or the objects are nearer than stereo.disparities allows; then increase "
        "stereo.disparities",
        check.row_error_px,
        check.matched,
        check.row_offset_px,
        kMaxRowError_px,
        has_rig ? "the calibration does not fit these images; calibrate the cameras again"
                : "the pair is not rectified; give its calibration with --rig");
}

Result<MeasuredPair> measure_pair(const StereoFrame& frame,
                                  const std::optional<camera::StereoRig>& rig,
                                  const pipeline::PipelineConfig& config,
                                  Executor& executor) {
    if (auto status = check_sizes(frame, rig); !status) return status.error();
    MeasuredPair measured;
    if (rig) {
        const auto rectifier = camera::Rectifier::make(*rig, config.camera);
        if (!rectifier) return rectifier.error();
        rectifier->rectify(frame, measured.pair);
        measured.rig = rectifier->rig();
    } else {
        measured.pair = {frame.left, frame.right};
    }
    const GreyImage& left = measured.pair.left;
    const GreyImage& right = measured.pair.right;
    if (left.width() <= config.stereo.disparities) {
        return input_error(
            fmt::format("images of {} px are too narrow for stereo.disparities = {}; set "
                        "stereo.disparities to a smaller value",
                        size_text(left),
                        config.stereo.disparities));
    }
    measured.check = check_rows(measured.pair, config.stereo.disparities);
    if (auto status = refuse_swapped(measured.check); !status) return status.error();
    stereo::make_matcher(config.stereo)->match(left.view(), right.view(), executor, measured.depth);
    return measured;
}

Result<MeasuredPair> measure_files(const std::string& left,
                                   const std::string& right,
                                   const std::optional<camera::StereoRig>& rig,
                                   const pipeline::PipelineConfig& config,
                                   Executor& executor) {
    auto left_image = io::read_grey_image(left);
    if (!left_image) return left_image.error();
    auto right_image = io::read_grey_image(right);
    if (!right_image) return right_image.error();
    StereoFrame frame;
    frame.left = std::move(left_image).value();
    frame.right = std::move(right_image).value();
    auto measured = measure_pair(frame, rig, config, executor);
    if (!measured)
        return input_error(fmt::format("{}, {}: {}", left, right, measured.error().message));
    return measured;
}

PairFigures figures_of(const DepthImage& depth) {
    std::vector<float> sigmas_px;
    std::size_t known = 0;
    for (std::size_t i = 0; i < depth.disparity_px.size(); ++i) {
        if (!std::isfinite(depth.disparity_px.data()[i])) continue;
        ++known;
        if (depth.outlier_probability.data()[i] <= kTrustedOutlierProbability)
            sigmas_px.push_back(depth.sigma_px.data()[i]);
    }
    const double percent = 100.0 / static_cast<double>(depth.disparity_px.size());
    PairFigures figures{percent * static_cast<double>(known),
                        percent * static_cast<double>(sigmas_px.size()),
                        std::numeric_limits<double>::quiet_NaN()};
    if (sigmas_px.empty()) return figures;
    const auto middle = sigmas_px.begin() + static_cast<std::ptrdiff_t>(sigmas_px.size() / 2);
    std::nth_element(sigmas_px.begin(), middle, sigmas_px.end());
    figures.median_sigma_px = static_cast<double>(*middle);
    return figures;
}

}  // namespace surefoot::app

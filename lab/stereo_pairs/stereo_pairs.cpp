// SPDX-License-Identifier: Apache-2.0
#include "lab/stereo_pairs/stereo_pairs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::experiments {
namespace {

constexpr float kStepsPerPixel = 16.0F;

struct PairFiles {
    const char* name = nullptr;
    const char* folder = nullptr;
    const char* right = nullptr;
    const char* truth = nullptr;
    const char* right_truth = nullptr;  ///< nullptr = use `mask` instead
    const char* mask = nullptr;
    double scale = 1.0;
    int disparities = 64;
    double truth_offset_px = 0.0;
};
constexpr PairFiles kPairs[] = {
    {"cones", "cones", "right.png", "disp_left_x4.png", "disp_right_x4.png", nullptr, 4.0, 64},
    {"teddy", "teddy", "right.png", "disp_left_x4.png", "disp_right_x4.png", nullptr, 4.0, 64},
    {"cloth3", "cloth3", "right.png", "disp_left.png", "disp_right.png", nullptr, 2.0, 96},
    {"adirondack", "adirondack", "right.png", "gt.png", nullptr, "mask.png", 1.0, 96, 0.5},
    {"adirondack (exposure)",
     "adirondack",
     "rightE.png",
     "gt.png",
     nullptr,
     "mask.png",
     1.0,
     96,
     0.5},
};

/// Reads a grey image. Returns an empty image if the file is not an image.
GreyImage load(const std::string& path) {
    const cv::Mat read = cv::imread(path, cv::IMREAD_GRAYSCALE);
    GreyImage image(read.cols, read.rows);
    if (!read.empty()) read.copyTo(cv::Mat(read.rows, read.cols, CV_8UC1, image.data()));
    return image;
}

/// Returns true if both cameras see a pixel: their truths agree within 1 px.
bool agrees(const GreyImage& right_truth, double scale, int u, int v, double disparity_px) {
    const int x = static_cast<int>(std::lround(u - disparity_px));
    return right_truth.contains(x, v) && right_truth.at(x, v) != 0 &&
           std::abs(right_truth.at(x, v) / scale - disparity_px) <= 1.0;
}

TruePair load_pair(const std::string& root, const PairFiles& files) {
    const std::string folder = fmt::format("{}/{}/", root, files.folder);
    TruePair pair;
    pair.name = files.name;
    pair.left = load(folder + "left.png");
    pair.right = load(folder + files.right);
    pair.disparities = files.disparities;
    pair.step_px = 1.0 / files.scale;
    pair.truth_offset_px = files.truth_offset_px;
    const GreyImage truth = load(folder + files.truth);
    const GreyImage other =
        files.right_truth != nullptr ? load(folder + files.right_truth) : GreyImage();
    const GreyImage mask = files.mask != nullptr ? load(folder + files.mask) : GreyImage();
    pair.truth_px = Image<float>(truth.width(), truth.height(), kNanF);
    for (int v = 0; v < truth.height(); ++v) {
        for (int u = 0; u < truth.width(); ++u) {
            const double d = truth.at(u, v) / files.scale;
            if (truth.at(u, v) == 0 || (!mask.empty() && mask.at(u, v) <= 200)) continue;
            if (!other.empty() && !agrees(other, files.scale, u, v, d)) continue;
            pair.truth_px.at(u, v) = static_cast<float>(d);
        }
    }
    return pair;
}

}  // namespace

Result<std::vector<TruePair>> middlebury_pairs(const std::string& folder) {
    std::vector<TruePair> pairs;
    pairs.reserve(std::size(kPairs));
    for (const PairFiles& files : kPairs) {
        pairs.push_back(load_pair(folder, files));
        const TruePair& pair = pairs.back();
        if (pair.left.empty() || pair.right.empty() || pair.truth_px.empty())
            return input_error(fmt::format("no images of {} in {}", pair.name, folder));
    }
    return pairs;
}

Result<TruePair> simulated_pair(const sim::SceneOptions& options) {
    sim::SceneOptions first = options;
    first.frames = 1;
    auto source = sim::open_scene(first);
    if (!source) return source.error();
    const auto frame = (*source)->next();
    if (!frame) return frame.error();
    const auto rectifier = camera::Rectifier::make((*source)->rig());
    if (!rectifier) return rectifier.error();
    TruePair pair;
    pair.name = fmt::format("{} ({} x {:g})",
                            options.scene,
                            sim::kCameraProfileNames[static_cast<std::size_t>(options.profile)],
                            options.noise);
    pair.left = (*frame)->left;
    pair.right = (*frame)->right;
    const double fb_px_m = rectifier->rig().depth_to_disparity_px_m();
    const Image<float>& depth_m = (*source)->last_depth_m();
    pair.truth_px = Image<float>(depth_m.width(), depth_m.height(), kNanF);
    for (std::size_t i = 0; i < depth_m.size(); ++i) {
        if (depth_m.data()[i] > 0.0F)
            pair.truth_px.data()[i] =
                static_cast<float>(fb_px_m / static_cast<double>(depth_m.data()[i]));
    }
    return pair;
}

void forget_hidden(TruePair& pair) {
    for (int v = 0; v < pair.truth_px.height(); ++v) {
        float seen_from = static_cast<float>(pair.truth_px.width());
        for (int u = pair.truth_px.width() - 1; u >= 0; --u) {
            float& truth_px = pair.truth_px.at(u, v);
            const float x = static_cast<float>(u) - truth_px;
            if (std::isnan(x)) continue;
            if (x >= seen_from || x < 0.0F) truth_px = kNanF;
            seen_from = std::fmin(seen_from, x);
        }
    }
}

Image<float> filled(const Image<float>& disparity_px) {
    Image<float> result = disparity_px;
    for (int v = 0; v < result.height(); ++v) {
        std::vector<float> from_left(static_cast<std::size_t>(result.width()), kNanF);
        float last = kNanF;
        for (int u = 0; u < result.width(); ++u) {
            if (!std::isnan(disparity_px.at(u, v))) last = disparity_px.at(u, v);
            from_left[static_cast<std::size_t>(u)] = last;
        }
        last = kNanF;
        for (int u = result.width() - 1; u >= 0; --u) {
            if (!std::isnan(disparity_px.at(u, v))) last = disparity_px.at(u, v);
            result.at(u, v) = std::fmin(from_left[static_cast<std::size_t>(u)], last);
        }
    }
    return result;
}

Score score(const TruePair& pair, const Image<float>& disparity_px, Truth truth) {
    const Image<float> all = filled(disparity_px);
    const auto offset_px = static_cast<float>(truth == Truth::centred ? pair.truth_offset_px : 0.0);
    double count = 0.0;
    Score sum;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const float truth_px = pair.truth_px.data()[i] + offset_px;
        if (std::isnan(truth_px)) continue;
        const float steps = std::round(all.data()[i] * kStepsPerPixel);
        const float error_px = std::abs(steps / kStepsPerPixel - truth_px);
        const double bad_1 = error_px <= 1.0F ? 0.0 : 100.0;
        const double bad_2 = error_px <= 2.0F ? 0.0 : 100.0;
        ++count;
        sum.bad_1 += bad_1;
        sum.bad_2 += bad_2;
        if (std::isnan(disparity_px.data()[i])) continue;
        sum.density += 100.0;
        sum.matched_bad_1 += bad_1;
        sum.matched_bad_2 += bad_2;
    }
    const double matched = sum.density / 100.0;
    return {sum.bad_1 / count,
            sum.bad_2 / count,
            sum.matched_bad_1 / matched,
            sum.matched_bad_2 / matched,
            sum.density / count};
}

}  // namespace surefoot::experiments

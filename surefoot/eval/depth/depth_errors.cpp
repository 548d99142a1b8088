// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/depth/depth_errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/core/unknown.hpp"
#include "surefoot/geometry/statistics.hpp"

namespace surefoot::eval {
namespace {

template <typename T>
Status check_size(const char* name, ImageView<T> image, ImageView<const float> truth_px) {
    if (image.width == truth_px.width && image.height == truth_px.height) return {};
    return input_error(
        fmt::format("eval depth: the {} has {} x {} pixels, but the truth has {} x {}; give files "
                    "of the same image",
                    name,
                    image.width,
                    image.height,
                    truth_px.width,
                    truth_px.height));
}

Status check_sizes(const DepthPair& pair) {
    if (auto status = check_size("estimate", pair.estimate_px, pair.truth_px); !status)
        return status;
    if (!pair.mask.empty()) {
        if (auto status = check_size("mask", pair.mask, pair.truth_px); !status) return status;
    }
    if (pair.sigma_px.empty()) return {};
    return check_size("sigma", pair.sigma_px, pair.truth_px);
}

class BadCounter {
  public:
    /// A NaN error is bad at every limit.
    void add(double error_px) {
        ++count_;
        for (int k = 0; k < 3; ++k) bad_[k] += std::abs(error_px) <= kLimits_px[k] ? 0 : 1;
    }
    [[nodiscard]] BadPixels shares() const {
        const auto percent = [this](std::int64_t bad) {
            return count_ == 0 ? std::numeric_limits<double>::quiet_NaN()
                               : 100.0 * static_cast<double>(bad) / static_cast<double>(count_);
        };
        return {percent(bad_[0]), percent(bad_[1]), percent(bad_[2])};
    }

  private:
    static constexpr double kLimits_px[3] = {0.5, 1.0, 2.0};
    std::int64_t bad_[3] = {};
    std::int64_t count_ = 0;
};

void keep_smaller(float& kept_px, float candidate_px) {
    if (std::isnan(kept_px) || candidate_px < kept_px) kept_px = candidate_px;
}

double median(std::vector<float>& values) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(upper_median_in_place(values));
}

}  // namespace

std::optional<double> suspected_factor(double truth_over_estimate) noexcept {
    // Middlebury uses 2, 3, 4 and 8, OpenCV 16, KITTI 256. The other factors lie between 16 and
    // 256.
    constexpr double kFactors[] = {2.0, 3.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0};
    // Largest deviation of the ratio, as a share of the factor. The median error of even a poor
    // matcher is smaller.
    constexpr double kTolerance = 0.125;
    for (const double factor : kFactors) {
        for (const double candidate : {factor, 1.0 / factor}) {
            if (std::abs(truth_over_estimate / candidate - 1.0) <= kTolerance) return candidate;
        }
    }
    return std::nullopt;
}

Image<float> filled(ImageView<const float> disparity_px) {
    Image<float> result(disparity_px.width, disparity_px.height, kNanF);
    for (int v = 0; v < disparity_px.height; ++v) {
        const float* in = disparity_px.row(v);
        float* out = result.row(v);
        float nearest_px = kNanF;
        for (int u = 0; u < disparity_px.width; ++u) {
            if (!std::isnan(in[u])) nearest_px = in[u];
            out[u] = nearest_px;
        }
        nearest_px = kNanF;
        for (int u = disparity_px.width - 1; u >= 0; --u) {
            if (!std::isnan(in[u])) {
                nearest_px = in[u];
            } else {
                keep_smaller(out[u], nearest_px);
            }
        }
    }
    return result;
}

Result<DepthErrors> depth_errors(const DepthPair& pair) {
    if (auto status = check_sizes(pair); !status) return status.error();
    const Image<float> filled_px = filled(pair.estimate_px);
    BadCounter all;
    BadCounter known;
    std::vector<float> errors_px;
    std::vector<float> sigmas_px;
    std::vector<float> ratios;
    DepthErrors result;
    for (int v = 0; v < pair.truth_px.height; ++v) {
        for (int u = 0; u < pair.truth_px.width; ++u) {
            const auto truth_px = static_cast<double>(pair.truth_px.at(u, v));
            const bool masked = !pair.mask.empty() && pair.mask.at(u, v) == 0;
            if (std::isnan(truth_px) || masked) continue;
            ++result.counted;
            all.add(static_cast<double>(filled_px.at(u, v)) - truth_px);
            const auto estimate_px = static_cast<double>(pair.estimate_px.at(u, v));
            if (std::isnan(estimate_px)) continue;
            known.add(estimate_px - truth_px);
            errors_px.push_back(static_cast<float>(estimate_px - truth_px));
            if (truth_px > 0.0 && estimate_px > 0.0)
                ratios.push_back(static_cast<float>(truth_px / estimate_px));
            if (!pair.sigma_px.empty()) sigmas_px.push_back(pair.sigma_px.at(u, v));
        }
    }
    sigmas_px.resize(errors_px.size(), kNanF);
    result.bad = all.shares();
    result.known_bad = known.shares();
    result.density_percent = result.counted == 0 ? std::numeric_limits<double>::quiet_NaN()
                                                 : 100.0 * static_cast<double>(errors_px.size()) /
                                                       static_cast<double>(result.counted);
    result.truth_over_estimate = median(ratios);
    result.known = error_figures(errors_px);
    result.coverage = sigma_coverage(errors_px, sigmas_px);
    result.sparsification = sparsification(errors_px, sigmas_px);
    return result;
}

}  // namespace surefoot::eval

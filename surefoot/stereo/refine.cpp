// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/refine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/stereo/row_blocks.hpp"

namespace surefoot::stereo {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
/// Grey levels are held in sixteenths.
constexpr float kScale = 16.0F;
/// Differences beyond 32 grey levels say "not the same point", not "by how much".
constexpr float kMaxError = 512.0F;
/// 64 grey levels per pixel; 33 x 33 squares of it fit an int32: 1089 * 1024^2 = 1.1e9.
constexpr float kMaxGradient = 1024.0F;
constexpr int kMaxWindowRadius_px = 16;

/// Binomial 1 4 6 4 1 in both directions, result in 1/16 grey level. It removes what the linear
/// interpolation of the warp cannot represent.
void smooth_image_row(ImageView<const std::uint8_t> in, int v, Image<std::int16_t>& out) {
    const std::uint8_t* rows[5];
    for (int k = 0; k < 5; ++k) rows[k] = in.row(std::clamp(v + k - 2, 0, in.height - 1));
    std::vector<int> column(static_cast<std::size_t>(in.width) + 4);
    int* const sum = column.data() + 2;
    for (int u = 0; u < in.width; ++u) {
        sum[u] = rows[0][u] + rows[4][u] + 4 * (rows[1][u] + rows[3][u]) + 6 * rows[2][u];
    }
    sum[-2] = sum[-1] = sum[0];
    sum[in.width] = sum[in.width + 1] = sum[in.width - 1];
    std::int16_t* const target = out.row(v);
    for (int u = 0; u < in.width; ++u) {
        const int total = sum[u - 2] + sum[u + 2] + 4 * (sum[u - 1] + sum[u + 1]) + 6 * sum[u];
        target[u] = static_cast<std::int16_t>((total + 8) >> 4);
    }
}

/// Nearest integer of |x| < 4096, without a rounding call.
std::int16_t rounded(float x) noexcept {
    return static_cast<std::int16_t>(static_cast<int>(x + 4096.5F) - 4096);
}

/// Exact sums over a window.
struct Sums {
    std::int32_t n = 0, g = 0, e = 0, gg = 0, ge = 0, ee = 0;

    void add(const Sums& o) noexcept {
        n += o.n, g += o.g, e += o.e, gg += o.gg, ge += o.ge, ee += o.ee;
    }
    void subtract(const Sums& o) noexcept {
        n -= o.n, g -= o.g, e -= o.e, gg -= o.gg, ge -= o.ge, ee -= o.ee;
    }
};

/// Adds (sign 1) or removes (sign -1) one image row in the column sums.
void accumulate(const std::int16_t* g,
                const std::int16_t* e,
                const std::int16_t* used,
                std::int32_t sign,
                std::vector<Sums>& columns) {
    for (std::size_t u = 0; u < columns.size(); ++u) {
        Sums& c = columns[u];
        const std::int32_t sg = sign * g[u];
        const std::int32_t se = sign * e[u];
        c.n += sign * used[u];
        c.g += sg;
        c.e += se;
        c.gg += sg * g[u];
        c.ge += sg * e[u];
        c.ee += se * e[u];
    }
}

struct Step {
    float shift_px = 0.0F;
    float residual_grey = kMaxError / kScale;
    float gradient_grey_px = 0.0F;
};

/// Equation of the class comment for one window.
Step solve(const Sums& w, int enough, const RefineConfig& config) noexcept {
    Step step;
    if (w.n < enough) return step;
    const float n = static_cast<float>(w.n);
    const auto g = static_cast<float>(w.g);
    const auto e = static_cast<float>(w.e);
    constexpr float kUnit = 1.0F / (kScale * kScale);
    const float gg = std::max(0.0F, (static_cast<float>(w.gg) - g * g / n) * kUnit);
    const float ge = (static_cast<float>(w.ge) - g * e / n) * kUnit;
    const float ee = (static_cast<float>(w.ee) - e * e / n) * kUnit;
    const float explained = gg > 0.0F ? ge * ge / gg : 0.0F;
    const auto min_noise = static_cast<float>(config.min_noise_grey);
    const float variance = std::max(min_noise * min_noise, (ee - explained) / n);
    const float weight = 1.0F / (static_cast<float>(config.correlation) * variance);
    const auto prior = static_cast<float>(config.prior_sigma_px);
    const auto limit = static_cast<float>(config.max_step_px);
    step.shift_px =
        std::clamp(-ge * weight / (gg * weight + 1.0F / (prior * prior)), -limit, limit);
    step.residual_grey = std::sqrt(variance);
    step.gradient_grey_px = std::sqrt(gg / n);
    return step;
}

}  // namespace

void smooth_along(const Image<float>& in,
                  int v,
                  bool down,
                  int radius_px,
                  double same_surface_px,
                  Image<float>& out) {
    const int width = in.width();
    const auto limit = static_cast<float>(same_surface_px);
    std::vector<float> sum(static_cast<std::size_t>(width), 0.0F);
    std::vector<float> count(static_cast<std::size_t>(width), 1.0F);
    const float* const centre = in.row(v);
    for (int k = 1; k <= radius_px; ++k) {
        if (down && (v - k < 0 || v + k >= in.height())) break;
        const float* const before = down ? in.row(v - k) : centre - k;
        const float* const after = down ? in.row(v + k) : centre + k;
        const int margin = down ? 0 : k;
        for (int u = margin; u < width - margin; ++u) {
            const float low = before[u] - centre[u];
            const float high = after[u] - centre[u];
            // NaN compares false.
            const bool same = std::abs(low) <= limit && std::abs(high) <= limit;
            sum[static_cast<std::size_t>(u)] += same ? low + high : 0.0F;
            count[static_cast<std::size_t>(u)] += same ? 2.0F : 0.0F;
        }
    }
    float* const target = out.row(v);
    for (int u = 0; u < width; ++u) {
        target[u] =
            centre[u] + sum[static_cast<std::size_t>(u)] / count[static_cast<std::size_t>(u)];
    }
}

SubpixelRefiner::SubpixelRefiner(const RefineConfig& config) : config_(config) {
    SUREFOOT_ASSERT(config.window_radius_px >= 1 && config.window_radius_px <= kMaxWindowRadius_px);
}

/// Grey difference and gradient of every pixel of a row at its disparity.
void SubpixelRefiner::warp(int v,
                           const Image<std::uint8_t>& jump_distance_px,
                           const Image<float>& disparity_px) {
    const int width = left_.width();
    const std::int16_t* const l = left_.row(v);
    const std::int16_t* const r = right_.row(v);
    const float* const d = disparity_px.row(v);
    const std::uint8_t* const jump = jump_distance_px.row(v);
    std::int16_t* const g = gradient_.row(v);
    std::int16_t* const e = error_.row(v);
    std::int16_t* const used = used_.row(v);
    for (int u = 0; u < width; ++u) {
        g[u] = e[u] = used[u] = 0;
        if (jump[u] <= config_.jump_margin_px) continue;
        const float x = static_cast<float>(u) - d[u];
        // NaN compares false. One column is left on each side for the gradients.
        if (!(x >= 1.0F && x < static_cast<float>(width - 3) && u >= 1 && u < width - 1)) continue;
        const int i = static_cast<int>(x);
        const float s = x - static_cast<float>(i);
        const auto at = [&](int k) { return static_cast<float>(r[i + k]); };
        const float error = static_cast<float>(l[u]) - (at(0) + s * (at(1) - at(0)));
        if (std::abs(error) > kMaxError) continue;
        const float slope_right = (1.0F - s) * (at(1) - at(-1)) + s * (at(2) - at(0));
        const float slope = 0.25F * (static_cast<float>(l[u + 1] - l[u - 1]) + slope_right);
        e[u] = rounded(error);
        g[u] = rounded(std::clamp(slope, -kMaxGradient, kMaxGradient));
        used[u] = 1;
    }
}

/// Solves the windows of some rows; sums slide down the columns and along each row.
void SubpixelRefiner::solve_block(int first,
                                  int last,
                                  Image<float>& disparity_px,
                                  Refinement& out) const {
    const int width = left_.width();
    const int height = left_.height();
    const int r = config_.window_radius_px;
    const int enough = (2 * r + 1) * (2 * r + 1) / 5;
    std::vector<Sums> columns(static_cast<std::size_t>(width));
    const auto row = [&](int v, std::int32_t sign) {
        if (v < 0 || v >= height) return;
        accumulate(gradient_.row(v), error_.row(v), used_.row(v), sign, columns);
    };
    for (int v = first - r; v < first + r; ++v) row(v, 1);
    for (int v = first; v < last; ++v) {
        row(v + r, 1);
        Sums window;
        for (int u = 0; u < std::min(r, width); ++u)
            window.add(columns[static_cast<std::size_t>(u)]);
        float* const d = disparity_px.row(v);
        for (int u = 0; u < width; ++u) {
            if (u + r < width) window.add(columns[static_cast<std::size_t>(u + r)]);
            if (u > r) window.subtract(columns[static_cast<std::size_t>(u - r - 1)]);
            const bool known = !std::isnan(d[u]);
            const Step step = known ? solve(window, enough, config_) : Step{kNan, kNan, kNan};
            d[u] += step.shift_px;
            out.shift_px.row(v)[u] = step.shift_px;
            out.residual_grey.row(v)[u] = step.residual_grey;
            out.gradient_grey_px.row(v)[u] = step.gradient_grey_px;
        }
        row(v - r, -1);
    }
}

void SubpixelRefiner::refine(ImageView<const std::uint8_t> left,
                             ImageView<const std::uint8_t> right,
                             const Image<std::uint8_t>& jump_distance_px,
                             Executor& executor,
                             Image<float>& disparity_px,
                             Refinement& out) {
    const int width = left.width;
    const int height = left.height;
    for (Image<std::int16_t>* image : {&left_, &right_, &gradient_, &error_, &used_})
        image->resize(width, height);
    for (Image<float>* image :
         {&horizontal_, &out.shift_px, &out.residual_grey, &out.gradient_grey_px}) {
        image->resize(width, height);
    }
    const int radius = config_.smooth_radius_px;
    const double same = config_.same_surface_px;
    for_row_blocks(executor, height, [&](int first, int last) {
        for (int v = first; v < last; ++v) {
            smooth_image_row(left, v, left_);
            smooth_image_row(right, v, right_);
            smooth_along(disparity_px, v, false, radius, same, horizontal_);
        }
    });
    for_row_blocks(executor, height, [&](int first, int last) {
        for (int v = first; v < last; ++v) {
            smooth_along(horizontal_, v, true, radius, same, disparity_px);
            warp(v, jump_distance_px, disparity_px);
        }
    });
    for_row_blocks(executor, height, [&](int first, int last) {
        solve_block(first, last, disparity_px, out);
    });
}

}  // namespace surefoot::stereo

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/consistency.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/stereo/row_blocks.hpp"

namespace surefoot::stereo {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kSteepestGround = 0.4F;
/// Steps of a ramp are spread over this many pixels.
constexpr int kRampReach_px = 4;

int right_pixel(int u, float disparity_px) noexcept {
    return static_cast<int>(std::floor(static_cast<float>(u) - disparity_px + 0.5F));
}

void drop_hidden_in_row(float* d, int width, float tolerance_px, std::vector<float>& claim) {
    claim.assign(static_cast<std::size_t>(width), 0.0F);
    for (int u = 0; u < width; ++u) {
        if (std::isnan(d[u])) continue;
        const int x = right_pixel(u, d[u]);
        if (x < 0 || x >= width) {
            d[u] = kNan;
            continue;
        }
        float& nearest = claim[static_cast<std::size_t>(x)];
        nearest = std::max(nearest, d[u]);
    }
    for (int u = 0; u < width; ++u) {
        if (std::isnan(d[u])) continue;
        if (claim[static_cast<std::size_t>(right_pixel(u, d[u]))] > d[u] + tolerance_px)
            d[u] = kNan;
    }
}

/// Jumps along one line of pixels, `stride` elements apart.
void mark_line(const float* d, std::uint8_t* jump, int count, int stride, float jump_px) {
    int last = -1;  // the last known pixel
    for (int i = 0; i < count; ++i) {
        const float here = d[i * stride];
        if (std::isnan(here)) continue;
        const bool torn = last >= 0 && std::abs(here - d[last * stride]) >
                                           jump_px + kSteepestGround * static_cast<float>(i - last);
        const bool ramp = i >= kRampReach_px && std::abs(here - d[(i - kRampReach_px) * stride]) >
                                                    jump_px + kSteepestGround * kRampReach_px;
        if (torn) jump[last * stride] = jump[i * stride] = 255;
        if (ramp) jump[(i - kRampReach_px / 2) * stride] = 255;
        last = i;
    }
}

}  // namespace

void drop_hidden(Executor& executor, double tolerance_px, Image<float>& disparity_px) {
    for_row_blocks(executor, disparity_px.height(), [&](int first, int last) {
        std::vector<float> claim;
        for (int v = first; v < last; ++v) {
            drop_hidden_in_row(
                disparity_px.row(v), disparity_px.width(), static_cast<float>(tolerance_px), claim);
        }
    });
}

void mark_jumps(const Image<float>& disparity_px, double jump_px, Image<std::uint8_t>& jumps) {
    const int width = disparity_px.width();
    const int height = disparity_px.height();
    jumps.resize(width, height);
    jumps.fill(0);
    const auto limit = static_cast<float>(jump_px);
    for (int v = 0; v < height; ++v) mark_line(disparity_px.row(v), jumps.row(v), width, 1, limit);
    for (int u = 0; u < width; ++u)
        mark_line(disparity_px.data() + u, jumps.data() + u, height, width, limit);
}

void distance_to_marks(const Image<std::uint8_t>& marks, Image<std::uint8_t>& distance_px) {
    const int width = marks.width();
    const int height = marks.height();
    distance_px.resize(width, height);
    const auto one_more = [](std::uint8_t d) {
        return static_cast<std::uint8_t>(d == 255 ? 255 : d + 1);
    };
    // The neighbours already visited: the row before and the pixel before.
    const auto pass = [&](int u, int v, int back) {
        std::uint8_t best = distance_px.at(u, v);
        for (int a = -1; a <= 1; ++a) {
            if (distance_px.contains(u + a, v + back))
                best = std::min(best, one_more(distance_px.row(v + back)[u + a]));
        }
        if (distance_px.contains(u + back, v))
            best = std::min(best, one_more(distance_px.row(v)[u + back]));
        distance_px.row(v)[u] = best;
    };
    for (std::size_t i = 0; i < marks.size(); ++i)
        distance_px.data()[i] = marks.data()[i] != 0 ? 0 : 255;
    for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) pass(u, v, -1);
    }
    for (int v = height - 1; v >= 0; --v) {
        for (int u = width - 1; u >= 0; --u) pass(u, v, 1);
    }
}

void unknown_share(Executor& executor,
                   const Image<float>& disparity_px,
                   int radius_px,
                   Image<float>& share) {
    const int width = disparity_px.width();
    const int height = disparity_px.height();
    share.resize(width, height);
    for_row_blocks(executor, height, [&](int first, int last) {
        std::vector<int> unknown(static_cast<std::size_t>(width), 0);
        const auto add_row = [&](int v, int sign) {
            if (v < 0 || v >= height) return;
            const float* const d = disparity_px.row(v);
            for (int u = 0; u < width; ++u)
                unknown[static_cast<std::size_t>(u)] += std::isnan(d[u]) ? sign : 0;
        };
        for (int v = first - radius_px; v < first + radius_px; ++v) add_row(v, 1);
        for (int v = first; v < last; ++v) {
            add_row(v + radius_px, 1);
            const int rows = std::min(height - 1, v + radius_px) - std::max(0, v - radius_px) + 1;
            int sum = 0;
            for (int u = 0; u < std::min(radius_px, width); ++u)
                sum += unknown[static_cast<std::size_t>(u)];
            for (int u = 0; u < width; ++u) {
                if (u + radius_px < width) sum += unknown[static_cast<std::size_t>(u + radius_px)];
                if (u > radius_px) sum -= unknown[static_cast<std::size_t>(u - radius_px - 1)];
                const int columns =
                    std::min(width - 1, u + radius_px) - std::max(0, u - radius_px) + 1;
                share.row(v)[u] = static_cast<float>(sum) / static_cast<float>(rows * columns);
            }
            add_row(v - radius_px, -1);
        }
    });
}

}  // namespace surefoot::stereo

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/clipped.hpp"

#include <algorithm>
#include <limits>

#include "surefoot/stereo/row_blocks.hpp"

namespace surefoot::stereo {

void ClippedFilter::remove(ImageView<const std::uint8_t> left,
                           Executor& executor,
                           Image<float>& disparity_px) {
    const int width = left.width;
    const int height = left.height;
    ends_.resize(width, height);
    columns_.resize(width, height);
    row_has_.resize(static_cast<std::size_t>(height));
    for_row_blocks(executor, height, [&](int first, int last) {
        for (int v = first; v < last; ++v) {
            const std::uint8_t* const grey = left.row(v);
            std::uint8_t* const ends = ends_.row(v);
            std::uint8_t any = 0;
            for (int u = 0; u < width; ++u) {
                const std::uint8_t white = grey[u] >= kClippedWhite ? 1 : 0;
                const std::uint8_t black = grey[u] <= kClippedBlack ? 2 : 0;
                ends[u] = white | black;
                any |= ends[u];
            }
            row_has_[static_cast<std::size_t>(v)] = any;
        }
    });
    for_row_blocks(executor, height, [&](int first, int last) {
        for (int v = first; v < last; ++v) {
            const int top = std::max(0, v - kReachY_px);
            const int bottom = std::min(height - 1, v + kReachY_px);
            const bool has_none = std::any_of(row_has_.begin() + top,
                                              row_has_.begin() + bottom + 1,
                                              [](std::uint8_t any) { return any == 0; });
            if (has_none) continue;
            std::uint8_t* const columns = columns_.row(v);
            std::copy_n(ends_.row(v), width, columns);
            for (int w = top; w <= bottom; ++w) {
                const std::uint8_t* const ends = ends_.row(w);
                for (int u = 0; u < width; ++u) columns[u] &= ends[u];
            }
            float* const d = disparity_px.row(v);
            for (int u = 0; u < width; ++u) {
                if (columns[u] == 0) continue;
                std::uint8_t common = columns[u];
                const int from = std::max(0, u - kReachX_px);
                const int to = std::min(width - 1, u + kReachX_px);
                for (int x = from; x <= to; ++x) common &= columns[x];
                if (common != 0) d[u] = std::numeric_limits<float>::quiet_NaN();
            }
        }
    });
}

}  // namespace surefoot::stereo

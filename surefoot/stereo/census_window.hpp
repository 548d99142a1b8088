// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace surefoot::stereo {

/// Offset [px] of a neighbour with which a census word compares its pixel. The neighbours are the
/// fields of one colour of a chequered 9 x 7 window, row by row: 8, 8, 8 and 6 in the four bytes.
struct CensusNeighbour {
    int du = 0;
    int dv = 0;
};
inline constexpr int kCensusReach_u = 4;
inline constexpr int kCensusReach_v = 3;
inline constexpr int kCensusBytes = 4;

constexpr std::array<CensusNeighbour, 30> census_window() {
    std::array<CensusNeighbour, 30> window{};
    std::size_t count = 0;
    for (int dv = -kCensusReach_v; dv <= kCensusReach_v; ++dv) {
        for (int du = -kCensusReach_u; du <= kCensusReach_u; ++du) {
            if ((du + dv) % 2 == 0 && (du != 0 || dv != 0)) window[count++] = {du, dv};
        }
    }
    return window;
}

}  // namespace surefoot::stereo

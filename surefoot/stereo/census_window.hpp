// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace surefoot::stereo {

/// Offset [px] of a neighbour with which a census word compares its pixel. The neighbours are the
/// other pixels of a window of 3 columns and 5 rows, row by row: 8 and 6 in the two bytes. A narrow
/// window sees only one of two surfaces at an edge, and stays right where the ground is slanted.
struct CensusNeighbour {
    int du = 0;
    int dv = 0;
};
inline constexpr int kCensusReach_u = 1;
inline constexpr int kCensusReach_v = 2;
inline constexpr int kCensusBytes = 2;
/// Bits of a census word. A bit tells if a neighbour is darker.
inline constexpr int kCensusBits = (2 * kCensusReach_u + 1) * (2 * kCensusReach_v + 1) - 1;

constexpr std::array<CensusNeighbour, kCensusBits> census_window() {
    std::array<CensusNeighbour, kCensusBits> window{};
    std::size_t count = 0;
    for (int dv = -kCensusReach_v; dv <= kCensusReach_v; ++dv) {
        for (int du = -kCensusReach_u; du <= kCensusReach_u; ++du) {
            if (du != 0 || dv != 0) window[count++] = {du, dv};
        }
    }
    return window;
}

}  // namespace surefoot::stereo

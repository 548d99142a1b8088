// SPDX-License-Identifier: Apache-2.0
// Rates the traversability of a height map: slope, step height and roughness of each cell.
// Usage: 03_rate_a_height_map HEIGHTS.asc   (an ESRI ASCII grid in metres)
#include <cmath>
#include <iostream>

#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/traversability/traversability.hpp"

int main(int argc, char** argv) {
    if (argc != 2) {
        std::cerr << "usage: 03_rate_a_height_map HEIGHTS.asc\n";
        return 2;
    }
    const auto heights = surefoot::io::read_height_grid(argv[1]);
    if (!heights) {
        std::cerr << heights.error().message << '\n';
        return 1;
    }
    surefoot::traversability::TraversabilityLayers rating;
    surefoot::traversability::rate({},  // default settings
                                   heights->values.view(),
                                   heights->geometry.resolution_m,
                                   surefoot::serial(),
                                   rating);
    std::size_t known = 0;
    std::size_t free = 0;
    for (std::size_t i = 0; i < rating.traversability.size(); ++i) {
        const float value =
            rating.traversability.data()[i];  // 0 = impassable, 1 = level and smooth
        if (std::isnan(value)) continue;      // unknown is not free
        ++known;
        if (value > 0.5F) ++free;
    }
    std::cout << known << " of " << rating.traversability.size() << " cells rated, " << free
              << " of these above 0.5\n";
}

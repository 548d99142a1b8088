// SPDX-License-Identifier: Apache-2.0
// Finds stairs, drops and kerbs in a height map.
// Usage: 04_find_stairs HEIGHTS.asc X Y   (where the machine stands, in metres of the map)
#include <cstdlib>
#include <iostream>

#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/stairs/feature_finder.hpp"

int main(int argc, char** argv) {
    if (argc != 4) {
        std::cerr << "usage: 04_find_stairs HEIGHTS.asc X Y\n";
        return 2;
    }
    const auto heights = surefoot::io::read_height_grid(argv[1]);
    if (!heights) {
        std::cerr << heights.error().message << '\n';
        return 1;
    }
    surefoot::stairs::Terrain terrain;
    terrain.geometry = heights->geometry;
    terrain.height_m = heights->values.view();
    terrain.stance_m = {std::atof(argv[2]), std::atof(argv[3])};

    surefoot::stairs::TerrainFeatures features;
    surefoot::stairs::FeatureFinder finder{surefoot::stairs::StairsConfig{}};
    finder.find(terrain, features);
    for (const surefoot::stairs::Flight& flight : features.flights)
        std::cout << (flight.kind == surefoot::stairs::FlightKind::up ? "up " : "down ")
                  << flight.steps << " steps, riser " << 1000.0 * flight.riser_m << " +- "
                  << 1000.0 * flight.riser_sigma_m << " mm, going " << 1000.0 * flight.going_m
                  << " mm, at (" << flight.pose.p_m.x() << ", " << flight.pose.p_m.y() << ") m\n";
    std::cout << features.flights.size() << " flights, " << features.drops.size() << " drops\n";
}

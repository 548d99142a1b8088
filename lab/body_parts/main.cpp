// SPDX-License-Identifier: Apache-2.0
// Which volumes does the body sweep in the simulated gait? Prints the lines of `body.parts` for
// machines/rex.yaml to stdout.
// Usage: body_parts [FIRST_SEED [SEEDS]]
//   FIRST_SEED: default 21. SEEDS: number of seeds, default 8.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "surefoot/sim/motion/body_trace.hpp"

int main(int argc, char** argv) {
    using namespace surefoot::sim;
    const std::uint64_t seed = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 21;
    const int seeds = argc > 2 ? std::atoi(argv[2]) : 8;
    const auto parts = trace_body(rex_movements({}), {}, seed, seeds);
    if (!parts) {
        fmt::print(stderr, "body_parts: {}\n", parts.error().message);
        return 1;
    }
    // Rounds outward to whole centimetres. The simulated gait is an assumption, so millimetres
    // would claim an accuracy that does not exist.
    const auto down = [](double x_m) { return 0.01 * std::floor(100.0 * x_m); };
    const auto up = [](double x_m) { return 0.01 * std::ceil(100.0 * x_m); };
    for (const TracedPart& part : *parts) {
        const double x0 = down(part.box.min_m.x());
        const double x1 = up(part.box.max_m.x());
        const double y0 = down(part.box.min_m.y());
        const double y1 = up(part.box.max_m.y());
        fmt::print(
            "    - {{name: {}, center_x_m: {:.3f}, center_y_m: {:.3f}, length_m: {:.2f}, width_m: "
            "{:.2f}, low_m: {:.2f}, high_m: {:.2f}}}\n",
            part.name,
            0.5 * (x0 + x1),
            0.5 * (y0 + y1),
            x1 - x0,
            y1 - y0,
            down(part.low_m),
            up(part.high_m));
    }
    return 0;
}

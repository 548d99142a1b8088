// SPDX-License-Identifier: Apache-2.0
// Runs the whole chain over a recording and prints what it knows of the ground at the end.
// Usage: 01_run_a_recording RECORDING [RIG_FILE]
#include <iostream>

#include "surefoot/surefoot.hpp"

int main(int argc, char** argv) {
    if (argc < 2) {
        std::cerr << "usage: 01_run_a_recording RECORDING [RIG_FILE]\n";
        return 2;
    }
    auto source = surefoot::open_recording(argv[1], argc > 2 ? argv[2] : "");
    if (!source) {
        std::cerr << source.error().message << '\n';
        return 1;
    }
    auto perception = surefoot::Perception::make((*source)->rig());
    if (!perception) {
        std::cerr << perception.error().message << '\n';
        return 1;
    }
    const auto print = [](std::span<const surefoot::FrameReport> reports) {
        for (const surefoot::FrameReport& report : reports)
            std::cout << "frame " << report.index << ": base_link at "
                      << report.motion.T_odom_body.translation_m.transpose() << " m in odom, "
                      << report.known_cells << " cells known\n";
    };
    for (auto frame = (*source)->next(); frame.ok() && frame->has_value();
         frame = (*source)->next())
        print(perception->process(**frame));
    print(perception->finish());

    for (const surefoot::stairs::Flight& flight : perception->features().flights)
        std::cout << "a flight of " << flight.steps << " steps, riser " << 1000.0 * flight.riser_m
                  << " mm, " << flight.pose.p_m.x() << " m ahead of the start\n";
}

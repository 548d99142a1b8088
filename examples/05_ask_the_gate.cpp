// SPDX-License-Identifier: Apache-2.0
// Asks whether a machine may step, after each frame of a recording.
// Usage: 05_ask_the_gate RECORDING MACHINE COMMAND   ("rex" or a machine file; 9 = a step ahead)
#include <cstdlib>
#include <iostream>

#include "surefoot/surefoot.hpp"

int main(int argc, char** argv) {
    if (argc != 4) {
        std::cerr << "usage: 05_ask_the_gate RECORDING MACHINE COMMAND\n";
        return 2;
    }
    auto source = surefoot::open_recording(argv[1]);
    const auto machine = surefoot::load_machine(argv[2]);
    if (!source || !machine) {
        std::cerr << (source ? machine.error() : source.error()).message << '\n';
        return 1;
    }
    auto perception = surefoot::Perception::make((*source)->rig(), *machine);
    if (!perception) {
        std::cerr << perception.error().message << '\n';
        return 1;
    }
    const auto command = static_cast<std::uint8_t>(std::atoi(argv[3]));
    for (auto frame = (*source)->next(); frame.ok() && frame->has_value();
         frame = (*source)->next()) {
        if (perception->process(**frame).empty()) continue;  // still starting up
        const surefoot::gate::Verdict verdict = perception->verdict(command);
        std::cout << surefoot::gate::to_string(verdict.decision) << ": "
                  << perception->text_of(verdict) << '\n';
    }
}

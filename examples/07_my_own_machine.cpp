// SPDX-License-Identifier: Apache-2.0
// Reads a machine file, which passes the gate's self-test or is refused, and prints its movements.
// Usage: 07_my_own_machine MACHINE   ("rex" or a file; docs/reference/machine_file.md)
#include <iostream>

#include "surefoot/surefoot.hpp"

int main(int argc, char** argv) {
    if (argc != 2) {
        std::cerr << "usage: 07_my_own_machine MACHINE\n";
        return 2;
    }
    const auto machine = surefoot::load_machine(argv[1]);
    if (!machine) {
        std::cerr << machine.error().message << '\n';
        return 1;
    }
    std::cout << machine->name << ": base_link " << 1e-4 * machine->machine.sole_depth_tenth_mm
              << " m above its soles\n";
    for (std::size_t code = 0; code < machine->machine.movements.size(); ++code) {
        const surefoot::Movement& movement = machine->machine.movements[code];
        if (movement.configured)
            std::cout << "movement " << code << " (" << movement.name.data()
                      << "): " << 0.1 * movement.forward_tenth_mm << " mm ahead\n";
    }
}

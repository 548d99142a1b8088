// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace surefoot::gate_process {

/// A process that listens at a TCP port.
struct PortHolder {
    int process = 0;
    int parent = 0;    ///< 1 = the process that started it has ended
    std::string name;  ///< of the program, at most 15 characters
};

/// Who listens at this port of this machine; nothing where nobody does, or where the system does
/// not tell (a process of another user). Reads /proc: milliseconds.
[[nodiscard]] std::optional<PortHolder> holder_of_port(std::uint16_t port);
/// "process 1234 (surefoot-gate)".
[[nodiscard]] std::string words_of(const PortHolder& holder);

}  // namespace surefoot::gate_process

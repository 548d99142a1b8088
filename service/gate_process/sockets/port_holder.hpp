// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace surefoot::gate_process {

/// The process that listens on a TCP port.
struct PortHolder {
    int process = 0;
    int parent = 0;    ///< process id of the parent; 1: the parent has ended
    std::string name;  ///< program name, at most 15 characters
};

/// Returns the process that listens on this port of this computer. Empty if there is no such
/// process or another user owns it. Reads /proc: takes milliseconds.
[[nodiscard]] std::optional<PortHolder> holder_of_port(std::uint16_t port);
/// Returns text for messages: "process 1234 (surefoot-gate)".
[[nodiscard]] std::string words_of(const PortHolder& holder);

}  // namespace surefoot::gate_process

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

#include "service/gate_process/channel/keyed_checksum.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Starts the gate process (surefoot-gate) and restarts it when it dies.
///
/// While the gate process does not run, its clients get no answer, so no step is allowed. A new
/// gate begins in state INIT. The gate process inherits the priority of the thread that starts it.
/// The gate process ends when this process ends, even after a crash: the socket pair between both
/// processes closes, and the kernel sends SIGTERM to the gate process.
class GateChild {
  public:
    /// Arguments and key for the gate process.
    struct Start {
        std::vector<std::string> arguments;        ///< arguments of every start
        std::vector<std::string> first_arguments;  ///< more arguments of the first start
        gate_process::ChecksumKey key;             ///< key of the map channel; sent by socket pair
    };
    /// Starts the program surefoot-gate, which must be in the folder of this program. Returns when
    /// the gate listens. Returns an error if the program is missing, if the gate ends before it
    /// listens, or if the gate is silent for 20 s.
    [[nodiscard]] static Result<GateChild> start(Start how);
    GateChild(GateChild&& other) noexcept;
    GateChild& operator=(GateChild&&) = delete;
    /// Sends SIGTERM to the gate process and waits for its end.
    ~GateChild();

    /// Restarts the gate process if it has died, at most twice a second. Returns true if this call
    /// restarted it. Call it from the thread that called `start`: the kernel ends the gate process
    /// together with the thread that started it.
    [[nodiscard]] Result<bool> watch(std::int64_t now_ns);
    [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
    [[nodiscard]] int restarts() const noexcept { return restarts_; }

  private:
    GateChild() = default;
    [[nodiscard]] Status launch(std::vector<std::string> arguments);
    void hang_up() noexcept;

    std::string program_;
    Start how_;
    pid_t process_ = -1;
    int line_ = -1;  ///< our end of the socket pair
    std::uint16_t port_ = 0;
    int restarts_ = 0;
    std::int64_t next_start_ns_ = 0;
};

}  // namespace surefoot::app

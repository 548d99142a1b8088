// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

#include "service/gate_process/channel/keyed_checksum.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// The gate process beside this one: started, watched, started again when it dies. Whatever
/// becomes of it, no step is allowed meanwhile: its clients hear nothing. Its state begins at INIT.
/// It has the priority of the thread that starts it, and ends when this process does, however it
/// ends: it holds one end of a socket pair, and the system sends it a signal.
class GateChild {
  public:
    /// What the gate is started with.
    struct Start {
        std::vector<std::string> arguments;        ///< of every start
        std::vector<std::string> first_arguments;  ///< of the first start, behind the others
        wire::ChecksumKey key;                     ///< of the channel; goes through the socket pair
    };
    /// The program is looked for beside this one. Returns when it listens.
    [[nodiscard]] static Result<GateChild> start(Start how);
    GateChild(GateChild&& other) noexcept;
    GateChild& operator=(GateChild&&) = delete;
    /// Ends it.
    ~GateChild();

    /// Restarts the gate if it has died, twice a second at most. True in the call that did so. To
    /// be called by the thread that started it: the gate ends with that thread.
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

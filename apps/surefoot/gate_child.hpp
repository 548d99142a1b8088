// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// The gate process beside this one: started, watched, started again when it dies. Whatever
/// becomes of it, no step is allowed meanwhile: its clients hear nothing. Its state begins at INIT.
/// It has the priority of the thread that starts it.
class GateChild {
  public:
    /// The program is looked for beside this one. `arguments` for every start, `first_arguments`
    /// for the first one alone. Returns when it listens.
    [[nodiscard]] static Result<GateChild> start(std::vector<std::string> arguments,
                                                 const std::vector<std::string>& first_arguments);
    GateChild(GateChild&& other) noexcept;
    GateChild& operator=(GateChild&&) = delete;
    /// Ends it.
    ~GateChild();

    /// Starts it anew if it has died, twice a second at most. True in the call that did so.
    [[nodiscard]] Result<bool> watch(std::int64_t now_ns);
    [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
    [[nodiscard]] int restarts() const noexcept { return restarts_; }

  private:
    GateChild() = default;
    [[nodiscard]] Status launch(const std::vector<std::string>& arguments);

    std::string program_;
    std::vector<std::string> arguments_;
    pid_t process_ = -1;
    std::uint16_t port_ = 0;
    int restarts_ = 0;
    std::int64_t next_start_ns_ = 0;
};

}  // namespace surefoot::app

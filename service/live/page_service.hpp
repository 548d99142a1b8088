// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <thread>

#include "service/gate_process/sockets/token_file.hpp"
#include "service/live/serve_options.hpp"
#include "service/page/page_server.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/io/settings/machine_file.hpp"

namespace surefoot::app {

/// Serves the live page on its own thread. Does nothing if the user disabled the page.
class PageService {
  public:
    static Result<std::unique_ptr<PageService>> start(const ServeOptions& options,
                                                      const gate_process::Access& access);
    PageService(const PageService&) = delete;
    PageService& operator=(const PageService&) = delete;
    ~PageService() {
        if (!thread_.joinable()) return;
        server_->stop();
        thread_.join();
    }

    /// Sends the hello message to all current and later viewers. Call it again when the port of the
    /// gate changes.
    void introduce(const page::PageHello& hello, const std::optional<io::MachineFile>& machine) {
        if (!server_) return;
        server_->introduce(hello,
                           machine ? page::colour_limits(machine->machine) : page::ColourLimits{});
        if (!thread_.joinable()) thread_ = std::thread([this] { server_->run(); });
    }
    [[nodiscard]] page::PageFeed* feed() noexcept { return server_ ? &feed_ : nullptr; }
    [[nodiscard]] page::PageControls& controls() noexcept { return controls_; }
    [[nodiscard]] std::uint16_t port() const noexcept { return server_ ? server_->port() : 0; }

  private:
    PageService() = default;

    page::PageFeed feed_;
    page::PageControls controls_;
    std::unique_ptr<page::PageServer> server_;
    std::thread thread_;
};

}  // namespace surefoot::app

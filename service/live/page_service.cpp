// SPDX-License-Identifier: Apache-2.0
#include "service/live/page_service.hpp"

#include <fmt/format.h>

#include "service/console/log.hpp"

namespace surefoot::app {

Result<std::unique_ptr<PageService>> PageService::start(const ServeOptions& options,
                                                        const gate_process::Access& access) {
    std::unique_ptr<PageService> service(new PageService());
    if (options.no_page) return service;
    page::PageServerConfig config;
    config.bind_address = options.bind_address;
    config.port = static_cast<std::uint16_t>(options.page_port);
    config.foxglove_origins = options.foxglove_origins;
    config.origins = options.origins;
    config.tls = {options.certificate_file, options.key_file};
    config.insecure = options.insecure;
    // The socket of the page accepts a single token; only the gate distinguishes roles.
    if (access.guest == gate_process::Role::none) config.token = access.operator_;
    auto server = page::PageServer::open(config, service->feed_, service->controls_);
    if (!server) return server.error();
    service->server_ = std::move(server).value();
    if (options.page_port != 0 && service->server_->port() != options.page_port)
        log_warning(
            fmt::format("port {} is in use; the page takes the next free port", options.page_port));
    return service;
}

}  // namespace surefoot::app

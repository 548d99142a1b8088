// SPDX-License-Identifier: Apache-2.0
#include "apps/surefoot/log.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdlib>

#include "apps/surefoot/verbs.hpp"

namespace surefoot::app {
namespace {

spdlog::logger& logger() {
    static const std::shared_ptr<spdlog::logger> instance = [] {
        const auto mode = std::getenv("NO_COLOR") != nullptr ? spdlog::color_mode::never
                                                             : spdlog::color_mode::automatic;
        auto made = spdlog::stderr_color_mt("surefoot", mode);
        made->set_pattern("%^%l%$: %v");
        return made;
    }();
    return *instance;
}

}  // namespace

void log_info(const std::string& message) {
    logger().info(message);
}
void log_warning(const std::string& message) {
    logger().warn(message);
}
void log_error(const std::string& message) {
    logger().error(message);
}

int report(const Error& error) {
    log_error(error.message);
    return error.code == ErrorCode::usage ? kExitUsage : kExitFailed;
}

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#include "service/console/log.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <cstdlib>

#include "service/console/options.hpp"

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

// State of this call of the program. If a verb fails without printing its JSON object,
// run_command_line() prints an object with the first error.
bool has_answered = false;
std::string first_error_sentence;

}  // namespace

void print_answer(const std::string& json_object) {
    has_answered = true;
    fmt::print("{}\n", json_object);
}
bool answered() noexcept {
    return has_answered;
}

// Each function flushes stdout first, so that earlier results appear before the message even if
// stdout is a pipe or a file. Otherwise results that appear after an error message would look as if
// the program had recovered.
void log_info(const std::string& message) {
    std::fflush(stdout);
    logger().info(message);
}
void log_warning(const std::string& message) {
    std::fflush(stdout);
    logger().warn(message);
}
void log_error(const std::string& message) {
    std::fflush(stdout);
    if (first_error_sentence.empty()) first_error_sentence = message;
    logger().error(message);
}

Status close_stdout() {
    const bool flushed = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
    return flushed ? Status()
                   : Status(output_error("stdout: cannot write the whole output; check whether the "
                                         "disk is full and run again"));
}

const std::string& first_error() noexcept {
    return first_error_sentence;
}

int report(const Error& error) {
    log_error(error.message);
    return error.code == ErrorCode::usage ? kExitUsage : kExitFailed;
}

}  // namespace surefoot::app

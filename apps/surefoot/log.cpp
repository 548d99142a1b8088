// SPDX-License-Identifier: Apache-2.0
#include "apps/surefoot/log.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdio>
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

// What the call has said so far: main answers for a verb that failed without an object.
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

// What was printed before comes before, also where stdout is a pipe or a file: an error that is
// followed by a line of results would read as if it were mended.
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
    return flushed ? Status() : Status(output_error("stdout: cannot write: is the disk full?"));
}

const std::string& first_error() noexcept {
    return first_error_sentence;
}

int report(const Error& error) {
    log_error(error.message);
    return error.code == ErrorCode::usage ? kExitUsage : kExitFailed;
}

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#include "apps/surefoot/gate_child.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <utility>

namespace surefoot::app {
namespace {

constexpr std::int64_t kRestartEvery_ns = 500'000'000;

/// Installed side by side, or in the folders of a build.
Result<std::string> find_program() {
    std::error_code error;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
    for (const char* place : {"surefoot-gate", "../surefoot-gate/surefoot-gate"}) {
        const auto candidate = self.parent_path() / place;
        if (::access(candidate.c_str(), X_OK) == 0) return candidate.lexically_normal().string();
    }
    return input_error("the program surefoot-gate is not beside " + self.string());
}

/// The first line that it writes, or what came until it closed.
std::string first_line(int file) {
    std::string line;
    char byte = 0;
    while (line.size() < 4096) {
        const ssize_t got = ::read(file, &byte, 1);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0 || byte == '\n') break;
        line += byte;
    }
    return line;
}

/// "listening on ws://127.0.0.1:9090" -> 9090; 0 when it says anything else.
std::uint16_t port_of(const std::string& line) {
    const auto colon = line.rfind(':');
    std::uint16_t port = 0;
    if (line.starts_with("listening on ") && colon != std::string::npos)
        std::from_chars(line.data() + colon + 1, line.data() + line.size(), port);
    return port;
}

}  // namespace

Result<GateChild> GateChild::start(std::vector<std::string> arguments,
                                   const std::vector<std::string>& first_arguments) {
    auto program = find_program();
    if (!program) return program.error();
    GateChild child;
    child.program_ = std::move(program).value();
    child.arguments_ = std::move(arguments);
    std::vector<std::string> first = child.arguments_;
    first.insert(first.end(), first_arguments.begin(), first_arguments.end());
    if (auto launched = child.launch(first); !launched) return launched.error();
    return child;
}

GateChild::GateChild(GateChild&& other) noexcept
    : program_(std::move(other.program_)),
      arguments_(std::move(other.arguments_)),
      process_(std::exchange(other.process_, -1)),
      port_(other.port_),
      restarts_(other.restarts_),
      next_start_ns_(other.next_start_ns_) {}

GateChild::~GateChild() {
    if (process_ <= 0) return;
    ::kill(process_, SIGTERM);
    ::waitpid(process_, nullptr, 0);
}

Status GateChild::launch(const std::vector<std::string>& arguments) {
    std::vector<char*> words{program_.data()};
    std::vector<std::string> copies = arguments;
    for (std::string& word : copies) words.push_back(word.data());
    words.push_back(nullptr);
    int pipe_ends[2];
    if (::pipe2(pipe_ends, O_CLOEXEC) != 0)
        return input_error("the gate process cannot be started: no pipe");
    process_ = ::fork();
    if (process_ == 0) {
        ::dup2(pipe_ends[1], STDOUT_FILENO);
        // Linux shares the processor between sessions before it looks at nice values: what
        // perception used up shall not make the gate wait. The keyboard's interrupt is for serve.
        ::setsid();
        ::execv(program_.c_str(), words.data());
        ::_exit(127);
    }
    ::close(pipe_ends[1]);
    const std::string line = process_ > 0 ? first_line(pipe_ends[0]) : "";
    ::close(pipe_ends[0]);
    port_ = port_of(line);
    if (port_ != 0) return {};
    if (process_ > 0) ::waitpid(process_, nullptr, 0);
    process_ = -1;
    return input_error("the gate process did not start (its reason is above): " + program_);
}

Result<bool> GateChild::watch(std::int64_t now_ns) {
    if (process_ > 0) {
        if (::waitpid(process_, nullptr, WNOHANG) != process_) return false;
        process_ = -1;
    }
    if (now_ns < next_start_ns_) return false;
    next_start_ns_ = now_ns + kRestartEvery_ns;
    if (auto launched = launch(arguments_); !launched) return launched.error();  // tried again
    ++restarts_;
    return true;
}

}  // namespace surefoot::app

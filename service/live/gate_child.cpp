// SPDX-License-Identifier: Apache-2.0
#include "service/live/gate_child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <tuple>
#include <utility>

namespace surefoot::app {
namespace {

constexpr std::int64_t kRestartEvery_ns = 500'000'000;

/// Returns the path of surefoot-gate, which must be in the folder of this program.
Result<std::string> find_program() {
    std::error_code error;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
    const auto gate = self.parent_path() / "surefoot-gate";
    if (::access(gate.c_str(), X_OK) == 0) return gate.string();
    return input_error("the program surefoot-gate is missing; install it in the folder of " +
                       self.string());
}

/// Longest time that the gate may need to write its first line. After this time the start counts as
/// failed.
constexpr std::chrono::seconds kLongestStart{20};

/// Returns the first line that the gate writes. The line may be incomplete if the gate closed the
/// pipe or the time ran out.
std::string first_line(int file) {
    const auto end = std::chrono::steady_clock::now() + kLongestStart;
    std::string line;
    char byte = 0;
    while (line.size() < 4096) {
        pollfd wait{file, POLLIN, 0};
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
            end - std::chrono::steady_clock::now());
        const auto left_ms = static_cast<int>(std::max<std::int64_t>(0, left.count()));
        const int ready = ::poll(&wait, 1, left_ms);
        if (ready < 0 && errno == EINTR) continue;
        if (ready <= 0) break;
        const ssize_t got = ::read(file, &byte, 1);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0 || byte == '\n') break;
        line += byte;
    }
    return line;
}

/// Reads the port from a line such as "listening on ws://127.0.0.1:9090". Returns 0 for other
/// texts.
std::uint16_t port_of(const std::string& line) {
    const auto colon = line.rfind(':');
    std::uint16_t port = 0;
    if (line.starts_with("listening on ") && colon != std::string::npos)
        std::from_chars(line.data() + colon + 1, line.data() + line.size(), port);
    return port;
}

/// Runs in the forked child until it executes the gate; uses only calls that are safe after a fork.
[[noreturn]] void become_gate(
    const char* program, char* const* words, int output, int line, pid_t parent) {
    ::dup2(output, STDOUT_FILENO);
    ::fcntl(line, F_SETFD, 0);  // keep the socket open across execv
    // Give the gate a session of its own, so that the load of perception cannot delay it. Linux
    // shares the processor among sessions before it compares nice values. Ctrl-C then reaches only
    // serve.
    ::setsid();
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() == parent) ::execv(program, words);
    ::_exit(127);
}

}  // namespace

Result<GateChild> GateChild::start(Start how) {
    auto program = find_program();
    if (!program) return program.error();
    GateChild child;
    child.program_ = std::move(program).value();
    child.how_ = std::move(how);
    std::vector<std::string> first = child.how_.arguments;
    first.insert(first.end(), child.how_.first_arguments.begin(), child.how_.first_arguments.end());
    if (auto launched = child.launch(std::move(first)); !launched) return launched.error();
    return child;
}

GateChild::GateChild(GateChild&& other) noexcept
    : program_(std::move(other.program_)),
      how_(std::move(other.how_)),
      process_(std::exchange(other.process_, -1)),
      line_(std::exchange(other.line_, -1)),
      port_(other.port_),
      restarts_(other.restarts_),
      next_start_ns_(other.next_start_ns_) {}

GateChild::~GateChild() {
    if (process_ > 0) {
        ::kill(process_, SIGTERM);
        ::waitpid(process_, nullptr, 0);
    }
    hang_up();
}

void GateChild::hang_up() noexcept {
    if (line_ >= 0) ::close(line_);
    line_ = -1;
}

Status GateChild::launch(std::vector<std::string> arguments) {
    hang_up();
    int output[2];
    // Use a socket pair for the key: another process of this user could open a pipe in /proc and
    // read the key.
    int line[2];
    if (::pipe2(output, O_CLOEXEC) != 0)
        return input_error(
            "the gate process cannot be started, because the system refuses a pipe; close other "
            "programs and start again");
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, line) != 0) {
        ::close(output[0]);
        ::close(output[1]);
        return input_error(
            "the gate process cannot be started, because the system refuses a socket pair; close "
            "other programs and start again");
    }
    arguments.insert(arguments.end(), {"--parent-fd", std::to_string(line[1])});
    std::vector<char*> words{program_.data()};
    for (std::string& word : arguments) words.push_back(word.data());
    words.push_back(nullptr);
    const std::string key = gate_process::bytes_of(how_.key);
    std::ignore = ::send(line[0], key.data(), key.size(), MSG_NOSIGNAL);
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ == 0) become_gate(program_.c_str(), words.data(), output[1], line[1], parent);
    ::close(output[1]);
    ::close(line[1]);
    line_ = line[0];
    const std::string said = process_ > 0 ? first_line(output[0]) : "";
    ::close(output[0]);
    port_ = port_of(said);
    if (port_ != 0) return {};
    if (process_ > 0) {
        ::kill(process_, SIGKILL);  // SIGKILL, because the gate may hang
        ::waitpid(process_, nullptr, 0);
    }
    process_ = -1;
    hang_up();
    return input_error(
        "the gate process did not start; read the message of the gate above. Program: " + program_);
}

Result<bool> GateChild::watch(std::int64_t now_ns) {
    if (process_ > 0) {
        if (::waitpid(process_, nullptr, WNOHANG) != process_) return false;
        process_ = -1;
    }
    if (now_ns < next_start_ns_) return false;
    next_start_ns_ = now_ns + kRestartEvery_ns;
    if (auto launched = launch(how_.arguments); !launched)
        return launched.error();  // the next call tries again to start the gate
    ++restarts_;
    return true;
}

}  // namespace surefoot::app

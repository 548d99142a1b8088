// SPDX-License-Identifier: Apache-2.0
// The step gate as a process. It reads the newest map from shared memory and answers queries over a
// WebSocket. With --audit, it records every verdict in the audit log. One thread decides; the audit
// log has its own writing thread.
#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <numbers>

#include "service/gate_process/audit/audit_log.hpp"
#include "service/gate_process/gatekeeper.hpp"
#include "service/gate_process/sockets/port_holder.hpp"
#include "service/gate_process/sockets/token_file.hpp"
#include "service/gate_process/sockets/websocket_server.hpp"
#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/io/settings/renamed_keys.hpp"
#include "surefoot/machines/built_in_machines.hpp"

namespace surefoot::app {
namespace {

constexpr int kExitOk = 0;
constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;
/// Longest wait for a port in use. When a `surefoot serve` has just ended, its gate releases the
/// port within milliseconds.
constexpr std::int64_t kPortPatience_ns = 1'500'000'000;

std::atomic<bool> stop_wanted{false};
static_assert(std::atomic<bool>::is_always_lock_free,
              "a signal handler sets this flag, so it must be lock-free");

struct Options {
    std::string machine = "rex";
    std::string snapshots;
    std::string token_file;
    std::string guests;
    std::string audit_dir;
    bool assured = false;
    int audit_mb = 1024;
    std::string key_file;
    int parent_fd = -1;
    double attestation_radius_m = 0.0;
    gate_process::ServerConfig server;
};

std::int64_t clock_ns(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

int fail(const Error& error) {
    fmt::print(stderr, "surefoot-gate: {}\n", error.message);
    return error.code == ErrorCode::usage ? kExitUsage : kExitFailed;
}

/// Reads the key of the snapshot channel from the program that started the gate, or from a file.
/// Without a key, returns a new random key, so the gate trusts no map.
Result<gate_process::ChecksumKey> channel_key(const Options& options) {
    if (options.parent_fd >= 0) {
        std::array<char, 16> bytes{};
        if (::recv(options.parent_fd, bytes.data(), bytes.size(), MSG_WAITALL) !=
            static_cast<ssize_t>(bytes.size()))
            return usage_error(
                "--parent-fd: only `surefoot serve` uses this option; start without it");
        ::fcntl(options.parent_fd, F_SETFD, FD_CLOEXEC);
        return gate_process::key_of({bytes.data(), bytes.size()});
    }
    if (!options.key_file.empty()) return gate_process::read_checksum_key(options.key_file);
    fmt::print(
        stderr,
        "surefoot-gate: warning: without the key of the channel the gate trusts no map and every "
        "answer is ERROR; give the key file of `surefoot serve` with --channel-key\n");
    return gate_process::new_checksum_key();
}

/// True if the program that started the gate has ended, normally or by a crash.
bool is_orphan(int parent_fd) {
    char byte = 0;
    return parent_fd >= 0 && ::recv(parent_fd, &byte, 1, MSG_DONTWAIT) == 0;
}

/// Reports changes of the snapshot channel's state on stderr.
class ChannelNews {
  public:
    explicit ChannelNews(std::string path) : path_(std::move(path)) {}
    void tell(gate_process::ChannelState state) {
        if (state == reported_) return;
        const bool was_lost = reported_ == gate_process::ChannelState::lost;
        reported_ = state;
        if (state == gate_process::ChannelState::lost)
            say("the channel was deleted, replaced or cut off; without new maps the gate allows no "
                "step. Wait until perception has repaired the channel");
        if (state == gate_process::ChannelState::open && was_lost) say("the channel is open again");
        if (state == gate_process::ChannelState::forged)
            say("another process has changed a map; the gate is in FAULT until an operator re-arms "
                "it. Find that process first: only this user and root can write there");
    }

  private:
    void say(const char* what) const {
        fmt::print(stderr, "surefoot-gate: {}: {}\n", path_, what);
        std::fflush(stderr);
    }
    std::string path_;
    gate_process::ChannelState reported_ = gate_process::ChannelState::absent;
};

/// Opens the server. If another process uses the port, retries for kPortPatience_ns and then
/// returns an error that names the other process.
Result<std::unique_ptr<gate_process::WebsocketServer>> listen(
    const gate_process::ServerConfig& config,
    gate_process::StepGate& gate,
    const gate_process::WebsocketServer::Tick& tick) {
    const std::int64_t end_ns = clock_ns(CLOCK_MONOTONIC) + kPortPatience_ns;
    while (true) {
        auto server = gate_process::WebsocketServer::open(config, gate, tick);
        if (server || config.port == 0) return server;
        const auto holder = gate_process::holder_of_port(config.port);
        if (!holder) return server;
        if (clock_ns(CLOCK_MONOTONIC) > end_ns)
            return Error{server.error().code,
                         fmt::format("{}; {} listens there{}; end that process, or name another "
                                     "port (--port)",
                                     server.error().message,
                                     gate_process::words_of(*holder),
                                     holder->parent == 1 ? ", whose parent has ended" : "")};
        constexpr timespec kPause{0, 20'000'000};
        ::nanosleep(&kPause, nullptr);
    }
}

gate::ReadinessLimits limits_of(const io::MachineFile& file) {
    gate::ReadinessLimits limits;
    if (file.speed_m_s > 0.0) limits.fastest_m_s = file.speed_m_s;
    if (file.turn_deg_s > 0.0) limits.fastest_rad_s = file.turn_deg_s * std::numbers::pi / 180.0;
    return limits;
}

/// Requests short time slices for the calling thread. After a query wakes the thread, the scheduler
/// runs it soon, not only at the end of another thread's slice (milliseconds). The request needs no
/// privileges. Linux before 6.12 ignores it.
void ask_for_short_slices() {
    if (::sched_getscheduler(0) != SCHED_OTHER) return;  // the process has another policy; keep it
    struct {  // as in sched_setattr(2); the kernel's header conflicts with that of the C library
        std::uint32_t size = 48;
        std::uint32_t policy = SCHED_OTHER;
        std::uint64_t flags = 0;
        std::int32_t nice = ::getpriority(PRIO_PROCESS, 0);  // unchanged
        std::uint32_t priority = 0;
        std::uint64_t slice_ns = 100'000;  // the shortest slice that Linux accepts
        std::uint64_t deadline_ns = 0;
        std::uint64_t period_ns = 0;
    } wish;
    static_assert(sizeof(wish) == 48);
    ::syscall(SYS_sched_setattr, 0, &wish, 0U);
}

/// Opens the audit log; null without --audit.
Result<std::unique_ptr<gate_process::AuditLog>> open_log(const Options& options,
                                                         const Machine& machine) {
    std::unique_ptr<gate_process::AuditLog> log;
    if (options.audit_dir.empty()) return log;
    gate_process::AuditConfig config;
    config.files.run_id = gate_process::new_run_id();
    config.files.total_bytes = static_cast<std::uint64_t>(options.audit_mb) << 20U;
    // The newest file is never removed, so a file must be small compared with the total limit.
    config.files.file_bytes = std::min(config.files.file_bytes, config.files.total_bytes / 4);
    log = std::make_unique<gate_process::AuditLog>(
        machine, gate_process::make_folder_disk(options.audit_dir), config);
    if (auto status = log->start(); !status) return status.error();
    return log;
}

int serve(const Options& options, const io::MachineFile& file) {
    const auto key = channel_key(options);
    if (!key) return fail(key.error());
    auto log = open_log(options, file.machine);
    if (!log) return fail(log.error());
    gate_process::AuditLog* const audit = log->get();
    gate_process::Gatekeeper keeper(
        file.machine,
        limits_of(file),
        {options.snapshots, *key},
        [audit](const gate_process::Judgement& j, const grid::MapSnapshot& map) {
            if (audit != nullptr)
                audit->push(
                    gate_process::AuditedVerdict{j.query, j.health, j.now_ns, map, j.verdict});
        },
        [audit](const gate_process::Act& act) {
            if (audit != nullptr) audit->push(act);
        });
    if (options.attestation_radius_m > 0.0) {
        if (auto status = keeper.attest_when_ready(options.attestation_radius_m); !status)
            return fail(status.error());
    }
    ChannelNews news(options.snapshots);
    gate_process::WebsocketServer* running = nullptr;
    const auto tick = [&](std::int64_t now_ns) {
        keeper.poll(now_ns, clock_ns(CLOCK_BOOTTIME));
        news.tell(keeper.channel_state());
        if (options.assured && audit != nullptr)
            keeper.set_log_failing(audit->state(now_ns) != gate_process::AuditState::ok);
        if (stop_wanted || is_orphan(options.parent_fd)) running->stop();
    };
    auto server = listen(options.server, keeper, tick);
    if (!server) return fail(server.error());
    running = server->get();
    fmt::print("listening on {}://{}:{}\n",
               options.server.tls.empty() ? "ws" : "wss",
               options.server.bind_address,
               running->port());
    std::fflush(stdout);
    ask_for_short_slices();
    running->run();
    keeper.stop();
    server->reset();  // releases the port before the log writes its last records
    if (audit != nullptr) audit->stop();
    return kExitOk;
}

int run(Options options) {
    const auto machine = machines::load_machine(options.machine);
    if (!machine) return fail(machine.error());
    for (const std::string& note : machine->notes)
        fmt::print(stderr, "surefoot-gate: warning: {}\n", note);
    for (const io::Deviation& deviation : machine->deviations)
        fmt::print(stderr, "surefoot-gate: {}: {}\n", options.machine, io::text_of(deviation));
    auto loaded =
        gate_process::load_access(options.token_file, options.guests, options.server.bind_address);
    if (!loaded) return fail(loaded.error());
    fmt::print(stderr, "{}", loaded->news);
    options.server.access = std::move(loaded->access);
    if (options.assured && options.audit_dir.empty())
        return fail(
            usage_error("--assured needs an audit log: give the folder of the log with --audit"));
    // Each start of the gate begins at another connection number. So a verdict from before the
    // start practically never has the number of a present client.
    options.server.first_connection = gate_process::new_run_id() >> 24U | 1U;
    struct sigaction action = {};
    action.sa_handler = [](int) { stop_wanted = true; };
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);  // exceeding a file size limit counts as a failed write
    return serve(options, *machine);
}

int main_with_arguments(int argc, char** argv) {
    Options options;
    CLI::App app(
        "The step gate: answers over a WebSocket whether a step may be taken. The gate can forbid "
        "a step; it never starts one.\n"
        "Usually `surefoot serve` starts this program.");
    app.footer("Example:\n  surefoot-gate --snapshots /dev/shm/surefoot.channel --audit out/audit");
    app.add_option("--snapshots", options.snapshots, "file in shared memory that holds the maps")
        ->required()
        ->type_name("FILE");
    app.add_option("--machine", options.machine, "machine file, or the name of a built-in machine")
        ->capture_default_str();
    app.add_option(
           "--port", options.server.port, "TCP port on which the gate listens; 0 = any free port")
        ->capture_default_str();
    app.add_option("--bind",
                   options.server.bind_address,
                   "address on which the gate listens; on an address other than loopback every "
                   "client needs a token, and the gate needs --certificate and --key")
        ->capture_default_str();
    app.add_option("--token-file",
                   options.token_file,
                   "file with the tokens of observer, rider and operator; the gate makes it at the "
                   "first start (default: ~/.local/state/surefoot/tokens)")
        ->type_name("FILE");
    app.add_option("--guests",
                   options.guests,
                   "role of a client without a token: none, observer or rider (default: rider on "
                   "loopback, none on other addresses)")
        ->check(CLI::IsMember({"none", "observer", "rider"}))
        ->type_name("ROLE");
    app.add_option("--certificate",
                   options.server.tls.certificate_file,
                   "file with the certificate chain for TLS (PEM)")
        ->type_name("FILE");
    app.add_option("--key",
                   options.server.tls.key_file,
                   "file with the private key for TLS (PEM), permissions 0600")
        ->type_name("FILE");
    app.add_option(
           "--insecure",
           options.server.insecure,
           "sentence that confirms an address other than loopback without TLS; start without "
           "this option, and the error message shows the sentence")
        ->type_name("TEXT");
    app.add_option(
           "--origin",
           options.server.origins,
           "origin whose web pages may connect, for example http://192.0.2.7:8000, null or file://")
        ->type_name("URL");
    app.add_option("--audit",
                   options.audit_dir,
                   "folder for the audit log; without this option the gate writes no log")
        ->type_name("DIR");
    app.add_flag(
        "--assured", options.assured, "never answer OK while the audit log cannot be written");
    app.add_option("--audit-mb",
                   options.audit_mb,
                   "largest size of the folder of the audit log; if the logs need more, the gate "
                   "deletes the oldest logs")
        ->check(CLI::Range(8, 1 << 20))
        ->capture_default_str()
        ->type_name("MB");
    app.add_option("--max-rate",
                   options.server.session.messages.per_s,
                   "largest number of messages from one client in a second; the gate refuses "
                   "further messages, and answers further step questions with OVERLOAD")
        ->check(CLI::Range(1, 1000000))
        ->capture_default_str()
        ->type_name("HZ");
    app.add_option(
           "--attest",
           options.attestation_radius_m,
           "operator attestation, given once when the gate is ready: radius around the "
           "machine within which ground that was not measured counts as level. At most "
           "attestation_radius_m of the machine file (1.0 m for rex). The attestation ends when "
           "the machine leaves the circle")
        ->check(CLI::NonNegativeNumber)
        ->type_name("M");
    app.add_option("--vouch", options.attestation_radius_m)  // the name until 0.1
        ->check(CLI::NonNegativeNumber)
        ->group("")
        ->each([](const std::string&) {
            fmt::print(
                stderr, "surefoot-gate: warning: {}\n", io::renamed_note("--vouch", "--attest"));
        });
    app.add_option("--channel-key",
                   options.key_file,
                   "file with the key of the maps, as given to `surefoot serve`; 32 hexadecimal "
                   "digits, permissions 0600")
        ->type_name("FILE");
    app.add_option("--parent-fd", options.parent_fd)->group("");  // only `surefoot serve` passes it
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? kExitOk : kExitUsage;
    }
    return run(std::move(options));
}

}  // namespace
}  // namespace surefoot::app

// The clients of an ended process get no further answer, so no step is allowed. This holds for
// every way in which the process ends.
int main(int argc, char** argv) {
    try {
        return surefoot::app::main_with_arguments(argc, argv);
    } catch (const std::exception& error) {
        std::fputs("surefoot-gate: internal error: ", stderr);
        std::fputs(error.what(), stderr);
        return surefoot::app::kExitFailed;
    }
}

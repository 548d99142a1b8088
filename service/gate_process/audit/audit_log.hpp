// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "service/gate_process/audit/audit_disk.hpp"
#include "service/gate_process/audit/audit_record.hpp"
#include "service/gate_process/audit/audit_writer.hpp"
#include "service/gate_process/audit/byte_ring.hpp"
#include "service/gate_process/sockets/acts.hpp"

namespace surefoot::gate_process {

struct AuditConfig {
    AuditFiles files;
    std::size_t memory_bytes = 8U << 20U;  ///< memory for waiting entries: about 250 verdicts
    std::int64_t behind_after_ns = 1'000'000'000;  ///< state `behind` if an entry waits longer
    std::int64_t poll_ns = 10'000'000;     ///< the thread looks for entries at this interval
    std::int64_t retry_ns = 200'000'000;   ///< pause after a failed attempt to write
    std::int64_t sync_ns = 1'000'000'000;  ///< sync period; a power loss costs the unsynced entries

    [[nodiscard]] std::optional<std::string> problem() const;
};

enum class AuditState : std::uint8_t {
    ok,       ///< every entry is written, or has waited for at most `behind_after_ns`
    behind,   ///< an entry waits longer, or the gap of lost entries is not written yet
    failing,  ///< the last attempt to write failed
};
/// Returns the name of a state, for example "ok".
[[nodiscard]] const char* to_string(AuditState state) noexcept;

struct AuditReport {
    std::uint64_t written = 0;  ///< verdicts and acts in the log
    std::uint64_t lost = 0;     ///< verdicts and acts that were dropped
    bool failing = false;
    std::string last_error;  ///< message of the last error; empty = no error yet
};

/// Writes every verdict of a gate with its inputs to disk. `push` copies and returns; a separate
/// thread writes, so a slow disk never delays a verdict. Waiting entries stay in memory. If the
/// memory is full, entries are dropped and counted, and the log gets a gap entry at their position.
/// The memory size is fixed at `start`. Format: docs/reference/audit_format.md.
///
/// One thread must call start, push, state and stop. Any thread may call `report`.
class AuditLog {
  public:
    AuditLog(const Machine& machine, std::unique_ptr<AuditDisk> disk, const AuditConfig& config);
    ~AuditLog();  ///< calls stop()
    AuditLog(const AuditLog&) = delete;
    AuditLog& operator=(const AuditLog&) = delete;

    /// Allocates the memory and starts the thread. A faulty disk shows in `state`, not here.
    [[nodiscard]] Status start();
    /// Copies an entry in microseconds. Never blocks, allocates, locks or makes a system call.
    void push(const AuditedVerdict& audited) noexcept;
    /// Adds an act in order between the verdicts. If the memory is full, the act is dropped.
    void push(const Act& act) noexcept;
    /// Returns the state at `now_ns` (clock of the verdicts). With --assured, an OK needs `ok`.
    [[nodiscard]] AuditState state(std::int64_t now_ns) const noexcept;
    /// Writes the waiting entries, tries a failing disk once more and ends the thread. Blocks until
    /// the disk returns.
    void stop();
    [[nodiscard]] AuditReport report() const;

  private:
    void run();
    [[nodiscard]] char* reserve(FrameKind kind, std::size_t bytes, std::int64_t now_ns) noexcept;
    [[nodiscard]] bool wait(std::int64_t time_ns);
    [[nodiscard]] bool write_all_that_waits();
    [[nodiscard]] bool write_entry(std::string_view entry);
    [[nodiscard]] bool succeeded(const Status& status);
    void write_last_gap();

    Machine machine_;
    std::uint64_t machine_hash_;
    AuditConfig config_;
    AuditWriter writer_;
    std::unique_ptr<ByteRing> ring_;
    AuditGap missed_;           ///< entries lost since the last entry; only for the pushing thread
    bool gap_written_ = false;  ///< true: the log has the gap before the first waiting entry
    std::atomic<bool> failing_{false};
    std::atomic<std::uint64_t> written_{0};
    std::atomic<std::uint64_t> lost_{0};

    mutable std::mutex mutex_;  ///< guards the members below; push and state never lock it
    std::condition_variable wake_;
    bool stopping_ = false;
    std::string last_error_;
    std::thread thread_;
};

}  // namespace surefoot::gate_process

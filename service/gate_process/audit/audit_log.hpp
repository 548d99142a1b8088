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
    std::size_t memory_bytes = 8U << 20U;  ///< what may wait for the disk: some 250 verdicts
    std::int64_t behind_after_ns = 1'000'000'000;  ///< a verdict that waits longer is behind
    std::int64_t poll_ns = 10'000'000;     ///< the thread looks so often whether something waits
    std::int64_t retry_ns = 200'000'000;   ///< after a failure
    std::int64_t sync_ns = 1'000'000'000;  ///< a loss of power costs no more than so much

    [[nodiscard]] std::optional<std::string> problem() const;
};

enum class AuditState : std::uint8_t {
    ok,       ///< every verdict is with the system, or will be at once
    behind,   ///< one waits for too long, or verdicts were lost and that is not in the log yet
    failing,  ///< the last try to write failed
};
/// "ok".
[[nodiscard]] const char* to_string(AuditState state) noexcept;

struct AuditReport {
    std::uint64_t written = 0;  ///< verdicts and acts that are in the log
    std::uint64_t lost = 0;     ///< verdicts and acts that never will be
    bool failing = false;
    std::string last_error;  ///< empty = none yet
};

/// Every verdict of a gate with all that it was made from, on disk. `push` copies and returns; a
/// thread of the log's own does the rest, so that no disk delays a verdict. What waits is kept as
/// long as the memory holds it; then verdicts are lost, counted, and the gap is in the log where
/// they would be. Machine and memory are fixed at `start`.
///
/// One thread calls start, push, state and stop; `report` any. The bytes on disk: audit_format.md.
class AuditLog {
  public:
    AuditLog(const Machine& machine, std::unique_ptr<AuditDisk> disk, const AuditConfig& config);
    ~AuditLog();  ///< stops
    AuditLog(const AuditLog&) = delete;
    AuditLog& operator=(const AuditLog&) = delete;

    /// Takes the memory and starts the thread. A bad disk is no error here: `state` tells of it.
    [[nodiscard]] Status start();
    /// Never blocks, allocates, locks or calls the system; some microseconds for the copy.
    void push(const AuditedVerdict& audited) noexcept;
    /// An act, in its order between the verdicts. One that finds no room is lost like a verdict.
    void push(const Act& act) noexcept;
    /// For a service that gives no OK without a log (Reason::audit). `now_ns` as in the verdicts.
    [[nodiscard]] AuditState state(std::int64_t now_ns) const noexcept;
    /// Writes what waits, tries a failing disk once more, and ends the thread: returns when the
    /// disk does.
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
    AuditGap missed_;           ///< since the last entry; of the pushing thread
    bool gap_written_ = false;  ///< the gap before the first entry that waits
    std::atomic<bool> failing_{false};
    std::atomic<std::uint64_t> written_{0};
    std::atomic<std::uint64_t> lost_{0};

    mutable std::mutex mutex_;  ///< of what follows; never taken by push or state
    std::condition_variable wake_;
    bool stopping_ = false;
    std::string last_error_;
    std::thread thread_;
};

}  // namespace surefoot::gate_process

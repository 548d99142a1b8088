// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/audit/audit_log.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstring>
#include <utility>

#include "service/gate_process/steady_clock.hpp"

namespace surefoot::gate_process {
namespace {

/// The start of a ring entry. The record follows.
struct EntryHead {
    std::int64_t now_ns = 0;
    AuditGap before;  ///< entries dropped since the previous entry
    FrameKind kind = FrameKind::verdict;
};

EntryHead head_of(std::string_view entry) noexcept {
    EntryHead head;
    std::memcpy(&head, entry.data(), sizeof(head));
    return head;
}

}  // namespace

std::optional<std::string> AuditConfig::problem() const {
    constexpr std::size_t kLeast = 2 * (kMaxRecordBytes + 64);
    if (memory_bytes < kLeast)
        return fmt::format("memory_bytes = {} must be at least {}", memory_bytes, kLeast);
    if (files.file_bytes == 0 || files.total_bytes < files.file_bytes)
        return fmt::format("file_bytes = {} must be above 0 and at most total_bytes = {}",
                           files.file_bytes,
                           files.total_bytes);
    if (behind_after_ns <= 0 || poll_ns <= 0 || retry_ns <= 0 || sync_ns <= 0)
        return "behind_after_ns, poll_ns, retry_ns and sync_ns must be above 0";
    return std::nullopt;
}

const char* to_string(AuditState state) noexcept {
    switch (state) {
        case AuditState::ok: return "ok";
        case AuditState::behind: return "behind";
        case AuditState::failing: return "failing";
    }
    return "failing";
}

AuditLog::AuditLog(const Machine& machine,
                   std::unique_ptr<AuditDisk> disk,
                   const AuditConfig& config)
    : machine_(machine),
      machine_hash_(hash_of(machine)),
      config_(config),
      writer_(machine, std::move(disk), config.files) {}

AuditLog::~AuditLog() {
    stop();
}

Status AuditLog::start() {
    if (const auto problem = config_.problem()) return usage_error("audit: " + *problem);
    SUREFOOT_ASSERT(ring_ == nullptr);
    ring_ = std::make_unique<ByteRing>(config_.memory_bytes);
    thread_ = std::thread([this] { run(); });
    return {};
}

void AuditLog::push(const AuditedVerdict& audited) noexcept {
    const CellBox zone = query_zone(
        machine_, audited.query, audited.map, audited.verdict.evidence.max_drift_tenth_mm);
    char* at = reserve(FrameKind::verdict, record_bytes(audited, zone), audited.now_ns);
    if (at == nullptr) return;
    write_record(machine_hash_, audited, zone, at);
    ring_->commit();
}

void AuditLog::push(const Act& act) noexcept {
    char* at = reserve(FrameKind::act, act_bytes(act), act.time_ns);
    if (at == nullptr) return;
    write_act(act, at);
    ring_->commit();
}

/// Reserves an entry and writes its head. If there is no room, counts the loss and returns nullptr.
char* AuditLog::reserve(FrameKind kind, std::size_t bytes, std::int64_t now_ns) noexcept {
    char* at = ring_ == nullptr ? nullptr : ring_->reserve(sizeof(EntryHead) + bytes);
    if (at == nullptr) {
        if (missed_.verdicts == 0) missed_.first_ns = now_ns;
        missed_.last_ns = now_ns;
        ++missed_.verdicts;
        lost_.fetch_add(1, std::memory_order_relaxed);
        return nullptr;
    }
    const EntryHead head{now_ns, missed_, kind};
    std::memcpy(at, &head, sizeof(head));
    missed_ = {};
    return at + sizeof(head);
}

AuditState AuditLog::state(std::int64_t now_ns) const noexcept {
    if (ring_ == nullptr || failing_.load(std::memory_order_acquire)) return AuditState::failing;
    if (missed_.verdicts > 0) return AuditState::behind;
    const std::string_view oldest = ring_->oldest();
    if (oldest.empty()) return AuditState::ok;
    const EntryHead head = head_of(oldest);
    const bool waits = now_ns - head.now_ns > config_.behind_after_ns;
    return waits || head.before.verdicts > 0 ? AuditState::behind : AuditState::ok;
}

void AuditLog::stop() {
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    wake_.notify_all();
    thread_.join();
    write_last_gap();
    ring_.reset();
}

AuditReport AuditLog::report() const {
    const std::lock_guard lock(mutex_);
    return {written_.load(), lost_.load(), failing_.load(), last_error_};
}

/// Waits for the next poll. Returns true if the log must stop.
bool AuditLog::wait(std::int64_t time_ns) {
    std::unique_lock lock(mutex_);
    return wake_.wait_for(lock, std::chrono::nanoseconds(time_ns), [this] { return stopping_; });
}

void AuditLog::run() {
    std::int64_t synced_ns = steady_ns();
    bool well = succeeded(writer_.open());
    for (bool stopping = false; !stopping;) {
        stopping = wait(well ? config_.poll_ns : config_.retry_ns);
        well = write_all_that_waits();
        if (well && (stopping || steady_ns() - synced_ns >= config_.sync_ns)) {
            well = succeeded(writer_.sync());
            synced_ns = steady_ns();
        }
    }
}

bool AuditLog::write_all_that_waits() {
    // Retries a failed disk even if no entry waits, so that `failing` ends when the disk works
    // again. No file is open then, so opening a file is an attempt to write.
    const bool idle = ring_->front().empty();
    if (idle && failing_.load(std::memory_order_relaxed) && !succeeded(writer_.open()))
        return false;
    for (std::string_view entry = ring_->front(); !entry.empty(); entry = ring_->front()) {
        if (!write_entry(entry)) return false;
        ring_->pop();
    }
    return true;
}

bool AuditLog::write_entry(std::string_view entry) {
    const EntryHead head = head_of(entry);
    if (head.before.verdicts > 0 && !gap_written_) {
        if (!succeeded(writer_.write(FrameKind::gap, format_gap(head.before)))) return false;
        gap_written_ = true;
    }
    if (!succeeded(writer_.write(head.kind, entry.substr(sizeof(head))))) return false;
    gap_written_ = false;
    written_.fetch_add(1, std::memory_order_relaxed);
    return true;
}

bool AuditLog::succeeded(const Status& status) {
    failing_.store(!status.ok(), std::memory_order_release);
    if (!status) {
        const std::lock_guard lock(mutex_);
        last_error_ = status.error().message;
    }
    return status.ok();
}

/// Writes the gap after the last entry, including entries that no disk accepted. Call it only after
/// the thread has ended.
void AuditLog::write_last_gap() {
    AuditGap gap;
    const auto add = [&gap](std::uint64_t verdicts, std::int64_t first_ns, std::int64_t last_ns) {
        if (verdicts == 0) return;
        if (gap.verdicts == 0) gap.first_ns = first_ns;
        gap.last_ns = last_ns;
        gap.verdicts += verdicts;
    };
    for (std::string_view entry = ring_->front(); !entry.empty(); entry = ring_->front()) {
        const EntryHead head = head_of(entry);
        if (!gap_written_) add(head.before.verdicts, head.before.first_ns, head.before.last_ns);
        gap_written_ = false;
        add(1, head.now_ns, head.now_ns);
        lost_.fetch_add(1, std::memory_order_relaxed);
        ring_->pop();
    }
    add(missed_.verdicts, missed_.first_ns, missed_.last_ns);
    missed_ = {};
    if (gap.verdicts == 0) return;
    if (succeeded(writer_.write(FrameKind::gap, format_gap(gap))))
        static_cast<void>(succeeded(writer_.sync()));
}

}  // namespace surefoot::gate_process

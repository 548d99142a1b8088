// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/audit/audit_writer.hpp"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <system_error>
#include <utility>

namespace surefoot::gate_process {

/// Compresses payloads with zstd level 1. Cells of a floor shrink tenfold, and the low level leaves
/// processor time to other work.
struct AuditWriter::Packer {
    static constexpr int kLevel = 1;
    ZSTD_CCtx* context = ZSTD_createCCtx();
    std::string packed = std::string(ZSTD_compressBound(kMaxPayloadBytes), '\0');

    Packer() = default;
    Packer(const Packer&) = delete;
    Packer& operator=(const Packer&) = delete;
    ~Packer() { ZSTD_freeCCtx(context); }

    /// Returns the packed payload if it is shorter than the plain one, otherwise the plain payload.
    std::string_view pack(std::string_view plain, FrameEncoding& encoding) {
        const std::size_t bytes = ZSTD_compressCCtx(
            context, packed.data(), packed.size(), plain.data(), plain.size(), kLevel);
        const bool shorter = ZSTD_isError(bytes) == 0 && bytes < plain.size();
        encoding = shorter ? FrameEncoding::zstd : FrameEncoding::plain;
        return shorter ? std::string_view(packed).substr(0, bytes) : plain;
    }
};

AuditWriter::AuditWriter(const Machine& machine,
                         std::unique_ptr<AuditDisk> disk,
                         const AuditFiles& files)
    : head_{files.run_id, 0, hash_of(machine), machine},
      disk_(std::move(disk)),
      files_(files),
      packer_(std::make_unique<Packer>()) {}

AuditWriter::~AuditWriter() = default;

Status AuditWriter::open() {
    return is_open_ ? Status() : begin_file();
}

Status AuditWriter::write(FrameKind kind, std::string_view payload) {
    const std::uint64_t grown = logs_.empty() ? 0 : logs_.back().bytes + payload.size();
    // Adds the unpacked size, so that the limit holds without packing twice.
    if (is_open_ && grown > files_.file_bytes) {
        if (auto status = sync(); !status) return status;
        leave_file();
    }
    if (auto status = open(); !status) return status;
    return append(kind, payload);
}

Status AuditWriter::sync() {
    if (!is_open_ || synced_) return {};
    Status status = disk_->sync();
    // After a failed sync the content of the file is uncertain: continue in a new file.
    if (!status) leave_file();
    synced_ = true;
    return status;
}

/// Opens a new file. Its number follows the number of the last file in the folder, whichever
/// process wrote that file.
Status AuditWriter::begin_file() {
    if (!listed_) {
        auto entries = disk_->list();
        if (!entries) return entries.error();
        for (AuditDisk::Entry& entry : *entries) {
            std::uint64_t number = 0;
            if (parse_audit_file_name(entry.name, number))
                logs_.push_back({std::move(entry.name), number, entry.bytes});
        }
        std::sort(logs_.begin(), logs_.end(), [](const Log& a, const Log& b) {
            return std::pair(a.number, a.name) < std::pair(b.number, b.name);
        });
        listed_ = true;
    }
    head_.number = logs_.empty() ? 0 : logs_.back().number + 1;
    const std::string name = audit_file_name(head_.run_id, head_.number);
    if (auto status = disk_->create(name); !status) {
        static_cast<void>(disk_->remove(name));
        return status;
    }
    logs_.push_back({name, head_.number, 0});
    is_open_ = true;
    if (auto status = append(FrameKind::file, format_file_head(head_)); !status) {
        // An empty file holds no data: reuse its number.
        disk_->close();
        is_open_ = false;
        if (disk_->remove(name)) logs_.pop_back();
        return status;
    }
    remove_oldest();
    return {};
}

Status AuditWriter::append(FrameKind kind, std::string_view payload) {
    FrameHeader header;
    header.kind = kind;
    const std::string_view stored = packer_->pack(payload, header.encoding);
    header.stored_bytes = static_cast<std::uint32_t>(stored.size());
    header.plain_bytes = static_cast<std::uint32_t>(payload.size());
    header.sequence = sequence_;
    header.previous_hash = previous_hash_;
    frame_.clear();
    const std::uint64_t hash = append_frame(frame_, header, stored);
    if (auto status = put(frame_); !status) return status;
    ++sequence_;
    previous_hash_ = hash;
    synced_ = false;
    return {};
}

/// Writes all bytes. On an error, removes the bytes that were written; if that fails too, leaves
/// the file.
Status AuditWriter::put(std::string_view bytes) {
    Log& log = logs_.back();
    std::size_t done = 0;
    int idle = 0;
    while (done < bytes.size()) {
        const AuditDisk::Written written = disk_->write(bytes.substr(done));
        done += written.bytes;
        idle = written.bytes == 0 ? idle + 1 : 0;
        constexpr int kMostIdle = 16;  // most attempts that are interrupted or accept no bytes
        if (written.error == 0 && idle < kMostIdle) continue;
        const Error error =
            output_error(log.name + ": " +
                         (written.error == 0 ? "the disk accepted no bytes in 16 attempts"
                                             : std::generic_category().message(written.error)));
        if (done > 0 && !disk_->truncate(log.bytes)) leave_file();
        return error;
    }
    log.bytes += bytes.size();
    return {};
}

void AuditWriter::leave_file() {
    disk_->close();
    is_open_ = false;
    synced_ = true;
}

std::uint64_t AuditWriter::folder_bytes() const noexcept {
    std::uint64_t bytes = 0;
    for (const Log& log : logs_) bytes += log.bytes;
    return bytes;
}

/// Removes the oldest files to make room for the new file. If a file cannot be removed, tries again
/// when the next new file is opened.
void AuditWriter::remove_oldest() {
    while (logs_.size() > 1 && folder_bytes() + files_.file_bytes > files_.total_bytes) {
        if (!disk_->remove(logs_.front().name)) return;
        logs_.erase(logs_.begin());
    }
}

}  // namespace surefoot::gate_process

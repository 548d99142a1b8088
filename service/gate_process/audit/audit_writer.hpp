// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "service/gate_process/audit/audit_disk.hpp"
#include "service/gate_process/audit/audit_frame.hpp"

namespace surefoot::gate_process {

struct AuditFiles {
    std::uint64_t run_id = 0;  ///< id of this process; part of the file names
    std::uint64_t file_bytes = 16ULL
                               << 20U;  ///< no file grows beyond this size; a new file continues
    std::uint64_t total_bytes = 1ULL << 30U;  ///< limit for the folder; the oldest logs are deleted
};

/// Writes frames to files, in one chain across files. A frame is written completely or removed. If
/// the removal fails, the writer abandons the file and continues the chain in a new file. Use it
/// from one thread; every call may block as long as the disk does.
class AuditWriter {
  public:
    AuditWriter(const Machine& machine, std::unique_ptr<AuditDisk> disk, const AuditFiles& files);
    ~AuditWriter();
    AuditWriter(const AuditWriter&) = delete;
    AuditWriter& operator=(const AuditWriter&) = delete;

    /// Opens a file if none is open.
    [[nodiscard]] Status open();
    /// Writes one frame. After an error no part of the frame counts as written; retry the frame.
    [[nodiscard]] Status write(FrameKind kind, std::string_view payload);
    /// Makes the written frames safe against a power loss. After an error the file is abandoned.
    [[nodiscard]] Status sync();
    [[nodiscard]] bool is_synced() const noexcept { return synced_; }

  private:
    struct Packer;

    [[nodiscard]] Status begin_file();
    [[nodiscard]] Status append(FrameKind kind, std::string_view payload);
    [[nodiscard]] Status put(std::string_view bytes);
    void leave_file();
    void remove_oldest();
    [[nodiscard]] std::uint64_t folder_bytes() const noexcept;

    struct Log {
        std::string name;
        std::uint64_t number = 0;
        std::uint64_t bytes = 0;
    };

    FileHead head_;
    std::unique_ptr<AuditDisk> disk_;
    AuditFiles files_;
    std::unique_ptr<Packer> packer_;
    std::vector<Log> logs_;  ///< oldest first; the last one is open if `is_open_`
    bool listed_ = false;
    bool is_open_ = false;
    bool synced_ = true;
    std::uint64_t sequence_ = 0;
    std::uint64_t previous_hash_ = 0;
    std::string frame_;
};

}  // namespace surefoot::gate_process

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"

namespace surefoot::gate_process {

/// A folder with one growing file at a time: the interface of the audit log to a disk. Tests can
/// replace the disk by a faulty disk. Every call may fail or block. Use it from one thread.
class AuditDisk {
  public:
    struct Entry {
        std::string name;
        std::uint64_t bytes = 0;
    };
    struct Written {
        std::size_t bytes = 0;  ///< number of written bytes; fewer than given is not an error
        int error = 0;          ///< errno; 0 = none
    };

    AuditDisk() = default;
    AuditDisk(const AuditDisk&) = delete;
    AuditDisk& operator=(const AuditDisk&) = delete;
    virtual ~AuditDisk() = default;

    /// Lists the files of the folder. Creates the folder if it is missing.
    [[nodiscard]] virtual Result<std::vector<Entry>> list() = 0;
    /// Creates a new file; fails if a file of that name exists.
    [[nodiscard]] virtual Status create(const std::string& name) = 0;
    /// Appends to the file that was created last.
    [[nodiscard]] virtual Written write(std::string_view bytes) = 0;
    /// Truncates the file that was created last to `bytes` bytes.
    [[nodiscard]] virtual Status truncate(std::uint64_t bytes) = 0;
    /// Waits until the written bytes are safe against a power loss.
    [[nodiscard]] virtual Status sync() = 0;
    virtual void close() = 0;
    [[nodiscard]] virtual Status remove(const std::string& name) = 0;
};

/// An audit disk in a folder of the file system.
[[nodiscard]] std::unique_ptr<AuditDisk> make_folder_disk(std::string folder);

/// Returns a number that is unique among all processes and boots of the computer. It is made from
/// the boot id, the steady clock and the process id.
[[nodiscard]] std::uint64_t new_run_id();

}  // namespace surefoot::gate_process

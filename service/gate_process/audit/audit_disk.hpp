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

/// A folder that takes one growing file at a time: all that the audit log asks of a disk, so that
/// tests can put a bad one in its place. Every call may fail and may take long. One thread.
class AuditDisk {
  public:
    struct Entry {
        std::string name;
        std::uint64_t bytes = 0;
    };
    struct Written {
        std::size_t bytes = 0;  ///< of those that were given; fewer is no error yet
        int error = 0;          ///< errno; 0 = none
    };

    AuditDisk() = default;
    AuditDisk(const AuditDisk&) = delete;
    AuditDisk& operator=(const AuditDisk&) = delete;
    virtual ~AuditDisk() = default;

    /// Files of the folder, which is made when it is not there.
    [[nodiscard]] virtual Result<std::vector<Entry>> list() = 0;
    /// Begins a new file; fails where one of that name is.
    [[nodiscard]] virtual Status create(const std::string& name) = 0;
    /// Appends to the file that was begun last.
    [[nodiscard]] virtual Written write(std::string_view bytes) = 0;
    /// Takes back what lies beyond `bytes` of it.
    [[nodiscard]] virtual Status truncate(std::uint64_t bytes) = 0;
    /// Returns when what was written survives a loss of power.
    [[nodiscard]] virtual Status sync() = 0;
    virtual void close() = 0;
    [[nodiscard]] virtual Status remove(const std::string& name) = 0;
};

/// A folder of the system.
[[nodiscard]] std::unique_ptr<AuditDisk> make_folder_disk(std::string folder);

/// A number that no other process of this or another start of the computer has: of its boot id,
/// the steady clock and the process.
[[nodiscard]] std::uint64_t new_run_id();

}  // namespace surefoot::gate_process

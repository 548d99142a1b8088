// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "surefoot/core/result.hpp"

namespace surefoot::gate_process {

/// The first bytes of every channel file.
struct ChannelBegin {
    std::uint64_t magic = 0;  ///< identifies the kind of file; 0 in a new file
    std::uint64_t owner = 0;  ///< id of the process that holds the lock or held it last
};

/// The open file of a snapshot channel. Uses system calls, because a truncated file then gives a
/// short read; a mapped file would end the process (SIGBUS).
class ChannelFile {
  public:
    ChannelFile() = default;
    ChannelFile(ChannelFile&& other) noexcept;
    ChannelFile& operator=(ChannelFile&& other) noexcept;
    ~ChannelFile();

    /// Opens an existing regular file for reading.
    [[nodiscard]] static Result<ChannelFile> open(const std::string& path);
    /// Opens the file for the only writer: creates it (rights 0600) if it is missing, and locks it.
    /// The lock ends with the process; the file keeps the process id. Error if another process
    /// holds the lock (the message names it). Error if the file is not regular, belongs to another
    /// user, or is not empty and does not begin with `magic`.
    [[nodiscard]] static Result<ChannelFile> lock(const std::string& path, std::uint64_t magic);

    /// Returns true if all bytes were read.
    [[nodiscard]] bool read(void* out, std::size_t bytes, std::size_t offset) const noexcept;
    /// Returns true if all bytes were written.
    bool write(const void* in, std::size_t bytes, std::size_t offset) const noexcept;
    /// Sets the file size and allocates its memory, so that later writes do not lack space.
    [[nodiscard]] Status resize(std::size_t bytes) const;

    /// Returns the size of the file [bytes], or 0 if the system call fails.
    [[nodiscard]] std::size_t size() const noexcept;
    /// True if `path` still refers to this file.
    [[nodiscard]] bool is_at(const std::string& path) const noexcept;

  private:
    explicit ChannelFile(int file) : file_(file) {}

    int file_ = -1;
};

/// Makes an error about the channel at a path.
[[nodiscard]] Error channel_error(const std::string& path, const std::string& what);

}  // namespace surefoot::gate_process

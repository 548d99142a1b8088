// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "surefoot/core/result.hpp"

namespace surefoot::gate_process {

/// How every channel begins.
struct ChannelBegin {
    std::uint64_t magic = 0;  ///< of the kind of file; 0 while the file is new
    std::uint64_t owner = 0;  ///< process that holds the lock, or held it last
};

/// The open file of a snapshot channel, read and written by system calls: a file that another
/// process cuts off gives a short read, where a mapped file would end the process (SIGBUS).
class ChannelFile {
  public:
    ChannelFile() = default;
    ChannelFile(ChannelFile&& other) noexcept;
    ChannelFile& operator=(ChannelFile&& other) noexcept;
    ~ChannelFile();

    /// For a reader: an existing regular file.
    [[nodiscard]] static Result<ChannelFile> open(const std::string& path);
    /// For the one writer: makes the file (rights 0600) where it is missing and locks it. The lock
    /// ends with the process, however it ends, and the file keeps the process's number. Errors:
    /// another process holds the lock (named); the file is no regular file, another user's, or not
    /// empty and does not begin with `magic`.
    [[nodiscard]] static Result<ChannelFile> lock(const std::string& path, std::uint64_t magic);

    /// Whether all of the bytes were there.
    [[nodiscard]] bool read(void* out, std::size_t bytes, std::size_t offset) const noexcept;
    /// Whether all of the bytes were taken.
    bool write(const void* in, std::size_t bytes, std::size_t offset) const noexcept;
    /// Gives the file this size, with memory behind it: later writes do not fail for want of room.
    [[nodiscard]] Status resize(std::size_t bytes) const;

    /// 0 where the system does not say it.
    [[nodiscard]] std::size_t size() const noexcept;
    /// Whether this path names this file.
    [[nodiscard]] bool is_at(const std::string& path) const noexcept;

  private:
    explicit ChannelFile(int file) : file_(file) {}

    int file_ = -1;
};

/// An error of a channel.
[[nodiscard]] Error channel_error(const std::string& path, const std::string& what);

}  // namespace surefoot::gate_process

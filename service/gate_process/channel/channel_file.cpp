// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/channel/channel_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <system_error>
#include <utility>

namespace surefoot::gate_process {
namespace {

/// O_NONBLOCK: a pipe with this name must not block the caller.
constexpr int kFlags = O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;

std::string system_words() {
    return std::generic_category().message(errno);
}

bool is_regular(int file, struct stat& info) noexcept {
    return ::fstat(file, &info) == 0 && S_ISREG(info.st_mode);
}

/// Returns the lock holder for messages: "process 1234 (surefoot)".
std::string owner_words(const ChannelFile& file) {
    ChannelBegin begin;
    if (!file.read(&begin, sizeof(begin), 0) || begin.owner == 0) return "another process";
    const std::string number = std::to_string(begin.owner);
    std::string name;
    std::getline(std::ifstream("/proc/" + number + "/comm"), name);
    return "process " + number + (name.empty() ? "" : " (" + name + ")");
}

}  // namespace

Error channel_error(const std::string& path, const std::string& what) {
    return {ErrorCode::input, "snapshot channel " + path + ": " + what};
}

ChannelFile::ChannelFile(ChannelFile&& other) noexcept : file_(std::exchange(other.file_, -1)) {}

ChannelFile& ChannelFile::operator=(ChannelFile&& other) noexcept {
    std::swap(file_, other.file_);
    return *this;
}

ChannelFile::~ChannelFile() {
    if (file_ >= 0) ::close(file_);
}

Result<ChannelFile> ChannelFile::open(const std::string& path) {
    ChannelFile file(::open(path.c_str(), kFlags));
    if (file.file_ < 0) return channel_error(path, "it cannot be opened: " + system_words());
    struct stat info {};
    if (!is_regular(file.file_, info))
        return channel_error(path, "it is not a regular file; name another file");
    return file;
}

Result<ChannelFile> ChannelFile::lock(const std::string& path, std::uint64_t magic) {
    // The previous owner may delete the file between open and lock. In that case, retry.
    constexpr int kAttempts = 10;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        ChannelFile file(::open(path.c_str(), kFlags | O_CREAT, 0600));
        if (file.file_ < 0) return channel_error(path, "it cannot be opened: " + system_words());
        struct stat info {};
        if (!is_regular(file.file_, info))
            return channel_error(path, "it is not a regular file; name another file");
        if (info.st_uid != ::geteuid())
            return channel_error(path, "it belongs to another user; name another file");
        if (::flock(file.file_, LOCK_EX | LOCK_NB) != 0) {
            if (errno != EWOULDBLOCK)
                return channel_error(path, "it cannot be locked: " + system_words());
            return channel_error(path,
                                 owner_words(file) +
                                     " writes into it; end that process, or name another file "
                                     "(--channel)");
        }
        if (!file.is_at(path)) continue;
        ChannelBegin begin;
        if (info.st_size > 0 &&
            (!file.read(&begin, sizeof(begin), 0) || (begin.magic != magic && begin.magic != 0)))
            return channel_error(
                path, "it is not a snapshot channel; delete it, or name another file (--channel)");
        if ((info.st_mode & 0777U) != 0600U && ::fchmod(file.file_, 0600) != 0)
            return channel_error(path, "its rights cannot be set: " + system_words());
        begin.owner = static_cast<std::uint64_t>(::getpid());
        file.write(&begin, sizeof(begin), 0);  // result ignored: resize() detects a full disk
        return file;
    }
    return channel_error(
        path,
        "other processes deleted it during each of 10 attempts to lock it; name another file "
        "(--channel)");
}

bool ChannelFile::read(void* out, std::size_t bytes, std::size_t offset) const noexcept {
    auto* to = static_cast<unsigned char*>(out);
    while (bytes > 0) {
        const ssize_t got = ::pread(file_, to, bytes, static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        to += got;
        offset += static_cast<std::size_t>(got);
        bytes -= static_cast<std::size_t>(got);
    }
    return true;
}

bool ChannelFile::write(const void* in, std::size_t bytes, std::size_t offset) const noexcept {
    const auto* from = static_cast<const unsigned char*>(in);
    while (bytes > 0) {
        const ssize_t put = ::pwrite(file_, from, bytes, static_cast<off_t>(offset));
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return false;
        from += put;
        offset += static_cast<std::size_t>(put);
        bytes -= static_cast<std::size_t>(put);
    }
    return true;
}

Status ChannelFile::resize(std::size_t bytes) const {
    const auto size = static_cast<off_t>(bytes);
    if (::ftruncate(file_, size) != 0)
        return input_error("the file size cannot be set: " + system_words());
    if (const int error = ::posix_fallocate(file_, 0, size); error != 0)
        return input_error(std::to_string(bytes) +
                           " bytes cannot be allocated: " + std::generic_category().message(error));
    return {};
}

std::size_t ChannelFile::size() const noexcept {
    struct stat info {};
    return ::fstat(file_, &info) == 0 ? static_cast<std::size_t>(info.st_size) : 0;
}

bool ChannelFile::is_at(const std::string& path) const noexcept {
    struct stat ours {};
    struct stat named {};
    return ::fstat(file_, &ours) == 0 && ::lstat(path.c_str(), &named) == 0 &&
           ours.st_dev == named.st_dev && ours.st_ino == named.st_ino;
}

}  // namespace surefoot::gate_process

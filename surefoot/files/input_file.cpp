// SPDX-License-Identifier: Apache-2.0
#include "surefoot/files/input_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

namespace surefoot::files {
namespace {

Error cannot_read(const std::string& path, int error) {
    return input_error(
        fmt::format("{}: cannot read: {}", path, std::generic_category().message(error)));
}

const char* kind_of(mode_t mode) {
    if (S_ISDIR(mode)) return "a directory";
    if (S_ISFIFO(mode)) return "a FIFO (named pipe)";
    if (S_ISSOCK(mode)) return "a socket";
    if (S_ISCHR(mode)) return "a device";
    if (S_ISBLK(mode)) return "a disk device";
    return "not a regular file";
}

Error too_large(const std::string& path, std::uint64_t bytes, std::uint64_t max_bytes) {
    return input_error(fmt::format(
        "{}: its {} bytes are more than the limit of {} bytes for this format; check that this is "
        "the right file",
        path,
        bytes,
        max_bytes));
}

Status check_kind(const std::string& path,
                  const struct stat& status,
                  std::uint64_t max_bytes,
                  Accept accept) {
    if (S_ISFIFO(status.st_mode) && accept == Accept::regular_or_fifo) return {};
    if (!S_ISREG(status.st_mode)) {
        return input_error(fmt::format("{}: cannot read: this is {}; give a regular file{}",
                                       path,
                                       kind_of(status.st_mode),
                                       accept == Accept::regular_or_fifo ? " or a FIFO" : ""));
    }
    const auto bytes = static_cast<std::uint64_t>(std::max<off_t>(status.st_size, 0));
    if (bytes > max_bytes) return too_large(path, bytes, max_bytes);
    return {};
}

}  // namespace

Status check_input(const std::string& path, std::uint64_t max_bytes, Accept accept) {
    const Result<InputFile> file = InputFile::open(path, max_bytes, accept);
    return file ? Status() : Status(file.error());
}

Result<InputFile> InputFile::open(const std::string& path, std::uint64_t max_bytes, Accept accept) {
    struct stat status = {};
    // Checks the kind of file by its name first, because opening a device can start it (a watchdog,
    // a tape).
    if (::stat(path.c_str(), &status) != 0) return cannot_read(path, errno);
    if (Status fits = check_kind(path, status, max_bytes, accept); !fits) return fits.error();
    // A FIFO may have replaced the file meanwhile. With O_NONBLOCK, opening does not wait for a
    // writer.
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (descriptor < 0) return cannot_read(path, errno);
    InputFile file(path, descriptor, 0);
    if (::fstat(descriptor, &status) != 0) return cannot_read(path, errno);
    if (Status fits = check_kind(path, status, max_bytes, accept); !fits) return fits.error();
    file.size_ = S_ISREG(status.st_mode) ? static_cast<std::uint64_t>(status.st_size) : 0;
    return file;
}

InputFile::~InputFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

InputFile::InputFile(InputFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      size_(other.size_) {}

InputFile& InputFile::operator=(InputFile&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(descriptor_, other.descriptor_);
    std::swap(size_, other.size_);
    return *this;
}

Result<InputFile::Piece> InputFile::read(std::span<char> buffer) {
    while (true) {
        const ssize_t got = ::read(descriptor_, buffer.data(), buffer.size());
        if (got >= 0) return Piece{static_cast<std::size_t>(got), false};
        if (errno == EAGAIN) return Piece{0, true};
        if (errno != EINTR) return cannot_read(path_, errno);
    }
}

Result<std::string> InputFile::read_at(std::uint64_t offset, std::uint64_t count) {
    std::string bytes(static_cast<std::size_t>(std::min(count, size_ - std::min(offset, size_))),
                      '\0');
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t got = ::pread(descriptor_,
                                    bytes.data() + done,
                                    bytes.size() - done,
                                    static_cast<off_t>(offset + done));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return cannot_read(path_, errno);
        if (got == 0) {
            return input_error(fmt::format(
                "{}: cannot read {} bytes from byte {} on: the file became shorter while open; "
                "read it again when no program changes it",
                path_,
                bytes.size(),
                offset));
        }
        done += static_cast<std::size_t>(got);
    }
    return bytes;
}

Result<std::string> read_file(const std::string& path, std::uint64_t max_bytes) {
    Result<InputFile> file = InputFile::open(path, max_bytes);
    if (!file) return file.error();
    std::string content;
    constexpr std::size_t kBlock = 1 << 18;
    std::size_t size = 0;
    // Files of the kernel have no size, and other files may grow: read until the end of the file.
    while (true) {
        const std::uint64_t announced = file->size() > size ? file->size() - size : 0;
        content.resize(size + std::max<std::size_t>(announced + 1, size == 0 ? 1 : kBlock));
        const Result<InputFile::Piece> piece =
            file->read(std::span(content).subspan(size, content.size() - size));
        if (!piece) return piece.error();
        size += piece->bytes;
        if (size > max_bytes) return too_large(path, size, max_bytes);
        if (piece->would_wait)
            return input_error(
                path +
                ": cannot read: the file has no data now and may get more; give a regular file");
        if (piece->bytes == 0) break;
    }
    content.resize(size);
    return content;
}

}  // namespace surefoot::files

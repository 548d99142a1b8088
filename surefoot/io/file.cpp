// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "surefoot/io/text.hpp"
#include "surefoot/io/write_at.hpp"

namespace surefoot::io {
namespace {

namespace fs = std::filesystem;

/// Writes all bytes. Returns 0, or errno after a failure.
int write_all(int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written < 0) {
            if (errno == EINTR) continue;
            return errno;
        }
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return 0;
}

/// Opens, writes and closes a file. Returns 0, or errno after a failure. Checks the result of
/// close, because some file systems report a full disk only in close.
int write_and_close(const std::string& path, int flags, std::string_view bytes) {
    // Opening a FIFO without a reader must fail, not block.
    const int descriptor =
        ::open(path.c_str(), flags | O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, 0666);
    if (descriptor < 0) return errno;
    ::fcntl(descriptor, F_SETFL, ::fcntl(descriptor, F_GETFL) & ~O_NONBLOCK);
    const int write_error = write_all(descriptor, bytes);
    const int close_error = ::close(descriptor) == 0 ? 0 : errno;
    return write_error != 0 ? write_error : close_error;
}

std::string temporary_name(const std::string& path) {
    static std::atomic<unsigned> counter{0};  // names are unique among the threads
    const fs::path target(path);
    const std::string name =
        fmt::format(".{}.{}.{}.tmp", target.filename().string(), ::getpid(), counter.fetch_add(1));
    return (target.parent_path() / name).string();
}

}  // namespace

Status write_file(const std::string& path, std::span<const std::uint8_t> bytes) {
    return write_file(path,
                      std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

Status write_file(const std::string& path, std::string_view bytes) {
    std::error_code ignored;
    const fs::file_status status = fs::status(path, ignored);
    if (fs::is_directory(status)) return cannot_write(path, EISDIR);
    if (fs::exists(status) && !fs::is_regular_file(status)) {
        const int error = write_and_close(path, 0, bytes);
        return error == 0 ? Status() : Status(cannot_write(path, error));
    }
    const std::string temporary = temporary_name(path);
    int error = write_and_close(temporary, O_CREAT | O_EXCL, bytes);
    if (error == 0 && ::rename(temporary.c_str(), path.c_str()) != 0) error = errno;
    if (error == 0) return {};
    ::unlink(temporary.c_str());
    return cannot_write(path, error);
}

Status remove_file(const std::string& path) {
    std::error_code error;
    std::filesystem::remove(path, error);
    if (error) return output_error(fmt::format("{}: cannot be removed: {}", path, error.message()));
    return {};
}

Status make_folder(const std::string& path) {
    std::error_code error;
    fs::create_directories(path, error);
    if (error) {
        return output_error(fmt::format("{}: cannot make this folder: {}", path, error.message()));
    }
    if (!is_folder(path)) {
        return output_error(fmt::format("{}: is a file; a folder is needed here", path));
    }
    return {};
}

Result<std::vector<std::string>> list_files(const std::string& folder,
                                            const std::vector<std::string>& extensions) {
    std::error_code error;
    std::vector<std::string> names;
    fs::directory_iterator entry(folder, error);
    for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        std::error_code ignored;
        if (name.empty() || name[0] == '.' || !entry->is_regular_file(ignored)) continue;
        const std::string extension = extension_of(name);
        if (std::find(extensions.begin(), extensions.end(), extension) != extensions.end()) {
            names.push_back(name);
        }
    }
    if (error)
        return input_error(
            fmt::format("{}: cannot list the files of this folder: {}", folder, error.message()));
    std::sort(names.begin(), names.end(), natural_less);
    return names;
}

std::optional<std::uint64_t> free_bytes(const std::string& folder) noexcept {
    std::error_code error;
    const fs::space_info space = fs::space(folder, error);
    if (error || space.available == static_cast<std::uintmax_t>(-1)) return std::nullopt;
    return space.available;
}

bool is_folder(const std::string& path) noexcept {
    std::error_code ignored;
    return fs::is_directory(path, ignored);
}

bool is_file(const std::string& path) noexcept {
    std::error_code ignored;
    return fs::exists(path, ignored) && !fs::is_directory(path, ignored);
}

std::string join_path(const std::string& folder, const std::string& name) {
    return (fs::path(folder) / name).string();
}

std::string folder_of(const std::string& path) {
    const std::string folder = fs::path(path).parent_path().string();
    return folder.empty() ? "." : folder;
}

std::string extension_of(const std::string& path) {
    return lowercase(fs::path(path).extension().string());
}

Result<AppendFile> AppendFile::create(const std::string& path) {
    return open(path, O_TRUNC);
}

Result<AppendFile> AppendFile::resume(const std::string& path) {
    return open(path, 0);
}

Result<AppendFile> AppendFile::open(const std::string& path, int flags) {
    const int descriptor =
        ::open(path.c_str(),
               flags | O_CREAT | O_WRONLY | O_APPEND | O_NONBLOCK | O_NOCTTY | O_CLOEXEC,
               0666);
    if (descriptor < 0) return cannot_write(path, errno);
    AppendFile file(path, descriptor);
    file.size_ =
        std::max<std::int64_t>(0, ::lseek(descriptor, 0, SEEK_END));  // a device has no size
    return file;
}

AppendFile::~AppendFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

AppendFile::AppendFile(AppendFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      size_(other.size_) {}

AppendFile& AppendFile::operator=(AppendFile&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(descriptor_, other.descriptor_);
    std::swap(size_, other.size_);
    return *this;
}

Status AppendFile::append(std::string_view text) {
    if (descriptor_ < 0) return output_error(fmt::format("{}: this file is closed already", path_));
    const int error = write_all(descriptor_, text);
    if (error != 0) {
        // Truncation fails on devices. Ignore this failure: the write error below matters more.
        [[maybe_unused]] const int cut = ::ftruncate(descriptor_, static_cast<off_t>(size_));
        return cannot_write(path_, error);
    }
    size_ += static_cast<std::int64_t>(text.size());
    return {};
}

Status AppendFile::close() {
    if (descriptor_ < 0) return {};
    const int error = ::close(std::exchange(descriptor_, -1)) == 0 ? 0 : errno;
    return error == 0 ? Status() : Status(cannot_write(path_, error));
}

}  // namespace surefoot::io

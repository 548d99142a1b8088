// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/files/input_file.hpp"

/// Whole files in and out, with the system's reason in every error.
namespace surefoot::io {

/// Reading is in `files`: regular files alone, and no more bytes than the format may have.
namespace limits = files::limits;
using files::read_file;

/// Replaces a file in one step: writes a temporary file in the same folder, then renames it, so
/// that a reader sees the old content or the whole new one. What is no regular file (a device, a
/// pipe) is written to directly. On failure (disk full, no permission) the old file stays as it
/// was.
[[nodiscard]] Status write_file(const std::string& path, std::string_view bytes);
[[nodiscard]] Status write_file(const std::string& path, std::span<const std::uint8_t> bytes);
/// Removes a file; one that is not there is no error.
[[nodiscard]] Status remove_file(const std::string& path);

/// Makes a folder and those above it; fine when it exists.
[[nodiscard]] Status make_folder(const std::string& path);

/// Names (without folder) of the regular files in a folder whose lower-case extension is one of
/// `extensions` (".png"), in natural order. Hidden files are left out.
[[nodiscard]] Result<std::vector<std::string>> list_files(
    const std::string& folder, const std::vector<std::string>& extensions);

/// What the file system of a folder still takes; nothing where it does not tell.
[[nodiscard]] std::optional<std::uint64_t> free_bytes(const std::string& folder) noexcept;
[[nodiscard]] bool is_folder(const std::string& path) noexcept;
[[nodiscard]] bool is_file(const std::string& path) noexcept;
/// "a/b" from "a" and "b"; `b` alone when it is absolute.
[[nodiscard]] std::string join_path(const std::string& folder, const std::string& name);
/// Folder part of a path, "." without one.
[[nodiscard]] std::string folder_of(const std::string& path);
/// Lower-case extension with its dot, or an empty string.
[[nodiscard]] std::string extension_of(const std::string& path);

/// A text file that grows line by line; every line is with the system before `append` returns, and
/// a line that does not fit on the disk is taken back: the file always ends in a whole line.
class AppendFile {
  public:
    /// Starts an empty file; what is there is replaced.
    [[nodiscard]] static Result<AppendFile> create(const std::string& path);
    /// Goes on at the end of what is there; an empty file where nothing is.
    [[nodiscard]] static Result<AppendFile> resume(const std::string& path);
    ~AppendFile();
    AppendFile(AppendFile&& other) noexcept;
    AppendFile& operator=(AppendFile&& other) noexcept;

    [[nodiscard]] Status append(std::string_view text);
    [[nodiscard]] Status close();

  private:
    AppendFile(std::string path, int descriptor)
        : path_(std::move(path)), descriptor_(descriptor) {}
    [[nodiscard]] static Result<AppendFile> open(const std::string& path, int flags);
    std::string path_;
    int descriptor_ = -1;
    std::int64_t size_ = 0;
};

}  // namespace surefoot::io

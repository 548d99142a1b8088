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

/// Reads and writes whole files. Every error names the file and the reason.
namespace surefoot::io {

/// Largest sizes of files that are read, one limit per kind of file.
namespace limits = files::limits;
using files::read_file;

/// Replaces a file in one step: writes a temporary file in the same folder, then renames it. A
/// reader sees either the old or the complete new content. A path that is not a regular file (a
/// device, a pipe) is written directly. After a failure (disk full, no permission) the old file is
/// unchanged.
[[nodiscard]] Status write_file(const std::string& path, std::string_view bytes);
[[nodiscard]] Status write_file(const std::string& path, std::span<const std::uint8_t> bytes);
/// Removes a file; a missing file is not an error.
[[nodiscard]] Status remove_file(const std::string& path);

/// Creates a folder and its parents; an existing folder is not an error.
[[nodiscard]] Status make_folder(const std::string& path);

/// Lists the names (without folder) of the regular files in a folder, in natural order. The
/// extension, in lower case, is one of `extensions` (".png"). Hidden files are left out.
[[nodiscard]] Result<std::vector<std::string>> list_files(
    const std::string& folder, const std::vector<std::string>& extensions);

/// Returns the free bytes of a folder's file system; no value if the system does not report it.
[[nodiscard]] std::optional<std::uint64_t> free_bytes(const std::string& folder) noexcept;
[[nodiscard]] bool is_folder(const std::string& path) noexcept;
[[nodiscard]] bool is_file(const std::string& path) noexcept;
/// Joins "a" and "b" to "a/b"; returns `b` alone if it is absolute.
[[nodiscard]] std::string join_path(const std::string& folder, const std::string& name);
/// Returns the folder part of a path; "." if there is none.
[[nodiscard]] std::string folder_of(const std::string& path);
/// Returns the lower-case extension with its dot; empty if there is none.
[[nodiscard]] std::string extension_of(const std::string& path);

/// A text file that grows line by line. `append` hands the line to the system before it returns. If
/// the disk is full, `append` removes the written part: the file still ends in a whole line.
class AppendFile {
  public:
    /// Creates an empty file; an existing file is replaced.
    [[nodiscard]] static Result<AppendFile> create(const std::string& path);
    /// Continues at the end of an existing file, or creates an empty one.
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

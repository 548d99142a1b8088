// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace surefoot::page {

/// A file of the page, embedded when the program was built (tools/embed_page).
struct PageFile {
    std::string_view path;  ///< for example "/index.html"
    std::string_view gzip;  ///< content of the file, compressed with gzip
};
/// Returns all embedded files. If the page was not built (tools/build_page), the only file says how
/// to build the page.
[[nodiscard]] std::span<const PageFile> page_files() noexcept;
/// Returns the file for a request path ("/" = "/index.html"), or nullptr if there is no such file.
[[nodiscard]] const PageFile* find_page_file(std::string_view path) noexcept;
/// Returns the content type for a file name extension, for example "text/html; charset=utf-8".
[[nodiscard]] std::string_view content_type_of(std::string_view path) noexcept;

}  // namespace surefoot::page

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace surefoot::page {

/// A file of the page, embedded when the program was built (tools/embed_page).
struct PageFile {
    std::string_view path;  ///< "/index.html"
    std::string_view gzip;  ///< content of the file, compressed with gzip
};
/// All embedded files. Without a built page (tools/build_page) there is one file, which says how to
/// build the page.
[[nodiscard]] std::span<const PageFile> page_files() noexcept;
/// The file for the path of a request ("/" means "/index.html"), or nullptr if it does not exist.
[[nodiscard]] const PageFile* find_page_file(std::string_view path) noexcept;
/// The content type by the file name's extension, for example "text/html; charset=utf-8".
[[nodiscard]] std::string_view content_type_of(std::string_view path) noexcept;

}  // namespace surefoot::page

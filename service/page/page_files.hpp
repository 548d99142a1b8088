// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace surefoot::page {

/// A file of the page, embedded when the program was built (tools/embed_page).
struct PageFile {
    std::string_view path;  ///< "/index.html"
    std::string_view gzip;  ///< its bytes, packed
};
/// All of them. Without a built page (tools/build_page) one that says so.
[[nodiscard]] std::span<const PageFile> page_files() noexcept;
/// The file for the path of a request, "/" being "/index.html"; nullptr: there is none.
[[nodiscard]] const PageFile* find_page_file(std::string_view path) noexcept;
/// "text/html; charset=utf-8", by the end of the name.
[[nodiscard]] std::string_view content_type_of(std::string_view path) noexcept;

}  // namespace surefoot::page

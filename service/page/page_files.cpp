// SPDX-License-Identifier: Apache-2.0
#include "service/page/page_files.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace surefoot::page {

const PageFile* find_page_file(std::string_view path) noexcept {
    if (path == "/") path = "/index.html";
    const auto files = page_files();
    const auto found =
        std::find_if(files.begin(), files.end(), [&](const PageFile& f) { return f.path == path; });
    return found == files.end() ? nullptr : &*found;
}

std::string_view content_type_of(std::string_view path) noexcept {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kTypes{{
        {".html", "text/html; charset=utf-8"},
        {".js", "text/javascript; charset=utf-8"},
        {".css", "text/css; charset=utf-8"},
        {".svg", "image/svg+xml"},
        {".png", "image/png"},
        {".json", "application/json"},
    }};
    for (const auto& [end, type] : kTypes) {
        if (path.ends_with(end)) return type;
    }
    return "application/octet-stream";
}

}  // namespace surefoot::page

// SPDX-License-Identifier: Apache-2.0
// Input of a browser from any bytes: messages of the page's socket, and the host names of its
// requests. SUREFOOT_FUZZ_READER names the function under test.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "fuzz/must.hpp"
#include "service/page/page_door.hpp"
#include "service/page/page_messages.hpp"

namespace {

using namespace surefoot;
using namespace surefoot::page;

bool is_within(double value, double least, double most) {
    return value >= least && value <= most;
}

void must_be_wish(const PageWish& wish, std::size_t layers) {
    must(is_within(wish.map_hz, PageWish::kSlowest_hz, PageWish::kMaxMap_hz));
    must(is_within(wish.image_hz, PageWish::kSlowest_hz, PageWish::kMaxImage_hz));
    std::vector<bool> wanted(layers, false);
    for (const std::uint16_t layer : wish.layers) {
        must(layer < layers && !wanted[layer]);
        wanted[layer] = true;
    }
}

void must_be_wish(const PlaybackWish& wish) {
    must(!wish.speed || is_within(*wish.speed, PlaybackWish::kSlowest, PlaybackWish::kFastest));
    must(!wish.frame || *wish.frame >= 0);
}

/// Every accepted request is within the limits of the page.
[[maybe_unused]] void fuzz_page_request(std::string_view bytes) {
    static const std::vector<std::string> layers{"elevation", "slope", "step"};
    const auto request = parse_request(bytes, layers);
    must_explain(request);
    if (!request) return;
    if (const auto* wish = std::get_if<PageWish>(&*request)) must_be_wish(*wish, layers.size());
    if (const auto* wish = std::get_if<PlaybackWish>(&*request)) must_be_wish(*wish);
}

bool is_plain(char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
           std::string_view("-.:[]%").find(c) != std::string_view::npos;
}

/// Two lines: Host and Origin. The first byte says whether the page listens on other interfaces
/// than loopback. Headers of the answer repeat only characters of a host name.
[[maybe_unused]] void fuzz_page_door(std::string_view bytes) {
    if (bytes.empty()) return;
    PageAddress page;
    page.bind_address =
        (static_cast<std::uint8_t>(bytes.front()) & 1U) != 0 ? "0.0.0.0" : "127.0.0.1";
    page.port = 8080;
    page.names = {"robot.local"};
    page.origins = {"https://robot.example:444"};
    bytes.remove_prefix(1);
    const std::string_view host = bytes.substr(0, bytes.find('\n'));
    const std::string_view origin = bytes.substr(std::min(bytes.size(), host.size() + 1));
    if (const auto parsed = parse_host(host)) {
        must(!parsed->host.empty());
        must(std::all_of(parsed->host.begin(), parsed->host.end(), is_plain));
        must(!parsed->port || *parsed->port != 0);
    }
    for (const auto& [name, value] : security_headers(host)) {
        must(!name.empty() && value.find_first_of("\r\n") == std::string::npos);
        if (name == "Content-Security-Policy")
            must(value.ends_with("; base-uri 'none'; form-action 'none'; frame-ancestors 'none'") &&
                 std::count(value.begin(), value.end(), ';') == 7);
    }
    must(!wrong_host_text(page).empty());
    if (!is_own_host(page, host)) return;
    if (!is_own_origin(page, host, origin)) return;
    must(origin == page.origins[0] || origin.find(":8080") != std::string_view::npos);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    SUREFOOT_FUZZ_READER({reinterpret_cast<const char*>(data), size});
    return 0;
}

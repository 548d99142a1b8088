// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace surefoot::page {

/// The names under which the page is served. A request with any other name in its Host header gets
/// no file and no socket. Such a name may belong to another site whose address was changed to this
/// machine (DNS rebinding).
struct PageAddress {
    std::string bind_address = "127.0.0.1";
    std::uint16_t port = 0;
    std::vector<std::string> names;    ///< names of this computer in lower case: "robot.local"
    std::vector<std::string> origins;  ///< origins of a proxy or tunnel: "https://a.example:444"
};

/// The parts of a Host header, for example of "localhost:8080".
struct HostAndPort {
    std::string host;  ///< host in lower case; an IPv6 address has brackets
    std::optional<std::uint16_t> port;
};
/// Reads a Host header. Returns empty if the text is not a valid host.
[[nodiscard]] std::optional<HostAndPort> parse_host(std::string_view text);

/// Returns true if the Host header names this page: one of the page's names with the page's own
/// port, or the host of one of its origins. The port may be missing: browsers omit it only if it is
/// the default port, but simple programs may always omit it. If the page is served beyond loopback,
/// every IP address is accepted, because DNS rebinding needs a name.
[[nodiscard]] bool is_own_host(const PageAddress& page, std::string_view host);
/// Returns true if scripts of `origin` may open a socket: `origin` is an origin of the page, or has
/// the host of `host` (see is_own_host()) and the port of the page. localhost, 127.0.0.1 and [::1]
/// are the same host. Another port on this machine is another page.
[[nodiscard]] bool is_own_origin(const PageAddress& page,
                                 std::string_view host,
                                 std::string_view origin);

/// Returns the headers of every HTTP answer. With them a browser shows the page in no other page,
/// guesses no content type and runs only the page's own scripts. `host`: the request's host, which
/// must satisfy is_own_host(); empty for a refused request.
[[nodiscard]] std::vector<std::pair<std::string_view, std::string>> security_headers(
    std::string_view host);
/// Returns the answer to a request with a wrong Host header. It names the address to open.
[[nodiscard]] std::string wrong_host_text(const PageAddress& page);

}  // namespace surefoot::page

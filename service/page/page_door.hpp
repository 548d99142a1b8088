// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace surefoot::page {

/// Under which names the page is reached. A name that is not here may be that of a stranger's page
/// whose address was moved to this machine (DNS rebinding): it gets no file and no socket.
struct PageAddress {
    std::string bind_address = "127.0.0.1";
    std::uint16_t port = 0;
    std::vector<std::string> names;    ///< of this computer, as "robot.local"; lower case
    std::vector<std::string> origins;  ///< of a proxy or a tunnel, as "https://robot.example:444"
};

/// "localhost:8080" in its parts.
struct HostAndPort {
    std::string host;  ///< in lower case; an IPv6 address in brackets
    std::optional<std::uint16_t> port;
};
/// Nothing where it is no host.
[[nodiscard]] std::optional<HostAndPort> parse_host(std::string_view text);

/// Whether the header Host names the page: a name of the page with the page's own port, or the host
/// of one of its origins. A browser always sends the port unless it is the usual one; a simple
/// program may leave it out. An IP address cannot be rebound: beyond loopback each one is right.
[[nodiscard]] bool is_own_host(const PageAddress& page, std::string_view host);
/// Whether a web page of this origin is the page itself: the same host and port as in `host`, which
/// is_own_host(). localhost, 127.0.0.1 and [::1] count as the same host. Every other port of this
/// machine is another page.
[[nodiscard]] bool is_own_origin(const PageAddress& page,
                                 std::string_view host,
                                 std::string_view origin);

/// What every answer carries, so that no other page can frame it, guess its type or add a script.
/// `host`: of the request, is_own_host(); empty for a request that is refused.
[[nodiscard]] std::vector<std::pair<std::string_view, std::string>> security_headers(
    std::string_view host);
/// What the browser is told when Host is wrong: where to go instead.
[[nodiscard]] std::string wrong_host_text(const PageAddress& page);

}  // namespace surefoot::page

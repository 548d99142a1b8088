// SPDX-License-Identifier: Apache-2.0
#include "service/page/page_door.hpp"

#include <algorithm>
#include <array>
#include <boost/asio/ip/address.hpp>
#include <charconv>

#include "service/gate_process/sockets/server_config.hpp"

namespace surefoot::page {
namespace {

constexpr std::uint16_t kHttp = 80;
constexpr std::uint16_t kHttps = 443;

char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool is_name_character(char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '.';
}

std::optional<std::uint16_t> parse_port(std::string_view digits) {
    std::uint16_t port = 0;
    const char* const end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, port);
    if (error != std::errc{} || stop != end || port == 0) return std::nullopt;
    return port;
}

/// Removes the brackets of an IPv6 address. Returns any other host unchanged.
std::string bare(const std::string& host) {
    return host.starts_with('[') ? host.substr(1, host.size() - 2) : host;
}

/// Returns true for an IP address without a zone. The characters are checked first, because Boost
/// accepts any text after '%' (the zone) or after a NUL.
bool is_ip_address(const std::string& host) {
    if (host.find_first_not_of("0123456789abcdef:.[]") != std::string::npos) return false;
    boost::system::error_code error;
    boost::asio::ip::make_address(bare(host), error);
    return !error;
}

bool is_loopback_host(const std::string& host) {
    return host == "localhost" || gate_process::is_loopback_address(bare(host));
}

/// Splits an origin into its parts. A missing port becomes the default port of the scheme.
std::optional<HostAndPort> parse_origin(std::string_view origin) {
    for (const auto& [scheme, port] :
         {std::pair<std::string_view, std::uint16_t>{"http://", kHttp}, {"https://", kHttps}}) {
        if (!origin.starts_with(scheme)) continue;
        auto parsed = parse_host(origin.substr(scheme.size()));
        if (parsed && !parsed->port) parsed->port = port;
        return parsed;
    }
    return std::nullopt;
}

bool is_host_of(std::string_view origin, const HostAndPort& host) {
    const auto parsed = parse_origin(origin);
    const auto implied = origin.starts_with("https:") ? kHttps : kHttp;
    return parsed && parsed->host == host.host && parsed->port == host.port.value_or(implied);
}

bool is_own_name(const PageAddress& page, const std::string& host) {
    if (is_loopback_host(host)) return true;
    if (gate_process::is_loopback_address(page.bind_address)) return false;
    return is_ip_address(host) ||
           std::find(page.names.begin(), page.names.end(), host) != page.names.end();
}

}  // namespace

std::optional<HostAndPort> parse_host(std::string_view text) {
    HostAndPort parsed;
    std::size_t end = 0;
    if (text.starts_with('[')) {
        end = text.find(']');
        if (end == std::string_view::npos) return std::nullopt;
        ++end;
    } else {
        end = std::min(text.find(':'), text.size());
    }
    parsed.host = text.substr(0, end);
    std::transform(parsed.host.begin(), parsed.host.end(), parsed.host.begin(), lower);
    const bool valid =
        parsed.host.starts_with('[')
            ? is_ip_address(parsed.host)
            : !parsed.host.empty() &&
                  std::all_of(parsed.host.begin(), parsed.host.end(), is_name_character);
    if (!valid) return std::nullopt;
    if (end == text.size()) return parsed;
    if (text[end] != ':') return std::nullopt;
    parsed.port = parse_port(text.substr(end + 1));
    if (!parsed.port) return std::nullopt;
    return parsed;
}

bool is_own_host(const PageAddress& page, std::string_view host) {
    const auto parsed = parse_host(host);
    if (!parsed) return false;
    if (is_own_name(page, parsed->host) && parsed->port.value_or(page.port) == page.port)
        return true;
    return std::any_of(page.origins.begin(), page.origins.end(), [&](const std::string& origin) {
        return is_host_of(origin, *parsed);
    });
}

bool is_own_origin(const PageAddress& page, std::string_view host, std::string_view origin) {
    if (std::find(page.origins.begin(), page.origins.end(), origin) != page.origins.end())
        return true;
    const auto here = parse_host(host);
    const auto there = parse_origin(origin);
    if (!here || !there || there->port != page.port) return false;
    return there->host == here->host ||
           (is_loopback_host(there->host) && is_loopback_host(here->host));
}

std::vector<std::pair<std::string_view, std::string>> security_headers(std::string_view host) {
    // The page opens a socket to its own server and a socket to the gate. The port of the gate may
    // change while the page stays open. CSP has no syntax for IPv6 addresses. So a page at an IPv6
    // address may open sockets to every host.
    std::string sockets;
    if (const auto parsed = parse_host(host)) {
        const std::string gate = parsed->host.starts_with('[') ? "" : "//" + parsed->host + ":*";
        sockets = " 'self' ws:" + gate + " wss:" + gate;
    }
    const std::string policy =
        "default-src 'none'; script-src 'self'; style-src 'self'; "
        "img-src 'self' blob:; connect-src" +
        (sockets.empty() ? " 'none'" : sockets) +
        "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
    return {{"Content-Security-Policy", policy},
            {"X-Frame-Options", "DENY"},
            {"X-Content-Type-Options", "nosniff"},
            {"Referrer-Policy", "no-referrer"},  // the URL may contain a token
            {"Cross-Origin-Resource-Policy", "same-origin"},
            {"Cross-Origin-Opener-Policy", "same-origin"}};
}

std::string wrong_host_text(const PageAddress& page) {
    const bool local = gate_process::is_loopback_address(page.bind_address);
    return std::string("This page is not served under the name and port of this request. Open ") +
           "http://" + (local ? "localhost" : "ADDRESS") + ":" + std::to_string(page.port) + "/" +
           (local ? "" : ", where ADDRESS is the name or the IP address of this computer") +
           ". If you use a tunnel, give both ends the same port number.\n";
}

}  // namespace surefoot::page

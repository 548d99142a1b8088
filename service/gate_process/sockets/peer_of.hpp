// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <string>

namespace surefoot::gate_process {

/// Returns the address of the client's computer. Empty if the client runs on this computer: its
/// address is loopback or equals the address that it connected to.
[[nodiscard]] inline std::string peer_of(const boost::asio::ip::tcp::socket& socket) {
    boost::system::error_code error;
    const auto there = socket.remote_endpoint(error).address();
    const auto here = socket.local_endpoint(error).address();
    if (error) return "unknown";
    if (there.is_loopback() || there == here) return {};
    return there.to_string();
}

}  // namespace surefoot::gate_process

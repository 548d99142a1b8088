// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <functional>
#include <memory>
#include <string>

#include "service/gate_process/sockets/slots.hpp"
#include "service/gate_process/sockets/tls_door.hpp"

namespace surefoot::gate_process {

/// A TLS door that hands its connections to the thread of `io`. `io` must outlive the door.
[[nodiscard]] inline Result<std::unique_ptr<TlsDoor>> open_tls_door(
    const std::string& bind_address,
    std::uint16_t port,
    const TlsFiles& files,
    const SlotLimits& slots,
    boost::asio::io_context& io,
    std::function<void(boost::asio::ip::tcp::socket socket, const std::string& peer)> admit) {
    TlsDoorConfig door;
    door.bind_address = bind_address;
    door.port = port;
    door.files = files;
    door.max_connections = slots.max_clients + slots.max_handshakes;
    return TlsDoor::open(
        door, [&io, admit = std::move(admit)](int handle, const std::string& peer) {
            boost::asio::post(io, [&io, admit, socket = OwnedHandle(handle), peer]() mutable {
                boost::asio::ip::tcp::socket arrived(io);
                boost::system::error_code error;
                arrived.assign(boost::asio::ip::tcp::v4(), socket.release(), error);
                if (!error) admit(std::move(arrived), peer);
            });
        });
}

}  // namespace surefoot::gate_process

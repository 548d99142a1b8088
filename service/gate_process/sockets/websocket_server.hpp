// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "service/gate_process/sockets/server_config.hpp"
#include "service/gate_process/step_gate.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::gate_process {

struct ServerCounts {
    std::size_t clients = 0;     ///< clients that use rosbridge now
    std::size_t handshakes = 0;  ///< connections without a complete request
    std::uint64_t accepted = 0;  ///< accepted connections since the start
    std::uint64_t refused = 0;   ///< connections refused by token, origin, request or limit
    std::uint64_t dropped = 0;   ///< clients that were disconnected: slow, too many messages,
                                 ///< invalid messages, or closed for another client
};

class SocketServer;

/// Serves the step gate on a socket: rosbridge over WebSocket, and GET /health. The caller's thread
/// asks the gate and serves all clients; TLS has its own thread. A client that misbehaves, sleeps
/// or floods takes little time from other clients. Riders and operators with a token are served at
/// once and keep their slots. All other clients share a bounded part of the time.
class WebsocketServer {
  public:
    /// Called every `tick_ms`, before topics are published.
    using Tick = std::function<void(std::int64_t now_ns)>;

    /// Listens, but does not serve yet. Uses TLS if its files are given. Returns an error if the
    /// configuration is invalid or the address is in use. The gate must outlive the server.
    [[nodiscard]] static Result<std::unique_ptr<WebsocketServer>> open(const ServerConfig& config,
                                                                       StepGate& gate,
                                                                       Tick tick = {});
    WebsocketServer(const WebsocketServer&) = delete;
    WebsocketServer& operator=(const WebsocketServer&) = delete;
    ~WebsocketServer();

    /// Returns the port on which the server listens.
    [[nodiscard]] std::uint16_t port() const noexcept;
    /// Serves until stop(). Call it once.
    void run();
    /// Serves all clients that are ready now. For an owner with its own loop.
    void poll();
    /// Ends run() and all connections. Thread-safe, but do not call it from a signal handler.
    void stop();
    /// Returns the counts. Call it on the thread of run() (in the tick), or after run() has ended.
    [[nodiscard]] ServerCounts counts() const;

  private:
    explicit WebsocketServer(std::unique_ptr<SocketServer> server);
    std::unique_ptr<SocketServer> server_;
};

}  // namespace surefoot::gate_process

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
    std::size_t clients = 0;     ///< that speak rosbridge now
    std::size_t handshakes = 0;  ///< that are still at the door
    std::uint64_t accepted = 0;  ///< connections since the start
    std::uint64_t refused = 0;   ///< of these turned away: token, origin, request, crowd
    std::uint64_t dropped = 0;   ///< clients that were sent away: too slow, too much, nonsense,
                                 ///< or of less use than another one
};

class SocketServer;

/// The step gate on a socket: rosbridge over WebSocket, and GET /health. One thread, the caller's,
/// asks the gate and serves all clients; TLS has a thread of its own. A client that misbehaves,
/// sleeps or floods takes little from the others: clients with the token of a rider or of the
/// operator are served at once and keep their slots, all others share a bounded part of the time.
class WebsocketServer {
  public:
    /// Called every `tick_ms` before topics are published.
    using Tick = std::function<void(std::int64_t now_ns)>;

    /// Listens, with TLS where its files are given, and serves nobody yet. Fails where the
    /// configuration is not valid or the address is taken. The gate outlives the server.
    [[nodiscard]] static Result<std::unique_ptr<WebsocketServer>> open(const ServerConfig& config,
                                                                       StepGate& gate,
                                                                       Tick tick = {});
    WebsocketServer(const WebsocketServer&) = delete;
    WebsocketServer& operator=(const WebsocketServer&) = delete;
    ~WebsocketServer();

    /// The one that it listens at.
    [[nodiscard]] std::uint16_t port() const noexcept;
    /// Serves until stop(). Once.
    void run();
    /// Serves what is ready now, for an owner with a loop of its own.
    void poll();
    /// Ends run() and all connections. From any thread; not from a signal handler.
    void stop();
    /// In `run`'s thread (from the tick), or when it has ended.
    [[nodiscard]] ServerCounts counts() const;

  private:
    explicit WebsocketServer(std::unique_ptr<SocketServer> server);
    std::unique_ptr<SocketServer> server_;
};

}  // namespace surefoot::gate_process

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "surefoot/core/result.hpp"

namespace surefoot::gate_process {

/// Certificate chain and private key as PEM files.
struct TlsFiles {
    std::string certificate_file;
    std::string key_file;
    [[nodiscard]] bool empty() const noexcept {
        return certificate_file.empty() && key_file.empty();
    }
};

struct TlsDoorConfig {
    std::string bind_address;
    std::uint16_t port = 0;  ///< 0 = any free port
    TlsFiles files;
    std::size_t max_connections = 320;  ///< limit, including connections with unfinished handshakes
    std::size_t max_handshakes = 64;    ///< above it, the peer with the most loses its oldest
    int handshake_ms = 5000;
};

/// Owns a socket and closes it unless it was released.
class OwnedHandle {
  public:
    explicit OwnedHandle(int handle) noexcept : handle_(handle) {}
    OwnedHandle(OwnedHandle&& other) noexcept : handle_(std::exchange(other.handle_, -1)) {}
    OwnedHandle& operator=(OwnedHandle&&) = delete;
    ~OwnedHandle() {
        if (handle_ >= 0) ::close(handle_);
    }
    [[nodiscard]] int release() noexcept { return std::exchange(handle_, -1); }

  private:
    int handle_;
};

class TlsListener;

/// TLS in front of a service that reads and writes plain bytes. The door listens, makes
/// the TLS handshake (TLS 1.2 or newer), and gives the service a local socket with the
/// plain bytes of each connection. It has its own thread, so encryption and handshake
/// floods take no time from the answering thread. Clients of this machine may send plain
/// bytes, because no network carries them. Other clients that send plain bytes get a
/// message to use TLS.
///
/// Only tls_door.cpp includes OpenSSL.
class TlsDoor {
  public:
    /// Called on the door's thread. `socket`: the service owns and closes it. `peer`: address of
    /// the other computer, empty for this machine.
    using OnArrival = std::function<void(int socket, const std::string& peer)>;

    /// Listens, but does not serve yet. Returns an error with the cause if a file is unusable, if
    /// others may read the key, or if the address is in use.
    [[nodiscard]] static Result<std::unique_ptr<TlsDoor>> open(const TlsDoorConfig& config,
                                                               OnArrival on_arrival);
    TlsDoor(const TlsDoor&) = delete;
    TlsDoor& operator=(const TlsDoor&) = delete;
    /// Calls stop().
    ~TlsDoor();

    [[nodiscard]] std::uint16_t port() const noexcept;
    /// Starts the thread. Call it once.
    void start();
    /// Ends all connections and the thread. Call it from any thread except the door's.
    void stop();

  private:
    explicit TlsDoor(std::unique_ptr<TlsListener> listener);
    std::unique_ptr<TlsListener> listener_;
};

}  // namespace surefoot::gate_process

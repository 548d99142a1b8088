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

/// Certificate chain and private key, both PEM.
struct TlsFiles {
    std::string certificate_file;
    std::string key_file;
    [[nodiscard]] bool empty() const noexcept {
        return certificate_file.empty() && key_file.empty();
    }
};

struct TlsDoorConfig {
    std::string bind_address;
    std::uint16_t port = 0;  ///< 0 = any free one
    TlsFiles files;
    std::size_t max_connections = 320;  ///< with those whose handshake is not done
    std::size_t max_handshakes = 64;    ///< beyond it the fullest peer's oldest one is ended
    int handshake_ms = 5000;
};

/// Closes a socket that nobody took over.
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

/// TLS in front of a service that reads and writes plain bytes. The door listens, makes the TLS
/// handshake (TLS 1.2 or newer), and hands the service a local socket with the plain bytes of each
/// connection. All of that runs on a thread of the door's own: encryption and a flood of handshakes
/// take no time from the thread that answers. A client of this same machine may speak plain bytes
/// to the door: they leave no wire to listen on. A client of another machine that does is told to
/// use TLS.
///
/// OpenSSL is included in tls_door.cpp and nowhere else.
class TlsDoor {
  public:
    /// `socket`: of the service from now on, which closes it. `peer`: address of the other
    /// computer, empty for this machine. Called on the door's thread.
    using OnArrival = std::function<void(int socket, const std::string& peer)>;

    /// Listens, and serves nobody yet. Fails, and says why, where a file cannot be used, others may
    /// read the key, or the address is taken.
    [[nodiscard]] static Result<std::unique_ptr<TlsDoor>> open(const TlsDoorConfig& config,
                                                               OnArrival on_arrival);
    TlsDoor(const TlsDoor&) = delete;
    TlsDoor& operator=(const TlsDoor&) = delete;
    /// Stops.
    ~TlsDoor();

    [[nodiscard]] std::uint16_t port() const noexcept;
    /// Starts the thread. Once.
    void start();
    /// Ends all connections and the thread. From any thread but the door's own.
    void stop();

  private:
    explicit TlsDoor(std::unique_ptr<TlsListener> listener);
    std::unique_ptr<TlsListener> listener_;
};

}  // namespace surefoot::gate_process

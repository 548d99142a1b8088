// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "service/gate_process/sockets/slots.hpp"
#include "service/gate_process/sockets/tls_door.hpp"
#include "service/page/page_feed.hpp"
#include "service/page/page_map.hpp"
#include "service/page/page_messages.hpp"
#include "service/page/page_settings.hpp"
#include "service/page/playback.hpp"
#include "service/page/recording_desk.hpp"
#include "service/page/steering.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::page {

struct PageServerConfig {
    /// Address to listen at. Beyond loopback the page needs a token, and TLS or `insecure`.
    std::string bind_address = "127.0.0.1";
    std::uint16_t port = 8080;   ///< TCP port; 0 = any free port
    int more_ports = 16;         ///< number of following ports to try if `port` is in use
    std::string token;           ///< the WebSocket's URL needs ?token=...; empty = no token
    gate_process::TlsFiles tls;  ///< empty = plain HTTP; beyond loopback only with `insecure`
    std::string insecure;  ///< gate_process::kInsecureSentence allows plain HTTP beyond loopback
    /// Addresses of the page through a proxy or a tunnel, e.g. "https://robot.example".
    std::vector<std::string> origins;
    /// Origins of Foxglove if Foxglove is a web page of another machine or a local file (file://).
    std::vector<std::string> foxglove_origins;
    /// Limits of connections. Only WebSockets count as clients. A request for a file is never a
    /// client.
    gate_process::SlotLimits slots{16, 0, 256, 8};
    int header_ms = 5000;   ///< longest time from connection to last byte of request
    int answer_ms = 20000;  ///< longest time for sending a file
    int write_ms = 10000;   ///< longest time for sending one message to a viewer

    /// Returns the first problem in words, or nullptr.
    [[nodiscard]] const char* problem() const;
};

/// Controls of pages. Pages control the source and the service, never the gate. Thread-safe.
struct PageControls {
    Steering steering;  ///< used only if PageHello::can_steer
    Playback playback;
    PageSettings settings;
    RecordingDesk recording;
};

class PageSockets;

/// Serves three protocols on one port: the embedded page over HTTP; the messages of the page
/// (messages.json) over a WebSocket at /page; and the Foxglove WebSocket protocol at every other
/// path, for clients that offer a Foxglove subprotocol.
///
/// All work happens on the thread that calls `run`. The next message for a viewer is made after the
/// previous message was sent: a slow viewer gets fewer messages, but never an old message. A page
/// that sends an invalid message gets the reason and is disconnected. With a certificate the server
/// uses TLS (gate_process::TlsDoor), but clients on this machine may still connect without TLS.
///
/// The Host header of a request must name this page (is_own_host() in page_door.hpp). A web
/// page that opens a socket must be the page itself (page_door.hpp) or a configured origin. The
/// server ends connections that send their request too slowly or do not receive. When all slots are
/// taken, gate_process::Slots chooses the connection to end.
class PageServer {
  public:
    /// Opens the port and listens. The error names the address and the reason. `feed` and
    /// `controls` must outlive the server.
    [[nodiscard]] static Result<std::unique_ptr<PageServer>> open(const PageServerConfig& config,
                                                                  PageFeed& feed,
                                                                  PageControls& controls);
    PageServer(const PageServer&) = delete;
    PageServer& operator=(const PageServer&) = delete;
    ~PageServer();

    /// Sets the first message to pages and the limits that colour the ground (colour_limits()).
    /// Call it before `run`, and after each change of these data, from any thread.
    void introduce(PageHello hello, ColourLimits colours);
    /// Serves until `stop` is called.
    void run();
    /// Ends `run`. Thread-safe.
    void stop();
    /// Returns the port of the server. It differs from the configured port if that port was 0 or in
    /// use.
    [[nodiscard]] std::uint16_t port() const noexcept;

  private:
    explicit PageServer(std::unique_ptr<PageSockets> sockets);
    std::unique_ptr<PageSockets> sockets_;
};

}  // namespace surefoot::page

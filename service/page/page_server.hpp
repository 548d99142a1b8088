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
    std::string bind_address = "127.0.0.1";  ///< another than loopback needs a token
    std::uint16_t port = 8080;               ///< 0 = any free one
    int more_ports = 16;                     ///< tried after it, where others are taken
    std::string token;                       ///< of the WebSocket's URL, as ?token=
    wire::TlsFiles tls;                      ///< empty: plain HTTP, on this machine alone or
    std::string insecure;                    ///< with wire::kInsecureSentence
    /// Where the page is reached through a proxy or a tunnel, as "https://robot.example".
    std::vector<std::string> origins;
    /// Of Foxglove, where it is a web page of another machine, or a file (file://).
    std::vector<std::string> foxglove_origins;
    /// Clients are those who look. Requests for files are answered at the door.
    wire::SlotLimits slots{16, 0, 256, 8};
    int header_ms = 5000;   ///< from the connection to the last byte of its request
    int answer_ms = 20000;  ///< for a file to leave
    int write_ms = 10000;   ///< for a message to a viewer to leave

    /// The first problem in words, or nullptr.
    [[nodiscard]] const char* problem() const;
};

/// What pages may do to the source and to the service; never to the gate.
struct PageControls {
    Steering steering;  ///< followed where the hello says can_steer
    Playback playback;
    PageSettings settings;
    RecordingDesk recording;
};

class PageSockets;

/// Serves the embedded page over HTTP, its messages (messages.json) over a WebSocket at /page, and
/// at every other path the WebSocket protocol of Foxglove to whoever offers its subprotocol; all on
/// the thread that calls `run`. A viewer that is slow is sent less often, never what is old: the
/// next message is made when the last one has left. Who sends what is not understood is told so and
/// let go. With a certificate all of it goes through TLS (wire::TlsDoor); clients of this same
/// machine may still speak plainly. A request must name the page by a name or address of this
/// computer and its own port, and a web page that opens a socket must be the page itself
/// (page_door.hpp). A connection that is slow with its request, or takes nothing, is ended;
/// wire::Slots says which one when all are taken.
class PageServer {
  public:
    /// Listens. Errors name the address and what is in the way.
    [[nodiscard]] static Result<std::unique_ptr<PageServer>> open(const PageServerConfig& config,
                                                                  PageFeed& feed,
                                                                  PageControls& controls);
    PageServer(const PageServer&) = delete;
    PageServer& operator=(const PageServer&) = delete;
    ~PageServer();

    /// Before `run`, and from any thread whenever something in it changed. `colours`: what of the
    /// machine the ground is coloured by.
    void introduce(PageHello hello, ColourLimits colours);
    /// Until `stop`.
    void run();
    /// From any thread.
    void stop();
    [[nodiscard]] std::uint16_t port() const noexcept;

  private:
    explicit PageServer(std::unique_ptr<PageSockets> sockets);
    std::unique_ptr<PageSockets> sockets_;
};

}  // namespace surefoot::page

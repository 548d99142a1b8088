// SPDX-License-Identifier: Apache-2.0
#include "service/page/page_server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/host_name.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <cctype>
#include <chrono>
#include <deque>
#include <iterator>
#include <optional>
#include <utility>
#include <variant>

#include "service/gate_process/sockets/admission.hpp"
#include "service/gate_process/sockets/peer_of.hpp"
#include "service/gate_process/sockets/server_config.hpp"
#include "service/gate_process/sockets/tls_arrivals.hpp"
#include "service/gate_process/sockets/token_bucket.hpp"
#include "service/gate_process/steady_clock.hpp"
#include "service/page/feature_lists.hpp"
#include "service/page/foxglove_client.hpp"
#include "service/page/gate_listener.hpp"
#include "service/page/page_door.hpp"
#include "service/page/page_files.hpp"
#include "service/page/show.hpp"

namespace surefoot::page {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;
namespace websocket = beast::websocket;
using tcp = net::ip::tcp;
using beast::error_code;
using gate_process::steady_ns;

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kMs_ns = 1'000'000;
constexpr auto kTick = std::chrono::milliseconds(20);
constexpr auto kHandshake = std::chrono::seconds(5);  ///< limit of a WebSocket handshake
constexpr auto kIdle = std::chrono::seconds(10);
constexpr std::size_t kMaxMessageBytes = 4096;
constexpr std::int64_t kStatusEvery_ns = 500'000'000;
constexpr std::int64_t kCountEvery_ns = 500'000'000;  ///< period of the counters of a recording
constexpr std::int64_t kMostLayerBytesPerSecond =
    1'200'000;  ///< largest data rate of layers; a page gets 2 MB/s in total
// Rate limits of one viewer. A viewer that exceeds a limit is disconnected. All messages together
// have the limit kMessages. Requests for data, settings and recordings also have the lower limit
// kWishes, because the server answers a request for data with the whole map.
constexpr gate_process::RateLimit kWishes{5, 20};
constexpr gate_process::RateLimit kMessages{40, 80};

std::string_view view(beast::string_view text) {
    return {text.data(), text.size()};
}

/// Returns the names of this computer in its network: the host name, without and with ".local".
std::vector<std::string> own_names() {
    error_code error;
    std::string name = net::ip::host_name(error);
    if (error || name.empty()) return {};
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
        return static_cast<char>(std::tolower(c));
    });
    return {name, name + ".local"};
}

/// Returns true if data arrived that is not a valid HTTP request. A closed connection alone does
/// not count.
bool is_malformed(error_code error) {
    return error.category() == make_error_code(http::error::bad_method).category() &&
           error != http::error::end_of_stream && error != http::error::partial_message;
}

std::int64_t period_ns(double rate_hz) {
    // in range: read_rate() and the feed keep rates from PageWish::kSlowest_hz on
    return static_cast<std::int64_t>(static_cast<double>(kSecond_ns) / rate_hz);
}

}  // namespace

/// Data of perception and of the gate that at least one viewer wants.
struct Demand {
    bool images = false;
    bool layers = false;
    bool stairs = false;
    GateTopics gate;

    Demand& operator|=(const Demand& other) {
        images |= other.images;
        layers |= other.layers;
        stairs |= other.stairs;
        gate.verdict |= other.gate.verdict;
        gate.outlook |= other.gate.outlook;
        return *this;
    }
};

class Viewer;

/// The listening port and all connections. Runs on one thread.
class PageSockets {
  public:
    PageSockets(PageServerConfig its_config, PageFeed& feed, PageControls& its_controls)
        : config(std::move(its_config)),
          controls(its_controls),
          rates(feed.rates),
          slots(config.slots),
          feed_(feed) {}

    Status listen();
    void run();
    void stop();
    void introduce(PageHello hello, ColourLimits colours);
    void leave(const Viewer& viewer);
    [[nodiscard]] std::size_t viewers() const;
    [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
    /// Sends the status to all viewers at the next tick.
    void tell_status() noexcept { ++status_serial_; }
    [[nodiscard]] std::uint64_t status_serial() const noexcept { return status_serial_; }
    /// Makes the connection a viewer. May end another connection to get a slot. Returns false if no
    /// slot is free.
    [[nodiscard]] bool enter(std::uint64_t name);
    [[nodiscard]] PageAddress address() const;

    const PageServerConfig config;
    PageControls& controls;
    const PageRates& rates;
    gate_process::Slots slots;
    Show show;
    FoxgloveShow foxglove{show};
    /// Identifier of this run of the service.
    const std::string session = fmt::format("{:x}", steady_ns());

  private:
    error_code listen_at(const net::ip::address& address, std::uint16_t port);
    Status listen_with_tls();
    void accept();
    void admit(tcp::socket socket, const std::string& peer);
    void end(std::optional<gate_process::Slots::Id> name);
    void wait_for_tick();
    void on_tick();

    PageFeed& feed_;
    net::io_context io_{1};  // destroyed after the members below, with all pending handlers
    tcp::acceptor acceptor_{io_};
    std::unique_ptr<gate_process::TlsDoor> tls_door_;
    net::steady_timer timer_{io_};
    GateListener gate_{io_, [this](GateNews news) { foxglove.hear(std::move(news)); }};
    // The pending handlers of a connection share it.
    std::vector<std::shared_ptr<Viewer>> connections_;
    std::vector<std::string> names_ = own_names();
    std::uint64_t connections_so_far_ = 0;
    std::uint64_t status_serial_ = 0;
    std::uint16_t port_ = 0;
    bool accepting_ = false;
};

/// One connection. It is a request for a file, the WebSocket of a page, or a Foxglove client.
class Viewer : public std::enable_shared_from_this<Viewer> {
  public:
    /// `name`: unique number of the connection, never 0.
    Viewer(PageSockets& sockets, std::uint64_t name, tcp::socket socket)
        : sockets_(sockets),
          name_(name),
          ws_(std::move(socket)),
          messages_(kMessages),
          wishes_(kWishes) {}

    void start();
    void on_tick(std::int64_t now_ns);
    void end();
    [[nodiscard]] bool looks() const { return looks_; }
    [[nodiscard]] Demand demand() const;
    [[nodiscard]] std::uint64_t name() const { return name_; }

  private:
    /// State of the joystick that this viewer received last.
    struct Hold {
        bool yours = false;
        bool taken = false;
        std::uint64_t serial = 0;
        bool operator==(const Hold&) const = default;
    };

    struct Refusal {
        http::status status;
        std::string text;
    };
    void on_request(error_code error);
    [[nodiscard]] std::optional<Refusal> refuse_host();
    [[nodiscard]] std::optional<Refusal> refuse_socket(bool is_foxglove) const;
    void answer(http::status status, std::string_view type, std::string body);
    void answer(const Refusal& refusal) { answer(refusal.status, "text/plain", refusal.text); }
    void send_response();
    void send_file(std::string_view path, bool head);
    void send_model(bool head);
    /// `protocol`: the client's Foxglove subprotocol; empty for a page.
    void upgrade(std::optional<std::string_view> protocol);
    void read();
    void on_message();
    void take(const PageWish& wish);
    void take(const JoystickWord& word);
    void take(const PlaybackWish& wish);
    void take(const SettingWish& wish);
    void take(const RecordWish& wish);
    void say_goodbye(const std::string& sentence);
    [[nodiscard]] Status hear(std::string_view bytes);
    void say(std::string text) { waiting_.push_back({true, std::move(text)}); }
    void push(std::string bytes) { waiting_.push_back({false, std::move(bytes)}); }
    void say_steering(std::int64_t now_ns);
    void say_status(std::int64_t now_ns);
    void say_stairs();
    void say_settings();
    void say_recording(std::int64_t now_ns);
    void push_map(std::int64_t now_ns);
    void push_images(std::int64_t now_ns);
    void write();

    PageSockets& sockets_;
    const std::uint64_t name_;
    websocket::stream<beast::tcp_stream> ws_;
    beast::flat_buffer buffer_;
    std::optional<http::request_parser<http::empty_body>> parser_;
    http::response<http::string_body> response_;
    std::string host_;  ///< Host header of the request, if it names the page
    gate_process::TokenBucket messages_;
    gate_process::TokenBucket wishes_;
    PageWish wish_;
    std::optional<FoxgloveClient> foxglove_;
    std::deque<SocketMessage> waiting_;
    SocketMessage writing_;
    std::optional<std::int64_t> write_since_ns_;  ///< time at which the current write started
    /// True after the viewer sent a message. Then each completed write counts as service in
    /// gate_process::Slots.
    bool has_asked_ = false;
    bool looks_ = false;  ///< true for a WebSocket, false for a request for a file
    bool open_ = false;   ///< the WebSocket's handshake is complete
    bool ended_ = false;

    // These members describe the data that this viewer already has.
    std::optional<PageMap> map_;
    std::uint64_t hello_serial_ = 0;
    std::uint64_t frame_serial_ = 0;
    std::uint64_t map_serial_ = 0;
    std::uint64_t layers_serial_ = 0;
    std::uint64_t images_serial_ = 0;
    std::int64_t map_due_ns_ = 0;
    std::int64_t layers_due_ns_ = 0;
    std::int64_t images_due_ns_ = 0;
    std::int64_t status_due_ns_ = 0;
    std::uint64_t status_serial_ = 0;
    std::uint64_t stairs_serial_ = 0;
    std::uint64_t settings_serial_ = 0;
    std::uint64_t recording_serial_ = 0;
    std::int64_t recording_due_ns_ = 0;
    RecordingStage recording_stage_ = RecordingStage::off;
    std::optional<Hold> hold_;
};

void Viewer::start() {
    error_code ignored;
    beast::get_lowest_layer(ws_).socket().set_option(tcp::no_delay(true), ignored);
    beast::get_lowest_layer(ws_).expires_after(
        std::chrono::milliseconds(sockets_.config.header_ms));
    parser_.emplace();
    constexpr std::uint32_t kMaxHeaderBytes = 16 * 1024;
    parser_->header_limit(kMaxHeaderBytes);
    parser_->body_limit(0);
    http::async_read(
        ws_.next_layer(),
        buffer_,
        *parser_,
        [self = shared_from_this()](error_code error, std::size_t) { self->on_request(error); });
}

void Viewer::on_request(error_code error) {
    if (ended_) return;
    if (is_malformed(error))
        return answer(http::status::bad_request,
                      "text/plain",
                      "this is not an HTTP request; open the page in a browser\n");
    if (error) return end();
    const auto& request = parser_->get();
    const std::string_view target = view(request.target());
    if (const auto refusal = refuse_host()) return answer(*refusal);
    if (!websocket::is_upgrade(request)) {
        const bool head = request.method() == http::verb::head;
        if (!head && request.method() != http::verb::get)
            return answer(http::status::method_not_allowed,
                          "text/plain",
                          "only the HTTP methods GET and HEAD are supported\n");
        if (gate_process::path_of(target) == kModelPath) return send_model(head);
        return send_file(gate_process::path_of(target), head);
    }
    const bool is_page = gate_process::path_of(target) == "/page";
    const auto offered = request.find(http::field::sec_websocket_protocol);
    const auto foxglove = is_page || offered == request.end()
                              ? std::nullopt
                              : foxglove_protocol_of(view(offered->value()));
    if (!is_page && !foxglove)
        return answer(http::status::not_found,
                      "text/plain",
                      "there is no WebSocket at this path: a page must connect to /page, and a "
                      "Foxglove client must offer a subprotocol of Foxglove\n");
    if (const auto refusal = refuse_socket(foxglove.has_value())) return answer(*refusal);
    if (!sockets_.enter(name_))
        return answer(http::status::service_unavailable,
                      "text/plain",
                      "too many pages are open; close another page and reload this page\n");
    upgrade(foxglove);
}

/// Checks that a request for a file or a socket has exactly one Host header, which names the page.
std::optional<Viewer::Refusal> Viewer::refuse_host() {
    const auto& request = parser_->get();
    const auto [first, last] = request.equal_range(http::field::host);
    if (std::distance(first, last) != 1 || !view(request.target()).starts_with('/'))
        return Refusal{http::status::bad_request,
                       "a request needs exactly one Host header and a path that begins with /\n"};
    const PageAddress address = sockets_.address();
    if (!is_own_host(address, view(first->value())))
        return Refusal{http::status::misdirected_request, wrong_host_text(address)};
    host_ = view(first->value());
    return std::nullopt;
}

std::optional<Viewer::Refusal> Viewer::refuse_socket(bool is_foxglove) const {
    const auto& request = parser_->get();
    const auto header = request.find(http::field::origin);
    if (header != request.end()) {  // programs other than browsers send no Origin
        const std::string_view origin = view(header->value());
        const auto& foxglove = sockets_.config.foxglove_origins;
        const bool is_friend =
            is_foxglove && std::find(foxglove.begin(), foxglove.end(), origin) != foxglove.end();
        if (!is_friend && !is_own_origin(sockets_.address(), host_, origin))
            return Refusal{http::status::forbidden,
                           "a web page of another host or port may not connect; open the page that "
                           "this service serves\n"};
    }
    if (gate_process::admit(sockets_.config.token, {}, view(request.target()), std::nullopt) !=
        gate_process::Admission::welcome)
        return Refusal{http::status::unauthorized,
                       "this address needs a token; add ?token=TOKEN to the address\n"};
    return std::nullopt;
}

void Viewer::answer(http::status status, std::string_view type, std::string body) {
    constexpr unsigned kHttp11 = 11;
    response_ = {status, kHttp11};
    response_.set(http::field::content_type, beast::string_view(type.data(), type.size()));
    response_.body() = std::move(body);
    response_.prepare_payload();
    send_response();
}

void Viewer::send_file(std::string_view path, bool head) {
    const PageFile* const file = find_page_file(path);
    if (file == nullptr)
        return answer(http::status::not_found,
                      "text/plain",
                      "there is no file at this path; open the page at /\n");
    constexpr unsigned kHttp11 = 11;
    response_ = {http::status::ok, kHttp11};
    const std::string_view type = content_type_of(file->path);
    response_.set(http::field::content_type, beast::string_view(type.data(), type.size()));
    response_.set(http::field::content_encoding, "gzip");
    if (!head) response_.body() = std::string(file->gzip);
    response_.content_length(file->gzip.size());
    send_response();
}

void Viewer::send_response() {
    for (const auto& [name, value] : security_headers(host_))
        response_.set(beast::string_view(name.data(), name.size()), value);
    // no-cache: a browser must not show the page of an older program.
    response_.set(http::field::cache_control, "no-cache");
    response_.keep_alive(false);
    beast::get_lowest_layer(ws_).expires_after(
        std::chrono::milliseconds(sockets_.config.answer_ms));
    http::async_write(ws_.next_layer(),
                      response_,
                      [self = shared_from_this()](error_code, std::size_t) { self->end(); });
}

/// Sends the model of the machine (URDF) that the current hello message names.
void Viewer::send_model(bool head) {
    const auto& machine = sockets_.show.hello.machine;
    if (!machine || machine->urdf.empty())
        return answer(http::status::not_found,
                      "text/plain",
                      "there is no 3D model of this machine; to show a model, start serve with "
                      "--model FILE\n");
    answer(http::status::ok, "application/xml", head ? std::string() : machine->urdf);
}

void Viewer::upgrade(std::optional<std::string_view> protocol) {
    beast::get_lowest_layer(ws_).expires_never();  // from here on the timeouts of the WebSocket
                                                   // apply
    ws_.set_option(websocket::stream_base::timeout{kHandshake, kIdle, true});
    ws_.read_message_max(kMaxMessageBytes);
    ws_.auto_fragment(false);  // one WebSocket frame per message
    if (protocol) {
        foxglove_.emplace(sockets_.foxglove.name(), sockets_.session);
        ws_.read_message_max(kMaxFoxgloveText_bytes);
    }
    ws_.set_option(websocket::stream_base::decorator(
        [name = std::string(protocol.value_or("")), host = host_](websocket::response_type& r) {
            for (const auto& [key, value] : security_headers(host))
                r.set(beast::string_view(key.data(), key.size()), value);
            if (!name.empty()) r.set(http::field::sec_websocket_protocol, name);
        }));
    looks_ = true;
    ws_.async_accept(parser_->get(), [self = shared_from_this()](error_code error) {
        if (self->ended_) return;
        if (error) return self->end();
        self->parser_.reset();
        self->buffer_.clear();
        self->open_ = true;
        self->on_tick(steady_ns());
        self->read();
    });
}

void Viewer::read() {
    ws_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
        if (self->ended_) return;
        if (error) return self->end();
        self->on_message();
    });
}

void Viewer::on_message() {
    if (!messages_.take(steady_ns()))
        return say_goodbye(
            "too many messages: the limit is 40 a second on average; reload the page");
    const auto bytes = buffer_.cdata();
    const Status heard = hear({static_cast<const char*>(bytes.data()), bytes.size()});
    buffer_.clear();
    if (!heard) return say_goodbye(heard.error().message);
    if (ended_) return;
    has_asked_ = true;
    sockets_.slots.listens(name_, true);
    sockets_.slots.served(name_, steady_ns(), 0);
    read();
}

Status Viewer::hear(std::string_view bytes) {
    if (foxglove_) return foxglove_->take(ws_.got_text(), bytes, steady_ns());
    const auto request = parse_request(bytes, sockets_.show.hello.layers);
    if (!request) return request.error();
    std::visit([this](const auto& what) { take(what); }, *request);
    return {};
}

Demand Viewer::demand() const {
    if (foxglove_)
        return {
            foxglove_->listens_to(FoxgloveChannel::camera), false, false, foxglove_->gate_topics()};
    const bool images =
        std::any_of(wish_.images.begin(), wish_.images.end(), [](bool wanted) { return wanted; });
    return {images, !wish_.layers.empty(), wish_.stairs, {}};
}

void Viewer::take(const PageWish& wish) {
    if (!wishes_.take(steady_ns()))
        return say_goodbye(
            "too many requests: the limit is 5 a second on average; reload the page");
    wish_ = wish;
    // Send all wanted data again.
    map_.reset();
    frame_serial_ = map_serial_ = layers_serial_ = images_serial_ = stairs_serial_ = 0;
    map_due_ns_ = images_due_ns_ = 0;
}

void Viewer::take(const JoystickWord& word) {
    if (!sockets_.show.hello.can_steer)
        return say_goodbye(
            "joystick: pages cannot steer this source; start serve with sim:SCENE and --joystick");
    // The next "steer" message tells a page that another page holds the joystick.
    sockets_.controls.steering.hold(name_, word.command, steady_ns());
}

void Viewer::take(const PlaybackWish& wish) {
    if (!sockets_.controls.playback.state())
        return say_goodbye(
            "playback: this source is not a recording, so a page cannot pause it or change its "
            "speed");
    sockets_.controls.playback.ask(wish);
    sockets_.tell_status();
}

void Viewer::take(const SettingWish& wish) {
    if (!wishes_.take(steady_ns()))
        return say_goodbye(
            "too many requests: the limit is 5 a second on average; reload the page");
    say(setting_text(sockets_.controls.settings.ask(wish)));
    write();
}

void Viewer::take(const RecordWish& wish) {
    if (!wishes_.take(steady_ns()))
        return say_goodbye(
            "too many requests: the limit is 5 a second on average; reload the page");
    if (!sockets_.controls.recording.ask(wish))
        say_goodbye("record: " + sockets_.controls.recording.state().text);
}

void Viewer::say_goodbye(const std::string& sentence) {
    ended_ = true;
    websocket::close_reason reason(websocket::close_code::policy_error);
    constexpr std::size_t kMostBytes = 120;  // a close frame holds at most 123 bytes
    reason.reason = beast::string_view(sentence.data(), std::min(sentence.size(), kMostBytes));
    ws_.async_close(reason, [self = shared_from_this()](error_code) {
        beast::get_lowest_layer(self->ws_).close();
        self->sockets_.leave(*self);
    });
}

void Viewer::push_map(std::int64_t now_ns) {
    const Show& show = sockets_.show;
    if (show.map_serial == map_serial_ || now_ns < map_due_ns_) return;
    map_serial_ = show.map_serial;
    map_due_ns_ = now_ns + period_ns(std::min(wish_.map_hz, sockets_.rates.map_hz.load()));
    push(map_message(show.map, map_ ? &*map_ : nullptr));
    map_ = show.map;
    if (show.layers_serial == layers_serial_ || now_ns < layers_due_ns_) return;
    layers_serial_ = show.layers_serial;
    std::int64_t bytes = 0;
    for (const std::uint16_t index : wish_.layers) {
        auto message = show.layer(index);
        if (!message) continue;
        bytes += std::ssize(*message);
        push(std::move(*message));
    }
    layers_due_ns_ = now_ns + bytes * (kSecond_ns / kMostLayerBytesPerSecond);
}

void Viewer::push_images(std::int64_t now_ns) {
    Show& show = sockets_.show;
    if (show.images_serial == images_serial_ || now_ns < images_due_ns_) return;
    images_serial_ = show.images_serial;
    images_due_ns_ = now_ns + period_ns(std::min(wish_.image_hz, sockets_.rates.image_hz.load()));
    for (std::size_t which = 0; which < kImageCount; ++which) {
        if (wish_.images[which]) push(show.picture(static_cast<PageImage>(which)));
    }
}

void Viewer::say_steering(std::int64_t now_ns) {
    if (!sockets_.show.hello.can_steer) return;
    const Steering& steering = sockets_.controls.steering;
    const std::uint64_t holder = steering.holder(now_ns);
    const SteerOutcome outcome = steering.outcome();
    const Hold hold{holder == name_, holder != 0, outcome.serial};
    if (hold_ == hold) return;
    hold_ = hold;
    say(steer_text(hold.yours, hold.taken, outcome));
}

void Viewer::say_status(std::int64_t now_ns) {
    if (now_ns < status_due_ns_ && status_serial_ == sockets_.status_serial()) return;
    status_due_ns_ = now_ns + kStatusEvery_ns;
    status_serial_ = sockets_.status_serial();
    const auto playback = sockets_.controls.playback.state();
    say(status_text(sockets_.show.status(now_ns, static_cast<int>(sockets_.viewers()), playback),
                    playback));
}

void Viewer::say_stairs() {
    const Show& show = sockets_.show;
    if (!wish_.stairs || stairs_serial_ == show.stairs_serial) return;
    stairs_serial_ = show.stairs_serial;
    say(show.stairs());
}

/// Sends the settings if the page wants them and they changed. They are large and change rarely, so
/// a new request of the page does not send them again.
void Viewer::say_settings() {
    const PageSettings& settings = sockets_.controls.settings;
    const std::uint64_t serial = settings.serial();
    if (!wish_.settings || settings_serial_ == serial) return;
    settings_serial_ = serial;
    say(settings_text(settings.all()));
}

/// Sends a new stage of the recording at once. Sends changed counters only every kCountEvery_ns.
void Viewer::say_recording(std::int64_t now_ns) {
    const RecordingDesk& desk = sockets_.controls.recording;
    const std::uint64_t serial = desk.serial();
    if (recording_serial_ == serial) return;
    const RecordingState state = desk.state();
    if (now_ns < recording_due_ns_ && recording_stage_ == state.stage) return;
    recording_serial_ = serial;
    recording_stage_ = state.stage;
    recording_due_ns_ = now_ns + kCountEvery_ns;
    say(recording_text(state));
}

void Viewer::on_tick(std::int64_t now_ns) {
    if (write_since_ns_ && now_ns - *write_since_ns_ > sockets_.config.write_ms * kMs_ns)
        return end();
    // Make no message while a write is pending, so that the next messages contain the newest frame.
    if (ended_ || !open_ || write_since_ns_ || !waiting_.empty()) return;
    if (foxglove_) {
        auto messages = foxglove_->next(sockets_.foxglove, now_ns);
        std::move(messages.begin(), messages.end(), std::back_inserter(waiting_));
        return write();
    }
    Show& show = sockets_.show;
    if (hello_serial_ != show.hello_serial) {
        hello_serial_ = show.hello_serial;
        say(hello_text(show.hello));
    }
    if (frame_serial_ != show.serial()) {
        frame_serial_ = show.serial();
        push(show.pose_bytes());
    }
    push_map(now_ns);
    push_images(now_ns);
    say_steering(now_ns);
    say_status(now_ns);
    say_stairs();
    say_settings();
    say_recording(now_ns);
    write();
}

void Viewer::write() {
    if (ended_ || write_since_ns_ || waiting_.empty()) return;
    writing_ = std::move(waiting_.front());
    waiting_.pop_front();
    write_since_ns_ = steady_ns();
    ws_.text(writing_.is_text);
    ws_.async_write(net::buffer(writing_.bytes),
                    [self = shared_from_this()](error_code error, std::size_t) {
                        if (self->ended_) return;
                        self->write_since_ns_.reset();
                        if (error) return self->end();
                        if (self->has_asked_)
                            self->sockets_.slots.served(self->name_, steady_ns(), 0);
                        self->write();
                    });
}

void Viewer::end() {
    if (ended_) return;
    ended_ = true;
    beast::get_lowest_layer(ws_).close();
    sockets_.leave(*this);
}

error_code PageSockets::listen_at(const net::ip::address& address, std::uint16_t port) {
    error_code error;
    const tcp::endpoint endpoint(address, port);
    acceptor_ = tcp::acceptor(io_);
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(net::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
    return error;
}

Status PageSockets::listen() {
    error_code error;
    const auto address = net::ip::make_address(config.bind_address, error);
    if (!error) error = listen_at(address, config.port);
    for (int more = 1; error == net::error::address_in_use && config.port != 0 &&
                       more <= config.more_ports && config.port + more <= 65535;
         ++more)
        error = listen_at(address, static_cast<std::uint16_t>(config.port + more));
    if (error) {
        return input_error(
            fmt::format("the page cannot be served at the address {}, port {}: {}; give another "
                        "--bind or --page-port",
                        config.bind_address,
                        config.port,
                        error.message()));
    }
    port_ = acceptor_.local_endpoint().port();
    return config.tls.empty() ? Status{} : listen_with_tls();
}

/// Replaces the acceptor with a TLS door on the same port.
Status PageSockets::listen_with_tls() {
    error_code ignored;
    acceptor_.close(ignored);
    auto opened = gate_process::open_tls_door(
        config.bind_address,
        port_,
        config.tls,
        config.slots,
        io_,
        [this](tcp::socket socket, const std::string& peer) { admit(std::move(socket), peer); });
    if (!opened) return opened.error();
    tls_door_ = std::move(opened).value();
    return {};
}

void PageSockets::run() {
    if (tls_door_) tls_door_->start();
    accept();
    timer_.expires_after(kTick);
    wait_for_tick();
    io_.run();
}

void PageSockets::stop() {
    net::post(io_, [this] {
        error_code ignored;
        acceptor_.close(ignored);
        if (tls_door_) tls_door_->stop();
        for (const auto& connection : std::vector(connections_)) connection->end();
        gate_.want({}, {}, steady_ns());
        io_.stop();
    });
}

void PageSockets::introduce(PageHello hello, ColourLimits colours) {
    net::post(io_, [this, hello = std::move(hello), colours]() mutable {
        show.introduce(std::move(hello), colours);
    });
}

void PageSockets::accept() {
    if (accepting_ || !acceptor_.is_open()) return;
    accepting_ = true;
    acceptor_.async_accept([this](error_code error, tcp::socket socket) {
        accepting_ = false;
        if (error) return;  // no free file handle, or the peer has left: the next tick tries again
        const std::string peer = gate_process::peer_of(socket);
        admit(std::move(socket), peer);
        accept();
    });
}

void PageSockets::admit(tcp::socket socket, const std::string& peer) {
    const std::uint64_t name = ++connections_so_far_;
    end(slots.arrive(name, peer, steady_ns()));
    connections_.push_back(std::make_shared<Viewer>(*this, name, std::move(socket)));
    connections_.back()->start();
}

bool PageSockets::enter(std::uint64_t name) {
    const auto entry = slots.enter(name, gate_process::Rank::low, steady_ns());
    end(entry.ended);
    return entry.granted;
}

/// Ends the connection `name`, because another connection needs its slot.
void PageSockets::end(std::optional<gate_process::Slots::Id> name) {
    if (!name) return;
    const auto found = std::find_if(connections_.begin(), connections_.end(), [&](const auto& c) {
        return c->name() == *name;
    });
    if (found != connections_.end()) std::shared_ptr(*found)->end();
}

PageAddress PageSockets::address() const {
    return {config.bind_address, port_, names_, config.origins};
}

void PageSockets::wait_for_tick() {
    timer_.async_wait([this](error_code error) {
        if (error) return;
        on_tick();
        timer_.expires_after(kTick);
        wait_for_tick();
    });
}

void PageSockets::on_tick() {
    const std::int64_t now_ns = steady_ns();
    show.update(feed_, now_ns);
    foxglove.update(now_ns, controls.playback.state());
    Demand demand;
    for (const auto& viewer : std::vector(connections_)) {
        viewer->on_tick(now_ns);
        demand |= viewer->demand();
    }
    feed_.want(demand.images, demand.layers, demand.stairs);
    gate_.want({config.bind_address, show.hello.gate_port, config.token}, demand.gate, now_ns);
    accept();
}

void PageSockets::leave(const Viewer& viewer) {
    controls.steering.leave(viewer.name());
    slots.leave(viewer.name());
    std::erase_if(connections_, [&](const auto& other) { return other.get() == &viewer; });
}

std::size_t PageSockets::viewers() const {
    return static_cast<std::size_t>(std::count_if(
        connections_.begin(), connections_.end(), [](const auto& c) { return c->looks(); }));
}

const char* PageServerConfig::problem() const {
    if (!gate_process::is_loopback_address(bind_address) && token.empty())
        return "a page at an address beyond loopback needs a token; give --guests none, and the "
               "token file with --token-file";
    if (tls.certificate_file.empty() != tls.key_file.empty())
        return "TLS needs both files; give --certificate FILE and --key FILE";
    if (!gate_process::is_loopback_address(bind_address) && tls.empty() &&
        insecure != gate_process::kInsecureSentence)
        return "a page at an address beyond loopback needs TLS; give --certificate FILE and --key "
               "FILE. To allow the page without TLS, give the confirmation sentence with "
               "--insecure";
    if (header_ms <= 0 || answer_ms <= 0 || write_ms <= 0)
        return "header_ms, answer_ms and write_ms must each be above 0 ms";
    return slots.problem();
}

Result<std::unique_ptr<PageServer>> PageServer::open(const PageServerConfig& config,
                                                     PageFeed& feed,
                                                     PageControls& controls) {
    if (const char* problem = config.problem()) return usage_error(problem);
    auto sockets = std::make_unique<PageSockets>(config, feed, controls);
    if (auto listening = sockets->listen(); !listening) return listening.error();
    return std::unique_ptr<PageServer>(new PageServer(std::move(sockets)));
}

PageServer::PageServer(std::unique_ptr<PageSockets> sockets) : sockets_(std::move(sockets)) {}
PageServer::~PageServer() = default;

void PageServer::introduce(PageHello hello, ColourLimits colours) {
    sockets_->introduce(std::move(hello), colours);
}
void PageServer::run() {
    sockets_->run();
}
void PageServer::stop() {
    sockets_->stop();
}
std::uint16_t PageServer::port() const noexcept {
    return sockets_->port();
}

}  // namespace surefoot::page

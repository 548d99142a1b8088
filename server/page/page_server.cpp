// SPDX-License-Identifier: Apache-2.0
#include "server/page/page_server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <deque>
#include <optional>
#include <utility>
#include <variant>

#include "server/page/page_files.hpp"
#include "server/page/page_pictures.hpp"
#include "server/wire/admission.hpp"
#include "server/wire/server_config.hpp"
#include "server/wire/steady_clock.hpp"
#include "server/wire/token_bucket.hpp"

namespace surefoot::page {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;
namespace websocket = beast::websocket;
using tcp = net::ip::tcp;
using beast::error_code;
using wire::steady_ns;

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr auto kTick = std::chrono::milliseconds(20);
constexpr auto kHandshake = std::chrono::seconds(5);
constexpr auto kIdle = std::chrono::seconds(10);
constexpr std::size_t kMaxMessageBytes = 4096;
constexpr std::int64_t kStatusEvery_ns = 500'000'000;
constexpr std::int64_t kLate_ns = kSecond_ns;  ///< no frame for so long is said in words
// Of a page, before it is let go. A wish costs a whole map, a hand on the joystick nothing.
constexpr wire::RateLimit kWishes{5, 20};
constexpr wire::RateLimit kMessages{40, 80};

std::string_view view(beast::string_view text) {
    return {text.data(), text.size()};
}

std::int64_t period_ns(double rate_hz) {
    return static_cast<std::int64_t>(static_cast<double>(kSecond_ns) / rate_hz);
}

}  // namespace

/// What all viewers are shown: the newest frame, and each message of it that is alike for all, made
/// once.
class Show {
  public:
    void introduce(PageHello its_hello, ColourLimits colours) {
        hello = std::move(its_hello);
        colours_ = colours;
        ++hello_serial;
    }
    void look(PageFeed& feed, std::int64_t now_ns) {
        if (!feed.fetch(frame_)) return;
        fetched_ns_ = now_ns;
        pose_.clear();
        if (frame_->has_map) {
            fill_page_map(frame_->map, frame_->map_time_ns, colours_, map);
            ++map_serial;
        }
        if (!frame_->layers.empty()) {
            layers_.swap(frame_->layers);
            ++layers_serial;
        }
        if (frame_->images_time_ns != 0) {
            for (std::string& picture : pictures_) picture.clear();
            ++images_serial;
        }
    }
    [[nodiscard]] std::uint64_t serial() const { return frame_->serial; }
    [[nodiscard]] const std::string& pose() {
        if (pose_.empty()) pose_ = pose_message(frame_->pose);
        return pose_;
    }
    [[nodiscard]] const std::string& picture(PageImage which) {
        std::string& picture = pictures_[static_cast<std::size_t>(which)];
        if (picture.empty()) {
            const std::string jpeg = which == PageImage::left
                                         ? jpeg_of(frame_->left)
                                         : jpeg_of_disparity(frame_->disparity_px);
            picture = image_message(frame_->images_time_ns, which, jpeg);
        }
        return picture;
    }
    [[nodiscard]] std::optional<std::string> layer(std::uint16_t index) const {
        for (const PageLayer& layer : layers_) {
            if (layer.index == index) return layer_message(layer);
        }
        return std::nullopt;
    }
    [[nodiscard]] std::string status(std::int64_t now_ns,
                                     int viewers,
                                     const std::optional<PlaybackState>& playback) const {
        PageStatus status = frame_->status;
        status.viewers = viewers;
        if (playback && playback->paused && status.state == SourceState::running) {
            status.state = SourceState::paused;
            status.text = "paused";
        } else if (serial() == 0) {
            status.state = SourceState::waiting;
            status.text = "no frame has come yet";
        } else if (status.state == SourceState::running && now_ns - fetched_ns_ > kLate_ns) {
            status.state = SourceState::waiting;
            status.text = fmt::format("no frame has come for {:.0f} s",
                                      static_cast<double>(now_ns - fetched_ns_) / kSecond_ns);
        }
        return status_text(status, playback);
    }

    PageHello hello;
    PageMap map;
    std::uint64_t hello_serial = 0;
    std::uint64_t map_serial = 0;
    std::uint64_t layers_serial = 0;
    std::uint64_t images_serial = 0;

  private:
    std::unique_ptr<PageFrame> frame_ = std::make_unique<PageFrame>();
    ColourLimits colours_;
    std::int64_t fetched_ns_ = 0;
    std::string pose_;
    std::array<std::string, kImageCount> pictures_;
    std::vector<PageLayer> layers_;
};

class Viewer;

/// The listener, and all that is connected. One thread.
class PageSockets {
  public:
    PageSockets(PageServerConfig its_config, PageFeed& feed, PageControls& its_controls)
        : config(std::move(its_config)), controls(its_controls), feed_(feed) {}

    Status listen();
    void run();
    void stop();
    void introduce(PageHello hello, ColourLimits colours);
    void leave(const Viewer& viewer);
    [[nodiscard]] std::size_t viewers() const;
    [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
    /// All viewers hear the status with the next tick.
    void tell_status() noexcept { ++status_serial_; }
    [[nodiscard]] std::uint64_t status_serial() const noexcept { return status_serial_; }
    /// A name for a viewer, never 0.
    [[nodiscard]] std::uint64_t next_name() noexcept { return ++names_; }

    const PageServerConfig config;
    PageControls& controls;
    Show show;

  private:
    error_code listen_at(const net::ip::address& address, std::uint16_t port);
    void accept();
    void wait_for_tick();
    void on_tick();

    PageFeed& feed_;
    net::io_context io_{1};  // destroyed last, with all waiting handlers
    tcp::acceptor acceptor_{io_};
    net::steady_timer timer_{io_};
    std::vector<std::shared_ptr<Viewer>> connections_;  // shared with their waiting handlers
    std::uint64_t names_ = 0;
    std::uint64_t status_serial_ = 0;
    std::uint16_t port_ = 0;
    bool accepting_ = false;
};

/// One connection: a request for a file, or a page that looks.
class Viewer : public std::enable_shared_from_this<Viewer> {
  public:
    Viewer(PageSockets& sockets, tcp::socket socket)
        : sockets_(sockets),
          name_(sockets.next_name()),
          ws_(std::move(socket)),
          messages_(kMessages),
          wishes_(kWishes) {}

    void start();
    void on_tick(std::int64_t now_ns);
    void end();
    [[nodiscard]] bool looks() const { return looks_; }
    [[nodiscard]] const PageWish& wish() const { return wish_; }
    [[nodiscard]] std::uint64_t name() const { return name_; }

  private:
    struct Message {
        bool text = false;
        std::string bytes;
    };
    /// Who has the joystick, and the outcome that was told.
    struct Hold {
        bool yours = false;
        bool taken = false;
        std::uint64_t serial = 0;
        bool operator==(const Hold&) const = default;
    };

    void on_request(error_code error);
    void answer(http::status status, std::string_view type, std::string body);
    void send_file(std::string_view path, bool head);
    void upgrade();
    void read();
    void on_message();
    void take(const PageWish& wish);
    void take(const JoystickWord& word);
    void take(const PlaybackWish& wish);
    void say_goodbye(const std::string& sentence);
    void say(std::string text) { waiting_.push_back({true, std::move(text)}); }
    void push(std::string bytes) { waiting_.push_back({false, std::move(bytes)}); }
    void say_steering(std::int64_t now_ns);
    void say_status(std::int64_t now_ns);
    void push_map(std::int64_t now_ns);
    void push_images(std::int64_t now_ns);
    void write();

    PageSockets& sockets_;
    const std::uint64_t name_;
    websocket::stream<beast::tcp_stream> ws_;
    beast::flat_buffer buffer_;
    std::optional<http::request_parser<http::empty_body>> parser_;
    http::response<http::string_body> response_;
    wire::TokenBucket messages_;
    wire::TokenBucket wishes_;
    PageWish wish_;
    std::deque<Message> waiting_;
    Message writing_;
    bool is_writing_ = false;
    bool looks_ = false;  ///< a page, not a request for a file
    bool open_ = false;   ///< its WebSocket
    bool ended_ = false;

    // What it has been shown.
    std::optional<PageMap> map_;
    std::uint64_t hello_serial_ = 0;
    std::uint64_t frame_serial_ = 0;
    std::uint64_t map_serial_ = 0;
    std::uint64_t layers_serial_ = 0;
    std::uint64_t images_serial_ = 0;
    std::int64_t map_due_ns_ = 0;
    std::int64_t images_due_ns_ = 0;
    std::int64_t status_due_ns_ = 0;
    std::uint64_t status_serial_ = 0;
    std::optional<Hold> hold_;
};

void Viewer::start() {
    error_code ignored;
    beast::get_lowest_layer(ws_).socket().set_option(tcp::no_delay(true), ignored);
    beast::get_lowest_layer(ws_).expires_after(kHandshake);
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
    if (error) return end();
    const auto& request = parser_->get();
    const std::string_view target = view(request.target());
    if (!websocket::is_upgrade(request)) {
        const bool head = request.method() == http::verb::head;
        if (!head && request.method() != http::verb::get)
            return answer(
                http::status::method_not_allowed, "text/plain", "GET and HEAD are served\n");
        return send_file(wire::path_of(target), head);
    }
    if (wire::path_of(target) != "/page")
        return answer(http::status::not_found, "text/plain", "the page's WebSocket is at /page\n");
    const auto origin = request.find(http::field::origin);
    std::vector<std::string> own;
    if (!wire::is_loopback_address(sockets_.config.bind_address))
        own.push_back(fmt::format("http://{}:{}", sockets_.config.bind_address, sockets_.port()));
    const auto admission =
        wire::admit(sockets_.config.token,
                    own,
                    target,
                    origin == request.end() ? std::nullopt : std::optional(view(origin->value())));
    if (admission == wire::Admission::wrong_origin)
        return answer(http::status::forbidden, "text/plain", "this page's origin is not allowed\n");
    if (admission == wire::Admission::wrong_token)
        return answer(
            http::status::unauthorized, "text/plain", "the URL needs the token: ?token=...\n");
    if (sockets_.viewers() >= sockets_.config.max_viewers)
        return answer(
            http::status::service_unavailable, "text/plain", "too many pages look already\n");
    upgrade();
}

void Viewer::answer(http::status status, std::string_view type, std::string body) {
    constexpr unsigned kHttp11 = 11;
    response_ = {status, kHttp11};
    response_.set(http::field::content_type, beast::string_view(type.data(), type.size()));
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set(http::field::cache_control, "no-cache");
    response_.body() = std::move(body);
    response_.keep_alive(false);
    response_.prepare_payload();
    http::async_write(ws_.next_layer(),
                      response_,
                      [self = shared_from_this()](error_code, std::size_t) { self->end(); });
}

void Viewer::send_file(std::string_view path, bool head) {
    const PageFile* const file = find_page_file(path);
    if (file == nullptr)
        return answer(http::status::not_found, "text/plain", "there is no such file\n");
    constexpr unsigned kHttp11 = 11;
    response_ = {http::status::ok, kHttp11};
    const std::string_view type = content_type_of(file->path);
    response_.set(http::field::content_type, beast::string_view(type.data(), type.size()));
    response_.set(http::field::content_encoding, "gzip");
    response_.set("X-Content-Type-Options", "nosniff");
    // The page of this program, not of the one that ran here before.
    response_.set(http::field::cache_control, "no-cache");
    if (!head) response_.body() = std::string(file->gzip);
    response_.content_length(file->gzip.size());
    response_.keep_alive(false);
    http::async_write(ws_.next_layer(),
                      response_,
                      [self = shared_from_this()](error_code, std::size_t) { self->end(); });
}

void Viewer::upgrade() {
    beast::get_lowest_layer(ws_).expires_never();  // the WebSocket has a clock of its own
    ws_.set_option(websocket::stream_base::timeout{kHandshake, kIdle, true});
    ws_.read_message_max(kMaxMessageBytes);
    ws_.auto_fragment(false);  // one frame a message
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
    if (!messages_.take(steady_ns())) return say_goodbye("too many messages");
    const auto bytes = buffer_.cdata();
    auto request = parse_request({static_cast<const char*>(bytes.data()), bytes.size()},
                                 sockets_.show.hello.layers);
    buffer_.clear();
    if (!request) return say_goodbye(request.error().message);
    std::visit([this](const auto& what) { take(what); }, *request);
    if (!ended_) read();
}

void Viewer::take(const PageWish& wish) {
    if (!wishes_.take(steady_ns())) return say_goodbye("too many wishes");
    wish_ = wish;
    // All it has is sent anew.
    map_.reset();
    frame_serial_ = map_serial_ = layers_serial_ = images_serial_ = 0;
    map_due_ns_ = images_due_ns_ = 0;
}

void Viewer::take(const JoystickWord& word) {
    if (!sockets_.show.hello.can_steer)
        return say_goodbye("joystick: nobody steers this source from a page");
    // Who may not have it sees so in "steer".
    sockets_.controls.steering.hold(name_, word.command, steady_ns());
}

void Viewer::take(const PlaybackWish& wish) {
    if (!sockets_.controls.playback.state())
        return say_goodbye("playback: this source is no recording");
    sockets_.controls.playback.ask(wish);
    sockets_.tell_status();
}

void Viewer::say_goodbye(const std::string& sentence) {
    ended_ = true;
    websocket::close_reason reason(websocket::close_code::policy_error);
    constexpr std::size_t kMostBytes = 120;  // 123 fit a close frame
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
    map_due_ns_ = now_ns + period_ns(wish_.map_hz);
    push(map_message(show.map, map_ ? &*map_ : nullptr));
    map_ = show.map;
    if (show.layers_serial == layers_serial_) return;
    layers_serial_ = show.layers_serial;
    for (const std::uint16_t index : wish_.layers) {
        if (auto message = show.layer(index)) push(std::move(*message));
    }
}

void Viewer::push_images(std::int64_t now_ns) {
    Show& show = sockets_.show;
    if (show.images_serial == images_serial_ || now_ns < images_due_ns_) return;
    images_serial_ = show.images_serial;
    images_due_ns_ = now_ns + period_ns(wish_.image_hz);
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
    say(sockets_.show.status(
        now_ns, static_cast<int>(sockets_.viewers()), sockets_.controls.playback.state()));
}

void Viewer::on_tick(std::int64_t now_ns) {
    // What it has not taken yet is followed by the newest, not by all between.
    if (ended_ || !open_ || is_writing_ || !waiting_.empty()) return;
    Show& show = sockets_.show;
    if (hello_serial_ != show.hello_serial) {
        hello_serial_ = show.hello_serial;
        say(hello_text(show.hello));
    }
    if (frame_serial_ != show.serial()) {
        frame_serial_ = show.serial();
        push(show.pose());
    }
    push_map(now_ns);
    push_images(now_ns);
    say_steering(now_ns);
    say_status(now_ns);
    write();
}

void Viewer::write() {
    if (ended_ || is_writing_ || waiting_.empty()) return;
    writing_ = std::move(waiting_.front());
    waiting_.pop_front();
    is_writing_ = true;
    ws_.text(writing_.text);
    ws_.async_write(net::buffer(writing_.bytes),
                    [self = shared_from_this()](error_code error, std::size_t) {
                        if (self->ended_) return;
                        self->is_writing_ = false;
                        if (error) return self->end();
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
        return input_error(fmt::format("the page cannot be served at {} port {}: {}",
                                       config.bind_address,
                                       config.port,
                                       error.message()));
    }
    port_ = acceptor_.local_endpoint().port();
    return {};
}

void PageSockets::run() {
    accept();
    timer_.expires_after(kTick);
    wait_for_tick();
    io_.run();
}

void PageSockets::stop() {
    net::post(io_, [this] {
        error_code ignored;
        acceptor_.close(ignored);
        for (const auto& connection : std::vector(connections_)) connection->end();
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
        if (error) return;  // no handles left, or gone already: the next tick tries again
        if (connections_.size() < config.max_connections) {
            connections_.push_back(std::make_shared<Viewer>(*this, std::move(socket)));
            connections_.back()->start();
        }
        accept();
    });
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
    show.look(feed_, now_ns);
    bool images = false;
    bool layers = false;
    for (const auto& viewer : std::vector(connections_)) {
        viewer->on_tick(now_ns);
        if (!viewer->looks()) continue;
        const auto& wanted = viewer->wish().images;
        images = images || std::any_of(wanted.begin(), wanted.end(), [](bool w) { return w; });
        layers = layers || !viewer->wish().layers.empty();
    }
    feed_.want(images, layers);
    accept();
}

void PageSockets::leave(const Viewer& viewer) {
    controls.steering.leave(viewer.name());
    std::erase_if(connections_, [&](const auto& other) { return other.get() == &viewer; });
}

std::size_t PageSockets::viewers() const {
    return static_cast<std::size_t>(std::count_if(
        connections_.begin(), connections_.end(), [](const auto& c) { return c->looks(); }));
}

const char* PageServerConfig::problem() const {
    if (!wire::is_loopback_address(bind_address) && token.empty())
        return "the page is served beyond this machine with a token alone (--token-file)";
    return nullptr;
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

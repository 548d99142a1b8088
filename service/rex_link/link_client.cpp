// SPDX-License-Identifier: Apache-2.0
// In this module, only this file and tests include Boost: it adds half a minute of compile time to
// each translation unit.
#include "service/rex_link/link_client.hpp"

#include <algorithm>
#include <boost/asio/connect.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <charconv>
#include <chrono>
#include <memory>
#include <random>
#include <utility>

#include "service/rex_link/answer_parser.hpp"

namespace surefoot::rex_link {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

constexpr std::int64_t kPoll_ns = 2'000'000;

std::int64_t steady_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch())
        .count();
}

/// One connection from its first byte to its end. Pending handlers keep it alive.
class Connection : public std::enable_shared_from_this<Connection> {
  public:
    struct Listener {
        std::function<void()> opened;
        std::function<void(const std::string& bytes, bool is_text)> received;
        std::function<void(const std::string& why)> ended;
    };

    Connection(asio::io_context& io, const GateAddress& gate, Listener listener)
        : gate_(gate), listener_(std::move(listener)), stream_(io) {}

    void open() {
        const asio::ip::tcp::endpoint endpoint(asio::ip::make_address(gate_.address), gate_.port);
        beast::get_lowest_layer(stream_).expires_after(std::chrono::seconds(2));
        beast::get_lowest_layer(stream_).async_connect(
            endpoint, [self = shared_from_this()](error_code error) { self->on_connect(error); });
    }
    /// Sends the newest question; an older question that is not being sent yet is dropped.
    void send(std::string text) {
        waiting_ = std::move(text);
        if (!writing_) write();
    }
    /// Closes the connection. After this call the listener gets no events.
    void abandon() {
        listener_ = {};
        error_code ignored;
        beast::get_lowest_layer(stream_).socket().close(ignored);
    }

  private:
    void on_connect(error_code error) {
        if (error) return end(error);
        beast::get_lowest_layer(stream_).expires_never();  // the WebSocket has its own timeouts
        beast::get_lowest_layer(stream_).socket().set_option(asio::ip::tcp::no_delay(true), error);
        auto limits = websocket::stream_base::timeout::suggested(beast::role_type::client);
        limits.handshake_timeout = std::chrono::seconds(2);
        limits.idle_timeout = std::chrono::seconds(4);
        limits.keep_alive_pings = true;
        stream_.set_option(limits);
        stream_.read_message_max(kLongestAnswer_bytes);
        const std::string host = gate_.address + ":" + std::to_string(gate_.port);
        stream_.async_handshake(host, gate_.target, [self = shared_from_this()](error_code failed) {
            self->on_handshake(failed);
        });
    }
    void on_handshake(error_code error) {
        if (error) return end(error);
        if (listener_.opened) listener_.opened();
        read();
    }
    void read() {
        stream_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
            self->on_read(error);
        });
    }
    void on_read(error_code error) {
        if (error) return end(error);
        const std::string bytes = beast::buffers_to_string(buffer_.data());
        buffer_.consume(buffer_.size());
        if (listener_.received) listener_.received(bytes, stream_.got_text());
        read();
    }
    void write() {
        writing_ = std::exchange(waiting_, std::nullopt);
        stream_.text(true);
        stream_.async_write(asio::buffer(*writing_),
                            [self = shared_from_this()](error_code error, std::size_t) {
                                self->writing_.reset();
                                if (error) return self->end(error);
                                if (self->waiting_) self->write();
                            });
    }
    void end(error_code error) {
        const auto ended = std::exchange(listener_, {}).ended;
        if (ended) ended(error.message());
    }

    GateAddress gate_;
    Listener listener_;
    websocket::stream<beast::tcp_stream> stream_;
    beast::flat_buffer buffer_;
    std::optional<std::string> writing_;
    std::optional<std::string> waiting_;
};

/// Connects joystick, state machine and connection, on one thread.
class Client {
  public:
    Client(const LinkClientConfig& config, const Joystick& joystick, const LinkEventSink& sink)
        : config_(config), joystick_(joystick), sink_(sink), link_(config.link) {}
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;
    ~Client() {
        if (connection_) connection_->abandon();
    }

    void run() {
        // keeps io_ waiting without a pending handler
        const auto idle_guard = asio::make_work_guard(io_);
        while (true) {
            const std::int64_t now_ns = steady_ns();
            const auto code = joystick_(now_ns - start_ns_);
            if (!code) return;
            if (*code != code_) move(*code, now_ns);
            if (link_.next_deadline_ns().value_or(now_ns + 1) <= now_ns) obey(link_.tick(now_ns));
            if (!connection_ && now_ns >= retry_ns_) connect();
            const std::int64_t wake_ns =
                std::min(now_ns + kPoll_ns, link_.next_deadline_ns().value_or(now_ns + kPoll_ns));
            io_.restart();
            io_.run_one_until(Clock::time_point(std::chrono::nanoseconds(wake_ns)));
        }
    }

  private:
    void move(std::uint8_t code, std::int64_t now_ns) {
        code_ = code;
        LinkEvent event = event_of(LinkEventKind::joystick);
        event.command = code;
        sink_(event);
        obey(link_.joystick(code, now_ns));
    }

    void connect() {
        connection_ = std::make_shared<Connection>(
            io_,
            config_.gate,
            Connection::Listener{
                [this] { on_open(); },
                [this](const std::string& bytes, bool is_text) { on_bytes(bytes, is_text); },
                [this](const std::string& why) { on_end(why); }});
        connection_->open();
    }
    void on_open() {
        std::random_device chance;
        nonce_ = (std::uint64_t{chance()} << 32U) | chance();
        open_ = true;
        sink_(event_of(LinkEventKind::connected));
        obey(link_.connected(nonce_, steady_ns()));
    }
    void on_bytes(const std::string& bytes, bool is_text) {
        const std::int64_t now_ns = steady_ns();
        const auto parsed =
            is_text ? parse_answer(bytes)
                    : Result<ParsedAnswer>(
                          input_error("answer: the gate sent a binary message instead of text"));
        LinkEvent event = event_of(parsed ? LinkEventKind::answer : LinkEventKind::damaged);
        event.text = parsed ? parsed.value().text : parsed.error().message;
        if (parsed) {
            event.sequence = parsed.value().answer.sequence;
            event.command = parsed.value().answer.command;
            event.verdict = parsed.value().answer.verdict;
        }
        sink_(event);
        obey(parsed ? link_.answer(parsed.value().answer, now_ns) : link_.damaged_answer(now_ns));
    }
    void on_end(const std::string& why) {
        const std::int64_t now_ns = steady_ns();
        retry_ns_ = now_ns + config_.reconnect_pause_ns;
        connection_.reset();
        if (!std::exchange(open_, false)) return;
        LinkEvent event = event_of(LinkEventKind::disconnected);
        event.text = why;
        sink_(event);
        obey(link_.disconnected(now_ns));
    }

    void obey(const Actions& actions) {
        if (actions.question && connection_) {
            LinkEvent event = event_of(LinkEventKind::question);
            event.sequence = actions.question->sequence;
            event.command = actions.question->command;
            connection_->send(format_question(nonce_, *actions.question));
            sink_(event);
        }
        if (actions.inhibit) {
            LinkEvent event = event_of(LinkEventKind::inhibited);
            event.inhibit = *actions.inhibit;
            sink_(event);
        }
        if (actions.tone) {
            LinkEvent event = event_of(LinkEventKind::tone);
            event.tone = *actions.tone;
            sink_(event);
        }
        if (actions.motion) {
            LinkEvent event = event_of(LinkEventKind::motion);
            event.command = actions.motion->command;
            event.duration_ns = actions.motion->duration_ns;
            sink_(event);
        }
    }
    [[nodiscard]] LinkEvent event_of(LinkEventKind kind) const {
        LinkEvent event;
        event.kind = kind;
        event.time_ns = steady_ns() - start_ns_;
        return event;
    }

    const LinkClientConfig& config_;
    const Joystick& joystick_;
    const LinkEventSink& sink_;
    RexLink link_;
    asio::io_context io_;
    std::shared_ptr<Connection> connection_;  ///< also held by its own pending handlers
    std::int64_t start_ns_ = steady_ns();
    std::int64_t retry_ns_ = 0;
    std::uint64_t nonce_ = 0;
    std::uint8_t code_ = 0;
    bool open_ = false;
};

Error bad_url(std::string_view url) {
    return usage_error(
        "'" + std::string(url) +
        "': give an address such as ws://127.0.0.1:9090 (an IP address or localhost)");
}

}  // namespace

void GateAddress::show_token(const std::string& token) {
    if (token.empty()) return;
    target += (target.find('?') == std::string::npos ? "?token=" : "&token=") + token;
}

Result<GateAddress> parse_gate_url(std::string_view url) {
    constexpr std::string_view kScheme = "ws://";
    if (!url.starts_with(kScheme)) return bad_url(url);
    std::string_view rest = url.substr(kScheme.size());
    GateAddress gate;
    if (const std::size_t slash = rest.find('/'); slash != std::string_view::npos) {
        gate.target = rest.substr(slash);
        rest = rest.substr(0, slash);
    }
    const bool printable = std::all_of(
        gate.target.begin(), gate.target.end(), [](char c) { return c > 0x20 && c < 0x7f; });
    if (!printable) return bad_url(url);
    // A colon inside the brackets of an IPv6 address does not start a port.
    const std::size_t colon = rest.rfind(':');
    if (colon != std::string_view::npos && rest.find(']', colon) == std::string_view::npos) {
        const std::string_view digits = rest.substr(colon + 1);
        const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), gate.port);
        if (read.ec != std::errc() || read.ptr != digits.data() + digits.size() || gate.port == 0)
            return bad_url(url);
        rest = rest.substr(0, colon);
    }
    const bool brackets = rest.starts_with('[') && rest.ends_with(']');
    gate.address = brackets ? rest.substr(1, rest.size() - 2) : rest;
    if (gate.address == "localhost") gate.address = "127.0.0.1";
    error_code error;
    const auto address = asio::ip::make_address(gate.address, error);
    if (error || address.is_v6() != brackets) return bad_url(url);
    return gate;
}

const char* to_string(LinkEventKind kind) noexcept {
    switch (kind) {
        case LinkEventKind::connected: return "connected";
        case LinkEventKind::disconnected: return "disconnected";
        case LinkEventKind::joystick: return "joystick";
        case LinkEventKind::question: return "question";
        case LinkEventKind::answer: return "answer";
        case LinkEventKind::damaged: return "damaged";
        case LinkEventKind::inhibited: return "inhibited";
        case LinkEventKind::tone: return "tone";
        case LinkEventKind::motion: return "motion";
    }
    return "damaged";
}

void run_link(const LinkClientConfig& config, const Joystick& joystick, const LinkEventSink& sink) {
    Client(config, joystick, sink).run();
}

}  // namespace surefoot::rex_link

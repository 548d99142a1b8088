// SPDX-License-Identifier: Apache-2.0
// In this module, only this file and tests include Boost.Beast: it adds 25 s of compile time to
// each translation unit.
#include "service/gate_process/sockets/websocket_server.hpp"

#include <unistd.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <optional>
#include <vector>

#include "service/gate_process/outlook.hpp"
#include "service/gate_process/protocol/out_queue.hpp"
#include "service/gate_process/protocol/periodic_topics.hpp"
#include "service/gate_process/protocol/topic_json.hpp"
#include "service/gate_process/sockets/admission.hpp"
#include "service/gate_process/sockets/peer_of.hpp"
#include "service/gate_process/sockets/tls_arrivals.hpp"
#include "service/gate_process/steady_clock.hpp"

namespace surefoot::gate_process {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;
namespace websocket = beast::websocket;
using tcp = net::ip::tcp;
using beast::error_code;
/// Reads at most as many bytes per second as the policy allows.
using Stream = beast::basic_stream<tcp, tcp::socket::executor_type, beast::simple_rate_policy>;

constexpr std::int64_t kNsPerMs = 1'000'000;

constexpr std::int64_t kNsPerUs = 1'000;

std::string_view view(beast::string_view text) {
    return {text.data(), text.size()};
}

/// Processor time for some work between two ticks. Time used above the allowance reduces the next
/// allowance.
class WorkBudget {
  public:
    explicit WorkBudget(int per_tick_us) : per_tick_ns_(per_tick_us * kNsPerUs) {}
    void refill() noexcept {
        left_ns_ = std::min(per_tick_ns_, left_ns_ + per_tick_ns_);
        ticks_spent_ = is_spent() ? ticks_spent_ + 1 : 0;
        if (ticks_spent_ < kMostTicks) return;
        left_ns_ = 1;  // permits one piece of work of any cost, so that no client waits forever
        ticks_spent_ = 0;
    }
    void charge(std::int64_t cost_ns) noexcept {
        left_ns_ = std::max(left_ns_ - cost_ns, -kMostTicks * per_tick_ns_);
    }
    [[nodiscard]] bool is_spent() const noexcept { return left_ns_ <= 0; }

  private:
    static constexpr std::int64_t kMostTicks = 10;

    std::int64_t per_tick_ns_;
    std::int64_t left_ns_ = per_tick_ns_;
    std::int64_t ticks_spent_ = 0;
};

}  // namespace

class Connection;

/// The listener and all its connections.
class SocketServer {
  public:
    SocketServer(const ServerConfig& its_config, StepGate& its_gate, WebsocketServer::Tick tick)
        : config(its_config),
          gate(its_gate),
          slots(its_config.slots),
          guest_work(its_config.guest_work_us),
          door_work(its_config.door_work_us),
          tick_(std::move(tick)) {}
    SocketServer(const SocketServer&) = delete;
    SocketServer& operator=(const SocketServer&) = delete;
    ~SocketServer() = default;

    Status listen();
    void run();
    void poll();
    void stop();
    void publish(const std::vector<TopicMessage>& messages, std::int64_t now_ns);
    void leave(const Connection& connection);
    /// Closes a connection to make room for another one.
    void end_for_another(Slots::Id id);
    /// Serves the connection in the next tick; clients with the least use come first.
    void wait_for_turn(std::shared_ptr<Connection> connection);
    [[nodiscard]] std::uint64_t new_connection() { return next_connection_++; }
    [[nodiscard]] std::uint16_t port() const { return port_; }
    [[nodiscard]] ServerCounts counts() const;

    const ServerConfig config;
    StepGate& gate;
    ServerCounts totals;
    Slots slots;
    WorkBudget guest_work;
    WorkBudget door_work;
    std::int64_t accounted_ns = 0;  ///< time [ns] since the last tick, assigned to clients

  private:
    void begin();
    void accept();
    Status listen_plainly();
    Status listen_with_tls();
    void admit_to_door(tcp::socket socket, const std::string& peer);
    void take_turns(std::int64_t now_ns);
    void do_tick(std::int64_t now_ns);
    void wait_for_tick();
    void on_tick();
    void look_ahead(std::int64_t now_ns);

    net::io_context io_{1};  // one thread: no locks. Destroyed last, with all waiting handlers
    tcp::acceptor acceptor_{io_};
    net::steady_timer timer_{io_};
    WebsocketServer::Tick tick_;
    PeriodicTopics topics_;
    OutlookRounds outlook_;
    std::vector<std::shared_ptr<Connection>> connections_;  // also held by their handlers
    std::vector<std::shared_ptr<Connection>> waiting_;      // clients that wait for their turn
    std::unique_ptr<TlsDoor> tls_door_;
    std::int64_t tick_ended_ns_ = 0;  // processor time
    std::int64_t poll_ended_ns_ = 0;  // processor time, for an owner with its own loop
    Slots::Id next_slot_ = 1;
    std::uint16_t port_ = 0;
    std::uint64_t next_connection_ = 1;
    int accepts_left_ = 0;
    bool newcomers_first_ = false;
    bool accepting_ = false;
    bool begun_ = false;
};

/// One connection: first an HTTP request, then possibly a WebSocket.
class Connection : public std::enable_shared_from_this<Connection> {
  public:
    Connection(SocketServer& server, tcp::socket socket, Slots::Id slot, std::string peer)
        : server_(server),
          slot_(slot),
          peer_(std::move(peer)),
          ws_(std::move(socket)),
          out_(server.config.max_queue_bytes),
          controls_(server.config.control_frames) {}

    void start();
    /// Passes a topic message to the client. Does nothing before the connection is a client.
    void offer(const TopicMessage& message, std::int64_t now_ns);
    /// Sends the messages that are due and checks the deadlines.
    void on_tick(std::int64_t now_ns);
    /// Closes the connection at once, even if data is in transit.
    void end();
    /// Closes the connection at once; sends the reason if the client reads.
    void end_for_another();
    /// Continues the work that waited for a turn.
    void take_turn();
    [[nodiscard]] bool is_client() const { return session_.has_value(); }
    [[nodiscard]] Slots::Id slot() const { return slot_; }
    [[nodiscard]] bool wants(Topic topic) const;
    /// True if the client has sent bytes that are not read yet.
    [[nodiscard]] bool has_bytes();

  private:
    void on_request(error_code error);
    void answer_request();
    void note_refusal(const Entrance& entrance);
    [[nodiscard]] static bool is_high(const Entrance& entrance) {
        return entrance.has_token && entrance.role >= Role::rider;
    }
    [[nodiscard]] std::string where_from() const {
        return peer_.empty() ? "from this computer" : "from " + peer_;
    }
    void refuse(http::status status, const std::string& text);
    void answer(http::status status, const char* type, std::string body);
    void upgrade(const Entrance& entrance);
    void on_upgraded(error_code error);
    void read();
    void on_read(error_code error);
    void on_message(std::int64_t now_ns);
    void go_on();
    void charge(std::int64_t cost_ns);
    void send_topics(std::vector<std::string> texts);
    void write();
    void on_written(error_code error);
    void dismiss();
    void drop();
    void close_politely();
    void say_goodbye(std::string_view frame);

    SocketServer& server_;
    const Slots::Id slot_;
    const std::string peer_;  // address of the other computer; empty for this computer
    websocket::stream<Stream> ws_;
    beast::flat_buffer buffer_;
    std::optional<http::request_parser<http::empty_body>> parser_;
    http::response<http::string_body> response_;
    std::optional<Entrance> entrance_;  // set while a WebSocket waits for its turn
    Role role_ = Role::none;
    bool has_token_ = false;  // the request had a valid token
    std::optional<RosbridgeSession> session_;
    OutQueue out_;
    TokenBucket controls_;
    std::string writing_;                           // text being sent; must live until then
    std::optional<std::int64_t> write_since_ns_;    // start of sending a text
    std::optional<std::int64_t> message_since_ns_;  // start of receiving a message
    bool has_message_ = false;                      // true: the buffer holds a complete message
    bool dismissed_ = false;                        // true: gets the queued texts, then is closed
    std::optional<std::int64_t> leaves_at_ns_;      // deadline after the close message
    bool flooded_ = false;                          // true: sent too many control frames
    bool ended_ = false;
};

void Connection::start() {
    error_code ignored;
    auto& socket = beast::get_lowest_layer(ws_).socket();
    socket.set_option(tcp::no_delay(true), ignored);
    // The socket buffer is small. So a client that does not read fills our queue, where its bytes
    // are counted.
    socket.set_option(net::socket_base::send_buffer_size(64 * 1024), ignored);
    auto& stream = ws_.next_layer();
    stream.rate_policy().read_limit(server_.config.max_read_bytes_per_s);
    stream.expires_after(std::chrono::milliseconds(server_.config.handshake_ms));
    parser_.emplace();
    constexpr std::uint32_t kMaxHeaderBytes = 8 * 1024;
    parser_->header_limit(kMaxHeaderBytes);
    parser_->body_limit(0);
    http::async_read(stream,
                     buffer_,
                     *parser_,
                     [self = shared_from_this()](error_code error, std::size_t /*bytes*/) {
                         self->on_request(error);
                     });
}

void Connection::on_request(error_code error) {
    if (ended_) return;
    if (error) {
        ++server_.totals.refused;
        return end();
    }
    const std::int64_t start_ns = thread_ns();
    answer_request();
    const std::int64_t cost_ns = thread_ns() - start_ns;
    server_.door_work.charge(cost_ns);
    server_.accounted_ns += cost_ns;
    if (entrance_) go_on();
}

void Connection::answer_request() {
    const auto& request = parser_->get();
    const auto value_of = [&request](http::field field) {
        const auto found = request.find(field);
        return found == request.end() ? std::optional<std::string_view>{} : view(found->value());
    };
    const std::string_view target = view(request.target());
    const Knock knock{target, value_of(http::field::origin), value_of(http::field::authorization)};
    const Entrance entrance = admit(server_.config.access, server_.config.origins, knock);
    if (entrance.admission != Admission::welcome) {
        note_refusal(entrance);
        return refuse(entrance.admission == Admission::wrong_origin ? http::status::forbidden
                                                                    : http::status::unauthorized,
                      refusal_text(entrance, knock));
    }
    if (websocket::is_upgrade(request)) {
        entrance_ = entrance;
        return;
    }
    if (path_of(target) == "/health" && request.method() == http::verb::get) {
        return answer(
            http::status::ok, "application/json", health_text(server_.gate.report(steady_ns())));
    }
    if (path_of(target) == "/")
        return refuse(http::status::upgrade_required,
                      "this path is a WebSocket; connect with ws:// or wss://");
    refuse(http::status::not_found, "this port serves a WebSocket and /health");
}

void Connection::note_refusal(const Entrance& entrance) {
    Act act;
    act.kind = entrance.has_token ? ActKind::authenticate : ActKind::connect;
    act.time_ns = steady_ns();
    act.text = where_from();
    act.text +=
        entrance.admission == Admission::wrong_origin ? ", a web page of another origin" : "";
    server_.gate.note(act);
}

void Connection::refuse(http::status status, const std::string& text) {
    ++server_.totals.refused;
    answer(status, "text/plain", text + "\n");
}

void Connection::answer(http::status status, const char* type, std::string body) {
    constexpr unsigned kHttp11 = 11;
    response_ = {status, kHttp11};
    response_.set(http::field::content_type, type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("X-Content-Type-Options", "nosniff");
    if (status == http::status::upgrade_required) response_.set(http::field::upgrade, "websocket");
    response_.body() = std::move(body);
    response_.keep_alive(false);
    response_.prepare_payload();
    http::async_write(ws_.next_layer(),
                      response_,
                      [self = shared_from_this()](error_code, std::size_t) { self->end(); });
}

void Connection::upgrade(const Entrance& entrance) {
    const Rank rank = is_high(entrance) ? Rank::high : Rank::low;
    const Slots::Entry entry = server_.slots.enter(slot_, rank, steady_ns());
    if (entry.ended) server_.end_for_another(*entry.ended);
    if (!entry.granted) {
        return refuse(http::status::service_unavailable,
                      entry.peer_is_full
                          ? "too many clients come from your computer: close one of them"
                          : "all slots are taken by clients that are being served: close one, or "
                            "connect with the token of a rider or of the operator, because slots "
                            "are reserved for these roles");
    }
    role_ = entrance.role;
    has_token_ = entrance.has_token;
    ws_.next_layer().expires_never();  // the WebSocket has its own timeouts
    ws_.set_option(
        websocket::stream_base::timeout{std::chrono::milliseconds(server_.config.handshake_ms),
                                        std::chrono::milliseconds(server_.config.idle_ms),
                                        true});  // pings after half of this time
    ws_.read_message_max(server_.config.session.json.max_bytes);
    ws_.text(true);
    ws_.control_callback([this](websocket::frame_type, beast::string_view) {
        if (flooded_ || controls_.take(steady_ns())) return;
        flooded_ = true;
        net::post(ws_.get_executor(), [self = shared_from_this()] {
            if (!self->ended_) self->drop();
        });
    });
    ws_.async_accept(parser_->get(),
                     [self = shared_from_this()](error_code error) { self->on_upgraded(error); });
}

void Connection::on_upgraded(error_code error) {
    if (ended_) return;
    if (error) {
        ++server_.totals.refused;
        return end();
    }
    parser_.reset();
    buffer_.clear();
    session_.emplace(server_.new_connection(),
                     server_.gate,
                     server_.config.session,
                     SessionRights{role_, &server_.config.access});
    if (has_token_) {
        Act act = act_of(ActKind::authenticate, role_, session_->connection(), {}, steady_ns());
        act.text = where_from();
        server_.gate.note(act);
    }
    read();
}

void Connection::read() {
    ws_.async_read_some(buffer_,
                        server_.config.session.json.max_bytes,
                        [self = shared_from_this()](error_code error, std::size_t /*bytes*/) {
                            self->on_read(error);
                        });
}

void Connection::on_read(error_code error) {
    if (ended_ || dismissed_) return;
    if (error) return end();
    if (ws_.is_message_done()) {
        message_since_ns_.reset();
        has_message_ = true;
    } else if (!message_since_ns_) {
        message_since_ns_ = steady_ns();
    }
    go_on();
}

/// Handles the message that was read and continues to read: now, or in this client's turn. Until
/// its turn, the client's data stays in its socket.
void Connection::go_on() {
    const bool high = entrance_ ? is_high(*entrance_) : server_.slots.is_high(slot_);
    if (!high && server_.guest_work.is_spent()) return server_.wait_for_turn(shared_from_this());
    const std::int64_t start_ns = thread_ns();
    if (entrance_) {
        upgrade(*std::exchange(entrance_, std::nullopt));
        return charge(thread_ns() - start_ns);
    }
    if (std::exchange(has_message_, false)) {
        const std::int64_t now_ns = steady_ns();
        on_message(now_ns);
        const std::int64_t cost_ns = thread_ns() - start_ns;
        server_.slots.served(slot_, now_ns, cost_ns);
        charge(cost_ns);
    } else {
        constexpr std::int64_t kPieceCost_ns = 20'000;  // processor time to read and unmask a part
        charge(kPieceCost_ns);
    }
    if (!ended_ && !dismissed_) read();
}

void Connection::charge(std::int64_t cost_ns) {
    server_.accounted_ns += cost_ns;
    if (!server_.slots.is_high(slot_)) server_.guest_work.charge(cost_ns);
}

void Connection::take_turn() {
    if (!ended_ && !dismissed_) go_on();
}

void Connection::on_message(std::int64_t now_ns) {
    const auto bytes = buffer_.cdata();
    Reaction reaction =
        session_->on_message({static_cast<const char*>(bytes.data()), bytes.size()}, now_ns);
    buffer_.clear();
    server_.slots.listens(slot_, session_->wants_any());
    if (session_->role() != role_) {
        role_ = session_->role();
        if (role_ >= Role::rider) server_.slots.promote(slot_);
    }
    bool room = true;
    for (auto& reply : reaction.replies) room = out_.push_reply(std::move(reply)) && room;
    if (!room) return drop();
    write();  // sends the answer before the topic message goes to other clients
    server_.publish(reaction.published, now_ns);
    if (reaction.drop && !ended_) dismiss();
}

void Connection::offer(const TopicMessage& message, std::int64_t now_ns) {
    if (session_ && !dismissed_) send_topics(session_->on_topic(message, now_ns));
}

bool Connection::wants(Topic topic) const {
    return session_ && !dismissed_ && session_->wants(topic);
}

bool Connection::has_bytes() {
    error_code ignored;
    if (!session_ || dismissed_) return false;
    return has_message_ || beast::get_lowest_layer(ws_).socket().available(ignored) > 0;
}

void Connection::send_topics(std::vector<std::string> texts) {
    for (auto& text : texts) {
        if (!out_.push_topic(std::move(text))) return drop();
    }
    write();
}

void Connection::on_tick(std::int64_t now_ns) {
    const auto late = [&](const std::optional<std::int64_t>& since_ns, int limit_ms) {
        return since_ns && now_ns - *since_ns > limit_ms * kNsPerMs;
    };
    if (leaves_at_ns_ && now_ns > *leaves_at_ns_) return end();
    if (late(message_since_ns_, server_.config.message_ms) ||
        late(write_since_ns_, server_.config.write_ms))
        return drop();
    if (session_ && !dismissed_) send_topics(session_->due(now_ns));
}

void Connection::write() {
    if (ended_ || write_since_ns_ || out_.empty()) return;
    writing_ = out_.pop();
    write_since_ns_ = steady_ns();
    ws_.async_write(net::buffer(writing_),
                    [self = shared_from_this()](error_code error, std::size_t /*bytes*/) {
                        self->on_written(error);
                    });
}

void Connection::on_written(error_code error) {
    if (ended_) return;
    write_since_ns_.reset();
    if (error) return end();
    if (dismissed_ && out_.empty()) return close_politely();
    write();
}

void Connection::dismiss() {
    ++server_.totals.dropped;
    dismissed_ = true;
    if (!write_since_ns_) close_politely();
}

/// Sends the reason and disconnects soon. Reads no more data: to wait for the client's close frame,
/// the server would have to read all data before it.
void Connection::close_politely() {
    if (leaves_at_ns_) return;
    constexpr std::int64_t kLinger_ns = 100'000'000;
    say_goodbye("\x88\x13\x03\xf0too many messages");
    error_code ignored;
    beast::get_lowest_layer(ws_).socket().shutdown(tcp::socket::shutdown_send, ignored);
    leaves_at_ns_ = steady_ns() + kLinger_ns;
}

/// Sends a complete close frame (RFC 6455) if the socket has room for it.
void Connection::say_goodbye(std::string_view frame) {
    error_code ignored;
    auto& socket = beast::get_lowest_layer(ws_).socket();
    socket.non_blocking(true, ignored);
    socket.send(net::buffer(frame.data(), frame.size()), 0, ignored);
}

void Connection::drop() {
    ++server_.totals.dropped;
    end();
}

/// Closes a client that loses its slot. Does not wait for the client.
void Connection::end_for_another() {
    if (session_) ++server_.totals.dropped;
    if (session_ && !write_since_ns_) say_goodbye("\x88\x1f\x03\xf0the slot went to a new client");
    end();
}

void Connection::end() {
    if (ended_) return;
    ended_ = true;
    session_.reset();  // the gate forgets the client now, even if handlers still wait
    beast::get_lowest_layer(ws_).close();
    server_.leave(*this);
}

Status SocketServer::listen() {
    next_connection_ = config.first_connection;
    return config.tls.empty() ? listen_plainly() : listen_with_tls();
}

Status SocketServer::listen_with_tls() {
    auto opened = open_tls_door(config.bind_address,
                                config.port,
                                config.tls,
                                config.slots,
                                io_,
                                [this](tcp::socket socket, const std::string& peer) {
                                    admit_to_door(std::move(socket), peer);
                                });
    if (!opened) return opened.error();
    tls_door_ = std::move(opened).value();
    port_ = tls_door_->port();
    return {};
}

Status SocketServer::listen_plainly() {
    error_code error;
    const tcp::endpoint endpoint(net::ip::make_address(config.bind_address, error), config.port);
    if (!error) acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(net::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
    if (error) {
        return input_error("cannot listen at " + config.bind_address + " port " +
                           std::to_string(config.port) + ": " + error.message());
    }
    port_ = acceptor_.local_endpoint().port();
    return {};
}

void SocketServer::run() {
    begin();
    io_.run();
}

void SocketServer::poll() {
    begin();
    const std::int64_t start_ns = thread_ns();
    accounted_ns += start_ns - poll_ended_ns_;  // processor time of the owner's own loop
    if (io_.poll() == 0) accounted_ns += thread_ns() - start_ns;
    poll_ended_ns_ = thread_ns();
}

void SocketServer::begin() {
    if (begun_) return;
    begun_ = true;
    tick_ended_ns_ = poll_ended_ns_ = thread_ns();
    accepts_left_ = config.accepts_per_tick;
    timer_.expires_after(std::chrono::milliseconds(config.tick_ms));
    wait_for_tick();
    if (tls_door_) tls_door_->start();
    accept();
}

void SocketServer::stop() {
    net::post(io_, [this] {
        error_code ignored;
        acceptor_.close(ignored);
        if (tls_door_) tls_door_->stop();
        for (const auto& connection : std::vector(connections_)) connection->end();
        io_.stop();
    });
}

void SocketServer::accept() {
    if (accepting_ || accepts_left_ == 0 || door_work.is_spent() || !acceptor_.is_open()) return;
    accepting_ = true;
    --accepts_left_;
    acceptor_.async_accept([this](error_code error, tcp::socket socket) {
        accepting_ = false;
        if (error) return;  // no file handles left, or already closed; the next tick retries
        const std::int64_t start_ns = thread_ns();
        const std::string peer = peer_of(socket);
        admit_to_door(std::move(socket), peer);
        const std::int64_t cost_ns = thread_ns() - start_ns;
        door_work.charge(cost_ns);
        accounted_ns += cost_ns;
        accept();
    });
}

void SocketServer::admit_to_door(tcp::socket socket, const std::string& peer) {
    ++totals.accepted;
    const Slots::Id slot = next_slot_++;
    if (const auto ended = slots.arrive(slot, peer, steady_ns())) {
        ++totals.refused;
        end_for_another(*ended);
    }
    connections_.push_back(std::make_shared<Connection>(*this, std::move(socket), slot, peer));
    connections_.back()->start();
}

void SocketServer::end_for_another(Slots::Id id) {
    const auto found = std::find_if(
        connections_.begin(), connections_.end(), [id](const auto& c) { return c->slot() == id; });
    if (found != connections_.end()) std::shared_ptr(*found)->end_for_another();
}

void SocketServer::wait_for_turn(std::shared_ptr<Connection> connection) {
    waiting_.push_back(std::move(connection));
}

/// Serves waiting connections. Clients with the least use come first. New connections and clients
/// take turns, so that neither group blocks the other.
void SocketServer::take_turns(std::int64_t now_ns) {
    guest_work.refill();
    door_work.refill();
    auto turns = std::exchange(waiting_, {});
    const auto clients = std::stable_partition(
        turns.begin(), turns.end(), [](const auto& c) { return !c->is_client(); });
    std::stable_sort(clients, turns.end(), [&](const auto& a, const auto& b) {
        return slots.burden_ns(a->slot(), now_ns) < slots.burden_ns(b->slot(), now_ns);
    });
    auto newcomer = turns.begin();
    auto client = clients;
    newcomers_first_ = !newcomers_first_;  // each group is first in every second tick
    for (bool newcomers_turn = newcomers_first_; newcomer != clients || client != turns.end();
         newcomers_turn = !newcomers_turn) {
        // If no time is left, the connections wait again.
        if (newcomers_turn && newcomer != clients) (*newcomer++)->take_turn();
        if (!newcomers_turn && client != turns.end()) (*client++)->take_turn();
    }
}

void SocketServer::wait_for_tick() {
    timer_.async_wait([this](error_code error) {
        if (error) return;
        on_tick();
        const auto period = std::chrono::milliseconds(config.tick_ms);
        // After a long pause, missed ticks are not repeated.
        timer_.expires_at(std::max(timer_.expiry() + period, net::steady_timer::clock_type::now()));
        wait_for_tick();
    });
}

/// Runs one tick. Some processor time since the last tick belongs to no client (pongs, writing,
/// closing). It is subtracted from the guests' budget, because guests cause nearly all of it.
void SocketServer::on_tick() {
    guest_work.charge(thread_ns() - tick_ended_ns_ - accounted_ns);
    do_tick(steady_ns());
    tick_ended_ns_ = thread_ns();
    accounted_ns = 0;
}

void SocketServer::do_tick(std::int64_t now_ns) {
    if (tick_) tick_(now_ns);
    publish(topics_.due(gate, now_ns), now_ns);
    for (const auto& connection : std::vector(connections_)) connection->on_tick(now_ns);
    take_turns(now_ns);
    accepts_left_ = config.accepts_per_tick;
    accept();
    // After a pause of the thread a question may have been read but not handled yet.
    net::post(io_, [this] {
        const std::int64_t start_ns = thread_ns();
        look_ahead(steady_ns());
        accounted_ns += thread_ns() - start_ns;
    });
}

void SocketServer::look_ahead(std::int64_t now_ns) {
    OutlookDemand demand;
    demand.subscribed = std::any_of(connections_.begin(), connections_.end(), [](const auto& c) {
        return c->wants(Topic::outlook);
    });
    demand.question_waits =
        demand.subscribed &&
        std::any_of(
            connections_.begin(), connections_.end(), [](const auto& c) { return c->has_bytes(); });
    if (auto message = outlook_.next(gate, demand, now_ns)) publish({std::move(*message)}, now_ns);
}

void SocketServer::publish(const std::vector<TopicMessage>& messages, std::int64_t now_ns) {
    if (messages.empty()) return;
    // Iterates over a copy, because a client that is too slow leaves the list meanwhile.
    for (const auto& connection : std::vector(connections_)) {
        for (const auto& message : messages) connection->offer(message, now_ns);
    }
}

void SocketServer::leave(const Connection& connection) {
    slots.leave(connection.slot());
    std::erase_if(connections_, [&](const auto& other) { return other.get() == &connection; });
}

ServerCounts SocketServer::counts() const {
    ServerCounts counts = totals;
    counts.clients = static_cast<std::size_t>(std::count_if(
        connections_.begin(), connections_.end(), [](const auto& c) { return c->is_client(); }));
    counts.handshakes = connections_.size() - counts.clients;
    return counts;
}

Result<std::unique_ptr<WebsocketServer>> WebsocketServer::open(const ServerConfig& config,
                                                               StepGate& gate,
                                                               Tick tick) {
    if (const auto problem = config.problem()) return usage_error(*problem);
    auto server = std::make_unique<SocketServer>(config, gate, std::move(tick));
    if (const auto listening = server->listen(); !listening) return listening.error();
    return std::unique_ptr<WebsocketServer>(new WebsocketServer(std::move(server)));
}

WebsocketServer::WebsocketServer(std::unique_ptr<SocketServer> server)
    : server_(std::move(server)) {}
WebsocketServer::~WebsocketServer() = default;

std::uint16_t WebsocketServer::port() const noexcept {
    return server_->port();
}
void WebsocketServer::run() {
    server_->run();
}
void WebsocketServer::poll() {
    server_->poll();
}
void WebsocketServer::stop() {
    server_->stop();
}
ServerCounts WebsocketServer::counts() const {
    return server_->counts();
}

}  // namespace surefoot::gate_process

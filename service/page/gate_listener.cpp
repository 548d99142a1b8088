// SPDX-License-Identifier: Apache-2.0
#include "service/page/gate_listener.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <deque>
#include <nlohmann/json.hpp>
#include <utility>

#include "service/gate_process/protocol/json_text.hpp"

namespace surefoot::page {
namespace {

namespace beast = boost::beast;
namespace net = boost::asio;
namespace websocket = beast::websocket;
using tcp = net::ip::tcp;
using beast::error_code;

constexpr std::int64_t kRetryAfter_ns = 500'000'000;
constexpr auto kConnect = std::chrono::seconds(2);
constexpr auto kIdle = std::chrono::seconds(10);
/// Largest message of the gate. For comparison: an outlook of 26 movements takes 5 kB.
constexpr std::size_t kLongestNews_bytes = 64 * 1024;

constexpr const char* name_of(GateTopic topic) {
    return topic == GateTopic::verdict ? "/surefoot/verdict" : "/surefoot/outlook";
}
constexpr const char* type_of(GateTopic topic) {
    return topic == GateTopic::verdict ? "surefoot/Verdict" : "surefoot/Outlook";
}

/// Returns the address to connect to. For a server that listens at all addresses this is loopback.
net::ip::address reachable(const std::string& address) {
    error_code error;
    const auto parsed = net::ip::make_address(address, error);
    if (error || (parsed.is_unspecified() && parsed.is_v4()))
        return net::ip::address_v4::loopback();
    return parsed.is_unspecified() ? net::ip::address(net::ip::address_v6::loopback()) : parsed;
}

}  // namespace

std::optional<GateNews> read_gate_news(std::string_view text) {
    const auto json = gate_process::parse_json(
        text, {kLongestNews_bytes, gate_process::JsonLimits{}.max_depth, 4096});
    if (!json || !json->is_object()) return std::nullopt;
    const auto op = json->find("op");
    const auto topic = json->find("topic");
    const auto body = json->find("msg");
    if (op == json->end() || *op != "publish" || topic == json->end() || body == json->end() ||
        !body->is_object())
        return std::nullopt;
    for (const GateTopic ours : {GateTopic::verdict, GateTopic::outlook}) {
        if (*topic == name_of(ours)) return GateNews{ours, gate_process::dump(*body)};
    }
    return std::nullopt;
}

/// One connection from its first byte to its end. Pending handlers keep it alive.
class GateListener::Connection : public std::enable_shared_from_this<Connection> {
  public:
    Connection(net::io_context& io, const GateService& service, Sink sink)
        : sink_(std::move(sink)), service_(service), stream_(io) {}

    void open() {
        const tcp::endpoint endpoint(reachable(service_.address), service_.port);
        beast::get_lowest_layer(stream_).expires_after(kConnect);
        beast::get_lowest_layer(stream_).async_connect(
            endpoint, [self = shared_from_this()](error_code error) { self->on_connect(error); });
    }
    void want(GateTopics topics) {
        if (!is_open_) return;
        ask(GateTopic::verdict, heard_.verdict, topics.verdict);
        ask(GateTopic::outlook, heard_.outlook, topics.outlook);
        heard_ = topics;
        write();
    }
    [[nodiscard]] bool is_over() const { return over_; }
    /// Closes the connection. The sink gets no further call.
    void abandon() {
        over_ = true;
        sink_ = {};
        error_code ignored;
        beast::get_lowest_layer(stream_).socket().close(ignored);
    }

  private:
    void on_connect(error_code error) {
        if (over_) return;
        if (error) return abandon();
        beast::get_lowest_layer(stream_).expires_never();  // from here on the timeouts of the
                                                           // WebSocket apply
        stream_.set_option(websocket::stream_base::timeout{kConnect, kIdle, true});
        stream_.read_message_max(kLongestNews_bytes);
        const std::string target =
            service_.token.empty() ? std::string("/") : "/?token=" + service_.token;
        stream_.async_handshake(service_.address + ":" + std::to_string(service_.port),
                                target,
                                [self = shared_from_this()](error_code failed) {
                                    if (self->over_) return;
                                    if (failed) return self->abandon();
                                    self->is_open_ = true;
                                    self->read();
                                });
    }
    void read() {
        stream_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
            if (self->over_) return;
            if (error) return self->abandon();
            const std::string text = beast::buffers_to_string(self->buffer_.data());
            self->buffer_.clear();
            if (auto news = read_gate_news(text)) self->sink_(std::move(*news));
            self->read();
        });
    }
    void ask(GateTopic topic, bool had, bool wanted) {
        if (had == wanted) return;
        gate_process::Json json{{"op", wanted ? "subscribe" : "unsubscribe"},
                                {"topic", name_of(topic)}};
        if (wanted) json["type"] = type_of(topic);
        waiting_.push_back(gate_process::dump(json));
    }
    void write() {
        if (over_ || is_writing_ || waiting_.empty()) return;
        is_writing_ = true;
        stream_.text(true);
        stream_.async_write(net::buffer(waiting_.front()),
                            [self = shared_from_this()](error_code error, std::size_t) {
                                self->is_writing_ = false;
                                if (self->over_) return;
                                if (error) return self->abandon();
                                self->waiting_.pop_front();
                                self->write();
                            });
    }

    Sink sink_;
    GateService service_;
    websocket::stream<beast::tcp_stream> stream_;
    beast::flat_buffer buffer_;
    std::deque<std::string> waiting_;
    GateTopics heard_;
    bool is_writing_ = false;
    bool is_open_ = false;
    bool over_ = false;
};

GateListener::GateListener(net::io_context& io, Sink sink) : io_(io), sink_(std::move(sink)) {}

GateListener::~GateListener() {
    hang_up();
}

void GateListener::hang_up() {
    if (connection_) connection_->abandon();
    connection_.reset();
}

void GateListener::want(const GateService& service, GateTopics topics, std::int64_t now_ns) {
    if (connection_ && (connection_->is_over() || service != service_)) hang_up();
    if (topics == GateTopics{} || service.port == 0) return hang_up();
    if (!connection_ && now_ns >= retry_ns_) {
        retry_ns_ = now_ns + kRetryAfter_ns;
        service_ = service;
        connection_ = std::make_shared<Connection>(io_, service, sink_);
        connection_->open();
    }
    if (connection_) connection_->want(topics);
}

}  // namespace surefoot::page

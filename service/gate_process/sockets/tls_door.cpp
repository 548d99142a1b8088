// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/sockets/tls_door.hpp"

#include <openssl/ssl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <map>
#include <thread>
#include <utility>

#include "service/gate_process/sockets/peer_of.hpp"
#include "service/gate_process/sockets/slots.hpp"
#include "service/gate_process/steady_clock.hpp"

namespace surefoot::gate_process {
namespace {

namespace net = boost::asio;
using boost::system::error_code;
using net::ip::tcp;
using Inner = net::local::stream_protocol::socket;
using Outer = net::ssl::stream<tcp::socket>;

constexpr std::size_t kBlock_bytes = 16 * 1024;  // size of one TLS record
constexpr unsigned char kTlsHandshake = 22;      // first byte of a ClientHello (RFC 8446, 5.1)
constexpr const char* kUseTls =
    "HTTP/1.1 400 Bad Request\r\nContent-Type: text/plain\r\nConnection: close\r\n\r\n"
    "This port uses TLS: connect to wss:// or https://\n";

/// Returns an error if the private key is missing, is not a regular file, or is open to other
/// users.
Status check_key_file(const std::string& file) {
    struct stat about {};
    if (::stat(file.c_str(), &about) != 0)
        return usage_error(
            file + ": the private key cannot be read: " + std::generic_category().message(errno));
    if (!S_ISREG(about.st_mode))
        return usage_error(file + ": the private key must be a regular file");
    if ((about.st_mode & (S_IRWXG | S_IRWXO)) != 0)
        return usage_error(file + ": other users may read this private key; run chmod 600 " + file);
    return {};
}

}  // namespace

/// Listens and owns the connections. Everything except `stop` runs on the door's thread.
class TlsListener {
  public:
    TlsListener(TlsDoorConfig its_config, TlsDoor::OnArrival its_arrival)
        : config(std::move(its_config)), on_arrival(std::move(its_arrival)) {}
    TlsListener(const TlsListener&) = delete;
    TlsListener& operator=(const TlsListener&) = delete;
    ~TlsListener() { stop(); }

    Status open();
    void start();
    void stop();
    void leave(Slots::Id id);
    void handshake_done(Slots::Id id) { door_.leave(id); }
    [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
    [[nodiscard]] net::io_context& io() noexcept { return io_; }

    const TlsDoorConfig config;
    const TlsDoor::OnArrival on_arrival;
    net::ssl::context context{net::ssl::context::tls_server};

  private:
    class Connection;

    Status load_files();
    void accept();
    void take(tcp::socket socket);

    net::io_context io_{1};
    tcp::acceptor acceptor_{io_};
    net::steady_timer retry_{io_};
    Slots door_{{.max_clients = 2,
                 .reserved = 1,
                 .max_handshakes = std::max<std::size_t>(1, config.max_handshakes)}};
    std::map<Slots::Id, std::shared_ptr<Connection>> connections_;
    Slots::Id next_id_ = 1;
    std::uint16_t port_ = 0;
    std::thread thread_;
};

/// One client: first the TLS handshake, then bytes in both directions until one side closes.
class TlsListener::Connection : public std::enable_shared_from_this<Connection> {
  public:
    Connection(TlsListener& listener, tcp::socket socket, Slots::Id id, std::string peer)
        : listener_(listener),
          outer_(std::move(socket), listener.context),
          inner_(listener.io()),
          deadline_(listener.io()),
          id_(id),
          peer_(std::move(peer)) {}

    void start() {
        deadline_.expires_after(std::chrono::milliseconds(listener_.config.handshake_ms));
        deadline_.async_wait([self = shared_from_this()](error_code error) {
            if (!error) self->end();
        });
        outer_.next_layer().async_wait(tcp::socket::wait_read,
                                       [self = shared_from_this()](error_code error) {
                                           if (!self->ended_) self->on_first_byte(error);
                                       });
    }
    void end() {
        if (ended_) return;
        ended_ = true;
        error_code ignored;
        deadline_.cancel();
        outer_.next_layer().close(ignored);
        inner_.close(ignored);
        listener_.leave(id_);
    }

  private:
    void on_first_byte(error_code error) {
        if (error) return end();
        unsigned char first = 0;
        auto& socket = outer_.next_layer();
        if (socket.receive(net::buffer(&first, 1), tcp::socket::message_peek, error) != 1 || error)
            return end();
        if (first == kTlsHandshake) return handshake();
        if (!peer_.empty()) return refuse_plain_bytes();
        listener_.handshake_done(id_);
        const int handle = socket.release(error);
        if (!error) listener_.on_arrival(handle, peer_);
        end();
    }
    void refuse_plain_bytes() {
        net::async_write(outer_.next_layer(),
                         net::buffer(kUseTls, std::char_traits<char>::length(kUseTls)),
                         [self = shared_from_this()](error_code, std::size_t) { self->end(); });
    }
    void handshake() {
        outer_.async_handshake(net::ssl::stream_base::server,
                               [self = shared_from_this()](error_code error) {
                                   if (self->ended_) return;
                                   if (error) return self->end();
                                   self->on_handshake();
                               });
    }
    void on_handshake() {
        int ends[2] = {-1, -1};
        if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return end();
        error_code error;
        inner_.assign(net::local::stream_protocol(), ends[0], error);
        if (error) {
            ::close(ends[0]);
            ::close(ends[1]);
            return end();
        }
        deadline_.cancel();
        listener_.handshake_done(id_);
        listener_.on_arrival(ends[1], peer_);
        read_outer();
        read_inner();
    }
    void read_outer() {
        outer_.async_read_some(net::buffer(from_outer_),
                               [self = shared_from_this()](error_code error, std::size_t bytes) {
                                   if (self->ended_) return;
                                   if (error) return self->end();
                                   self->write_inner(bytes);
                               });
    }
    void write_inner(std::size_t bytes) {
        net::async_write(inner_,
                         net::buffer(from_outer_, bytes),
                         [self = shared_from_this()](error_code error, std::size_t) {
                             if (self->ended_) return;
                             if (error) return self->end();
                             self->read_outer();
                         });
    }
    void read_inner() {
        inner_.async_read_some(net::buffer(from_inner_),
                               [self = shared_from_this()](error_code error, std::size_t bytes) {
                                   if (self->ended_) return;
                                   if (error) return self->say_goodbye();
                                   self->write_outer(bytes);
                               });
    }
    void write_outer(std::size_t bytes) {
        net::async_write(outer_,
                         net::buffer(from_inner_, bytes),
                         [self = shared_from_this()](error_code error, std::size_t) {
                             if (self->ended_) return;
                             if (error) return self->end();
                             self->read_inner();
                         });
    }
    /// Ends the connection after the service has closed it. Sends close_notify within one second,
    /// so the client knows that no data was cut.
    void say_goodbye() {
        deadline_.expires_after(std::chrono::seconds(1));
        deadline_.async_wait([self = shared_from_this()](error_code) { self->end(); });
        outer_.async_shutdown([self = shared_from_this()](error_code) { self->end(); });
    }

    TlsListener& listener_;
    Outer outer_;
    Inner inner_;
    net::steady_timer deadline_;
    const Slots::Id id_;
    const std::string peer_;
    std::array<char, kBlock_bytes> from_outer_{};
    std::array<char, kBlock_bytes> from_inner_{};
    bool ended_ = false;
};

Status TlsListener::load_files() {
    const TlsFiles& files = config.files;
    if (auto status = check_key_file(files.key_file); !status) return status;
    SSL_CTX_set_min_proto_version(context.native_handle(), TLS1_2_VERSION);
    SSL_CTX_set_options(context.native_handle(), SSL_OP_NO_RENEGOTIATION);
    error_code error;
    context.use_certificate_chain_file(files.certificate_file, error);
    if (error)
        return usage_error(files.certificate_file +
                           ": no certificate chain (PEM) can be read: " + error.message());
    context.use_private_key_file(files.key_file, net::ssl::context::pem, error);
    if (error)
        return usage_error(files.key_file + ": no private key (PEM) of the certificate " +
                           files.certificate_file + " can be read: " + error.message());
    return {};
}

Status TlsListener::open() {
    if (auto status = load_files(); !status) return status;
    error_code error;
    const tcp::endpoint endpoint(net::ip::make_address(config.bind_address, error), config.port);
    if (!error) acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(net::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
    if (error)
        return input_error("cannot listen at " + config.bind_address + " port " +
                           std::to_string(config.port) + ": " + error.message());
    port_ = acceptor_.local_endpoint().port();
    return {};
}

void TlsListener::start() {
    accept();
    thread_ = std::thread([this] { io_.run(); });
}

void TlsListener::stop() {
    if (!thread_.joinable()) return;
    net::post(io_, [this] {
        error_code ignored;
        acceptor_.close(ignored);
        retry_.cancel();
        for (const auto& [id, connection] : std::map(connections_)) connection->end();
        io_.stop();
    });
    thread_.join();
}

void TlsListener::accept() {
    acceptor_.async_accept([this](error_code error, tcp::socket socket) {
        if (!acceptor_.is_open()) return;
        if (!error) {
            take(std::move(socket));
            return accept();
        }
        // The usual cause is that no file handles are left. An immediate retry would keep a core
        // busy.
        retry_.expires_after(std::chrono::milliseconds(20));
        retry_.async_wait([this](error_code cancelled) {
            if (!cancelled) accept();
        });
    });
}

void TlsListener::take(tcp::socket socket) {
    if (connections_.size() >= config.max_connections) return;  // the destructor closes the socket
    error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    const std::string peer = peer_of(socket);
    const Slots::Id id = next_id_++;
    if (const auto ended = door_.arrive(id, peer, steady_ns())) {
        if (const auto found = connections_.find(*ended); found != connections_.end())
            std::shared_ptr(found->second)->end();
    }
    auto connection = std::make_shared<Connection>(*this, std::move(socket), id, peer);
    connections_.emplace(id, connection);
    connection->start();
}

void TlsListener::leave(Slots::Id id) {
    door_.leave(id);
    connections_.erase(id);
}

Result<std::unique_ptr<TlsDoor>> TlsDoor::open(const TlsDoorConfig& config, OnArrival on_arrival) {
    auto listener = std::make_unique<TlsListener>(config, std::move(on_arrival));
    if (auto opened = listener->open(); !opened) return opened.error();
    return std::unique_ptr<TlsDoor>(new TlsDoor(std::move(listener)));
}

TlsDoor::TlsDoor(std::unique_ptr<TlsListener> listener) : listener_(std::move(listener)) {}
TlsDoor::~TlsDoor() = default;

std::uint16_t TlsDoor::port() const noexcept {
    return listener_->port();
}
void TlsDoor::start() {
    listener_->start();
}
void TlsDoor::stop() {
    listener_->stop();
}

}  // namespace surefoot::gate_process

// SPDX-License-Identifier: Apache-2.0
// The service over real sockets of this machine. No result depends on a clock: clients wait for the
// expected messages, and the deadlines of the server are short.
#include "service/gate_process/sockets/websocket_server.hpp"

#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/gate_process/wire_testing.hpp"

namespace surefoot::gate_process {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;
namespace websocket = beast::websocket;
using beast::error_code;
using tcp = net::ip::tcp;
using testing::ScriptedGate;

const std::string kToken = testing::three_tokens().operator_;
const std::string kRider = testing::three_tokens().rider;

ServerConfig any_port() {
    ServerConfig config;
    config.port = 0;
    return config;
}

/// A server on its own thread; its gate can be examined after it has ended.
class Service {
  public:
    explicit Service(const ServerConfig& config = any_port())
        : server_(std::move(
              WebsocketServer::open(config, gate, [this](std::int64_t) { look(); }).value())),
          thread_([this] { server_->run(); }) {}
    Service(const Service&) = delete;
    Service& operator=(const Service&) = delete;
    ~Service() { end(); }

    void end() {
        if (!thread_.joinable()) return;
        server_->stop();
        thread_.join();
        look();
    }
    [[nodiscard]] tcp::endpoint endpoint() const {
        return {net::ip::make_address("127.0.0.1"), server_->port()};
    }
    /// The counts at the last tick.
    [[nodiscard]] ServerCounts counts() {
        const std::lock_guard lock(mutex_);
        return counts_;
    }
    /// Waits for this many accepted connections, no pending ones, and this many clients.
    void wait_for(std::uint64_t accepted, std::size_t clients) {
        for (ServerCounts now = counts();
             now.accepted != accepted || now.clients != clients || now.handshakes != 0;
             now = counts())
            std::this_thread::yield();
    }

    ScriptedGate gate;
    std::atomic<int> ticks = 0;

  private:
    void look() {
        ++ticks;
        const std::lock_guard lock(mutex_);
        counts_ = server_->counts();
    }

    std::mutex mutex_;
    ServerCounts counts_;
    std::unique_ptr<WebsocketServer> server_;
    std::thread thread_;
};

/// A client that follows the protocol until it writes to the bare socket.
class Client {
  public:
    explicit Client(const Service& service) { socket().connect(service.endpoint()); }
    explicit Client(const Service& service, const std::string& target, const std::string& origin)
        : Client(service) {
        open(target, origin);
    }

    void open(const std::string& target = "/", const std::string& origin = "") {
        ws_.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
            if (!origin.empty()) request.set(http::field::origin, origin);
            if (!authorization_.empty()) request.set(http::field::authorization, authorization_);
        }));
        ws_.handshake("127.0.0.1", target);
    }
    /// Call it before `open`.
    void authorize(const std::string& header) { authorization_ = header; }
    void send(const std::string& text) { ws_.write(net::buffer(text)); }
    Json receive() {
        beast::flat_buffer buffer;
        ws_.read(buffer);
        return Json::parse(beast::buffers_to_string(buffer.data()));
    }
    Json ask(const std::string& text) {
        send(text);
        return receive();
    }
    /// Reads until the connection ends. Returns the close code, or 0.
    int end_of_reading() {
        error_code error;
        while (!error) {
            beast::flat_buffer buffer;
            ws_.read(buffer, error);
        }
        return error == websocket::error::closed ? ws_.reason().code : 0;
    }
    /// The close code, even if the server did not wait for the client's close frame.
    int goodbye() {
        (void)end_of_reading();
        return ws_.reason().code;
    }
    void send_bytes(const std::string& bytes) {
        error_code ignored;
        net::write(socket(), net::buffer(bytes), ignored);
    }
    /// Reads everything that still arrives, without answering.
    std::string read_bytes() {
        std::string bytes;
        error_code error;
        net::read(socket(), net::dynamic_buffer(bytes), error);
        return bytes;
    }
    tcp::socket& socket() { return ws_.next_layer(); }
    websocket::stream<tcp::socket>& ws() { return ws_; }

  private:
    net::io_context io_;
    std::string authorization_;
    websocket::stream<tcp::socket> ws_{io_};
};

const char* const kStep = R"({"op":"call_service","id":"q","service":"/step","args":[9]})";

void expect_allowed(Client& client) {
    const Json response = client.ask(kStep);
    EXPECT_EQ(response["values"]["resultCode"], 0) << response;
}

http::response<http::string_body> answer_to(const Service& service,
                                            const http::request<http::empty_body>& request) {
    net::io_context io;
    tcp::socket socket(io);
    socket.connect(service.endpoint());
    http::write(socket, request);
    beast::flat_buffer buffer;
    http::response_parser<http::string_body> parser;
    parser.skip(request.find(http::field::upgrade) != request.end());
    http::read(socket, buffer, parser);
    return parser.release();
}

http::response<http::string_body> get(const Service& service,
                                      const std::string& target,
                                      http::verb verb = http::verb::get) {
    return answer_to(service, {verb, target, 11});
}

/// The HTTP status; 101 if a WebSocket opens.
unsigned status_of_upgrade(const Service& service,
                           const std::string& target,
                           const std::string& origin = "") {
    http::request<http::empty_body> request(http::verb::get, target, 11);
    request.set(http::field::host, "127.0.0.1");
    request.set(http::field::connection, "Upgrade");
    request.set(http::field::upgrade, "websocket");
    request.set(http::field::sec_websocket_version, "13");
    request.set(http::field::sec_websocket_key, "MDEyMzQ1Njc4OWFiY2RlZg==");
    if (!origin.empty()) request.set(http::field::origin, origin);
    return answer_to(service, request).result_int();
}

TEST(WebsocketServer, AnswersAQuestion) {
    Service service;
    Client client(service, "/", "");
    expect_allowed(client);
    EXPECT_EQ(
        client.ask(R"({"op":"call_service","id":"q","service":"/step","args":[17]})")["values"]
                                                                                     ["resultCode"],
        1);
    service.end();
    ASSERT_EQ(service.gate.questions.size(), 2U);
    EXPECT_EQ(service.gate.questions[0].connection, 1U);
    EXPECT_EQ(service.gate.forgotten, std::vector<std::uint64_t>{1});
}

TEST(WebsocketServer, EveryClientIsAConnectionOfItsOwn) {
    ServerConfig config = any_port();
    config.first_connection = 1000;
    Service service(config);
    for (std::uint64_t i = 0; i < 3; ++i) {
        Client client(service, "/", "");
        const Json response =
            client.ask(R"({"op":"call_service","id":"q","service":"/surefoot/step","args":[9]})");
        EXPECT_EQ(response["values"]["connection"], 1000 + i);
        EXPECT_EQ(response["values"]["sequence"], 1);
        client.ws().close(websocket::close_code::normal);
    }
}

TEST(WebsocketServer, DoesNotListenOutsideWithoutATokenAndTls) {
    ScriptedGate gate;
    ServerConfig config = any_port();
    config.bind_address = "0.0.0.0";
    EXPECT_FALSE(WebsocketServer::open(config, gate));
    config.access = testing::three_tokens(Role::none);
    EXPECT_FALSE(WebsocketServer::open(config, gate));
    config.insecure = kInsecureSentence;
    EXPECT_TRUE(WebsocketServer::open(config, gate));
}

TEST(WebsocketServer, APortThatIsTakenIsSaid) {
    Service service;
    ScriptedGate gate;
    ServerConfig config;
    config.port = service.endpoint().port();
    const auto server = WebsocketServer::open(config, gate);
    ASSERT_FALSE(server);
    EXPECT_NE(server.error().message.find(std::to_string(config.port)), std::string::npos);
}

TEST(WebsocketServer, TheTokenOpensTheDoor) {
    ServerConfig config = any_port();
    config.access = testing::three_tokens(Role::none);
    Service service(config);
    EXPECT_EQ(status_of_upgrade(service, "/"), 401U);
    EXPECT_EQ(status_of_upgrade(service, "/?token=operator-token-of-testt"), 401U);
    EXPECT_EQ(get(service, "/health").result_int(), 401U);
    EXPECT_EQ(get(service, "/health?token=" + kToken).result_int(), 200U);
    Client client(service, "/?token=" + kToken, "");
    expect_allowed(client);
}

TEST(WebsocketServer, PagesOfOthersStayOutside) {
    ServerConfig config = any_port();
    config.origins = {"https://clinic.example"};
    Service service(config);
    EXPECT_EQ(status_of_upgrade(service, "/", "http://evil.example"), 403U);
    EXPECT_EQ(status_of_upgrade(service, "/", "null"), 403U);
    EXPECT_EQ(status_of_upgrade(service, "/", "http://localhost:8080"), 101U);
    EXPECT_EQ(status_of_upgrade(service, "/", "https://clinic.example"), 101U);
}

TEST(WebsocketServer, HealthWithoutAWebSocket) {
    Service service;
    const auto response = get(service, "/health");
    EXPECT_EQ(response.result_int(), 200U);
    EXPECT_EQ(Json::parse(response.body())["state"], "READY");
    EXPECT_EQ(get(service, "/").result_int(), 426U);
    EXPECT_EQ(get(service, "/healthy").result_int(), 404U);
    EXPECT_EQ(get(service, "/../etc/passwd").result_int(), 404U);
    EXPECT_EQ(get(service, "/health", http::verb::delete_).result_int(), 404U);
}

TEST(WebsocketServer, RequestsThatAreNoneEnd) {
    ServerConfig config = any_port();
    config.handshake_ms = 100;
    Service service(config);
    Client other(service, "/", "");
    for (const std::string& bytes :
         {std::string(),
          std::string("\0\1\2", 3),
          std::string("GET / HTTP/1.1\r\nHost: x\r\n"),
          std::string("GET / HTTP/1.1\r\n") + "a: " + std::string(20'000, 'b'),
          std::string("POST /health HTTP/1.1\r\nContent-Length: 9999999\r\n\r\nabc")}) {
        Client client(service);
        client.send_bytes(bytes);
        (void)client.read_bytes();  // returns: the server closed
    }
    expect_allowed(other);
}

TEST(WebsocketServer, SubscribersHearOfVerdictsAndHealth) {
    Service service;
    Client listener(service, "/", "");
    Client asker(service, "/", "");
    listener.send(R"({"op":"subscribe","topic":"/surefoot/health"})");
    for (int i = 0; i < 3; ++i) {
        const Json message = listener.receive();
        EXPECT_EQ(message["topic"], "/surefoot/health");
        EXPECT_EQ(message["msg"]["state"], "READY");
    }
    listener.send(R"({"op":"unsubscribe","topic":"/surefoot/health"})");
    listener.send(R"({"op":"subscribe","topic":"/surefoot/verdict"})");
    // The answer to its own question proves that the subscription was read. The answer comes first,
    // although its verdict is also a message to this client.
    Json message = listener.ask(kStep);
    while (message["topic"] == "/surefoot/health") message = listener.receive();
    EXPECT_EQ(message["op"], "service_response");
    EXPECT_EQ(listener.receive()["msg"]["connection"], 1);
    expect_allowed(asker);
    EXPECT_EQ(listener.receive()["msg"]["connection"], 2);
}

TEST(WebsocketServer, TheOutlookComesToWhoSubscribesAndOnlyWhileTheyDo) {
    Service service;
    Client listener(service, "/", "");
    listener.send(R"({"op":"subscribe","topic":"/surefoot/outlook","type":"surefoot/Outlook"})");
    for (int i = 0; i < 2; ++i) {
        const Json message = listener.receive();
        EXPECT_EQ(message["topic"], "/surefoot/outlook");
        EXPECT_EQ(message["msg"]["verdicts"].size(), 3U);
    }
    listener.send(R"({"op":"unsubscribe","topic":"/surefoot/outlook"})");
    while (listener.ask(kStep)["op"] != "service_response") {
    }
    const int ticks = service.ticks;
    while (service.ticks < ticks + 2) std::this_thread::yield();
    service.end();
    const std::size_t looks = service.gate.looked_at.size();
    EXPECT_GE(looks, 6U);
    EXPECT_LE(looks, 9U) << "two rounds, and what was left of a third";
}

/// The server's end of a client's connection; both are in this process.
int server_end_of(const tcp::socket& client) {
    const tcp::endpoint wanted = client.local_endpoint();
    constexpr int kMostHandles = 1024;
    for (int handle = 0; handle < kMostHandles; ++handle) {
        tcp::endpoint peer;
        socklen_t length = static_cast<socklen_t>(peer.capacity());
        if (::getpeername(handle, peer.data(), &length) == 0 && peer == wanted) return handle;
    }
    return -1;
}

/// The tick's hook sends a question to the server that calls it: its bytes are in the socket when
/// the server computes the outlook.
TEST(WebsocketServer, AQuestionThatWaitsGoesBeforeTheOutlook) {
    ScriptedGate gate;
    std::function<void()> hook;
    const auto server = std::move(WebsocketServer::open(any_port(), gate, [&](std::int64_t) {
                                      if (hook) hook();
                                  }).value());
    net::io_context io;
    websocket::stream<tcp::socket> ws(io);
    ws.next_layer().connect({net::ip::make_address("127.0.0.1"), server->port()});
    ws.next_layer().set_option(tcp::no_delay(true));  // otherwise a second message waits for an ACK
    std::atomic<bool> done = false;
    std::thread thread([&] {
        ws.handshake("127.0.0.1", "/");
        ws.write(net::buffer(std::string(R"({"op":"subscribe","topic":"/surefoot/outlook"})")));
        done = true;
    });
    while (!done || gate.looked_at.empty()) server->poll();
    thread.join();
    pollfd arrival{server_end_of(ws.next_layer()), POLLIN, 0};
    std::size_t asked = 0;
    std::size_t looks = 0;
    bool its_turn = false;
    hook = [&] {
        // Only in every second tick: a client that asks in each tick is served before the outlook
        // only four times out of five.
        its_turn = !its_turn;
        if (!its_turn || asked != gate.questions.size()) return;
        looks = gate.looked_at.size();
        ws.write(net::buffer(std::string(kStep)));
        ASSERT_EQ(::poll(&arrival, 1, -1), 1);
        ++asked;
    };
    std::size_t answered = 0;
    while (answered < 50) {
        server->poll();
        if (gate.questions.size() == answered) continue;
        EXPECT_EQ(gate.looks_before.back(), looks) << "question " << answered;
        ++answered;
    }
}

TEST(WebsocketServer, TheOwnerIsCalledAndCounts) {
    Service service;
    Client client(service, "/", "");
    service.wait_for(1, 1);
    const int ticks = service.ticks;
    while (service.ticks < ticks + 10) std::this_thread::yield();
    client.ws().close(websocket::close_code::normal);
    service.wait_for(1, 0);
    service.end();
    EXPECT_EQ(service.counts().accepted, 1U);
    EXPECT_EQ(service.counts().refused, 0U);
    EXPECT_EQ(service.counts().dropped, 0U);
}

TEST(WebsocketServer, AMessageThatIsTooLongEndsItsConnection) {
    Service service;
    Client other(service, "/", "");
    Client client(service, "/", "");
    error_code ignored;
    client.ws().write(net::buffer(std::string(10'000'000, ' ')), ignored);
    // The server does not read ten megabytes first, so the close frame may be lost.
    const int code = client.end_of_reading();
    EXPECT_TRUE(code == websocket::close_code::too_big || code == 0) << code;
    expect_allowed(other);
    service.end();
    EXPECT_EQ(service.gate.questions.size(), 1U);
}

TEST(WebsocketServer, NonsenseGetsAStatusAndThenTheDoor) {
    ServerConfig config = any_port();
    config.session.faults = {.per_s = 1, .burst = 3};
    Service service(config);
    Client other(service, "/", "");
    Client client(service, "/", "");
    for (int i = 0; i < 3; ++i) EXPECT_EQ(client.ask("{")["op"], "status");
    EXPECT_EQ(client.ask("{")["op"], "status");
    EXPECT_EQ(client.end_of_reading(), websocket::close_code::policy_error);
    service.wait_for(2, 1);
    expect_allowed(other);
    service.end();
    EXPECT_EQ(service.counts().dropped, 1U);
    EXPECT_EQ(service.gate.forgotten.front(), 2U);
}

TEST(WebsocketServer, HalfAFrameIsNotWaitedForForEver) {
    ServerConfig config = any_port();
    config.message_ms = 50;
    Service service(config);
    Client other(service, "/", "");
    Client client(service, "/", "");
    // A masked text frame of 100 bytes; only two of them are sent.
    client.send_bytes(std::string("\x81\xe4\0\0\0\0ab", 8));
    (void)client.read_bytes();
    expect_allowed(other);
    service.end();
    EXPECT_EQ(service.counts().dropped, 1U);
}

TEST(WebsocketServer, AMessageInPiecesHasATimeAsAWhole) {
    ServerConfig config = any_port();
    config.message_ms = 50;
    Service service(config);
    Client client(service, "/", "");
    // Endless pieces of one message with pings between them: each piece is a sign of life.
    error_code error;
    client.send_bytes(std::string("\x01\x81\0\0\0\0{", 7));
    while (!error && service.counts().dropped == 0) {
        client.send_bytes(std::string("\0\x81\0\0\0\0 ", 7));
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    service.end();
    EXPECT_EQ(service.counts().dropped, 1U);
}

TEST(WebsocketServer, FramesThatBreakTheRulesEndTheirConnection) {
    Service service;
    Client other(service, "/", "");
    for (const std::string& bytes : {std::string("\x81\x01{", 3),          // not masked
                                     std::string("\x83\x81\0\0\0\0{", 7),  // opcode 3
                                     std::string("\xf1\x81\0\0\0\0{", 7),  // reserved bits
                                     std::string("\x80\x81\0\0\0\0{", 7),  // goes on from nothing
                                     std::string("\x89\xfe\0\x7e\0\0\0\0", 8),       // long ping
                                     std::string("\x81\x82\0\0\0\0\xc0\xaf", 8)}) {  // no UTF-8
        Client client(service, "/", "");
        client.send_bytes(bytes);
        (void)client.read_bytes();
        expect_allowed(other);
    }
}

TEST(WebsocketServer, WhoGivesNoSignOfLifeIsLeft) {
    ServerConfig config = any_port();
    config.idle_ms = 100;
    Service service(config);
    Client client(service, "/", "");
    const std::string bytes = client.read_bytes();
    ASSERT_FALSE(bytes.empty());
    EXPECT_EQ(bytes[0], '\x89');  // the answer to a ping
    service.end();
    EXPECT_EQ(service.gate.forgotten.size(), 1U);
}

TEST(WebsocketServer, AFloodOfPingsEndsItsConnection) {
    Service service;
    Client other(service, "/", "");
    Client client(service, "/", "");
    std::string pings;
    for (int i = 0; i < 100; ++i) pings += std::string("\x89\x80\0\0\0\0", 6);
    client.send_bytes(pings);
    (void)client.read_bytes();
    expect_allowed(other);
    service.end();
    EXPECT_EQ(service.counts().dropped, 1U);
}

TEST(WebsocketServer, WhoDoesNotReadIsLeftAndTheOthersGoOn) {
    ServerConfig config = any_port();
    config.max_queue_bytes = 64 * 1024;
    config.write_ms = 60'000;  // the queue is full before
    config.session.messages = {.per_s = 1'000'000, .burst = 1'000'000};
    Service service(config);
    Client slow(service);
    slow.socket().set_option(net::socket_base::receive_buffer_size(4096));
    slow.open();
    slow.send(R"({"op":"subscribe","topic":"/surefoot/verdict"})");
    Client client(service, "/", "");
    for (int i = 0; i < 100'000 && service.counts().dropped == 0; ++i) expect_allowed(client);
    EXPECT_EQ(service.counts().dropped, 1U);
    expect_allowed(client);
}

TEST(WebsocketServer, WhoAsksWithoutReadingIsLeft) {
    ServerConfig config = any_port();
    config.write_ms = 50;
    config.max_queue_bytes = 64 << 20;  // never full
    // Under load a client may miss the acknowledgement of its own data and stop in the middle of a
    // message. Another deadline covers this case.
    config.message_ms = 60'000;
    config.session.messages = {.per_s = 1'000'000, .burst = 1'000'000};
    Service service(config);
    Client other(service, "/", "");
    Client client(service);
    client.socket().set_option(net::socket_base::receive_buffer_size(4096));
    client.open();
    // Answers of some megabytes, more than the sockets can hold.
    const std::string question =
        R"({"op":"call_service","id":"q","service":"/surefoot/step","args":[9]})";
    error_code error;
    for (int i = 0; i < 8000 && !error; ++i) client.ws().write(net::buffer(question), error);
    while (service.counts().dropped == 0) std::this_thread::yield();
    expect_allowed(other);
}

TEST(WebsocketServer, TooManyQuestionsAreAnsweredAsErrors) {
    ServerConfig config = any_port();
    config.session.messages = {.per_s = 1, .burst = 2};
    Service service(config);
    Client client(service, "/", "");
    expect_allowed(client);
    expect_allowed(client);
    const Json response =
        client.ask(R"({"op":"call_service","id":"q","service":"/surefoot/step","args":[9]})");
    EXPECT_EQ(response["values"]["primary"], "OVERLOAD");
}

TEST(WebsocketServer, NoMoreClientsThanTheLimit) {
    ServerConfig config = any_port();
    config.slots.max_clients = 2;
    config.slots.reserved = 0;
    Service service(config);
    Client first(service, "/", "");
    {
        Client second(service, "/", "");
        expect_allowed(first);
        expect_allowed(second);
        EXPECT_EQ(status_of_upgrade(service, "/"), 503U) << "both are being served";
        second.ws().close(websocket::close_code::normal);
    }
    service.wait_for(3, 1);
    EXPECT_EQ(status_of_upgrade(service, "/"), 101U);
    expect_allowed(first);
}

SlotLimits few_slots() {
    SlotLimits slots;
    slots.max_clients = 4;
    slots.reserved = 1;
    return slots;
}

TEST(WebsocketServer, SleepersLockNobodyOut) {
    ServerConfig config = any_port();
    config.slots = few_slots();
    Service service(config);
    Client inside(service, "/", "");
    expect_allowed(inside);
    std::vector<std::unique_ptr<Client>> sleepers;
    for (int i = 0; i < 20; ++i) sleepers.push_back(std::make_unique<Client>(service, "/", ""));
    Client newcomer(service, "/", "");
    expect_allowed(newcomer);
    expect_allowed(inside);
    EXPECT_EQ(sleepers.front()->goodbye(), websocket::close_code::policy_error)
        << "it is told that its slot went to another one";
    service.end();
    EXPECT_EQ(service.counts().refused, 0U);
}

TEST(WebsocketServer, ASlotIsKeptForWhoeverShowsAToken) {
    ServerConfig config = any_port();
    config.slots = few_slots();
    config.slots.useful_ns = 3'600'000'000'000;
    config.access = testing::three_tokens();
    Service service(config);
    std::vector<std::unique_ptr<Client>> guests;
    for (int i = 0; i < 3; ++i) {
        guests.push_back(std::make_unique<Client>(service, "/", ""));
        expect_allowed(*guests.back());
    }
    EXPECT_EQ(status_of_upgrade(service, "/"), 503U);
    EXPECT_EQ(status_of_upgrade(service, "/?token=" + testing::three_tokens().observer), 503U);
    Client rider(service, "/?token=" + kRider, "");
    expect_allowed(rider);
    Client operator_(service, "/?token=" + kToken, "");
    expect_allowed(operator_);
    EXPECT_EQ(guests.front()->goodbye(), websocket::close_code::policy_error);
    expect_allowed(*guests.back());
}

TEST(WebsocketServer, ARiderWithATokenDoesNotWaitForAFloodOfGuests) {
    ServerConfig config = any_port();
    config.access = testing::three_tokens();
    config.guest_work_us = 300;  // some questions a tick
    config.session.messages = {.per_s = 100'000, .burst = 100'000};
    Service service(config);
    Client guest(service, "/", "");
    for (int i = 0; i < 2000; ++i) guest.send(kStep);
    Client rider(service, "/?token=" + kRider, "");
    for (int i = 0; i < 100; ++i) expect_allowed(rider);
    EXPECT_EQ(guest.receive()["values"]["resultCode"], 0) << "guests are served, too";
    service.end();
    const auto questions_of = [&](std::uint64_t connection) {
        return std::count_if(service.gate.questions.begin(),
                             service.gate.questions.end(),
                             [&](const StepQuestion& q) { return q.connection == connection; });
    };
    EXPECT_EQ(questions_of(2), 100);
    EXPECT_LT(questions_of(1), 2000) << "what is left waits for its turn";
}

TEST(WebsocketServer, AGuestThatAsksSeldomComesBeforeOneThatNeverStops) {
    ServerConfig config = any_port();
    config.guest_work_us = 300;  // some questions a tick
    config.session.messages = {.per_s = 100'000, .burst = 100'000};
    Service service(config);
    Client flood(service, "/", "");
    for (int i = 0; i < 2000; ++i) flood.send(kStep);
    Client seldom(service, "/", "");
    for (int i = 0; i < 5; ++i) expect_allowed(seldom);
    service.end();
    EXPECT_LT(service.gate.questions.size(), 2000U) << "the flood has not been worked off before";
}

Json call(Client& client, const std::string& service, const std::string& args = "[]") {
    return client.ask(R"({"op":"call_service","id":"c","service":")" + service + R"(","args":)" +
                      args + "}")["values"];
}

TEST(WebsocketServer, TheRoleComesWithTheConnection) {
    ServerConfig config = any_port();
    config.access = testing::three_tokens();
    Service service(config);
    Client guest(service, "/", "");
    EXPECT_EQ(call(guest, "/surefoot/attest", "[0.4]")["success"], false);
    Client observer(service, "/?token=" + testing::three_tokens().observer, "");
    EXPECT_EQ(observer.ask(kStep)["result"], false);
    Client by_url(service, "/?token=" + kToken, "");
    EXPECT_EQ(call(by_url, "/surefoot/attest", "[0.4]")["success"], true);
    Client by_header(service);
    by_header.authorize("Bearer " + kToken);
    by_header.open();
    EXPECT_EQ(call(by_header, "/surefoot/rearm")["success"], true);
    EXPECT_EQ(call(guest, "/surefoot/authenticate", R"({"token":")" + kToken + "\"}")["role"],
              "operator");
    EXPECT_EQ(call(guest, "/surefoot/attest", "[0.4]")["success"], true);
    service.end();
    const auto acts_of = [&](std::uint64_t connection) {
        std::string text;
        for (const Act& act : service.gate.acts) {
            if (act.connection == connection)
                text += std::string(to_string(act.role)) + " " + to_string(act.kind) + " " +
                        to_string(act.outcome) + ";";
        }
        return text;
    };
    EXPECT_EQ(acts_of(1), "rider attest no right;operator authenticate done;operator attest done;");
    EXPECT_EQ(acts_of(2), "observer authenticate done;observer ask no right;");
    EXPECT_EQ(acts_of(3), "operator authenticate done;operator attest done;");
    EXPECT_EQ(acts_of(4), "operator authenticate done;operator re-arm done;");
}

TEST(WebsocketServer, WhoeverIsRefusedAtTheDoorIsToldWhyAndNoted) {
    ServerConfig config = any_port();
    config.access = testing::three_tokens(Role::none);
    Service service(config);
    const auto wrong = get(service, "/health?token=0123456789abcdef");
    EXPECT_EQ(wrong.result_int(), 401U);
    EXPECT_NE(wrong.body().find("this token is not known"), std::string::npos) << wrong.body();
    const auto none = get(service, "/health");
    EXPECT_EQ(none.result_int(), 401U);
    EXPECT_NE(none.body().find("a token is needed"), std::string::npos) << none.body();
    http::request<http::empty_body> page(http::verb::get, "/health?token=" + kToken, 11);
    page.set(http::field::origin, "null");
    const auto origin = answer_to(service, page);
    EXPECT_EQ(origin.result_int(), 403U);
    EXPECT_NE(origin.body().find("--origin 'null'"), std::string::npos) << origin.body();
    service.end();
    ASSERT_EQ(service.gate.acts.size(), 3U);
    EXPECT_EQ(service.gate.acts[0].kind, ActKind::authenticate);
    EXPECT_EQ(service.gate.acts[1].kind, ActKind::connect);
    EXPECT_EQ(service.gate.acts[2].text, "from this computer, a web page of another origin");
    for (const Act& act : service.gate.acts) EXPECT_EQ(act.outcome, ActOutcome::no_right);
}

TEST(WebsocketServer, AtAFullDoorTheOldestGivesWay) {
    ServerConfig config = any_port();
    config.slots.max_handshakes = 2;
    config.handshake_ms = 60'000;
    Service service(config);
    Client oldest(service);
    Client other(service);
    Client newest(service, "/", "");
    EXPECT_EQ(oldest.read_bytes(), "");
    expect_allowed(newest);
    other.open();
    expect_allowed(other);
    service.end();
    EXPECT_EQ(service.counts().refused, 1U);
}

TEST(WebsocketServer, AThousandAtTheDoorDisturbNobody) {
    Service service;
    Client inside(service, "/", "");
    net::io_context io;
    std::vector<tcp::socket> crowd;
    for (int i = 0; i < 1000; ++i) {
        crowd.emplace_back(io);
        error_code error;
        crowd.back().connect(service.endpoint(), error);
        ASSERT_FALSE(error) << i << ": " << error.message();
        if (i % 20 == 0) expect_allowed(inside);
    }
    Client late(service, "/", "");
    expect_allowed(late);
    service.end();
    EXPECT_EQ(service.counts().accepted, 1002U);
    EXPECT_EQ(service.gate.forgotten.size(), 2U);
}

TEST(WebsocketServer, AClientThatVanishesIsForgotten) {
    Service service;
    Client other(service, "/", "");
    {
        Client client(service, "/", "");
        client.send_bytes(std::string("\x81\xbf\0\0\0\0{\"op\":", 12));
        client.socket().set_option(net::socket_base::linger(true, 0));
    }
    service.wait_for(2, 1);
    expect_allowed(other);
    service.end();
    EXPECT_EQ(service.gate.forgotten.front(), 2U);
    EXPECT_EQ(service.gate.questions.size(), 1U);
}

TEST(WebsocketServer, StopEndsEverything) {
    Service service;
    Client client(service, "/", "");
    service.end();
    EXPECT_EQ(client.end_of_reading(), 0);
    EXPECT_EQ(service.counts().clients, 0U);
}

TEST(WebsocketServer, ServesInALoopOfItsOwner) {
    ScriptedGate gate;
    const auto server = std::move(WebsocketServer::open(any_port(), gate).value());
    std::atomic<bool> done = false;
    std::thread thread([&] {
        net::io_context io;
        websocket::stream<tcp::socket> ws(io);
        ws.next_layer().connect({net::ip::make_address("127.0.0.1"), server->port()});
        ws.handshake("127.0.0.1", "/");
        ws.write(net::buffer(std::string(kStep)));
        beast::flat_buffer buffer;
        ws.read(buffer);
        done = true;
    });
    while (!done) server->poll();
    thread.join();
    EXPECT_EQ(gate.questions.size(), 1U);
}

}  // namespace
}  // namespace surefoot::gate_process

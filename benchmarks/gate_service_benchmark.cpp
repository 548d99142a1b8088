// SPDX-License-Identifier: Apache-2.0
// Measures how long a client of the running gate process waits for an answer while other clients
// ask and listen. Usage: gate_service_benchmark PORT QUERIES RATE_HZ OTHERS. RATE_HZ: questions per
// second, 0 = ask again as soon as the answer has arrived. OTHERS: number of other clients. Prints
// one line of JSON.
#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;
using Socket = websocket::stream<tcp::socket>;

constexpr std::string_view kQuestion =
    R"({"op":"call_service","service":"/surefoot/step","args":{"direction":9}})";

void open(Socket& socket, std::uint16_t port) {
    socket.next_layer().connect({asio::ip::make_address("127.0.0.1"), port});
    socket.next_layer().set_option(tcp::no_delay(true));
    socket.handshake("127.0.0.1", "/");
    socket.text(true);
}

/// Another client: asks three times a second, and reads two topics of at most five messages a
/// second each.
class Other {
  public:
    static constexpr std::chrono::milliseconds kPeriod{333};

    Other(asio::io_context& io, std::uint16_t port, int number, std::uint64_t& received)
        : socket_(io), timer_(io), received_(received) {
        open(socket_, port);
        for (const char* topic : {"/surefoot/verdict", "/surefoot/health"}) {
            const std::string text =
                R"({"op":"subscribe","throttle_rate":200,"topic":")" + std::string(topic) + R"("})";
            socket_.write(asio::buffer(text));
        }
        next_ = Clock::now() + kPeriod * number / 50;
        read();
        wait();
    }

  private:
    void read() {
        socket_.async_read(buffer_, [this](error_code error, std::size_t) {
            if (error) return;
            ++received_;
            buffer_.clear();
            read();
        });
    }
    void wait() {
        timer_.expires_at(next_);
        next_ += kPeriod;
        timer_.async_wait([this](error_code error) {
            if (!error) ask();
        });
    }
    void ask() {
        socket_.async_write(asio::buffer(kQuestion), [this](error_code error, std::size_t) {
            if (!error) wait();
        });
    }

    Socket socket_;
    asio::steady_timer timer_;
    beast::flat_buffer buffer_;
    Clock::time_point next_;
    std::uint64_t& received_;
};

/// The client whose waiting time is measured.
class Measured {
  public:
    explicit Measured(std::uint16_t port) { open(socket_, port); }

    /// Asks one question. Returns the milliseconds from before the sending to after the reading of
    /// the answer.
    double ask() {
        begin_ = Clock::now();
        socket_.write(asio::buffer(kQuestion));
        buffer_.clear();
        socket_.read(buffer_);
        const std::chrono::duration<double, std::milli> took = Clock::now() - begin_;
        answer_ = beast::buffers_to_string(buffer_.data());
        return took.count();
    }
    [[nodiscard]] bool was_ok() const {
        return answer_.find(R"("verdict":"OK")") != std::string::npos;
    }
    /// Milliseconds from the sending of the last question until the gate decided, by the steady
    /// clock that both processes share.
    [[nodiscard]] double to_gate_ms() const {
        constexpr std::string_view kKey = R"("decided_ns":")";
        const auto at = answer_.find(kKey);
        if (at == std::string::npos) throw std::runtime_error("an answer has no decided_ns");
        const std::chrono::nanoseconds decided(std::stoll(answer_.substr(at + kKey.size())));
        const std::chrono::duration<double, std::milli> took = decided - begin_.time_since_epoch();
        return took.count();
    }

  private:
    asio::io_context io_;
    Socket socket_{io_};
    beast::flat_buffer buffer_;
    Clock::time_point begin_;
    std::string answer_;
};

void wait_for_ok(Measured& client) {
    for (int i = 0; i < 3000; ++i) {
        client.ask();
        if (client.was_ok()) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    throw std::runtime_error("the gate gave no OK within a minute");
}

struct Measurement {
    std::vector<double> times_ms;    ///< sorted
    std::vector<double> to_gate_ms;  ///< sorted: part of the time before the gate decided
    int ok = 0;
};

/// `rate_hz` 0 = ask the next question as soon as the answer has arrived. A question that is late
/// because the previous one took long is asked at once.
Measurement measure(Measured& client, int queries, double rate_hz) {
    Measurement found;
    found.times_ms.reserve(static_cast<std::size_t>(queries));
    const auto begin = Clock::now();
    for (int i = 0; i < queries; ++i) {
        if (rate_hz > 0.0)
            std::this_thread::sleep_until(begin + std::chrono::duration_cast<Clock::duration>(
                                                      std::chrono::duration<double>(i / rate_hz)));
        found.times_ms.push_back(client.ask());
        found.to_gate_ms.push_back(client.to_gate_ms());
        if (client.was_ok()) ++found.ok;
    }
    std::sort(found.times_ms.begin(), found.times_ms.end());
    std::sort(found.to_gate_ms.begin(), found.to_gate_ms.end());
    return found;
}

/// The percentile of the sorted times: `share` of the times are not longer.
double at(const std::vector<double>& sorted, double share) {
    const auto rank =
        static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
    return sorted[std::min(rank == 0 ? 0 : rank - 1, sorted.size() - 1)];
}

int run(std::uint16_t port, int queries, double rate_hz, int others) {
    Measured client(port);
    wait_for_ok(client);
    asio::io_context io;
    std::uint64_t received = 0;
    std::vector<std::unique_ptr<Other>> crowd;
    crowd.reserve(static_cast<std::size_t>(others));
    for (int i = 0; i < others; ++i)
        crowd.push_back(std::make_unique<Other>(io, port, i, received));
    std::thread crowd_thread([&io] { io.run(); });
    const Measurement found = measure(client, queries, rate_hz);
    std::array<double, 3> load{};
    if (::getloadavg(load.data(), static_cast<int>(load.size())) < 1) load[0] = -1.0;
    io.stop();
    crowd_thread.join();
    std::printf(
        "{\"queries\": %d, \"rate_hz\": %g, \"others\": %d, \"p50_ms\": %.3f, \"p99_ms\": %.3f, "
        "\"p999_ms\": %.3f, \"max_ms\": %.3f, \"to_gate_p99_ms\": %.3f, "
        "\"to_gate_p999_ms\": %.3f, \"ok\": %d, \"received_by_others\": %llu, "
        "\"load_average\": %.1f}\n",
        queries,
        rate_hz,
        others,
        at(found.times_ms, 0.5),
        at(found.times_ms, 0.99),
        at(found.times_ms, 0.999),
        found.times_ms.back(),
        at(found.to_gate_ms, 0.99),
        at(found.to_gate_ms, 0.999),
        found.ok,
        static_cast<unsigned long long>(received),
        load[0]);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 5) {
        std::fputs("usage: gate_service_benchmark PORT QUERIES RATE_HZ OTHERS\n", stderr);
        return 2;
    }
    try {
        const int queries = std::atoi(argv[2]);
        if (queries < 1) throw std::invalid_argument("QUERIES must be at least 1");
        return run(static_cast<std::uint16_t>(std::atoi(argv[1])),
                   queries,
                   std::atof(argv[3]),
                   std::atoi(argv[4]));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "gate_service_benchmark: %s\n", error.what());
        return 1;
    }
}

// SPDX-License-Identifier: Apache-2.0
// Any bytes to the server over a loopback socket: as they are, after a handshake, or cut into
// masked frames. The client then stops sending. The server must close and forget the connection,
// and say OK at most as often as the gate.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "fuzz/must.hpp"
#include "service/gate_process/sockets/websocket_server.hpp"
#include "service/gate_process/wire_testing.hpp"

namespace {

using namespace surefoot;
using namespace surefoot::gate_process;

const char* const kHandshake =
    "GET / HTTP/1.1\r\nHost: x\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\n\r\n";

/// Server and gate, created once. No state of a connection may remain after it.
struct Rig {
    Rig() {
        ServerConfig config;
        config.port = 0;
        config.accepts_per_tick = 1'000'000;
        config.door_work_us = config.guest_work_us = 1'000'000'000;
        config.session.json.max_bytes = 4096;
        server = std::move(WebsocketServer::open(config, gate).value());
    }
    testing::ScriptedGate gate;
    std::unique_ptr<WebsocketServer> server;
};

/// Connects from a new address of 127/8 each time, because one address runs out of ports.
int connect_from(std::uint32_t number, std::uint16_t port) {
    const int handle = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in from{};
    from.sin_family = AF_INET;
    from.sin_addr.s_addr = htonl((127U << 24U) + 2U + number % 60'000U);
    sockaddr_in to = from;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(port);
    if (bind(handle, reinterpret_cast<const sockaddr*>(&from), sizeof(from)) == 0 &&
        connect(handle, reinterpret_cast<const sockaddr*>(&to), sizeof(to)) == 0)
        return handle;
    close(handle);
    return -1;
}

/// Retries, because the system may lack resources for a moment. A server that accepts no connection
/// any more is a finding.
int connect_to(std::uint16_t port) {
    static std::uint32_t number = 0;
    constexpr int kTries = 500;
    constexpr useconds_t kPause_us = 10'000;
    for (int i = 0; i < kTries; ++i) {
        const int handle = connect_from(number++, port);
        if (handle >= 0) return handle;
        usleep(kPause_us);
    }
    std::perror("cannot connect to the server within five seconds");
    std::abort();
}

/// Builds frames. The bytes choose their heads: opcode and FIN in one byte, length in the next.
std::string frames_of(std::string_view bytes) {
    constexpr std::size_t kHead = 2;
    constexpr std::size_t kShort = 126;
    std::string frames;
    while (bytes.size() > kHead) {
        const auto size = std::min<std::size_t>(static_cast<std::uint8_t>(bytes[1]) % kShort,
                                                bytes.size() - kHead);
        frames += bytes[0];
        frames += static_cast<char>(0x80U | size);
        frames += std::string(4, '\0');
        frames += bytes.substr(kHead, size);
        bytes.remove_prefix(kHead + size);
    }
    return frames;
}

std::string bytes_to_send(std::uint8_t kind, std::string_view bytes) {
    switch (kind % 4) {
        case 0: return std::string(bytes);
        case 1: return kHandshake + std::string(bytes);
        case 2: return kHandshake + frames_of(bytes);
        default: {  // one long text
            std::string frame = "\x81\xfe";
            frame += static_cast<char>(bytes.size() >> 8U);
            frame += static_cast<char>(bytes.size() & 0xffU);
            return kHandshake + frame + std::string(4, '\0') + std::string(bytes);
        }
    }
}

/// Sends the bytes, stops sending, and reads until the server closes.
std::string converse(WebsocketServer& server, std::string_view bytes) {
    const int handle = connect_to(server.port());
    (void)send(handle, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    shutdown(handle, SHUT_WR);
    std::string received;
    constexpr int kPatience = 1'000'000;  // far beyond every deadline: the server hangs
    for (int i = 0;; ++i) {
        must(i != kPatience);
        server.poll();
        char part[4096];
        const ssize_t count = recv(handle, part, sizeof(part), MSG_DONTWAIT);
        if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) break;
        if (count > 0) received.append(part, static_cast<std::size_t>(count));
    }
    close(handle);
    server.poll();
    return received;
}

/// Payloads of the text frames that the service wrote itself. A pong only repeats the ping. Replies
/// to a handshake are not frames and come first.
std::string texts_of(std::string_view received) {
    const std::size_t end_of_reply = received.find("\r\n\r\n");
    if (end_of_reply == std::string_view::npos) return {};
    received.remove_prefix(end_of_reply + 4);
    std::string texts;
    while (received.size() >= 2) {
        const auto at = [&](std::size_t i) { return static_cast<std::uint8_t>(received[i]); };
        std::uint64_t size = at(1) & 0x7fU;  // a server does not mask frames
        std::size_t head = 2;
        const std::size_t more = size == 126 ? 2 : size == 127 ? 8 : 0;
        if (received.size() < head + more) break;
        if (more > 0) {
            size = 0;
            for (std::size_t i = 0; i < more; ++i) size = (size << 8U) | at(head + i);
            head += more;
        }
        const auto opcode = at(0) & 0x0fU;
        const std::string_view payload = received.substr(head, size);
        if (opcode <= 2) texts += payload;  // text, binary, and continuations
        received.remove_prefix(head + payload.size());
    }
    return texts;
}

std::size_t count_of(std::string_view text, std::string_view part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string_view::npos;
         at = text.find(part, at + 1))
        ++count;
    return count;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0 || size > 4096) return 0;
    static Rig service;
    const std::uint64_t allowed_before = service.gate.report_.allowed;
    const std::string received = texts_of(
        converse(*service.server,
                 bytes_to_send(data[0], {reinterpret_cast<const char*>(data) + 1, size - 1})));
    const std::uint64_t allowed = service.gate.report_.allowed - allowed_before;
    must(count_of(received, R"("resultCode":0)") + count_of(received, R"("result_code":0)") <=
         2 * allowed);  // one reply each, and one topic message if subscribed
    const ServerCounts counts = service.server->counts();
    must(counts.clients == 0 && counts.handshakes == 0);
    service.gate.questions.clear();
    service.gate.goals.clear();
    service.gate.rearmed.clear();
    service.gate.attested.clear();
    service.gate.forgotten.clear();
    service.gate.acts.clear();
    service.gate.last_sequence.clear();
    return 0;
}

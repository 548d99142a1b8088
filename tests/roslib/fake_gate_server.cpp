// SPDX-License-Identifier: Apache-2.0
// The service with a gate that follows the script of tests/conformance/rosbridge. Prints its port
// on one line. Serves until its standard input ends, which the parent process holds open.
#include <unistd.h>

#include <cstdio>
#include <thread>

#include "service/gate_process/sockets/websocket_server.hpp"
#include "service/gate_process/wire_testing.hpp"

int main() {
    using namespace surefoot::gate_process;
    testing::ScriptedGate gate;
    ServerConfig config;
    config.port = 0;
    config.access = testing::three_tokens();
    auto server = WebsocketServer::open(config, gate);
    if (!server) {
        std::fprintf(stderr, "%s\n", server.error().message.c_str());
        return 1;
    }
    std::printf("%u\n", static_cast<unsigned>(server.value()->port()));
    std::fflush(stdout);
    std::thread watch([&] {
        char byte = 0;
        while (read(STDIN_FILENO, &byte, 1) > 0) {
        }
        server.value()->stop();
    });
    server.value()->run();
    watch.join();
    return 0;
}

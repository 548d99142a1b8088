// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/sockets/port_holder.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace surefoot::gate_process {
namespace {

TEST(PortHolder, names_the_process_that_listens) {
    const int door = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof(address);
    ASSERT_EQ(::bind(door, reinterpret_cast<sockaddr*>(&address), length), 0);
    ASSERT_EQ(::getsockname(door, reinterpret_cast<sockaddr*>(&address), &length), 0);
    const std::uint16_t port = ntohs(address.sin_port);
    EXPECT_FALSE(holder_of_port(port)) << "bound, but it does not listen";
    ASSERT_EQ(::listen(door, 1), 0);
    const auto holder = holder_of_port(port);
    ASSERT_TRUE(holder);
    EXPECT_EQ(holder->process, ::getpid());
    EXPECT_EQ(holder->parent, ::getppid());
    EXPECT_EQ(words_of(*holder),
              "process " + std::to_string(::getpid()) + " (" + holder->name + ")");
    EXPECT_FALSE(holder->name.empty());
    const int client = ::socket(AF_INET, SOCK_STREAM, 0);
    ASSERT_EQ(::connect(client, reinterpret_cast<sockaddr*>(&address), length), 0);
    ASSERT_EQ(::getsockname(client, reinterpret_cast<sockaddr*>(&address), &length), 0);
    EXPECT_FALSE(holder_of_port(ntohs(address.sin_port))) << "connected, but it does not listen";
    ::close(client);
    ::close(door);
    EXPECT_FALSE(holder_of_port(port));
}

}  // namespace
}  // namespace surefoot::gate_process

// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/sockets/server_config.hpp"

#include <gtest/gtest.h>

#include <string>

namespace surefoot::gate_process {
namespace {

TEST(ServerAddress, LoopbackIsTheWholeNetAndOneAddress) {
    for (const char* inside : {"127.0.0.1", "127.255.0.9", "::1", "0:0:0:0:0:0:0:1"})
        EXPECT_TRUE(is_loopback_address(inside)) << inside;
    for (const char* outside :
         {"", "localhost", "128.0.0.1", "0.0.0.0", "::", "::2", "127.1", "::ffff:127.0.0.1"})
        EXPECT_FALSE(is_loopback_address(outside)) << outside;
}

TEST(ServerAddress, AnAddressIsTheWholeText) {
    const std::string more("127.0.0.1\0.evil", 15);
    EXPECT_FALSE(is_loopback_address(more)) << "a reader of C strings sees 127.0.0.1";
    ServerConfig config;
    EXPECT_FALSE(config.problem()) << *config.problem();
    config.bind_address = more;
    ASSERT_TRUE(config.problem());
    EXPECT_NE(config.problem()->find("give an IP address"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::gate_process

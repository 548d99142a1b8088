// SPDX-License-Identifier: Apache-2.0
#include "surefoot/core/fnv1a.hpp"

#include <gtest/gtest.h>

namespace surefoot {
namespace {

static_assert(fnv1a("a") == 0xaf63dc4c8601ec8cULL, "test vector of the authors");

TEST(Fnv1a, GivesTheTestVectorsOfItsAuthors) {
    EXPECT_EQ(fnv1a(""), 0xcbf29ce484222325ULL);
    EXPECT_EQ(fnv1a("foobar"), 0x85944171f73967e8ULL);
}

TEST(Fnv1a, GoesOnWhereItStopped) {
    EXPECT_EQ(fnv1a("bar", fnv1a("foo")), fnv1a("foobar"));
}

}  // namespace
}  // namespace surefoot

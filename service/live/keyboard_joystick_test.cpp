// SPDX-License-Identifier: Apache-2.0
#include "service/live/keyboard_joystick.hpp"

#include <gtest/gtest.h>

namespace surefoot::app {
namespace {

TEST(KeyReader, KnowsItsKeys) {
    const std::pair<const char*, int> keys[] = {{"w", 9},
                                                {"a", 21},
                                                {"s", 17},
                                                {"d", 13},
                                                {"q", 25},
                                                {"e", 26},
                                                {"\x1b[A", 9},
                                                {"\x1b[B", 17},
                                                {"\x1b[C", 13},
                                                {"\x1b[D", 21},
                                                {" ", 0}};
    KeyReader reader;
    EXPECT_EQ(reader.code(), 0);
    for (const auto& [bytes, code] : keys) {
        reader.read(bytes);
        EXPECT_EQ(int{reader.code()}, code) << bytes;
        EXPECT_FALSE(reader.finished());
    }
}

TEST(KeyReader, OtherKeysChangeNothingAndArrowsMayComeInPieces) {
    KeyReader reader;
    reader.read("wz1\n\x1bz");
    EXPECT_EQ(reader.code(), 9);
    reader.read("\x1b");
    reader.read("[");
    EXPECT_EQ(reader.code(), 9);
    reader.read("B");
    EXPECT_EQ(reader.code(), 17);
    reader.read("\x1bz[A");
    EXPECT_EQ(reader.code(), 17);
    reader.read("\x1b[Zd");
    EXPECT_EQ(reader.code(), 13);
}

TEST(KeyReader, XAndCtrlDFinish) {
    for (const char* bytes : {"x", "\x04"}) {
        KeyReader reader;
        reader.read(bytes);
        EXPECT_TRUE(reader.finished());
    }
}

}  // namespace
}  // namespace surefoot::app

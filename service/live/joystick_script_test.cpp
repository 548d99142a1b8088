// SPDX-License-Identifier: Apache-2.0
#include "service/live/joystick_script.hpp"

#include <gtest/gtest.h>

namespace surefoot::app {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(JoystickScript, HoldsEachCodeUntilTheNextLine) {
    const auto script = parse_joystick_script("# walk\n0.5 9\n\n1.25\t17\r\n2,0\n", "s");
    ASSERT_TRUE(script) << script.error().message;
    const std::pair<std::int64_t, int> expected[] = {
        {0, 0}, {499, 0}, {500, 9}, {1249, 9}, {1250, 17}, {1999, 17}, {2000, 0}, {9000, 0}};
    for (const auto& [time_ms, code] : expected)
        EXPECT_EQ(int{code_at(script.value(), time_ms * kMs)}, code) << time_ms << " ms";
}

TEST(JoystickScript, ReadsWhatTheSimulatorWrites) {
    const auto script = parse_joystick_script(
        "time_s,end_s,command\n1.000,11.000,9\n11.000,21.000,25\n30.000,40.000,9\n", "s");
    ASSERT_TRUE(script) << script.error().message;
    const std::pair<std::int64_t, int> expected[] = {
        {999, 0}, {1000, 9}, {10'999, 9}, {11'000, 25}, {21'000, 0}, {30'000, 9}, {40'000, 0}};
    for (const auto& [time_ms, code] : expected)
        EXPECT_EQ(int{code_at(script.value(), time_ms * kMs)}, code) << time_ms << " ms";
}

TEST(JoystickScript, AnEmptyOneRests) {
    const auto script = parse_joystick_script("time_s,end_s,command\n", "s");
    ASSERT_TRUE(script);
    EXPECT_TRUE(script.value().empty());
    EXPECT_EQ(code_at(script.value(), 5), 0);
}

TEST(JoystickScript, BeginsAtZeroAtTheEarliest) {
    EXPECT_TRUE(parse_joystick_script("0 9\n", "s"));
    EXPECT_FALSE(parse_joystick_script("-0.1 9\n", "s"));
}

TEST(JoystickScript, NamesTheLineThatIsNone) {
    for (const char* line : {"1",
                             "1 2 3 4",
                             "x 9",
                             "1 x",
                             "1 256",
                             "1 -1",
                             "-1 9",
                             "nan 9",
                             "0.5 9",
                             "2 1 9",
                             "1 9.0"}) {
        const auto script = parse_joystick_script("1 9\n" + std::string(line) + "\n", "walk.txt");
        ASSERT_FALSE(script) << line;
        EXPECT_NE(script.error().message.find("walk.txt:2"), std::string::npos)
            << script.error().message;
    }
}

}  // namespace
}  // namespace surefoot::app

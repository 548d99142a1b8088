// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/expression.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace surefoot::sim {
namespace {

const NamedNumbers kNames{{"a", 3.0}, {"rise_m", 0.25}, {"zero", 0.0}};

TEST(ExpressionTest, ArithmeticFollowsTheUsualRules) {
    // All values are exact in binary.
    const std::vector<std::pair<std::string, double>> cases{
        {"2", 2.0},
        {"  -1.5e1 ", -15.0},
        {".5", 0.5},
        {"1 + 2 * a", 7.0},
        {"(1 + 2) * a", 9.0},
        {"8 - 4 - 2", 2.0},
        {"16 / 4 / 2", 2.0},
        {"16 / (4 / 2)", 8.0},
        {"-a + 1", -2.0},
        {"2 * -a", -6.0},
        {"--a", 3.0},
        {"+a - -a", 6.0},
        {"a*rise_m*2-1/(zero+4)", 1.25},
        {"((((a))))", 3.0},
    };
    for (const auto& [text, expected] : cases) {
        const auto value = evaluate(text, kNames);
        ASSERT_TRUE(value) << text << ": " << value.error().message;
        EXPECT_EQ(*value, expected) << text;
    }
}

TEST(ExpressionTest, ErrorsSayWhatIsWrongAndWhere) {
    const std::vector<std::pair<std::string, std::string>> cases{
        {"", "character 1: a number or a name is missing at the end"},
        {"1 +", "character 4: a number or a name is missing at the end"},
        {"(1 + 2", "character 7: ')' is missing"},
        {"1 2", "character 3: '2' was not expected"},
        {"1 + b", "character 5: no number is named 'b'"},
        {"* 2", "character 1: '*' was not expected"},
        {"2 % 3", "character 3: '%' was not expected"},
        {"1 / zero", "the value is not finite"},
        {"1e999", "not a number"},
        {".", "not a number"},
        {"1..2", "character 3: '.' was not expected"},
        {std::string(100, '(') + "1" + std::string(100, ')'), "nested deeper than 64"},
        {std::string(100, '-') + "1", "nested deeper than 64"},
    };
    for (const auto& [text, expected] : cases) {
        const auto value = evaluate(text, kNames);
        ASSERT_FALSE(value) << text;
        EXPECT_NE(value.error().message.find(expected), std::string::npos)
            << value.error().message << "\nshould contain: " << expected;
        EXPECT_NE(value.error().message.find("'" + text + "'"), std::string::npos);
    }
}

TEST(ExpressionTest, NamesBeginWithALetter) {
    for (const char* name : {"a", "rise_m", "_", "k2"}) EXPECT_TRUE(is_name(name)) << name;
    for (const char* text : {"", "2k", "a-b", "a b", "1"}) EXPECT_FALSE(is_name(text)) << text;
}

}  // namespace
}  // namespace surefoot::sim

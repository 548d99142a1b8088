// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/protocol/json_text.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace surefoot::gate_process {
namespace {

std::string problem_of(const std::string& text, const JsonLimits& limits = {}) {
    const auto json = parse_json(text, limits);
    return json ? "" : json.error().message;
}

TEST(JsonText, DepthIsLimitedExactly) {
    const JsonLimits limits{.max_depth = 3};
    EXPECT_EQ(problem_of("[[[1]]]", limits), "");
    EXPECT_EQ(problem_of(R"({"a":[{"b":1}]})", limits), "");
    EXPECT_EQ(problem_of("[[[[]]]]", limits), "the JSON is nested deeper than the limit of 3");
    EXPECT_EQ(problem_of(R"({"a":[{"b":{}}]})", limits),
              "the JSON is nested deeper than the limit of 3");
}

TEST(JsonText, StringsAndKeysAreLimitedExactly) {
    const JsonLimits limits{.max_string_bytes = 4};
    EXPECT_EQ(problem_of(R"({"abcd":"abcd"})", limits), "");
    EXPECT_EQ(problem_of(R"({"abcde":1})", limits), "string of 5 bytes exceeds the limit of 4");
    EXPECT_EQ(problem_of(R"(["abcde"])", limits), "string of 5 bytes exceeds the limit of 4");
}

TEST(JsonText, SizeIsLimitedExactly) {
    EXPECT_EQ(problem_of("[1]", {.max_bytes = 3}), "");
    EXPECT_EQ(problem_of("[1] ", {.max_bytes = 3}), "message of 4 bytes exceeds the limit of 3");
}

TEST(JsonText, AKeyMayComeOnceInEachObject) {
    EXPECT_EQ(problem_of(R"({"a":{"a":1},"b":[{"a":1},{"a":2}]})"), "");
    EXPECT_EQ(problem_of(R"({"a":1,"b":{},"a":2})"), "key 'a' comes twice");
    EXPECT_EQ(problem_of(R"({"a":1,"\u0061":2})"), "key 'a' comes twice");
}

TEST(JsonText, NumbersAreFinite) {
    EXPECT_EQ(problem_of("[1e308]"), "");
    for (const char* text : {"[1e309]", "[-1e999]", "[NaN]", "[Infinity]"})
        EXPECT_NE(problem_of(text), "") << text;
}

TEST(JsonText, DeepNestingIsNoStackOverflow) {
    const std::string open(60'000, '[');
    EXPECT_EQ(problem_of(open), "the JSON is nested deeper than the limit of 12");
}

}  // namespace
}  // namespace surefoot::gate_process

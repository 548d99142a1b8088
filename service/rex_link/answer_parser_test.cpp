// SPDX-License-Identifier: Apache-2.0
#include "service/rex_link/answer_parser.hpp"

#include <gtest/gtest.h>

namespace surefoot::rex_link {
namespace {

/// The gate's OK to question 17, about a step ahead.
const std::string kOk =
    R"({"op":"service_response","id":"rex:00000000deadbeef:17:9","service":"/surefoot/step",)"
    R"("result":true,"values":{"verdict":"OK","result_code":0,"reasons":[],"primary":"NONE",)"
    R"("text":"the step ahead is safe","evidence":{"worst_cell_m":[0.1,-0.2],"foot":null},)"
    R"("command":9,"sequence":17,"connection":3,"map_version":5,"config_hash":"0f","valid_for_ms":300}})";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), by);
}

/// The error's sentence, or an empty text if the answer is valid.
std::string refusal(const std::string& text) {
    const auto parsed = parse_answer(text);
    return parsed ? "" : parsed.error().message;
}

TEST(AnswerParser, ReadsAnOk) {
    const auto parsed = parse_answer(kOk);
    ASSERT_TRUE(parsed) << parsed.error().message;
    EXPECT_EQ(parsed.value().answer.nonce, 0xdeadbeefU);
    EXPECT_EQ(parsed.value().answer.sequence, 17U);
    EXPECT_EQ(parsed.value().answer.command, 9);
    EXPECT_EQ(parsed.value().answer.connection, 3U);
    EXPECT_EQ(parsed.value().answer.verdict, AnswerVerdict::ok);
    EXPECT_EQ(parsed.value().answer.valid_for_ns, 300'000'000);
    EXPECT_EQ(parsed.value().primary, "NONE");
    EXPECT_EQ(parsed.value().text, "the step ahead is safe");
}

TEST(AnswerParser, ReadsTheOtherVerdicts) {
    const std::string no =
        replaced(replaced(replaced(kOk, "\"OK\"", "\"NOT_TRAVERSABLE\""), "_code\":0", "_code\":1"),
                 "[]",
                 "[\"DROP_OFF\"]");
    ASSERT_EQ(refusal(no), "");
    EXPECT_EQ(parse_answer(no).value().answer.verdict, AnswerVerdict::not_traversable);
    const std::string error =
        replaced(replaced(replaced(kOk, "\"OK\"", "\"ERROR\""), "_code\":0", "_code\":-1"),
                 "[]",
                 "[\"NOT_READY\"]");
    ASSERT_EQ(refusal(error), "");
    EXPECT_EQ(parse_answer(error).value().answer.verdict, AnswerVerdict::error);
}

TEST(AnswerParser, EveryTruncationIsRefused) {
    for (std::size_t length = 0; length < kOk.size(); ++length)
        EXPECT_NE(refusal(kOk.substr(0, length)), "") << length;
    EXPECT_NE(refusal(kOk + kOk), "");
    EXPECT_NE(refusal(kOk + "x"), "");
}

TEST(AnswerParser, WhatContradictsItselfIsRefused) {
    const struct {
        const char *what, *by, *names;
    } cases[] = {{"service_response", "publish", "'op'"},
                 {"/surefoot/step", "/step", "'service'"},
                 {"true", "false", "'result'"},
                 {"true", "1", "'result'"},
                 {"\"verdict\":\"OK\"", "\"verdict\":\"ok\"", "'verdict'"},
                 {"\"verdict\":\"OK\"", "\"verdict\":0", "'verdict'"},
                 {"\"verdict\":\"OK\"", "\"verdict\":\"ERROR\"", "'result_code'"},
                 {"_code\":0", "_code\":1", "'result_code'"},
                 {"_code\":0", "_code\":0.0", "'result_code'"},
                 {"_code\":0", "_code\":false", "'result_code'"},
                 {"_code\":0", "_code\":256", "'result_code'"},
                 {"[]", "[\"DROP_OFF\"]", "'reasons'"},
                 {"[]", "[1]", "'reasons'"},
                 {"[]", "null", "'reasons'"},
                 {"[]", "{}", "'reasons'"},
                 {"\"sequence\":17", "\"sequence\":18", "'sequence'"},
                 {"\"sequence\":17", "\"sequence\":-17", "'sequence'"},
                 {"\"sequence\":17", "\"sequence\":17.0", "'sequence'"},
                 {"\"sequence\":17", "\"sequence\":\"17\"", "'sequence'"},
                 {"\"command\":9", "\"command\":10", "'command'"},
                 {"\"command\":9", "\"command\":265", "'command'"},
                 {"\"command\":9", "\"command\":9.0", "'command'"},
                 {"\"connection\":3", "\"connection\":0", "'connection'"},
                 {"\"connection\":3", "\"connection\":-3", "'connection'"},
                 {"\"connection\":3", "\"connection\":3.5", "'connection'"},
                 {"_ms\":300", "_ms\":-1", "'valid_for_ms'"},
                 {"_ms\":300", "_ms\":60001", "'valid_for_ms'"},
                 {"_ms\":300", "_ms\":1e2", "'valid_for_ms'"},
                 {"_ms\":300", "_ms\":18446744073709551616", "'valid_for_ms'"},
                 {"\"NONE\"", "7", "'primary'"},
                 {"the step", "\\u001b[2J", "'text'"},
                 {"the step", "\\u007f", "'text'"},
                 {"rex:", "sol:", "'id'"},
                 {"deadbeef", "DEADBEEF", "'id'"},
                 {":17:9", ":17:09", "'id'"},
                 {":17:9", ":+17:9", "'id'"},
                 {":17:9", ":17", "'id'"},
                 {":17:9", ":17:265", "'id'"},
                 {":17:9", "", "'id'"},
                 {"deadbeef:17:9", "dead", "'id'"},
                 {"\"rex:00000000deadbeef:17:9\"", "17", "'id'"}};
    for (const auto& c : cases) {
        const std::string said = refusal(replaced(kOk, c.what, c.by));
        EXPECT_NE(said.find(c.names), std::string::npos)
            << c.what << " -> " << c.by << ": " << said;
    }
}

TEST(AnswerParser, EveryFieldIsNeeded) {
    for (const char* name : {"op",
                             "id",
                             "service",
                             "result",
                             "values",
                             "verdict",
                             "result_code",
                             "reasons",
                             "primary",
                             "text",
                             "command",
                             "sequence",
                             "connection",
                             "valid_for_ms"}) {
        const std::string quoted = "\"" + std::string(name) + "\"";
        EXPECT_NE(refusal(replaced(kOk, quoted, "\"x\"")), "") << name;
    }
    EXPECT_EQ(refusal(replaced(kOk, "\"map_version\"", "\"x\"")), "") << "not of use to a client";
}

TEST(AnswerParser, ANameThatComesTwiceIsRefused) {
    const std::string twice =
        replaced(kOk, "\"verdict\":\"OK\"", "\"verdict\":\"ERROR\",\"verdict\":\"OK\"");
    EXPECT_NE(refusal(twice).find("twice"), std::string::npos);
    EXPECT_NE(refusal(replaced(kOk, "{\"op\"", "{\"op\":\"status\",\"op\"")), "");
}

TEST(AnswerParser, WhatIsNoObjectOrTooLargeIsRefused) {
    for (const char* text : {"", "null", "[]", "17", "\"OK\"", "{}", "{\"values\":{}}", "\xff\xfe"})
        EXPECT_NE(refusal(text), "") << text;
    EXPECT_NE(refusal("[]").find("not a JSON object"), std::string::npos);
    EXPECT_NE(refusal(replaced(kOk, "[0.1,-0.2]", "[[[[[[[[[[1]]]]]]]]]]")), "");
    EXPECT_NE(refusal(replaced(kOk, "the step", "\xc3\x28")), "") << "no UTF-8";
    const std::string long_text(kLongestAnswer_bytes, 'a');
    EXPECT_NE(refusal(replaced(kOk, "the step", long_text)).find("exceed the limit"),
              std::string::npos);
    const std::string fits(kLongestAnswer_bytes - kOk.size(), ' ');
    EXPECT_EQ(refusal(kOk + fits), "");
}

TEST(AnswerParser, AQuestionNamesItselfInItsId) {
    EXPECT_EQ(format_question(0xdeadbeef, {17, 9}),
              R"({"op":"call_service","id":"rex:00000000deadbeef:17:9","service":"/surefoot/step",)"
              R"("args":{"direction":9,"sequence":17}})");
}

}  // namespace
}  // namespace surefoot::rex_link

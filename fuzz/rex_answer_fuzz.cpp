// SPDX-License-Identifier: Apache-2.0
// Bytes from the network never become an OK that the gate did not send. The parser gives an answer
// within its ranges or an error with a message. It refuses a truncated text. A waiting link does
// not accept a damaged refusal, or a damaged answer to another client, as OK.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "fuzz/must.hpp"
#include "service/rex_link/answer_parser.hpp"
#include "service/rex_link/rex_link.hpp"

namespace {

using namespace surefoot;
using namespace surefoot::rex_link;

constexpr std::uint64_t kNonce = 0x5eed5eed5eed5eedULL;

std::string answer_text(const char* nonce, const char* verdict, const char* reasons, int code) {
    return std::string(R"({"id":"rex:)") + nonce +
           R"(:1:9","op":"service_response","result":true,"service":"/surefoot/step","values":)"
           R"({"command":9,"connection":3,"primary":"NONE","reasons":[)" +
           reasons + R"(],"result_code":)" + std::to_string(code) +
           R"(,"sequence":1,"text":"so it is","valid_for_ms":300,"verdict":")" + verdict + "\"}}";
}

/// Whether a link that waits for the answer to its first question (sequence 1) accepts the bytes as
/// OK.
bool is_taken_for_ok(std::string_view bytes) {
    RexLink link{RexLinkConfig{}};
    (void)link.connected(kNonce, 0);
    (void)link.joystick(9, 1'000'000'000);
    const auto parsed = parse_answer(bytes);
    const Actions actions = parsed ? link.answer(parsed.value().answer, 1'001'000'000)
                                   : link.damaged_answer(1'001'000'000);
    must(!actions.motion);
    return link.state() == LinkState::acknowledged;
}

void any_bytes(std::string_view bytes) {
    const auto parsed = parse_answer(bytes);
    must_explain(parsed);
    if (!parsed) return;
    const Answer& answer = parsed.value().answer;
    must(answer.connection != 0);
    must(answer.valid_for_ns >= 0 && answer.valid_for_ns <= 60'000'000'000);
    const std::string_view whole = bytes.substr(0, bytes.find_last_of('}') + 1);
    for (std::size_t cut = 1; cut <= std::min<std::size_t>(whole.size(), 40); ++cut)
        must(!parse_answer(whole.substr(0, whole.size() - cut)));
}

/// Replaces, deletes or inserts up to three bytes (three choices each), then may truncate the text.
std::string damaged(std::string text, std::string_view choices) {
    for (int i = 0; i < 3 && choices.size() >= 4 && !text.empty(); ++i, choices.remove_prefix(4)) {
        const auto number = [&](std::size_t at) {
            return static_cast<std::size_t>(static_cast<unsigned char>(choices[at]));
        };
        const std::size_t at = (256 * number(0) + number(1)) % text.size();
        switch (number(2) % 4) {
            case 0: text[at] = choices[3]; break;
            case 1: text.erase(at, 1); break;
            case 2: text.insert(at, 1, choices[3]); break;
            default: text.resize(at); break;
        }
    }
    return text;
}

void damaged_answers(std::string_view choices) {
    static const std::string no =
        answer_text("5eed5eed5eed5eed", "NOT_TRAVERSABLE", "\"DROP_OFF\"", 1);
    static const std::string error = answer_text("5eed5eed5eed5eed", "ERROR", "\"BLIND\"", -1);
    static const std::string others = answer_text("0123456789abcdef", "OK", "", 0);
    static const std::string ok = answer_text("5eed5eed5eed5eed", "OK", "", 0);
    must(is_taken_for_ok(ok));  // precondition of the checks below
    for (const std::string* text : {&no, &error, &others})
        must(!is_taken_for_ok(damaged(*text, choices)));
    const std::string text = damaged(ok, choices);
    if (text.size() + 3 < ok.size()) must(!is_taken_for_ok(text));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    if (bytes[0] % 2 == 0) {
        damaged_answers(bytes.substr(1));
    } else {
        any_bytes(bytes.substr(1));
    }
    return 0;
}

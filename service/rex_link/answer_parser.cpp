// SPDX-License-Identifier: Apache-2.0
// In this module, only this file includes nlohmann-json: it adds 6 s of compile time to each
// translation unit.
#include "service/rex_link/answer_parser.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <vector>

namespace surefoot::rex_link {
namespace {

using Json = nlohmann::json;

constexpr int kDeepest = 8;  // most levels of nested JSON; the gate uses fewer
constexpr std::int64_t kNsPerMs = 1'000'000;
constexpr std::int64_t kLongestLife_ms = 60'000;

/// Finds duplicate names in an object, and JSON with more than kDeepest levels. Duplicate names
/// must be refused: two readers of one text could read two different verdicts.
class Shape {
  public:
    bool operator()(int depth, Json::parse_event_t event, const Json& parsed) {
        if (depth > kDeepest) sound_ = false;
        if (event == Json::parse_event_t::object_start) names_.emplace_back();
        if (event == Json::parse_event_t::object_end) names_.pop_back();
        if (event == Json::parse_event_t::key)
            sound_ = names_.back().insert(parsed.get<std::string>()).second && sound_;
        return true;
    }
    [[nodiscard]] bool sound() const noexcept { return sound_; }

  private:
    std::vector<std::set<std::string>> names_;
    bool sound_ = true;
};

Error missing(const char* name, const char* what) {
    return input_error(fmt::format("answer: '{}' is not {}", name, what));
}

const Json* find(const Json& object, const char* name) {
    const auto found = object.find(name);
    return found == object.end() ? nullptr : &*found;
}

bool is_text(const Json* value, const char* text) {
    return value != nullptr && value->is_string() && value->get_ref<const std::string&>() == text;
}

/// Returns the text if it has no control characters, so that a terminal can show it; else empty.
std::optional<std::string> printable(const Json* value) {
    if (value == nullptr || !value->is_string()) return std::nullopt;
    const auto& text = value->get_ref<const std::string&>();
    const bool has_control = std::any_of(text.begin(), text.end(), [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return byte < 0x20 || byte == 0x7f;
    });
    if (has_control) return std::nullopt;
    return text;
}

template <typename T>
bool begins_with_number(std::string_view text, int base, T& value) {
    return std::from_chars(text.data(), text.data() + text.size(), value, base).ec == std::errc();
}

std::string format_id(std::uint64_t nonce, const Question& question) {
    return fmt::format("rex:{:016x}:{}:{}", nonce, question.sequence, question.command);
}

/// Reads the question from an id. The values must give exactly the same id when formatted.
bool read_id(const std::string& id, Answer& answer) {
    const std::string_view text = id;
    constexpr std::size_t kNonceAt = 4, kSequenceAt = 21;
    if (text.size() < kSequenceAt) return false;
    return begins_with_number(text.substr(kNonceAt, 16), 16, answer.nonce) &&
           begins_with_number(text.substr(kSequenceAt), 10, answer.sequence) &&
           begins_with_number(text.substr(text.rfind(':') + 1), 10, answer.command) &&
           format_id(answer.nonce, {answer.sequence, answer.command}) == id;
}

/// Returns the resultCode of a verdict for stepQuery in the reference thesis (Lange 2016).
int result_code_of(AnswerVerdict verdict) {
    switch (verdict) {
        case AnswerVerdict::ok: return 0;
        case AnswerVerdict::not_traversable: return 1;
        case AnswerVerdict::error: return -1;
    }
    return -1;
}
constexpr std::array kVerdicts = {
    AnswerVerdict::ok, AnswerVerdict::not_traversable, AnswerVerdict::error};

Status read_verdict(const Json& values, Answer& answer) {
    const Json* verdict = find(values, "verdict");
    const auto* const known =
        std::find_if(kVerdicts.begin(), kVerdicts.end(), [verdict](AnswerVerdict candidate) {
            return is_text(verdict, to_string(candidate));
        });
    if (known == kVerdicts.end()) return missing("verdict", "OK, NOT_TRAVERSABLE or ERROR");
    const Json* code = find(values, "result_code");
    if (code == nullptr || !code->is_number_integer() || *code != result_code_of(*known))
        return missing("result_code", "the result code of its verdict");
    const Json* reasons = find(values, "reasons");
    const bool is_list = reasons != nullptr && reasons->is_array();
    if (!is_list || !std::all_of(reasons->begin(), reasons->end(), [](const Json& reason) {
            return reason.is_string();
        })) {
        return missing("reasons", "a list of texts");
    }
    if (reasons->empty() != (*known == AnswerVerdict::ok))
        return missing("reasons", "a list that is empty for OK and not empty for other verdicts");
    answer.verdict = *known;
    return {};
}

/// Reads the values about the question; they must agree with the id.
Status read_question(const Json& values, Answer& answer) {
    const Json* sequence = find(values, "sequence");
    if (sequence == nullptr || !sequence->is_number_unsigned() || *sequence != answer.sequence)
        return missing("sequence", "the number in the id of the answer");
    const Json* command = find(values, "command");
    if (command == nullptr || !command->is_number_unsigned() || *command != answer.command)
        return missing("command", "the number in the id of the answer");
    const Json* connection = find(values, "connection");
    if (connection == nullptr || !connection->is_number_unsigned() || *connection == 0)
        return missing("connection", "a whole number of at least 1");
    answer.connection = connection->get<std::uint64_t>();
    const Json* life = find(values, "valid_for_ms");
    if (life == nullptr || !life->is_number_unsigned() || *life > kLongestLife_ms)
        return missing("valid_for_ms", "a whole number from 0 to 60000");
    answer.valid_for_ns = life->get<std::int64_t>() * kNsPerMs;
    return {};
}

Result<ParsedAnswer> read_response(const Json& message) {
    if (!is_text(find(message, "op"), "service_response")) return missing("op", "service_response");
    if (!is_text(find(message, "service"), kStepService)) return missing("service", kStepService);
    const Json* result = find(message, "result");
    if (result == nullptr || !result->is_boolean() || !result->get<bool>())
        return missing("result", "true");
    ParsedAnswer parsed;
    const Json* id = find(message, "id");
    if (id == nullptr || !id->is_string() ||
        !read_id(id->get_ref<const std::string&>(), parsed.answer)) {
        return missing("id", "an id that this link sends");
    }
    const Json* values = find(message, "values");
    if (values == nullptr || !values->is_object()) return missing("values", "an object");
    if (auto status = read_verdict(*values, parsed.answer); !status) return status.error();
    if (auto status = read_question(*values, parsed.answer); !status) return status.error();
    const auto primary = printable(find(*values, "primary"));
    if (!primary) return missing("primary", "a printable word");
    const auto text = printable(find(*values, "text"));
    if (!text) return missing("text", "a printable sentence");
    parsed.primary = *primary;
    parsed.text = *text;
    return parsed;
}

}  // namespace

std::string format_question(std::uint64_t nonce, const Question& question) {
    return fmt::format(
        R"({{"op":"call_service","id":"{}","service":"{}","args":{{"direction":{},"sequence":{}}}}})",
        format_id(nonce, question),
        kStepService,
        question.command,
        question.sequence);
}

Result<ParsedAnswer> parse_answer(std::string_view bytes) {
    if (bytes.size() > kLongestAnswer_bytes)
        return input_error(fmt::format(
            "answer: {} bytes exceed the limit of {} bytes", bytes.size(), kLongestAnswer_bytes));
    Shape shape;
    const Json message = Json::parse(
        bytes,
        [&shape](int depth, Json::parse_event_t event, const Json& parsed) {
            return shape(depth, event, parsed);
        },
        false);
    if (message.is_discarded() || !message.is_object())
        return input_error(fmt::format("answer: its {} bytes are not a JSON object", bytes.size()));
    if (!shape.sound())
        return input_error(
            "answer: a name occurs twice, or the JSON has more than 8 nested levels");
    return read_response(message);
}

}  // namespace surefoot::rex_link

// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/protocol/json_text.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

namespace surefoot::gate_process {
namespace {

/// Checks a text without storing it, and stops at the first forbidden element. nlohmann-json
/// requires the names of the functions.
class Guard {
  public:
    explicit Guard(const JsonLimits& limits) : limits_(limits) {}

    [[nodiscard]] const std::string& problem() const { return problem_; }

    bool null() { return true; }
    bool boolean(bool /*value*/) { return true; }
    bool number_integer(std::int64_t /*value*/) { return true; }
    bool number_unsigned(std::uint64_t /*value*/) { return true; }
    bool number_float(double value, const std::string& text) {
        return std::isfinite(value) || refuse("number " + text + " is out of range");
    }
    bool string(const std::string& value) { return short_enough(value); }
    bool binary(const Json::binary_t& /*value*/) { return refuse("binary value"); }
    bool start_object(std::size_t /*size*/) {
        keys_.emplace_back();
        return shallow_enough();
    }
    bool key(const std::string& name) {
        if (!short_enough(name)) return false;
        return keys_.back().insert(name).second || refuse("key '" + name + "' comes twice");
    }
    bool end_object() {
        keys_.pop_back();
        return true;
    }
    bool start_array(std::size_t /*size*/) {
        keys_.emplace_back();
        return shallow_enough();
    }
    bool end_array() {
        keys_.pop_back();
        return true;
    }
    bool parse_error(std::size_t position,
                     const std::string& /*token*/,
                     const nlohmann::detail::exception& /*error*/) {
        return refuse("not valid JSON at byte " + std::to_string(position));
    }

  private:
    bool refuse(std::string problem) {
        problem_ = std::move(problem);
        return false;
    }
    bool short_enough(const std::string& text) {
        return text.size() <= limits_.max_string_bytes ||
               refuse("string of " + std::to_string(text.size()) + " bytes exceeds the limit of " +
                      std::to_string(limits_.max_string_bytes));
    }
    bool shallow_enough() {
        return keys_.size() <= static_cast<std::size_t>(limits_.max_depth) ||
               refuse("the JSON is nested deeper than the limit of " +
                      std::to_string(limits_.max_depth));
    }

    const JsonLimits& limits_;
    std::vector<std::set<std::string>> keys_;  // keys of the open objects and arrays
    std::string problem_;
};

}  // namespace

Result<Json> parse_json(std::string_view text, const JsonLimits& limits) {
    if (text.size() > limits.max_bytes) {
        return input_error("message of " + std::to_string(text.size()) +
                           " bytes exceeds the limit of " + std::to_string(limits.max_bytes));
    }
    Guard guard(limits);
    if (!Json::sax_parse(text.begin(), text.end(), &guard)) return input_error(guard.problem());
    Json json = Json::parse(text.begin(), text.end(), nullptr, false);
    if (json.is_discarded()) return input_error("not valid JSON");
    return Result<Json>(std::move(json));
}

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

std::string dump(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string dump_indented(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace surefoot::gate_process

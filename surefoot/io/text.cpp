// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "surefoot/core/time.hpp"

namespace surefoot::io {
namespace {

constexpr bool is_digit(char c) noexcept {
    return c >= '0' && c <= '9';
}
constexpr bool is_space(char c) noexcept {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v';
}

std::string_view without_plus(std::string_view text) noexcept {
    // from_chars does not accept '+', so remove it. "+-1" stays an error.
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
    return text;
}

std::optional<double> parse_yaml_special(std::string_view text) {
    const std::string lower = lowercase(text);
    if (lower == ".nan") return std::numeric_limits<double>::quiet_NaN();
    if (lower == ".inf") return std::numeric_limits<double>::infinity();
    if (lower == "-.inf") return -std::numeric_limits<double>::infinity();
    return std::nullopt;
}

}  // namespace

std::optional<double> parse_double(std::string_view text) noexcept {
    text = without_plus(text);
    double value = 0.0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error == std::errc{} && stop == end && !text.empty()) return value;
    if (error == std::errc::result_out_of_range && stop == end) {
        // A number too small for a double becomes zero. A number too large for a double is an
        // error.
        const bool tiny = text.find("e-") != text.npos || text.find("E-") != text.npos;
        if (tiny) return 0.0;
        return std::nullopt;
    }
    if (text.size() <= 5) return parse_yaml_special(text);
    return std::nullopt;
}

std::optional<std::int64_t> parse_int64(std::string_view text) noexcept {
    text = without_plus(text);
    std::int64_t value = 0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc{} || stop != end || text.empty()) return std::nullopt;
    return value;
}

std::optional<double> parse_value(std::string_view text) noexcept {
    // Words that databases, spreadsheets and the Windows C runtime print for a missing number.
    static constexpr std::string_view kMissing[] = {"null",
                                                    "na",
                                                    "n/a",
                                                    "#n/a",
                                                    "none",
                                                    "-nan",
                                                    "-nan(ind)",
                                                    "nan(ind)",
                                                    "1.#qnan",
                                                    "-1.#qnan",
                                                    "1.#ind",
                                                    "-1.#ind"};
    constexpr std::size_t kLongest = 9;
    if (const auto value = parse_double(text)) return value;
    if (text.empty() || text.size() > kLongest) return std::nullopt;
    const std::string lower = lowercase(text);
    for (const std::string_view word : kMissing)
        if (lower == word) return std::numeric_limits<double>::quiet_NaN();
    return std::nullopt;
}

bool has_decimal_comma(std::string_view text) noexcept {
    const std::size_t comma = text.find(',');
    if (comma == text.npos || comma + 1 == text.size() || !is_digit(text[comma + 1])) return false;
    return text.find_first_not_of("0123456789+-.,eE") == text.npos;
}

std::string why_no_number(std::string_view word) {
    if (!has_decimal_comma(word)) return quoted(word) + " is not a number";
    return quoted(word) + " has a decimal comma: write decimal points (1.5, not 1,5)";
}

std::optional<std::string> encoding_problem(std::string_view text) {
    if (!text.starts_with("\xff\xfe") && !text.starts_with("\xfe\xff")) return std::nullopt;
    return "is text in UTF-16: save it as UTF-8 or plain ASCII";
}

std::optional<std::int64_t> parse_decimal(std::string_view text, int decimals) noexcept {
    constexpr double kMax = 9.2e18;  // int64 holds 9.22e18
    std::int64_t scale = 1;
    for (int i = 0; i < decimals; ++i) scale *= 10;
    text = without_plus(text);
    const bool negative = !text.empty() && text[0] == '-';
    std::string_view digits = text.substr(negative ? 1 : 0);
    if (digits.find_first_not_of("0123456789.") != digits.npos) {  // exponent, as in KITTI
        const auto value = parse_double(text);
        if (!value) return std::nullopt;
        const double scaled = std::round(*value * static_cast<double>(scale));
        if (!(std::abs(scaled) < kMax)) return std::nullopt;
        return static_cast<std::int64_t>(scaled);  // in range, as checked
    }
    const std::size_t dot = std::min(digits.find('.'), digits.size());
    const std::string_view whole = digits.substr(0, dot);
    const std::string_view fraction = dot < digits.size() ? digits.substr(dot + 1) : "";
    if (whole.empty() && fraction.empty()) return std::nullopt;
    if (fraction.find('.') != fraction.npos) return std::nullopt;
    const auto ones = whole.empty() ? std::optional<std::int64_t>(0) : parse_int64(whole);
    if (!ones || static_cast<double>(*ones) * static_cast<double>(scale) >= kMax)
        return std::nullopt;
    std::int64_t sum = *ones * scale;
    std::int64_t unit = scale;
    const auto kept = static_cast<std::size_t>(decimals);
    for (std::size_t i = 0; i < fraction.size() && i < kept; ++i) {
        unit /= 10;
        sum += (fraction[i] - '0') * unit;
    }
    if (fraction.size() > kept && fraction[kept] >= '5') sum += 1;
    return negative ? -sum : sum;
}

std::optional<std::int64_t> parse_seconds_as_ns(std::string_view text) noexcept {
    return parse_decimal(text, 9);
}

std::string format_seconds(std::int64_t time_ns) {
    // Use unsigned, because the magnitude of the smallest int64 does not fit in int64.
    const auto magnitude =
        time_ns < 0 ? 0 - static_cast<std::uint64_t>(time_ns) : static_cast<std::uint64_t>(time_ns);
    constexpr auto kSecond = static_cast<std::uint64_t>(kNanosecondsPerSecond);
    return fmt::format(
        "{}{}.{:09}", time_ns < 0 ? "-" : "", magnitude / kSecond, magnitude % kSecond);
}

std::string format_double(double value) {
    return fmt::format("{}", value);
}

std::string_view trimmed(std::string_view text) noexcept {
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    return text;
}

std::vector<std::string_view> split(std::string_view text, std::string_view separators) {
    std::vector<std::string_view> parts;
    std::size_t begin = text.find_first_not_of(separators);
    while (begin != text.npos) {
        const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
        parts.push_back(text.substr(begin, end - begin));
        begin = text.find_first_not_of(separators, end);
    }
    return parts;
}

std::string lowercase(std::string_view text) {
    std::string lower(text);
    for (char& c : lower) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return lower;
}

std::string_view unquoted(std::string_view text) noexcept {
    const bool quotes = text.size() >= 2 && text.front() == text.back() &&
                        (text.front() == '"' || text.front() == '\'');
    return quotes ? text.substr(1, text.size() - 2) : text;
}

std::string one_word(std::string_view name) {
    std::string word(name.empty() ? "_" : name);
    for (char& c : word) {
        if (is_space(c)) c = '_';
    }
    return word;
}

std::string quoted(std::string_view value) {
    constexpr std::size_t kLongest = 40;
    std::string text;
    for (const char c : value.substr(0, kLongest)) {
        text += c >= 0x20 && c < 0x7f ? c : '?';
    }
    if (value.size() > kLongest) text += "...";
    return "'" + text + "'";
}

bool natural_less(std::string_view a, std::string_view b) noexcept {
    std::size_t i = 0;
    std::size_t j = 0;
    const auto number = [](std::string_view text, std::size_t& position) {
        std::size_t begin = position;
        while (position < text.size() && is_digit(text[position])) ++position;
        while (begin + 1 < position && text[begin] == '0') ++begin;
        return text.substr(begin, position - begin);
    };
    while (i < a.size() && j < b.size()) {
        if (is_digit(a[i]) && is_digit(b[j])) {
            const std::string_view m = number(a, i);
            const std::string_view n = number(b, j);
            if (m.size() != n.size()) return m.size() < n.size();
            if (m != n) return m < n;
        } else {
            if (a[i] != b[j]) return a[i] < b[j];
            ++i;
            ++j;
        }
    }
    if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
    return a < b;  // "01" and "1" are equal numbers; this keeps the order total
}

LineReader::LineReader(std::string_view text) noexcept : rest_(text), next_feed_(text.size() + 1) {}

std::optional<std::string_view> LineReader::next() noexcept {
    if (rest_.empty()) return std::nullopt;
    // Search for the next LF only once. Otherwise the program would search a file with CR line ends
    // to its end for every line.
    if (next_feed_ > rest_.size()) {
        const std::size_t feed = rest_.find('\n');
        next_feed_ = feed == rest_.npos ? 0 : rest_.size() - feed;
    }
    const std::size_t feed = rest_.size() - next_feed_;
    const std::size_t end = std::min(rest_.substr(0, feed).find('\r'), feed);
    std::string_view line = rest_.substr(0, end);
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
    const bool both = end + 1 == feed && feed < rest_.size();  // CR LF
    rest_.remove_prefix(std::min(end + (both ? 2 : 1), rest_.size()));
    ++number_;
    return line;
}

std::string_view WordReader::next() noexcept {
    while (!rest_.empty() && is_space(rest_.front())) rest_.remove_prefix(1);
    std::size_t end = 0;
    while (end < rest_.size() && !is_space(rest_[end])) ++end;
    const std::string_view word = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return word;
}

}  // namespace surefoot::io

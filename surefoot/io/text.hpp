// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Reads numbers and lines of text files, independent of the locale.
namespace surefoot::io {

/// Parses the whole text as a number (also '+1', nan, inf, .nan and .inf); otherwise no value.
[[nodiscard]] std::optional<double> parse_double(std::string_view text) noexcept;
/// Parses the whole text as a decimal integer; no value otherwise, also on overflow.
[[nodiscard]] std::optional<std::int64_t> parse_int64(std::string_view text) noexcept;

/// Parses a number of a data file. Common words for a missing value ("null", "na", "n/a", "none",
/// "-nan(ind)", "1.#QNAN") become NaN.
[[nodiscard]] std::optional<double> parse_value(std::string_view text) noexcept;
/// Returns true for a decimal comma: digits with a comma among them, as in "1,5" and ",25E-01".
[[nodiscard]] bool has_decimal_comma(std::string_view text) noexcept;
/// Explains why a word of a data file is not a number; names decimal commas.
[[nodiscard]] std::string why_no_number(std::string_view word);
/// Explains why an encoding is not readable (UTF-16); no value if it is readable.
[[nodiscard]] std::optional<std::string> encoding_problem(std::string_view text);

/// Parses a decimal number times 10^`decimals` (0 to 9), rounded to the nearest whole number. Exact
/// for plain digits; an exponent goes through a double. No value for other text or above 9.2e18.
[[nodiscard]] std::optional<std::int64_t> parse_decimal(std::string_view text,
                                                        int decimals) noexcept;
/// Parses decimal seconds to nanoseconds, exact for up to 9 decimals (a double cannot hold
/// 1403715273.262142976). No value for other text or beyond +-292 years.
[[nodiscard]] std::optional<std::int64_t> parse_seconds_as_ns(std::string_view text) noexcept;
/// Formats nanoseconds as seconds with 9 decimals, exact.
[[nodiscard]] std::string format_seconds(std::int64_t time_ns);

/// Formats the shortest text that reads back to the same double.
[[nodiscard]] std::string format_double(double value);

[[nodiscard]] std::string_view trimmed(std::string_view text) noexcept;
/// Returns the non-empty parts of the text between any of the `separators`.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text,
                                                  std::string_view separators = " \t");
[[nodiscard]] std::string lowercase(std::string_view text);
/// Removes one pair of quotes (" or ') around the text.
[[nodiscard]] std::string_view unquoted(std::string_view text) noexcept;
/// Replaces white space by '_', because headers of data files need names of one word.
[[nodiscard]] std::string one_word(std::string_view name);
/// Formats a value for an error message: one line, printable, only the first 40 characters.
[[nodiscard]] std::string quoted(std::string_view value);

/// Sorts "frame2" before "frame10": runs of digits compare as numbers.
[[nodiscard]] bool natural_less(std::string_view a, std::string_view b) noexcept;

/// Reads the lines of a text without line ends (LF, CR LF or CR), counted from 1. Skips a UTF-8
/// byte order mark at the beginning of any line, because files can be concatenated.
class LineReader {
  public:
    explicit LineReader(std::string_view text) noexcept;

    [[nodiscard]] std::optional<std::string_view> next() noexcept;
    /// Returns the number of the line that `next` returned last.
    [[nodiscard]] int number() const noexcept { return number_; }
    /// Returns everything after the line that `next` returned last.
    [[nodiscard]] std::string_view rest() const noexcept { return rest_; }

  private:
    std::string_view rest_;
    std::size_t next_feed_;  ///< position of the next LF, counted from the end; 0 = no LF
    int number_ = 0;
};

/// Reads white-space separated words of a text, without copying the text.
class WordReader {
  public:
    explicit WordReader(std::string_view text) noexcept : rest_(text) {}
    /// Returns the next word, or an empty view at the end.
    [[nodiscard]] std::string_view next() noexcept;

  private:
    std::string_view rest_;
};

}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Numbers and lines of text files, the same in every locale.
namespace surefoot::io {

/// The whole text as a number (a leading '+', nan, inf, .nan and .inf are accepted), or nothing.
[[nodiscard]] std::optional<double> parse_double(std::string_view text) noexcept;
/// The whole text as a decimal integer, or nothing (overflow included).
[[nodiscard]] std::optional<std::int64_t> parse_int64(std::string_view text) noexcept;

/// A number of a data file. The words that programs write where a value is missing ("null", "na",
/// "n/a", "none", "-nan(ind)", "1.#QNAN") are NaN.
[[nodiscard]] std::optional<double> parse_value(std::string_view text) noexcept;
/// Digits with a comma among them, as in "1,5" and ",25E-01": a decimal comma.
[[nodiscard]] bool has_decimal_comma(std::string_view text) noexcept;
/// Says why a word of a data file is no number; decimal commas are named.
[[nodiscard]] std::string why_no_number(std::string_view word);
/// Says why a text cannot be read as it is encoded (UTF-16), or nothing.
[[nodiscard]] std::optional<std::string> encoding_problem(std::string_view text);

/// A decimal number times 10^`decimals` (0 to 9), rounded to the nearest whole number. Exact for
/// plain digits; an exponent goes through a double. Nothing where it is no number or above 9.2e18.
[[nodiscard]] std::optional<std::int64_t> parse_decimal(std::string_view text,
                                                        int decimals) noexcept;
/// Seconds written as a decimal number -> nanoseconds, exact for up to 9 decimals (a double cannot
/// hold 1403715273.262142976). Nothing for anything else, or beyond +-292 years.
[[nodiscard]] std::optional<std::int64_t> parse_seconds_as_ns(std::string_view text) noexcept;
/// Nanoseconds -> seconds with 9 decimals, exact.
[[nodiscard]] std::string format_seconds(std::int64_t time_ns);

/// Shortest text that reads back to the same double.
[[nodiscard]] std::string format_double(double value);

[[nodiscard]] std::string_view trimmed(std::string_view text) noexcept;
/// Non-empty parts between any of `separators`.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text,
                                                  std::string_view separators = " \t");
[[nodiscard]] std::string lowercase(std::string_view text);
/// Without one pair of quotes (" or ') around it.
[[nodiscard]] std::string_view unquoted(std::string_view text) noexcept;
/// A name without white space ('_' instead), as headers of data files need it.
[[nodiscard]] std::string one_word(std::string_view name);
/// A value as it may appear in an error message: one line, printable, at most 40 characters.
[[nodiscard]] std::string quoted(std::string_view value);

/// Sorts "frame2" before "frame10": runs of digits compare as numbers.
[[nodiscard]] bool natural_less(std::string_view a, std::string_view b) noexcept;

/// Lines of a text, without their line ends (LF, CR LF or CR), counted from 1. A byte order mark of
/// UTF-8 at the beginning of a line is stepped over: files are put one behind the other.
class LineReader {
  public:
    explicit LineReader(std::string_view text) noexcept;

    [[nodiscard]] std::optional<std::string_view> next() noexcept;
    /// Number of the line that `next` returned last.
    [[nodiscard]] int number() const noexcept { return number_; }
    /// Everything after the line that `next` returned last.
    [[nodiscard]] std::string_view rest() const noexcept { return rest_; }

  private:
    std::string_view rest_;
    std::size_t next_feed_;  ///< where the next LF is, counted from the end; 0 = there is none
    int number_ = 0;
};

/// White-space separated words of a text, without copying it.
class WordReader {
  public:
    explicit WordReader(std::string_view text) noexcept : rest_(text) {}
    /// The next word, or an empty view at the end.
    [[nodiscard]] std::string_view next() noexcept;

  private:
    std::string_view rest_;
};

}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/text.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <clocale>
#include <cmath>
#include <limits>

#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

TEST(Text, NumbersNeedTheWholeText) {
    EXPECT_EQ(parse_double("1."), 1.0);
    EXPECT_EQ(parse_double("+1.5e-3"), 1.5e-3);
    EXPECT_EQ(parse_double(".5"), 0.5);
    EXPECT_EQ(parse_double("1e-400"), 0.0);
    EXPECT_TRUE(std::isnan(*parse_double("nan")));
    EXPECT_TRUE(std::isnan(*parse_double(".NaN")));
    EXPECT_EQ(parse_double("-.inf"), -std::numeric_limits<double>::infinity());
    for (const char* bad :
         {"", "+", "-", "1,5", "1 ", " 1", "1m", "+-1", "0x10", "1e400", "1e", "--1"}) {
        EXPECT_FALSE(parse_double(bad).has_value()) << "'" << bad << "'";
    }
    EXPECT_EQ(parse_int64("-12"), -12);
    EXPECT_FALSE(parse_int64("9223372036854775808").has_value());
    EXPECT_FALSE(parse_int64("1.0").has_value());
}

TEST(Text, NumbersDoNotDependOnTheLocale) {
    // Where a comma locale is installed it must change nothing; elsewhere this is the plain check.
    const char* installed = std::setlocale(LC_ALL, "de_DE.UTF-8");
    EXPECT_EQ(parse_double("1.5"), 1.5);
    EXPECT_EQ(format_double(1.5), "1.5");
    EXPECT_EQ(format_seconds(1'500'000'000), "1.500000000");
    if (installed != nullptr) std::setlocale(LC_ALL, "C");
}

TEST(Text, SecondsKeepEveryNanosecond) {
    EXPECT_EQ(parse_seconds_as_ns("1403715273.262142976"), 1403715273262142976);
    EXPECT_EQ(parse_seconds_as_ns("1403715273.26214"), 1403715273262140000);
    EXPECT_EQ(parse_seconds_as_ns("-0.000000001"), -1);
    EXPECT_EQ(parse_seconds_as_ns("0.0000000015"), 2);
    EXPECT_EQ(parse_seconds_as_ns("1.036224e-01"), 103622400);
    EXPECT_EQ(parse_seconds_as_ns("12"), 12'000'000'000);
    for (const char* bad : {"", ".", "-", "1.2.3", "1e30", "nan", "99999999999", "1s", "1-2"}) {
        EXPECT_FALSE(parse_seconds_as_ns(bad).has_value()) << "'" << bad << "'";
    }
    Rng rng(3);
    for (int i = 0; i < 10000; ++i) {
        const auto time_ns =
            static_cast<std::int64_t>(rng.next_u64() >> 2) * (rng.below(2) == 0 ? 1 : -1);
        ASSERT_EQ(parse_seconds_as_ns(format_seconds(time_ns)), time_ns) << time_ns;
    }
}

TEST(Text, DoublesRoundTrip) {
    Rng rng(4);
    for (int i = 0; i < 10000; ++i) {
        const double value = std::bit_cast<double>(rng.next_u64());
        if (!std::isfinite(value)) continue;
        ASSERT_EQ(parse_double(format_double(value)), value) << format_double(value);
    }
}

TEST(Text, NaturalOrderCountsNumbers) {
    EXPECT_TRUE(natural_less("frame2.png", "frame10.png"));
    EXPECT_FALSE(natural_less("frame10.png", "frame2.png"));
    EXPECT_TRUE(natural_less("a1b2", "a1b10"));
    EXPECT_TRUE(natural_less("000009.png", "000010.png"));
    EXPECT_TRUE(natural_less("frame", "frame1"));
    EXPECT_FALSE(natural_less("a", "a"));
    EXPECT_NE(natural_less("a01", "a1"), natural_less("a1", "a01"));
}

TEST(Text, LinesCountAndLoseTheirEnds) {
    LineReader lines("a\r\n\nb");
    EXPECT_EQ(lines.next(), "a");
    EXPECT_EQ(lines.next(), "");
    EXPECT_EQ(lines.next(), "b");
    EXPECT_EQ(lines.number(), 3);
    EXPECT_FALSE(lines.next().has_value());
    LineReader odd(
        "\xef\xbb\xbf"
        "a\rb\r\n\rc");
    for (const char* line : {"a", "b", "", "c"}) EXPECT_EQ(odd.next(), line);
    EXPECT_EQ(odd.number(), 4);
    EXPECT_FALSE(odd.next().has_value());
    LineReader head("end_header\r\n\r\n.");
    EXPECT_EQ(head.next(), "end_header");
    EXPECT_EQ(head.rest(), "\r\n.") << "bytes behind a line are left as they are";
}

TEST(Text, MissingValuesAreNanAndDecimalCommasAreNamed) {
    for (const char* word :
         {"null", "NULL", "NA", "n/a", "none", "-nan", "-nan(ind)", "1.#QNAN", "NaN"})
        EXPECT_TRUE(std::isnan(parse_value(word).value_or(0.0))) << word;
    EXPECT_EQ(parse_value("-1.5e3"), -1500.0);
    for (const char* bad : {"", "1,5", "nothing", "0x10"}) EXPECT_FALSE(parse_value(bad)) << bad;
    EXPECT_TRUE(testing::contains(why_no_number("1,5"), "'1,5' has a decimal comma"));
    EXPECT_TRUE(testing::contains(why_no_number(",25E-01"), "decimal comma"));
    EXPECT_EQ(why_no_number("a,b"), "'a,b' is not a number");
    EXPECT_TRUE(encoding_problem("\xff\xfe"
                                 "0")
                    .has_value());
    EXPECT_FALSE(encoding_problem("0 0 0").has_value());
}

TEST(Text, DecimalsMoveExactly) {
    EXPECT_EQ(parse_decimal("1403636579049999872.4", 0), 1403636579049999872);
    EXPECT_EQ(parse_decimal("1.5", 0), 2);
    EXPECT_EQ(parse_decimal("1403636579049999.8", 3), 1403636579049999800);
    EXPECT_FALSE(parse_decimal("9300000000000000000", 0).has_value());
}

}  // namespace
}  // namespace surefoot::io

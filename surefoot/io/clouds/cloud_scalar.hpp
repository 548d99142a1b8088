// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace surefoot::io {

/// Values of one of the number types of cloud files. Float is the first alternative, so that an
/// empty list holds floats.
using ScalarValues = std::variant<std::vector<float>,
                                  std::vector<double>,
                                  std::vector<std::int8_t>,
                                  std::vector<std::uint8_t>,
                                  std::vector<std::int16_t>,
                                  std::vector<std::uint16_t>,
                                  std::vector<std::int32_t>,
                                  std::vector<std::uint32_t>,
                                  std::vector<std::int64_t>,
                                  std::vector<std::uint64_t>>;

/// An additional value per point: intensity, time, identifier, variance, component of a normal. The
/// values keep the type of the file, so that a time in seconds since 1970 and an identifier above
/// 2^24 keep all their digits.
struct CloudScalar {
    std::string name;
    ScalarValues values;

    [[nodiscard]] std::size_t size() const;
    void reserve(std::size_t count);
    /// Returns one value as a double, exact except for 64-bit whole numbers beyond 2^53.
    [[nodiscard]] double at(std::size_t i) const;
    /// Returns the float values, for reading and appending. Precondition: the type is float.
    [[nodiscard]] std::vector<float>& floats();
    [[nodiscard]] const std::vector<float>& floats() const;

    /// Appends a number. Returns false and appends nothing if the type cannot hold it: whole-number
    /// types hold no fraction, no NaN and no value beyond their range.
    [[nodiscard]] bool add(double value);
    /// Appends a number written as text; whole numbers are exact. Returns false if the text is not
    /// a number or the type cannot hold the number. Missing values (parse_value) count as NaN.
    [[nodiscard]] bool add(std::string_view word);

    /// Returns a scalar with the same name and type, without values.
    [[nodiscard]] CloudScalar without_values() const;
    /// Appends `count` values of `other` from `first` on. Both must have the same type.
    void append(const CloudScalar& other, std::size_t first, std::size_t count);
    /// Appends the values of `other` for which `keep` is not 0. Both must have the same type.
    void append_kept(const CloudScalar& other, std::span<const char> keep);
};

/// Returns an empty list for type 'F', 'I' or 'U' with `bytes` bytes (PCD's TYPE and SIZE); no
/// value if there is no such type.
[[nodiscard]] std::optional<ScalarValues> no_values_of(char type, std::size_t bytes);

}  // namespace surefoot::io

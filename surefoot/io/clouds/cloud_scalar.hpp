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

/// Values of one of the types that cloud files have. Float is the first: it is what an empty list
/// of values holds.
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

/// A further value per point: intensity, time, an identifier, variance, a normal's component. It
/// has the type that it has in the file, so that a time in seconds since 1970 and an identifier
/// above 2^24 stay what they are.
struct CloudScalar {
    std::string name;
    ScalarValues values;

    [[nodiscard]] std::size_t size() const;
    void reserve(std::size_t count);
    /// One value as a double: exact but for 64-bit whole numbers beyond 2^53.
    [[nodiscard]] double at(std::size_t i) const;
    /// The values of a scalar that holds floats, to add to or to look at.
    [[nodiscard]] std::vector<float>& floats();
    [[nodiscard]] const std::vector<float>& floats() const;

    /// Adds a number; false, and nothing is added, where the type does not hold it: a whole-number
    /// type neither a fraction, nor NaN, nor what is beyond its range.
    [[nodiscard]] bool add(double value);
    /// Adds a number written as text, exactly where it is a whole number; false as above, or where
    /// it is no number. Missing values (parse_value) are NaN.
    [[nodiscard]] bool add(std::string_view word);

    /// The same name and type without values.
    [[nodiscard]] CloudScalar without_values() const;
    /// Adds the values of `other`, which is of the same type, from `first` on.
    void append(const CloudScalar& other, std::size_t first, std::size_t count);
    /// Adds the values of `other`, which is of the same type, for which `keep` holds no 0.
    void append_kept(const CloudScalar& other, std::span<const char> keep);
};

/// No values of the type 'F', 'I' or 'U' of so many bytes (PCD's TYPE and SIZE); nothing where
/// there is no such type.
[[nodiscard]] std::optional<ScalarValues> no_values_of(char type, std::size_t bytes);

}  // namespace surefoot::io

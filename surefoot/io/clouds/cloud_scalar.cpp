// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/clouds/cloud_scalar.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <type_traits>

#include "surefoot/core/assert.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

template <typename Values>
using ValueOf = typename std::decay_t<Values>::value_type;

/// Converts the number to another type; no value if that type cannot hold it. A double becomes the
/// nearest float; beyond the largest float it becomes an infinite float.
template <typename T>
std::optional<T> held_as(double value) {
    if constexpr (std::is_same_v<T, double>) {
        return value;
    } else if constexpr (std::is_same_v<T, float>) {
        constexpr auto kMax = static_cast<double>(std::numeric_limits<float>::max());
        if (std::abs(value) > kMax)
            return std::copysign(std::numeric_limits<float>::infinity(),
                                 value < 0.0 ? -1.0F : 1.0F);
        return static_cast<float>(value);
    } else {
        // A double can hold 2^digits exactly, but not the largest value of a 64-bit type.
        const double above = std::ldexp(1.0, std::numeric_limits<T>::digits);
        const double lowest = std::is_signed_v<T> ? -above : 0.0;
        if (!(value >= lowest && value < above) || value != std::floor(value)) return std::nullopt;
        return static_cast<T>(value);
    }
}

template <typename T>
std::optional<T> parsed_as(std::string_view word) {
    if constexpr (std::is_integral_v<T>) {
        T whole{};
        const char* end = word.data() + word.size();
        const auto [stop, error] = std::from_chars(word.data(), end, whole);
        if (error == std::errc{} && stop == end && !word.empty()) return whole;
    }
    const auto value = parse_value(word);
    return value ? held_as<T>(*value) : std::nullopt;
}

}  // namespace

std::size_t CloudScalar::size() const {
    return std::visit([](const auto& v) { return v.size(); }, values);
}

void CloudScalar::reserve(std::size_t count) {
    std::visit([&](auto& v) { v.reserve(count); }, values);
}

double CloudScalar::at(std::size_t i) const {
    return std::visit([&](const auto& v) { return static_cast<double>(v[i]); }, values);
}

std::vector<float>& CloudScalar::floats() {
    SUREFOOT_ASSERT(std::holds_alternative<std::vector<float>>(values));
    return *std::get_if<std::vector<float>>(&values);
}

const std::vector<float>& CloudScalar::floats() const {
    SUREFOOT_ASSERT(std::holds_alternative<std::vector<float>>(values));
    return *std::get_if<std::vector<float>>(&values);
}

bool CloudScalar::add(double value) {
    return std::visit(
        [&](auto& v) {
            const auto held = held_as<ValueOf<decltype(v)>>(value);
            if (held) v.push_back(*held);
            return held.has_value();
        },
        values);
}

bool CloudScalar::add(std::string_view word) {
    return std::visit(
        [&](auto& v) {
            const auto held = parsed_as<ValueOf<decltype(v)>>(word);
            if (held) v.push_back(*held);
            return held.has_value();
        },
        values);
}

CloudScalar CloudScalar::without_values() const {
    return {name,
            std::visit([](const auto& v) -> ScalarValues { return std::decay_t<decltype(v)>(); },
                       values)};
}

void CloudScalar::append(const CloudScalar& other, std::size_t first, std::size_t count) {
    SUREFOOT_ASSERT(values.index() == other.values.index() && first + count <= other.size());
    std::visit(
        [&](auto& v) {
            const auto& from = *std::get_if<std::decay_t<decltype(v)>>(&other.values);
            const auto begin = from.begin() + static_cast<std::ptrdiff_t>(first);
            v.insert(v.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
        },
        values);
}

void CloudScalar::append_kept(const CloudScalar& other, std::span<const char> keep) {
    SUREFOOT_ASSERT(values.index() == other.values.index() && keep.size() == other.size());
    std::visit(
        [&](auto& v) {
            const auto& from = *std::get_if<std::decay_t<decltype(v)>>(&other.values);
            for (std::size_t i = 0; i < keep.size(); ++i)
                if (keep[i] != 0) v.push_back(from[i]);
        },
        values);
}

std::optional<ScalarValues> no_values_of(char type, std::size_t bytes) {
    if (type == 'F') {
        if (bytes == 4) return std::vector<float>();
        if (bytes == 8) return std::vector<double>();
        return std::nullopt;
    }
    const bool is_signed = type == 'I';
    switch (bytes) {
        case 1:
            return is_signed ? ScalarValues(std::vector<std::int8_t>())
                             : ScalarValues(std::vector<std::uint8_t>());
        case 2:
            return is_signed ? ScalarValues(std::vector<std::int16_t>())
                             : ScalarValues(std::vector<std::uint16_t>());
        case 4:
            return is_signed ? ScalarValues(std::vector<std::int32_t>())
                             : ScalarValues(std::vector<std::uint32_t>());
        case 8:
            return is_signed ? ScalarValues(std::vector<std::int64_t>())
                             : ScalarValues(std::vector<std::uint64_t>());
        default: return std::nullopt;
    }
}

}  // namespace surefoot::io

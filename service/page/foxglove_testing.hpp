// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "service/page/foxglove_messages.hpp"

/// Helpers for tests of the Foxglove messages. The readers follow the protocol and use no code of
/// the service.
namespace surefoot::page::testing {

using Json = nlohmann::ordered_json;

inline std::string from_base64(const std::string& text) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    std::uint32_t word = 0;
    int bits = 0;
    for (const char c : text) {
        if (c == '=') break;
        word = word << 6U | static_cast<std::uint32_t>(digits.find(c));
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        bytes += static_cast<char>(word >> static_cast<unsigned>(bits) & 0xffU);
    }
    return bytes;
}

template <typename T>
T number_at(std::string_view bytes, std::size_t offset) {
    T value{};
    std::memcpy(&value, bytes.data() + offset, sizeof(T));
    return value;
}

inline bool is_of_type(const Json& value, const std::string& type) {
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "integer") return value.is_number_integer();
    return type == "number" && value.is_number();
}

/// The first reason why a value violates a schema; empty if it is valid.
inline std::string problem_of(const Json& value, const Json& schema, const std::string& where) {
    const auto type = schema.at("type").get<std::string>();
    if (!is_of_type(value, type)) return where + " is no " + type + ": " + value.dump();
    if (schema.contains("minimum") && value < schema.at("minimum")) return where + " is too small";
    if (schema.contains("maximum") && value > schema.at("maximum")) return where + " is too large";
    if (type == "array") {
        for (const Json& item : value) {
            if (auto problem = problem_of(item, schema.at("items"), where + "[]"); !problem.empty())
                return problem;
        }
    }
    if (type != "object") return {};
    for (const Json& name : schema.value("required", Json::array())) {
        if (!value.contains(name.get<std::string>())) return where + " lacks " + name.dump();
    }
    for (const auto& [name, property] : schema.at("properties").items()) {
        if (!value.contains(name)) continue;
        auto problem = problem_of(value.at(name), property, where + "." + name);
        if (!problem.empty()) return problem;
    }
    return {};
}

/// A map of 4 x 3 cells of 0.1 m, in which the cells (1, 0) and (2, 1) are known.
inline PageMap small_ground() {
    PageMap map;
    map.version = 7;
    map.frame_time_ns = 1'403'636'579'763'555'584;
    map.origin_x_tenth_mm = -10'000;
    map.origin_y_tenth_mm = 20'000;
    map.base_z_tenth_mm = 100'000;
    map.resolution_tenth_mm = 1000;
    map.nx = 4;
    map.ny = 3;
    map.cells.assign(12, PageCell{});
    map.cells[1] = {-250, 3, static_cast<std::uint8_t>(GroundState::free)};
    map.cells[6] = {17, 12, static_cast<std::uint8_t>(GroundState::unsafe) | kDropBit};
    return map;
}

}  // namespace surefoot::page::testing

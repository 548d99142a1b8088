// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

/// A plain decoder that follows messages.json only and uses no code of the service.
namespace surefoot::page::testing {

using Json = nlohmann::ordered_json;

inline Json read_json(const std::string& path) {
    std::ifstream file(path);
    return Json::parse(file);
}

/// Reads numbers by the names of their types. 64-bit integers become text, because a page's
/// integers end at 2^53; NaN becomes null.
class TypedReader {
  public:
    explicit TypedReader(std::string_view bytes) : rest_(bytes) {}

    Json number(const std::string& type) {
        if (type == "u8") return take<std::uint8_t>();
        if (type == "u16") return take<std::uint16_t>();
        if (type == "u32") return take<std::uint32_t>();
        if (type == "u64") return std::to_string(take<std::uint64_t>());
        if (type == "i16") return take<std::int16_t>();
        if (type == "i32") return take<std::int32_t>();
        if (type == "i64") return std::to_string(take<std::int64_t>());
        if (type == "f32") return real(static_cast<double>(take<float>()));
        if (type == "f64") return real(take<double>());
        throw std::runtime_error("messages.json has an unknown type " + type);
    }
    /// `table`: [[name, type], ...].
    Json fields(const Json& table) {
        Json out = Json::object();
        for (const Json& field : table)
            out[field[0].get<std::string>()] = number(field[1].get<std::string>());
        return out;
    }
    [[nodiscard]] std::string_view rest() const { return rest_; }

  private:
    static Json real(double value) { return std::isnan(value) ? Json(nullptr) : Json(value); }
    template <typename T>
    T take() {
        if (rest_.size() < sizeof(T)) throw std::runtime_error("the message ends too early");
        T value{};
        std::memcpy(&value, rest_.data(), sizeof(T));
        rest_.remove_prefix(sizeof(T));
        return value;
    }
    std::string_view rest_;
};

inline std::string hex_of(std::string_view bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string out;
    for (const char c : bytes) {
        const auto byte = static_cast<unsigned char>(c);
        out += kDigits[byte >> 4U];
        out += kDigits[byte & 15U];
    }
    return out;
}

inline Json cell_values(const Json& cell) {
    return Json::array({cell["height_mm"], cell["sigma_mm"], cell["state"]});
}

inline void decode_map_body(const Json& kind, TypedReader& reader, Json& out) {
    out["edges"] = Json::array();
    for (int i = 0; i < out["edge_count"].get<int>(); ++i)
        out["edges"].push_back(reader.fields(kind["edge"]));
    out["runs"] = Json::array();
    for (int i = 0; i < out["run_count"].get<int>(); ++i) {
        Json run = reader.fields(kind["run"]);
        run["cells"] = Json::array();
        for (int k = 0; k < run["count"].get<int>(); ++k)
            run["cells"].push_back(cell_values(reader.fields(kind["cell"])));
        out["runs"].push_back(std::move(run));
    }
}

/// Decodes a binary message into {"message": its name, every field}. Throws if it is invalid.
inline Json decode(const Json& contract, std::string_view bytes) {
    const Json& binary = contract["binary"];
    TypedReader reader(bytes);
    const Json header = reader.fields(binary["header"]);
    if (header["protocol"] != contract["protocol"]) throw std::runtime_error("another protocol");
    for (const auto& [name, kind] : binary.items()) {
        if (name == "header" || kind["kind"] != header["kind"]) continue;
        Json out{{"message", name}};
        out.update(reader.fields(kind["fields"]));
        if (name == "map") decode_map_body(kind, reader, out);
        if (name == "pose") {
            out["joints"] = Json::array();
            for (int i = 0; i < out["joint_count"].get<int>(); ++i)
                out["joints"].push_back(reader.fields(kind["joint"])["angle_rad"]);
        }
        if (name == "layer") {
            out["values"] = Json::array();
            while (!reader.rest().empty()) out["values"].push_back(reader.number("f32"));
        }
        if (name == "image") {
            out["jpeg_hex"] = hex_of(reader.rest());
        } else if (!reader.rest().empty()) {
            throw std::runtime_error("bytes behind the end of the message");
        }
        return out;
    }
    throw std::runtime_error("a message of an unknown kind");
}

/// The map that a page holds after the messages so far.
struct HeldMap {
    std::int64_t origin_x_tenth_mm = 0;
    std::int64_t origin_y_tenth_mm = 0;
    int nx = 0;
    int ny = 0;
    std::vector<Json> cells;  ///< [height_mm, sigma_mm, state]

    static Json unknown() { return Json::array({-32768, 255, 0}); }

    void take(const Json& map) {
        const std::int64_t x = std::stoll(map["origin_x_tenth_mm"].get<std::string>());
        const std::int64_t y = std::stoll(map["origin_y_tenth_mm"].get<std::string>());
        const auto resolution = map["resolution_tenth_mm"].get<std::int64_t>();
        if (map["whole"] == 1) {
            nx = map["nx"].get<int>();
            ny = map["ny"].get<int>();
            cells.assign(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny), unknown());
        } else {
            shift((x - origin_x_tenth_mm) / resolution, (y - origin_y_tenth_mm) / resolution);
        }
        origin_x_tenth_mm = x;
        origin_y_tenth_mm = y;
        for (const Json& run : map["runs"]) {
            auto i = run["first"].get<std::size_t>();
            for (const Json& cell : run["cells"]) cells.at(i++) = cell;
        }
    }

  private:
    void shift(std::int64_t dx, std::int64_t dy) {
        const std::vector<Json> old = cells;
        for (int iy = 0; iy < ny; ++iy) {
            for (int ix = 0; ix < nx; ++ix) {
                const std::int64_t x = ix + dx;
                const std::int64_t y = iy + dy;
                const bool inside = x >= 0 && y >= 0 && x < nx && y < ny;
                cells[static_cast<std::size_t>(iy * nx + ix)] =
                    inside ? old[static_cast<std::size_t>(y * nx + x)] : unknown();
            }
        }
    }
};

}  // namespace surefoot::page::testing

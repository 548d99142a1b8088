// SPDX-License-Identifier: Apache-2.0
// Reads and writes PLY, after Turk 1994, "The PLY Polygon File Format". A text header describes
// elements with typed properties. Their rows follow as text, or packed in either byte order.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <type_traits>

#include "surefoot/io/bytes.hpp"
#include "surefoot/io/clouds/cloud_rows.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };
constexpr std::size_t kTypeBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
constexpr std::size_t kMaxProperties = 256;

constexpr std::size_t bytes_of(Type type) noexcept {
    return kTypeBytes[static_cast<int>(type)];
}

std::optional<Type> type_named(std::string_view name) {
    static constexpr struct {
        std::string_view name;
        Type type;
    } kNames[] = {{"char", Type::i8},
                  {"int8", Type::i8},
                  {"uchar", Type::u8},
                  {"uint8", Type::u8},
                  {"short", Type::i16},
                  {"int16", Type::i16},
                  {"ushort", Type::u16},
                  {"uint16", Type::u16},
                  {"int", Type::i32},
                  {"int32", Type::i32},
                  {"uint", Type::u32},
                  {"uint32", Type::u32},
                  {"float", Type::f32},
                  {"float32", Type::f32},
                  {"double", Type::f64},
                  {"float64", Type::f64}};
    for (const auto& known : kNames) {
        if (known.name == name) return known.type;
    }
    return std::nullopt;
}

struct Property {
    std::string name;
    Type type = Type::f32;
    std::optional<Type> count_type;  ///< set for a list: type of the count before the values
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;

    /// Smallest size of one row [bytes], binary or as text with one blank after each value.
    [[nodiscard]] std::uint64_t smallest_row(bool binary) const {
        std::uint64_t size = 0;
        for (const Property& p : properties)
            size += binary ? bytes_of(p.count_type.value_or(p.type)) : 2;
        return size;
    }
};

struct Header {
    enum class Encoding { ascii, little, big } encoding = Encoding::ascii;
    std::vector<Element> elements;
    std::string_view body;
};

Error at_line(const std::string& file, int line, const std::string& what) {
    return input_error(fmt::format("{}:{}: {}", file, line, what));
}

/// Parses one "property ..." line.
Result<Property> parse_property(const std::vector<std::string_view>& words) {
    const bool list = words.size() == 5 && words[1] == "list";
    if (!list && words.size() != 3)
        return input_error("expected 'property TYPE NAME' or 'property list COUNT_TYPE TYPE NAME'");
    const auto type = type_named(words[list ? 3 : 1]);
    const auto count_type = list ? type_named(words[2]) : std::nullopt;
    if (!type || (list && (!count_type || *count_type >= Type::f32))) {
        return input_error(fmt::format("unknown property type {}", quoted(words[list ? 3 : 1])));
    }
    return Property{std::string(words.back()), *type, count_type};
}

/// Parses one header line; the caller adds the position to an error.
Status parse_header_line(const std::vector<std::string_view>& words, Header& header) {
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return {};
    if (words[0] == "format" && words.size() == 3) {
        if (words[1] == "ascii") {
            header.encoding = Header::Encoding::ascii;
        } else if (words[1] == "binary_little_endian") {
            header.encoding = Header::Encoding::little;
        } else if (words[1] == "binary_big_endian") {
            header.encoding = Header::Encoding::big;
        } else {
            return input_error(fmt::format(
                "unknown format {}; expected ascii, binary_little_endian or binary_big_endian",
                quoted(words[1])));
        }
        return {};
    }
    if (words[0] == "element" && words.size() == 3) {
        const auto count = parse_int64(words[2]);
        if (!count || *count < 0) {
            return input_error(fmt::format("element count {} is not a whole number of 0 or more",
                                           quoted(words[2])));
        }
        header.elements.push_back({std::string(words[1]), static_cast<std::uint64_t>(*count), {}});
        return {};
    }
    if (words[0] == "property" && !header.elements.empty()) {
        Result<Property> property = parse_property(words);
        if (!property) return property.error();
        header.elements.back().properties.push_back(std::move(property).value());
        if (header.elements.back().properties.size() <= kMaxProperties) return {};
        return input_error(fmt::format("an element has more than {} properties, which is the limit",
                                       kMaxProperties));
    }
    return input_error(fmt::format("unexpected header line beginning with {}", quoted(words[0])));
}

Result<Header> parse_header(std::string_view bytes, const std::string& file) {
    LineReader lines(bytes);
    if (const auto first = lines.next(); !first || trimmed(*first) != "ply") {
        return at_line(file, 1, "not a PLY file (its first line must be 'ply')");
    }
    Header header;
    while (const auto line = lines.next()) {
        if (trimmed(*line) == "end_header") {
            header.body = lines.rest();
            return header;
        }
        const Status status = parse_header_line(split(*line), header);
        if (!status) return at_line(file, lines.number(), status.error().message);
    }
    return at_line(
        file, lines.number(), "truncated PLY header: 'end_header' is missing; copy the file again");
}

/// Reads values from the body in any of the three encodings.
class ValueReader {
  public:
    ValueReader(const Header& header)
        : ascii_(header.encoding == Header::Encoding::ascii),
          order_(header.encoding == Header::Encoding::big ? std::endian::big : std::endian::little),
          rest_(header.body),
          words_(header.body) {}

    [[nodiscard]] std::optional<double> next(Type type) {
        if (ascii_) return parse_double(words_.next());
        if (rest_.size() < bytes_of(type)) return std::nullopt;
        const char* data = rest_.data();
        rest_.remove_prefix(bytes_of(type));
        switch (type) {
            case Type::i8: return static_cast<signed char>(*data);
            case Type::u8: return static_cast<unsigned char>(*data);
            case Type::i16: return load<std::int16_t>(data, order_);
            case Type::u16: return load<std::uint16_t>(data, order_);
            case Type::i32: return load<std::int32_t>(data, order_);
            case Type::u32: return load<std::uint32_t>(data, order_);
            case Type::f32: return static_cast<double>(load<float>(data, order_));
            case Type::f64: return load<double>(data, order_);
        }
        return std::nullopt;
    }
    /// Skips a list property; returns false if the data end or the count is invalid.
    [[nodiscard]] bool skip_list(const Property& property) {
        const auto count = next(*property.count_type);
        if (!count || !(*count >= 0.0)) return false;
        for (double i = 0.0; i < *count; i += 1.0) {
            if (!next(property.type)) return false;
        }
        return true;
    }

  private:
    bool ascii_;
    std::endian order_;
    std::string_view rest_;
    WordReader words_;
};

/// Names the part of the cloud that stores the values of one vertex property.
struct Target {
    enum class Kind { x, y, z, red, green, blue, scalar, none } kind = Kind::none;
    std::size_t scalar = 0;
};

ScalarValues no_values(Type type) {
    switch (type) {
        case Type::i8: return std::vector<std::int8_t>();
        case Type::u8: return std::vector<std::uint8_t>();
        case Type::i16: return std::vector<std::int16_t>();
        case Type::u16: return std::vector<std::uint16_t>();
        case Type::i32: return std::vector<std::int32_t>();
        case Type::u32: return std::vector<std::uint32_t>();
        case Type::f64: return std::vector<double>();
        case Type::f32: break;
    }
    return std::vector<float>();
}

/// Finds three numeric properties with these names. Returns no value unless each occurs once.
/// `type`: type that all three must have, if given.
std::optional<std::array<std::size_t, 3>> three_named(const Element& vertex,
                                                      const std::array<std::string_view, 3>& names,
                                                      std::optional<Type> type) {
    std::array<std::size_t, 3> at{};
    std::array<int, 3> count{};
    for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
        const Property& property = vertex.properties[i];
        if (property.count_type || (type && property.type != *type)) continue;
        for (std::size_t k = 0; k < names.size(); ++k) {
            if (property.name != names[k]) continue;
            at[k] = i;
            ++count[k];
        }
    }
    if (count != std::array<int, 3>{1, 1, 1}) return std::nullopt;
    return at;
}

/// Returns the targets of all properties. Returns no value unless x, y and z (or X, Y and Z) each
/// occur once.
std::optional<std::vector<Target>> targets_of(const Element& vertex, PointCloud& cloud) {
    auto axes = three_named(vertex, {"x", "y", "z"}, std::nullopt);
    if (!axes) axes = three_named(vertex, {"X", "Y", "Z"}, std::nullopt);
    if (!axes) return std::nullopt;
    const auto colours = three_named(vertex, {"red", "green", "blue"}, Type::u8);
    std::vector<Target> targets(vertex.properties.size());
    using Kind = Target::Kind;
    for (std::size_t k = 0; k < 3; ++k) {
        constexpr Kind kAxes[] = {Kind::x, Kind::y, Kind::z};
        constexpr Kind kColours[] = {Kind::red, Kind::green, Kind::blue};
        targets[(*axes)[k]].kind = kAxes[k];
        if (colours) targets[(*colours)[k]].kind = kColours[k];
        const Type type = vertex.properties[(*axes)[k]].type;
        cloud.double_precision =
            cloud.double_precision || type == Type::f64 || type == Type::i32 || type == Type::u32;
    }
    for (std::size_t i = 0; i < targets.size(); ++i) {
        const Property& property = vertex.properties[i];
        if (property.count_type || targets[i].kind != Kind::none) continue;
        targets[i] = {Kind::scalar, cloud.scalars.size()};
        cloud.scalars.push_back({property.name, no_values(property.type)});
    }
    return targets;
}

/// Reads one vertex. Returns false if the data end, or if a word is not a number or does not fit
/// the type of its property.
bool read_vertex(ValueReader& values,
                 const Element& vertex,
                 const std::vector<Target>& targets,
                 bool coloured,
                 PointCloud& cloud) {
    Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
    Rgb colour;
    for (std::size_t i = 0; i < targets.size(); ++i) {
        const Property& property = vertex.properties[i];
        if (property.count_type) {
            if (!values.skip_list(property)) return false;
            continue;
        }
        const auto value = values.next(property.type);
        if (!value) return false;
        const auto channel = [&] {
            // in range: 0 to 255, or 0 for other values (NaN)
            return static_cast<std::uint8_t>(*value >= 0.0 && *value <= 255.0 ? *value : 0.0);
        };
        switch (targets[i].kind) {
            case Target::Kind::x: point_m.x() = *value; break;
            case Target::Kind::y: point_m.y() = *value; break;
            case Target::Kind::z: point_m.z() = *value; break;
            case Target::Kind::red: colour.r = channel(); break;
            case Target::Kind::green: colour.g = channel(); break;
            case Target::Kind::blue: colour.b = channel(); break;
            case Target::Kind::scalar:
                // A double holds every value of the types that PLY has.
                if (!cloud.scalars[targets[i].scalar].add(*value)) return false;
                break;
            case Target::Kind::none: break;
        }
    }
    cloud.points_m.push_back(point_m);
    if (coloured) cloud.colours.push_back(colour);
    return true;
}

bool skip_element(ValueReader& values, const Element& element) {
    if (element.properties.empty()) return true;
    for (std::uint64_t row = 0; row < element.count; ++row) {
        for (const Property& property : element.properties) {
            const bool fine = property.count_type ? values.skip_list(property)
                                                  : values.next(property.type).has_value();
            if (!fine) return false;
        }
    }
    return true;
}

Error too_short(const std::string& file, const Element& element, std::size_t bytes) {
    return input_error(fmt::format(
        "{}: truncated or damaged PLY: the header announces {} '{}', but the file has only "
        "{} bytes of data; copy the file again",
        file,
        element.count,
        element.name,
        bytes));
}

Result<PointCloud> read_vertices(const Element& vertex,
                                 ValueReader& values,
                                 const std::string& file) {
    PointCloud cloud;
    const auto targets = targets_of(vertex, cloud);
    if (!targets) {
        return input_error(
            fmt::format("{}: PLY vertices must have each of x, y and z exactly once", file));
    }
    const bool coloured = std::any_of(targets->begin(), targets->end(), [](const Target& target) {
        return target.kind == Target::Kind::red;
    });
    cloud.points_m.reserve(vertex.count);
    if (coloured) cloud.colours.reserve(vertex.count);
    for (CloudScalar& scalar : cloud.scalars) scalar.reserve(vertex.count);
    for (std::uint64_t i = 0; i < vertex.count; ++i) {
        if (read_vertex(values, vertex, *targets, coloured, cloud)) continue;
        return input_error(
            fmt::format("{}: PLY vertex {} of {}: the file ends here, or a value is not a number "
                        "or does not fit the type of its property",
                        file,
                        i,
                        vertex.count));
    }
    cloud.width = static_cast<int>(vertex.count);
    return cloud;
}

/// Names the contents of the file that the cloud cannot store.
std::vector<std::string> notes_of(const Header& header) {
    std::vector<std::string> notes;
    for (const Element& element : header.elements) {
        if (element.name != "vertex" && element.count > 0) {
            notes.push_back(fmt::format("the element {} is not kept", quoted(element.name)));
        }
        for (const Property& property : element.properties) {
            if (element.name != "vertex" || !property.count_type) continue;
            notes.push_back(
                fmt::format("the list {} of vertices is not kept", quoted(property.name)));
        }
    }
    return notes;
}

template <typename T>
void put(std::string& out, T value, bool binary) {
    if (binary) {
        store_le(out, value);
    } else {
        out += fmt::format("{} ", value);
    }
}

/// PLY has no whole numbers of 64 bits: they become doubles.
template <typename T>
constexpr bool kNotInPly = std::is_same_v<T, std::int64_t> || std::is_same_v<T, std::uint64_t>;

template <typename T>
void put_scalar(std::string& out, T value, bool binary) {
    if constexpr (kNotInPly<T>) {
        put(out, static_cast<double>(value), binary);
    } else {
        put(out, value, binary);
    }
}

template <typename T>
constexpr const char* ply_type() {
    if (std::is_same_v<T, float>) return "float";
    if (std::is_same_v<T, std::int8_t>) return "char";
    if (std::is_same_v<T, std::uint8_t>) return "uchar";
    if (std::is_same_v<T, std::int16_t>) return "short";
    if (std::is_same_v<T, std::uint16_t>) return "ushort";
    if (std::is_same_v<T, std::int32_t>) return "int";
    if (std::is_same_v<T, std::uint32_t>) return "uint";
    return "double";
}

}  // namespace

Result<PointCloud> parse_ply(std::string_view bytes, const std::string& file) {
    const Result<Header> header = parse_header(bytes, file);
    if (!header) return header.error();
    ValueReader values(*header);
    const bool binary = header->encoding != Header::Encoding::ascii;
    constexpr std::uint64_t kMaxPoints = 1ULL << 30;
    for (const Element& element : header->elements) {
        // A count is accepted only if the data can hold it, so that a damaged count allocates no
        // memory.
        const std::uint64_t room = (header->body.size() + (binary ? 0 : 1)) /
                                   std::max<std::uint64_t>(element.smallest_row(binary), 1);
        if (!element.properties.empty() && (element.count > room || element.count > kMaxPoints)) {
            return too_short(file, element, header->body.size());
        }
        if (element.name == "vertex") {
            Result<PointCloud> cloud = read_vertices(element, values, file);
            if (cloud) cloud->notes = notes_of(*header);
            return cloud;
        }
        if (!skip_element(values, element)) return too_short(file, element, header->body.size());
    }
    return input_error(fmt::format("{}: the PLY file has no vertices", file));
}

std::optional<CloudRows> ply_rows(std::string_view head, std::uint64_t size) {
    const Result<Header> header = parse_header(head, "");
    if (!header || header->encoding == Header::Encoding::ascii || header->elements.empty())
        return std::nullopt;
    const Element& vertex = header->elements.front();
    const auto is_list = [](const Property& property) { return property.count_type.has_value(); };
    if (vertex.name != "vertex" || vertex.properties.empty() ||
        std::any_of(vertex.properties.begin(), vertex.properties.end(), is_list))
        return std::nullopt;
    CloudRows rows;
    rows.first_byte = head.size() - header->body.size();
    rows.rows = vertex.count;
    rows.row_bytes = vertex.smallest_row(true);
    if (rows.rows > (size - rows.first_byte) / rows.row_bytes) return std::nullopt;
    rows.head = [text = std::string(head.substr(0, rows.first_byte))](std::uint64_t count) {
        std::string with_count;
        LineReader lines(text);
        while (const auto line = lines.next()) {
            const auto words = split(*line);
            const bool counts = words.size() == 3 && words[0] == "element" && words[1] == "vertex";
            with_count += counts ? fmt::format("element vertex {}", count) : std::string(*line);
            with_count += '\n';
        }
        return with_count;
    };
    return rows;
}

std::string format_ply(const PointCloud& cloud, const CloudFormat& format) {
    const char* real = format.double_precision ? "double" : "float";
    std::string out = fmt::format("ply\nformat {} 1.0\nelement vertex {}\n",
                                  format.binary ? "binary_little_endian" : "ascii",
                                  cloud.points_m.size());
    for (const char* axis : {"x", "y", "z"}) out += fmt::format("property {} {}\n", real, axis);
    if (!cloud.colours.empty()) {
        for (const char* c : {"red", "green", "blue"}) out += fmt::format("property uchar {}\n", c);
    }
    for (const CloudScalar& scalar : cloud.scalars) {
        const char* type = std::visit(
            [](const auto& v) {
                return ply_type<typename std::decay_t<decltype(v)>::value_type>();
            },
            scalar.values);
        out += fmt::format("property {} {}\n", type, one_word(scalar.name));
    }
    out += "end_header\n";
    for (std::size_t i = 0; i < cloud.points_m.size(); ++i) {
        for (const double value : cloud.points_m[i]) {
            format.double_precision ? put(out, value, format.binary)
                                    : put(out, static_cast<float>(value), format.binary);
        }
        if (!cloud.colours.empty()) {
            const Rgb& colour = cloud.colours[i];
            for (const std::uint8_t channel : {colour.r, colour.g, colour.b}) {
                put(out, channel, format.binary);
            }
        }
        for (const CloudScalar& scalar : cloud.scalars)
            std::visit([&](const auto& v) { put_scalar(out, v[i], format.binary); }, scalar.values);
        if (!format.binary) out.back() = '\n';
    }
    return out;
}

Status write_ply(const std::string& path, const PointCloud& cloud, const CloudFormat& format) {
    if (const auto problem = cloud.problem()) return output_error(path + ": " + *problem);
    return write_file(path, format_ply(cloud, format));
}

}  // namespace surefoot::io

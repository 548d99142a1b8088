// SPDX-License-Identifier: Apache-2.0
// Reads and writes PCD 0.7 of the Point Cloud Library. A text header (FIELDS SIZE TYPE COUNT WIDTH
// HEIGHT VIEWPOINT POINTS DATA) comes first. The points follow as text rows, as packed records, or
// field after field in LZF compression.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>

#include "surefoot/io/bytes.hpp"
#include "surefoot/io/clouds/cloud_rows.hpp"
#include "surefoot/io/clouds/lzf.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

constexpr std::size_t kMaxFields = 256;
constexpr std::uint64_t kMaxPoints = 1ULL << 30;

struct Field {
    std::string name;
    std::size_t bytes = 4;
    char type = 'F';        ///< I, U or F
    std::size_t count = 1;  ///< values per point
};

struct Header {
    enum class Data { ascii, binary, compressed } data = Data::ascii;
    std::vector<Field> fields;
    std::optional<std::uint64_t> width;
    std::uint64_t height = 1;
    std::optional<std::uint64_t> points;
    std::optional<Pose> T_cloud_sensor;
    std::string_view body;
    int last_line = 0;

    [[nodiscard]] std::size_t stride() const {
        std::size_t sum = 0;
        for (const Field& field : fields) sum += field.bytes * field.count;
        return sum;
    }
    [[nodiscard]] std::size_t values_per_point() const {
        std::size_t sum = 0;
        for (const Field& field : fields) sum += field.count;
        return sum;
    }
};

Error at_line(const std::string& file, int line, const std::string& what) {
    return input_error(fmt::format("{}:{}: {}", file, line, what));
}

std::optional<std::uint64_t> parse_count(std::string_view word, std::uint64_t max) {
    const auto value = parse_int64(word);
    if (!value || *value < 0 || static_cast<std::uint64_t>(*value) > max) return std::nullopt;
    return static_cast<std::uint64_t>(*value);
}

/// Returns true if the key names the fields: FIELDS, or COLUMNS in versions below 0.6.
bool names_fields(std::string_view key) {
    return key == "FIELDS" || key == "COLUMNS";
}

/// Parses a FIELDS, SIZE, TYPE or COUNT line with one word per field.
Status parse_field_line(const std::vector<std::string_view>& words, Header& header) {
    if (names_fields(words[0])) header.fields.resize(words.size() - 1);
    if (header.fields.empty() || header.fields.size() > kMaxFields ||
        words.size() != header.fields.size() + 1) {
        return input_error(fmt::format(
            "{} has {} values for {} fields; give one value for each field, and at most 256 fields",
            words[0],
            words.size() - 1,
            header.fields.size()));
    }
    for (std::size_t i = 0; i < header.fields.size(); ++i) {
        Field& field = header.fields[i];
        const std::string_view word = words[i + 1];
        if (names_fields(words[0])) {
            field.name = word;
        } else if (words[0] == "TYPE" && (word == "I" || word == "U" || word == "F")) {
            field.type = word[0];
        } else if (words[0] == "SIZE" &&
                   (word == "1" || word == "2" || word == "4" || word == "8")) {
            field.bytes = static_cast<std::size_t>(word[0] - '0');
        } else if (const auto count = parse_count(word, 65536); words[0] == "COUNT" && count) {
            field.count = *count;
        } else {
            return input_error(
                fmt::format("{} {} is not a valid value; TYPE is I, U or F, SIZE is 1, 2, 4 or 8, "
                            "COUNT is 0 to 65536",
                            words[0],
                            quoted(word)));
        }
    }
    return {};
}

/// Parses VIEWPOINT tx ty tz qw qx qy qz, the pose of the sensor.
Status parse_viewpoint(const std::vector<std::string_view>& words, Header& header) {
    double v[7] = {};
    for (std::size_t i = 0; i < 7; ++i) {
        const auto value = words.size() == 8 ? parse_double(words[i + 1]) : std::nullopt;
        if (!value) return input_error("VIEWPOINT must hold 7 numbers");
        v[i] = *value;
    }
    const Eigen::Quaterniond rotation(v[3], v[4], v[5], v[6]);
    // Some writers leave the quaternion at zero. A quaternion whose length is not 1 is ignored with
    // its viewpoint.
    if (std::abs(rotation.norm() - 1.0) > 0.01) return {};
    header.T_cloud_sensor = Pose{rotation.normalized(), {v[0], v[1], v[2]}};
    if (!header.T_cloud_sensor->all_finite()) header.T_cloud_sensor.reset();
    return {};
}

Status parse_data_line(const std::vector<std::string_view>& words, Header& header) {
    const std::string_view kind = words.size() == 2 ? words[1] : std::string_view();
    if (kind == "ascii") {
        header.data = Header::Data::ascii;
    } else if (kind == "binary") {
        header.data = Header::Data::binary;
    } else if (kind == "binary_compressed") {
        header.data = Header::Data::compressed;
    } else {
        return input_error(fmt::format(
            "unknown DATA {}; expected ascii, binary or binary_compressed", quoted(kind)));
    }
    return {};
}

Status parse_header_line(const std::vector<std::string_view>& words, Header& header) {
    const std::string_view key = words[0];
    if (key == "VERSION") return {};
    if (names_fields(key) || key == "SIZE" || key == "TYPE" || key == "COUNT") {
        return parse_field_line(words, header);
    }
    if (key == "VIEWPOINT") return parse_viewpoint(words, header);
    if (key == "DATA") return parse_data_line(words, header);
    if (key == "WIDTH" || key == "HEIGHT" || key == "POINTS") {
        const auto value = words.size() == 2 ? parse_count(words[1], kMaxPoints) : std::nullopt;
        if (!value)
            return input_error(
                fmt::format("{} must be a whole number from 0 to {}", key, kMaxPoints));
        if (key == "WIDTH") header.width = *value;
        if (key == "HEIGHT") header.height = *value;
        if (key == "POINTS") header.points = *value;
        return {};
    }
    return input_error(fmt::format("unexpected header line beginning with {}", quoted(key)));
}

Result<Header> parse_header(std::string_view bytes, const std::string& file) {
    Header header;
    LineReader lines(bytes);
    while (const auto line = lines.next()) {
        const std::vector<std::string_view> words = split(*line);
        if (words.empty() || words[0].starts_with("#")) continue;
        if (Status status = parse_header_line(words, header); !status) {
            return at_line(file, lines.number(), status.error().message);
        }
        if (words[0] != "DATA") continue;
        header.body = lines.rest();
        header.last_line = lines.number();
        // Version 0.5 has no WIDTH: all points are one row, as in PCL.
        if (!header.width) header.width = header.points.value_or(0);
        const std::uint64_t cells = *header.width * header.height;  // both factors are at most 2^30
        if (cells > kMaxPoints || header.points.value_or(cells) != cells) {
            return at_line(file,
                           lines.number(),
                           fmt::format("WIDTH {} x HEIGHT {} must equal POINTS {}",
                                       *header.width,
                                       header.height,
                                       header.points.value_or(0)));
        }
        header.points = cells;
        return header;
    }
    return at_line(
        file, lines.number(), "truncated PCD header: 'DATA' is missing; copy the file again");
}

/// Calls `use` with a zero of the field's type.
template <typename Use>
void with_type_of(const Field& field, const Use& use) {
    // check_fields has verified the type.
    const auto values = no_values_of(field.type, field.bytes).value_or(ScalarValues());
    std::visit([&](const auto& v) { use(typename std::decay_t<decltype(v)>::value_type{}); },
               values);
}

/// Unpacks the colour 0x00RRGGBB, which PCL stores in the bits of a float or an integer.
Rgb unpacked_colour(std::uint32_t bits) {
    return {static_cast<std::uint8_t>(bits >> 16),
            static_cast<std::uint8_t>(bits >> 8),
            static_cast<std::uint8_t>(bits)};
}

bool is_colour(const Field& field) {
    return (field.name == "rgb" || field.name == "rgba") && field.bytes == 4 && field.count == 1;
}
bool is_padding(const Field& field) {
    return field.name == "_" || field.count != 1;
}

/// Returns 0 to 2 for x, y and z, also in capitals.
std::optional<int> axis_of(const Field& field) {
    const std::string name = lowercase(field.name);
    if (name.size() != 1 || name[0] < 'x' || name[0] > 'z' || field.count != 1) return std::nullopt;
    return name[0] - 'x';
}

/// Names the part of the cloud that stores the values of a field.
struct Role {
    enum class Kind : std::uint8_t { nothing, axis, colour, scalar } kind = Kind::nothing;
    std::size_t index = 0;  ///< index of the axis or of the scalar
};

/// A cloud that is filled field by field, or point by point.
struct Collector {
    PointCloud cloud;
    std::vector<Role> roles;  ///< one role per field

    explicit Collector(const Header& header) {
        const std::size_t count = *header.points;
        cloud.points_m.assign(count, Eigen::Vector3d::Zero());
        for (const Field& field : header.fields) {
            if (is_padding(field)) {
                roles.push_back({});
            } else if (is_colour(field)) {
                roles.push_back({Role::Kind::colour, 0});
                cloud.colours.assign(count, Rgb{});
            } else if (const auto axis = axis_of(field)) {
                roles.push_back({Role::Kind::axis, static_cast<std::size_t>(*axis)});
                cloud.double_precision = cloud.double_precision || field.bytes == 8 ||
                                         (field.type != 'F' && field.bytes == 4);
            } else {
                roles.push_back({Role::Kind::scalar, cloud.scalars.size()});
                cloud.scalars.push_back(
                    {field.name, no_values_of(field.type, field.bytes).value_or(ScalarValues())});
                cloud.scalars.back().reserve(count);
            }
        }
    }
};

/// Stores all values of one field; the values are `step` bytes apart.
void collect_field(
    const Field& field, const Role& role, const char* data, std::size_t step, PointCloud& cloud) {
    const std::size_t count = cloud.points_m.size();
    if (role.kind == Role::Kind::nothing) return;
    if (role.kind == Role::Kind::colour) {
        for (std::size_t i = 0; i < count; ++i)
            cloud.colours[i] = unpacked_colour(load_le<std::uint32_t>(data + i * step));
        return;
    }
    with_type_of(field, [&]<typename T>(T) {
        if (role.kind == Role::Kind::axis) {
            for (std::size_t i = 0; i < count; ++i)
                cloud.points_m[i][static_cast<Eigen::Index>(role.index)] =
                    static_cast<double>(load_le<T>(data + i * step));
            return;
        }
        auto& values = *std::get_if<std::vector<T>>(&cloud.scalars[role.index].values);
        for (std::size_t i = 0; i < count; ++i) values.push_back(load_le<T>(data + i * step));
    });
}

void collect_binary(const Header& header, std::string_view data, bool by_field, Collector& out) {
    const std::size_t stride = header.stride();
    std::size_t offset = 0;
    for (std::size_t f = 0; f < header.fields.size(); ++f) {
        const Field& field = header.fields[f];
        const std::size_t size = field.bytes * field.count;
        // Uncompressed data are stored point by point, compressed data field by field.
        const std::size_t first = by_field ? offset * *header.points : offset;
        collect_field(
            field, out.roles[f], data.data() + first, by_field ? size : stride, out.cloud);
        offset += size;
    }
}

/// Parses a colour in text: a float whose bits are the colour, or a whole number.
std::optional<Rgb> parse_colour(std::string_view word, const Field& field) {
    const auto value = parse_value(word);
    if (!value) return std::nullopt;
    if (field.type == 'F') {
        const bool is_float =
            std::abs(*value) <= static_cast<double>(std::numeric_limits<float>::max());
        return unpacked_colour(
            std::bit_cast<std::uint32_t>(is_float ? static_cast<float>(*value) : 0.0F));
    }
    const bool fits = *value >= 0.0 && *value <= 4294967295.0;
    return unpacked_colour(static_cast<std::uint32_t>(fits ? *value : 0.0));  // in range
}

/// Stores a word of point `i`; returns false if the word is not a number of the field's type.
bool collect_word(
    std::string_view word, const Field& field, const Role& role, std::size_t i, PointCloud& cloud) {
    switch (role.kind) {
        case Role::Kind::nothing: return parse_value(word).has_value();
        case Role::Kind::colour: {
            const auto colour = parse_colour(word, field);
            cloud.colours[i] = colour.value_or(Rgb{});
            return colour.has_value();
        }
        case Role::Kind::axis: {
            const auto value = parse_value(word);
            cloud.points_m[i][static_cast<Eigen::Index>(role.index)] = value.value_or(0.0);
            return value.has_value();
        }
        case Role::Kind::scalar: return cloud.scalars[role.index].add(word);
    }
    return false;
}

Status collect_ascii(const Header& header, const std::string& file, Collector& out) {
    LineReader lines(header.body);
    std::size_t point = 0;
    while (point < *header.points) {
        const auto line = lines.next();
        if (!line) {
            return input_error(
                fmt::format("{}: truncated PCD: {} of {} points; copy the file again",
                            file,
                            point,
                            *header.points));
        }
        const int number = header.last_line + lines.number();
        const std::vector<std::string_view> words = split(*line);
        if (words.empty()) continue;
        if (words.size() != header.values_per_point()) {
            return at_line(file,
                           number,
                           fmt::format("the line has {} values, but a point has {}",
                                       words.size(),
                                       header.values_per_point()));
        }
        std::size_t w = 0;
        for (std::size_t f = 0; f < header.fields.size(); ++f) {
            const Field& field = header.fields[f];
            for (std::size_t k = 0; k < field.count; ++k, ++w) {
                if (collect_word(words[w], field, out.roles[f], point, out.cloud)) continue;
                return at_line(file,
                               number,
                               parse_value(words[w])
                                   ? fmt::format("{} does not fit the field {} of type {}{}; "
                                                 "correct the value, or TYPE and SIZE of the field",
                                                 quoted(words[w]),
                                                 quoted(field.name),
                                                 field.type,
                                                 field.bytes)
                                   : why_no_number(words[w]));
            }
        }
        ++point;
    }
    return {};
}

/// Names the contents of the file that the cloud cannot store.
std::vector<std::string> notes_of(const Header& header) {
    std::vector<std::string> notes;
    for (const Field& field : header.fields) {
        if (field.name == "rgba" && is_colour(field)) {
            notes.emplace_back("the fourth channel of 'rgba' is not kept");
        } else if (field.name != "_" && field.count > 1) {
            notes.push_back(
                fmt::format("the field {} is not kept, because it has {} values per point",
                            quoted(field.name),
                            field.count));
        }
    }
    return notes;
}

/// Returns the unpacked values of a compressed body, field after field. Checks the sizes before it
/// allocates memory.
Result<std::string> unpacked_body(const Header& header, const std::string& file) {
    const std::uint64_t needed = *header.points * header.stride();
    if (header.body.size() < 8)
        return input_error(
            file +
            ": truncated PCD: the sizes of the compressed data are missing; copy the file again");
    const auto packed = load_le<std::uint32_t>(header.body.data());
    const auto unpacked = load_le<std::uint32_t>(header.body.data() + 4);
    if (unpacked != needed) {
        return input_error(
            fmt::format("{}: {} points of {} bytes each do not give the {} bytes that the file "
                        "announces; copy the file again",
                        file,
                        *header.points,
                        header.stride(),
                        unpacked));
    }
    if (packed > header.body.size() - 8) {  // bytes after `packed` are padding
        return input_error(
            fmt::format("{}: truncated PCD: {} of {} compressed bytes; copy the file again",
                        file,
                        header.body.size() - 8,
                        packed));
    }
    auto data = unpack_lzf(header.body.substr(8, packed), unpacked);
    if (!data)
        return input_error(
            fmt::format("{}: damaged compressed PCD data; copy the file again", file));
    return *std::move(data);
}

Status check_fields(const Header& header, const std::string& file) {
    int axes[3] = {0, 0, 0};
    for (const Field& field : header.fields) {
        if (const auto axis = axis_of(field)) ++axes[*axis];
        if (field.type == 'F' && field.bytes < 4) {
            return input_error(
                fmt::format("{}: field {}: TYPE F needs SIZE 4 or 8", file, quoted(field.name)));
        }
    }
    if (axes[0] == 1 && axes[1] == 1 && axes[2] == 1) return {};
    return input_error(
        fmt::format("{}: a PCD file must have each of the fields x, y and z exactly once", file));
}

}  // namespace

Result<PointCloud> parse_pcd(std::string_view bytes, const std::string& file) {
    const Result<Header> header = parse_header(bytes, file);
    if (!header) return header.error();
    if (Status status = check_fields(*header, file); !status) return status.error();
    const bool ascii = header->data == Header::Data::ascii;
    const std::uint64_t smallest = ascii ? 2 * header->values_per_point() : header->stride();
    const std::uint64_t needed = *header->points * smallest;
    std::string unpacked;
    std::string_view data = header->body;
    if (header->data == Header::Data::compressed) {
        Result<std::string> body = unpacked_body(*header, file);
        if (!body) return body.error();
        unpacked = std::move(body).value();
        data = unpacked;
    } else if (needed > data.size() + 1) {
        return input_error(
            fmt::format("{}: truncated PCD: {} points need {} bytes, but only {} follow the "
                        "header; copy the file again",
                        file,
                        *header->points,
                        needed,
                        data.size()));
    } else if (!ascii && needed > data.size()) {
        return input_error(fmt::format(
            "{}: truncated PCD: {} of {} bytes; copy the file again", file, data.size(), needed));
    }
    Collector collector(*header);
    if (ascii) {
        if (Status status = collect_ascii(*header, file, collector); !status) return status.error();
    } else {
        collect_binary(*header, data, header->data == Header::Data::compressed, collector);
    }
    PointCloud cloud = std::move(collector.cloud);
    cloud.width = static_cast<int>(*header->width);
    cloud.height = static_cast<int>(header->height);
    if (cloud.points_m.empty()) cloud.width = 0;
    if (cloud.points_m.empty() || cloud.height == 0) cloud.height = 1;
    cloud.T_cloud_sensor = header->T_cloud_sensor;
    cloud.notes = notes_of(*header);
    return cloud;
}

std::optional<CloudRows> pcd_rows(std::string_view head, std::uint64_t size) {
    const Result<Header> header = parse_header(head, "");
    if (!header || header->data != Header::Data::binary || !check_fields(*header, ""))
        return std::nullopt;
    CloudRows rows;
    rows.first_byte = head.size() - header->body.size();
    rows.rows = *header->points;
    rows.row_bytes = header->stride();
    if (rows.rows > (size - rows.first_byte) / rows.row_bytes) return std::nullopt;
    rows.head = [text = std::string(head.substr(0, rows.first_byte))](std::uint64_t count) {
        std::string with_count;
        LineReader lines(text);
        while (const auto line = lines.next()) {
            const auto words = split(*line);
            const std::string_view key = words.empty() ? std::string_view() : words[0];
            if (key == "WIDTH" || key == "POINTS") {  // version 0.5 has POINTS but no WIDTH
                with_count += fmt::format("{} {}", key, count);
            } else {
                with_count += key == "HEIGHT" ? "HEIGHT 1" : std::string(*line);
            }
            with_count += '\n';
        }
        return with_count;
    };
    return rows;
}

std::string format_pcd(const PointCloud& cloud, const CloudFormat& format) {
    std::string fields, sizes, types, counts;
    const auto add_field = [&](const std::string& name, std::size_t bytes, char type) {
        fields += " " + name;
        sizes += fmt::format(" {}", bytes);
        types += fmt::format(" {}", type);
        counts += " 1";
    };
    for (const char* axis : {"x", "y", "z"}) add_field(axis, format.double_precision ? 8 : 4, 'F');
    if (!cloud.colours.empty()) add_field("rgb", 4, 'U');
    for (const CloudScalar& scalar : cloud.scalars) {
        std::visit(
            [&](const auto& v) {
                using T = typename std::decay_t<decltype(v)>::value_type;
                const char type = std::is_floating_point_v<T> ? 'F'
                                  : std::is_signed_v<T>       ? 'I'
                                                              : 'U';
                add_field(one_word(scalar.name), sizeof(T), type);
            },
            scalar.values);
    }
    const Pose view = cloud.T_cloud_sensor.value_or(Pose{});
    const Eigen::Vector3d& t = view.translation_m;
    const Eigen::Quaterniond& q = view.rotation;
    std::string out = fmt::format(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
        "FIELDS{}\nSIZE{}\nTYPE{}\nCOUNT{}\n"
        "WIDTH {}\nHEIGHT {}\nVIEWPOINT {} {} {} {} {} {} {}\nPOINTS {}\nDATA {}\n",
        fields,
        sizes,
        types,
        counts,
        cloud.width,
        cloud.height,
        t.x(),
        t.y(),
        t.z(),
        q.w(),
        q.x(),
        q.y(),
        q.z(),
        cloud.points_m.size(),
        format.binary ? "binary" : "ascii");
    const auto put_number = [&](auto value) {
        if (format.binary) {
            store_le(out, value);
        } else {
            out += fmt::format("{} ", value);
        }
    };
    for (std::size_t i = 0; i < cloud.points_m.size(); ++i) {
        for (const double value : cloud.points_m[i]) {
            format.double_precision ? put_number(value) : put_number(static_cast<float>(value));
        }
        if (!cloud.colours.empty()) {
            const Rgb& c = cloud.colours[i];
            put_number(static_cast<std::uint32_t>(c.r << 16 | c.g << 8 | c.b));
        }
        for (const CloudScalar& scalar : cloud.scalars)
            std::visit([&](const auto& v) { put_number(v[i]); }, scalar.values);
        if (!format.binary) out.back() = '\n';
    }
    return out;
}

Status write_pcd(const std::string& path, const PointCloud& cloud, const CloudFormat& format) {
    if (const auto problem = cloud.problem()) return output_error(path + ": " + *problem);
    return write_file(path, format_pcd(cloud, format));
}

}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/raw_floats.hpp"

#include <fmt/format.h>

#include "surefoot/io/bytes.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::io {

Result<std::vector<float>> parse_floats(std::string_view bytes,
                                        const std::string& file,
                                        std::optional<std::size_t> count) {
    if (bytes.size() % sizeof(float) != 0) {
        return input_error(
            fmt::format("{}: {} bytes are not a multiple of 4, the size of a float32 value",
                        file,
                        bytes.size()));
    }
    std::vector<float> values(bytes.size() / sizeof(float));
    if (count && values.size() != *count) {
        return input_error(fmt::format(
            "{}: the file has {} float32 values; {} are expected", file, values.size(), *count));
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = load_le<float>(bytes.data() + i * sizeof(float));
    }
    return values;
}

Result<std::vector<float>> read_floats(const std::string& path, std::optional<std::size_t> count) {
    const Result<std::string> bytes = read_file(path, limits::kMapBytes);
    if (!bytes) return bytes.error();
    return parse_floats(*bytes, path, count);
}

Status write_floats(const std::string& path, std::span<const float> values) {
    std::string bytes;
    bytes.reserve(values.size_bytes());
    for (const float value : values) store_le(bytes, value);
    return write_file(path, bytes);
}

}  // namespace surefoot::io

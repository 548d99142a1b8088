// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/clouds/point_cloud.hpp"

#include <fmt/format.h>

#include "surefoot/io/file.hpp"

namespace surefoot::io {

const CloudScalar* PointCloud::scalar(std::string_view name) const noexcept {
    for (const CloudScalar& candidate : scalars) {
        if (candidate.name == name) return &candidate;
    }
    return nullptr;
}

std::optional<std::string> PointCloud::problem() const {
    const std::size_t count = points_m.size();
    if (width < 0 || height < 1 ||
        static_cast<std::size_t>(width) * static_cast<std::size_t>(height) != count) {
        return fmt::format(
            "a cloud of {} points cannot have the size {} x {}", count, width, height);
    }
    if (!colours.empty() && colours.size() != count) {
        return fmt::format(
            "{} colours for {} points; the numbers must be equal", colours.size(), count);
    }
    for (const CloudScalar& scalar : scalars) {
        if (scalar.size() != count) {
            return fmt::format("{} values of '{}' for {} points; the numbers must be equal",
                               scalar.size(),
                               scalar.name,
                               count);
        }
    }
    return std::nullopt;
}

bool is_text_cloud(std::string_view extension) noexcept {
    return extension == ".xyz" || extension == ".asc" || extension == ".txt" ||
           extension == ".csv" || extension == ".pts";
}

Result<PointCloud> parse_cloud(std::string_view bytes, const std::string& file) {
    const std::string extension = extension_of(file);
    if (extension == ".ply") return parse_ply(bytes, file);
    if (extension == ".pcd") return parse_pcd(bytes, file);
    if (extension == ".las") return parse_las(bytes, file);
    if (extension == ".vtk") return parse_vtk(bytes, file);
    return parse_text_cloud(bytes, file);
}

namespace {

/// Refuses a file with a zero byte among its first four bytes, before the program reads gigabytes.
/// Every cloud format begins with text, also LAS: its first four bytes are "LASF".
Status check_beginning(const std::string& path) {
    auto file = files::InputFile::open(path, limits::kCloudBytes);
    if (!file) return file.error();
    const Result<std::string> head = file->read_at(0, 4);
    if (!head) return head.error();
    if (head->find('\0') == head->npos) return {};
    return input_error(path +
                       ": not a cloud: its first four bytes contain a zero byte; check the file");
}

}  // namespace

Result<PointCloud> read_cloud(const std::string& path) {
    const std::string extension = extension_of(path);
    const bool named =
        extension == ".ply" || extension == ".pcd" || extension == ".las" || extension == ".vtk";
    if (!named && !is_text_cloud(extension)) {
        const char* hint =
            extension == ".laz"
                ? "LAZ is not supported: convert it with 'pdal translate "
                  "IN.laz OUT.las' or 'laszip'"
                : "clouds are read from .ply .pcd .las .vtk .xyz .asc .txt .csv .pts";
        return input_error(fmt::format("{}: unknown cloud format '{}'; {}", path, extension, hint));
    }
    if (Status status = check_beginning(path); !status) return status.error();
    const Result<std::string> bytes = read_file(path, limits::kCloudBytes);
    if (!bytes) return bytes.error();
    return parse_cloud(*bytes, path);
}

}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/io/clouds/cloud_scalar.hpp"
#include "surefoot/io/images/image_file.hpp"

namespace surefoot::io {

/// Points of a file, in the frame of the file [m].
struct PointCloud {
    std::vector<Eigen::Vector3d> points_m;  ///< NaN = no measurement (organised clouds)
    int width = 0;                          ///< columns if organised; otherwise number of points
    int height = 1;            ///< rows; above 1 if organised: (u, v) has index v * width + u
    std::vector<Rgb> colours;  ///< one colour per point, or empty
    std::vector<CloudScalar> scalars;
    /// Viewpoint, if the file has one (PCD's VIEWPOINT). The points keep the frame of the file: the
    /// viewpoint is not applied to them.
    std::optional<Pose> T_cloud_sensor;
    bool double_precision = false;   ///< true if coordinates may need more than 24 bits
    std::vector<std::string> notes;  ///< sentences about contents of the file that are missing here

    [[nodiscard]] bool organised() const noexcept { return height > 1; }
    [[nodiscard]] const CloudScalar* scalar(std::string_view name) const noexcept;
    /// Describes the first inconsistency of the sizes; no value if there is none.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// Options for writing a cloud.
struct CloudFormat {
    bool binary = true;
    bool double_precision = false;  ///< coordinates as doubles; a float has only 24 bits
};

/// Returns true for the extension of a text cloud (one point per line): .xyz .asc .txt .csv .pts.
[[nodiscard]] bool is_text_cloud(std::string_view extension) noexcept;

/// Reads a cloud by its extension: .ply, .pcd, .las, .vtk, and .xyz .asc .txt .csv .pts as text.
[[nodiscard]] Result<PointCloud> read_cloud(const std::string& path);
/// Parses the content of a cloud file; the extension of `file` selects the format.
[[nodiscard]] Result<PointCloud> parse_cloud(std::string_view bytes, const std::string& file);

/// Parses PLY 1.0: ascii, binary_little_endian, binary_big_endian; vertices with x y z, optional
/// colours (red green blue, all three as uchar) and any further numeric property as scalar. Lists
/// and other elements are skipped.
[[nodiscard]] Result<PointCloud> parse_ply(std::string_view bytes, const std::string& file);
[[nodiscard]] std::string format_ply(const PointCloud& cloud, const CloudFormat& format = {});
[[nodiscard]] Status write_ply(const std::string& path,
                               const PointCloud& cloud,
                               const CloudFormat& format = {});

/// Parses PCD 0.5 to 0.7: ascii, binary, binary_compressed (LZF). Padding and fields with COUNT
/// other than 1 are skipped. Accepts X Y Z, COLUMNS in place of FIELDS, and a missing WIDTH.
[[nodiscard]] Result<PointCloud> parse_pcd(std::string_view bytes, const std::string& file);
[[nodiscard]] std::string format_pcd(const PointCloud& cloud, const CloudFormat& format = {});
[[nodiscard]] Status write_pcd(const std::string& path,
                               const PointCloud& cloud,
                               const CloudFormat& format = {});

/// Parses LAS 1.0 to 1.4, point formats 0 to 10, but not LAZ. The fields of a point become scalars
/// and 8-bit colours. Flags, wave packets and extra bytes are skipped.
[[nodiscard]] Result<PointCloud> parse_las(std::string_view bytes, const std::string& file);

/// Parses the POINTS of a legacy VTK file in text form.
[[nodiscard]] Result<PointCloud> parse_vtk(std::string_view bytes, const std::string& file);

/// Parses text, one point per line. Blanks, tabs, commas or semicolons separate fields. A header
/// line, with or without '#' or '//', names the columns; x, y and z are found by name. Without a
/// header x, y and z are the first three columns. Further columns become scalars; an empty field is
/// NaN. A single number in a line before the points is their count. Errors in a line name the line.
[[nodiscard]] Result<PointCloud> parse_text_cloud(std::string_view text, const std::string& file);
[[nodiscard]] std::string format_text_cloud(const PointCloud& cloud);
[[nodiscard]] Status write_text_cloud(const std::string& path, const PointCloud& cloud);

}  // namespace surefoot::io

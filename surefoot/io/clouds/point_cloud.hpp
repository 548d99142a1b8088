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

/// Points of a file, in its own frame [m].
struct PointCloud {
    std::vector<Eigen::Vector3d> points_m;  ///< NaN = no measurement (organised clouds)
    int width = 0;                          ///< organised: columns; otherwise all points in one row
    int height = 1;            ///< organised: rows > 1; point of (u, v) at v * width + u
    std::vector<Rgb> colours;  ///< one per point, or none at all
    std::vector<CloudScalar> scalars;
    /// Viewpoint, where the file knows one (PCD's VIEWPOINT). The points are as the file has them:
    /// it is not applied to them.
    std::optional<Pose> T_cloud_sensor;
    bool double_precision = false;   ///< the file's coordinates may need more than 24 bits
    std::vector<std::string> notes;  ///< what the file holds that is not here, a sentence each

    [[nodiscard]] bool organised() const noexcept { return height > 1; }
    [[nodiscard]] const CloudScalar* scalar(std::string_view name) const noexcept;
    /// First reason why the sizes do not fit each other, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// How a cloud is written.
struct CloudFormat {
    bool binary = true;
    bool double_precision = false;  ///< for large (projected) coordinates; float keeps 24 bits
};

/// .xyz .asc .txt .csv .pts: a point a line.
[[nodiscard]] bool is_text_cloud(std::string_view extension) noexcept;

/// By extension: .ply, .pcd, .las, .vtk, and .xyz .asc .txt .csv .pts as text.
[[nodiscard]] Result<PointCloud> read_cloud(const std::string& path);
/// The content of such a file; `file` says by its extension what it is.
[[nodiscard]] Result<PointCloud> parse_cloud(std::string_view bytes, const std::string& file);

/// PLY 1.0: ascii, binary_little_endian, binary_big_endian; vertices with x y z, optional colours
/// (red green blue, all three as uchar) and any further numeric property as scalar. Lists and other
/// elements are stepped over.
[[nodiscard]] Result<PointCloud> parse_ply(std::string_view bytes, const std::string& file);
[[nodiscard]] std::string format_ply(const PointCloud& cloud, const CloudFormat& format = {});
[[nodiscard]] Status write_ply(const std::string& path,
                               const PointCloud& cloud,
                               const CloudFormat& format = {});

/// PCD 0.5 to 0.7: ascii, binary, binary_compressed (LZF); padding fields and COUNT > 1 are stepped
/// over. X Y Z, COLUMNS for FIELDS and a head without WIDTH are read too.
[[nodiscard]] Result<PointCloud> parse_pcd(std::string_view bytes, const std::string& file);
[[nodiscard]] std::string format_pcd(const PointCloud& cloud, const CloudFormat& format = {});
[[nodiscard]] Status write_pcd(const std::string& path,
                               const PointCloud& cloud,
                               const CloudFormat& format = {});

/// LAS 1.0 to 1.4, point formats 0 to 10, not LAZ: the fields of a point as scalars, and colours
/// (of 8 bits). Flags, wave packets and extra bytes are stepped over.
[[nodiscard]] Result<PointCloud> parse_las(std::string_view bytes, const std::string& file);

/// The POINTS of a legacy VTK file, as text.
[[nodiscard]] Result<PointCloud> parse_vtk(std::string_view bytes, const std::string& file);

/// Lines of points in text. One of blanks (or tabs), commas and semicolons separates. A head line,
/// with or without '#' or '//' before it, names the columns: x, y and z are found by their names.
/// Without one they are the first three. Further columns become scalars; an empty field is NaN. A
/// number alone in a line, before points, is how many follow. Errors name the line.
[[nodiscard]] Result<PointCloud> parse_text_cloud(std::string_view text, const std::string& file);
[[nodiscard]] std::string format_text_cloud(const PointCloud& cloud);
[[nodiscard]] Status write_text_cloud(const std::string& path, const PointCloud& cloud);

}  // namespace surefoot::io

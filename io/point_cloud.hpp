// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/image_file.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::io {

/// A further value per point: intensity, variance, a normal's component.
struct CloudScalar {
    std::string name;
    std::vector<float> values;
};

/// Points of a file, in its own frame [m].
struct PointCloud {
    std::vector<Eigen::Vector3d> points_m;  ///< NaN = no measurement (organised clouds)
    int width = 0;                          ///< organised: columns; otherwise all points in one row
    int height = 1;            ///< organised: rows > 1; point of (u, v) at v * width + u
    std::vector<Rgb> colours;  ///< one per point, or none at all
    std::vector<CloudScalar> scalars;
    std::optional<Pose> T_cloud_sensor;  ///< viewpoint, where the file knows one

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

/// .xyz .asc .txt .csv: a point a line.
[[nodiscard]] bool is_text_cloud(std::string_view extension) noexcept;

/// By extension: .ply, .pcd, .las, .vtk, and .xyz .asc .txt .csv as text.
[[nodiscard]] Result<PointCloud> read_cloud(const std::string& path);
/// The content of such a file; `file` says by its extension what it is.
[[nodiscard]] Result<PointCloud> parse_cloud(std::string_view bytes, const std::string& file);

/// PLY 1.0: ascii, binary_little_endian, binary_big_endian; vertices with x y z, optional colours
/// (red green blue) and any further numeric property as scalar. Other elements are stepped over.
[[nodiscard]] Result<PointCloud> parse_ply(std::string_view bytes, const std::string& file);
[[nodiscard]] std::string format_ply(const PointCloud& cloud, const CloudFormat& format = {});
[[nodiscard]] Status write_ply(const std::string& path,
                               const PointCloud& cloud,
                               const CloudFormat& format = {});

/// PCD 0.7: ascii, binary, binary_compressed (LZF); padding fields and COUNT > 1 are stepped over.
[[nodiscard]] Result<PointCloud> parse_pcd(std::string_view bytes, const std::string& file);
[[nodiscard]] std::string format_pcd(const PointCloud& cloud, const CloudFormat& format = {});
[[nodiscard]] Status write_pcd(const std::string& path,
                               const PointCloud& cloud,
                               const CloudFormat& format = {});

/// LAS 1.0 to 1.4, point formats 0 to 10: intensity, classification and colours; not LAZ.
[[nodiscard]] Result<PointCloud> parse_las(std::string_view bytes, const std::string& file);

/// The POINTS of a legacy VTK file, as text.
[[nodiscard]] Result<PointCloud> parse_vtk(std::string_view bytes, const std::string& file);

/// Lines of at least "x y z" with blanks, commas, semicolons or tabs between; '#' and '//' lines
/// are comments; a "//X Y Z name ..." head names the further columns, which become scalars.
[[nodiscard]] Result<PointCloud> parse_text_cloud(std::string_view text, const std::string& file);
[[nodiscard]] std::string format_text_cloud(const PointCloud& cloud);
[[nodiscard]] Status write_text_cloud(const std::string& path, const PointCloud& cloud);

}  // namespace surefoot::io

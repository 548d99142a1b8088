// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/settings/yaml_tree.hpp"

/// Helpers that the rig readers share; private to them.
namespace surefoot::io {

/// Largest side of a camera image in a rig file [px].
inline constexpr int kMaxRigSide_px = 1 << 15;

/// Reads [width, height] in px.
[[nodiscard]] ImageSize read_size(YamlReader& yaml, const YamlNode& node, std::string_view key);
/// Reads a rigid 4x4 matrix, 16 numbers row by row; R^T R may differ from 1 by less than 1e-3.
[[nodiscard]] Pose read_pose(YamlReader& yaml, const YamlNode& node, std::string_view key);
[[nodiscard]] Pose pose_from_rows(YamlReader& yaml,
                                  const YamlNode& node,
                                  std::string_view key,
                                  const std::vector<double>& rows);
/// Formats numbers as "[a, b, c]", with all digits that an exact value needs.
[[nodiscard]] std::string format_list(const std::vector<double>& values);
/// Formats the 16 matrix numbers of a pose.
[[nodiscard]] std::string format_pose_rows(const Pose& pose);
/// Reads one focal length or a pair [px], each above 0.
[[nodiscard]] std::vector<double> read_focal(YamlReader& yaml,
                                             const YamlNode& node,
                                             std::string_view key);
/// Builds a lens from intrinsics (fx fy cx cy) and coefficients in OpenCV's order k1 k2 p1 p2 k3 k4
/// k5 k6; the last ones may be missing. The lens is rational if k4, k5 or k6 is not 0.
[[nodiscard]] camera::CameraModel make_pinhole(const std::vector<double>& intrinsics,
                                               std::vector<double> coefficients);
[[nodiscard]] camera::CameraModel make_rational(const std::vector<double>& intrinsics,
                                                std::vector<double> coefficients);
[[nodiscard]] camera::CameraModel make_kannala_brandt(const std::vector<double>& intrinsics,
                                                      std::vector<double> coefficients);
/// Returns fx fy cx cy; coefficients_of returns the distortion coefficients of the lens.
[[nodiscard]] std::vector<double> intrinsics_of(const camera::CameraModel& model);
[[nodiscard]] std::vector<double> coefficients_of(const camera::CameraModel& model);
[[nodiscard]] bool is_kannala_brandt(const camera::CameraModel& model) noexcept;
[[nodiscard]] bool is_rational(const camera::CameraModel& model) noexcept;
/// Fails unless the rig is valid and has two cameras, which the formats of other programs require.
[[nodiscard]] Status check_pair(const camera::StereoRig& rig, std::string_view format);
/// Builds a rigid motion from a rotation (9 numbers row by row) and a translation [m].
[[nodiscard]] Pose pose_from_parts(YamlReader& yaml,
                                   const YamlNode& node,
                                   std::string_view key,
                                   const std::vector<double>& R,
                                   const std::vector<double>& t_m);

/// Reads `min` to `max` numbers of a matrix {rows, cols, data} or of a plain list.
[[nodiscard]] std::vector<double> read_matrix(
    YamlReader& yaml, const YamlNode& node, std::string_view key, std::size_t min, std::size_t max);
/// Returns the lens, or reports its error at the key of its coefficients.
[[nodiscard]] camera::CameraModel lens_or_fail(YamlReader& yaml,
                                               const YamlNode& node,
                                               std::string_view key,
                                               const Result<camera::CameraModel>& lens);
/// Checks that the focal lengths of a camera matrix (9 numbers row by row) are above 0.
void check_focal(YamlReader& yaml,
                 const YamlNode& node,
                 std::string_view key,
                 const std::vector<double>& K);

/// Matrices of the rectification of a camera pair, in the form of OpenCV and ROS, row by row.
struct RectifiedMatrices {
    std::vector<double> R_left, R_right;  ///< 3x3, x_rectified = R x_raw
    std::vector<double> P_left, P_right;  ///< 3x4; P_right(0, 3) = -fx * baseline [px m]
    std::vector<double> Q;  ///< 4x4, maps (u, v, disparity, 1) to W (x, y, z, 1), point in m
};
/// Computes Surefoot's rectification (camera::Rectifier). `rig` must be valid and a pair.
[[nodiscard]] RectifiedMatrices rectified_matrices(const camera::StereoRig& rig);

/// Works like parse_opencv_rig, but on a parsed document; also returns the notes.
[[nodiscard]] Result<RigFile> opencv_rig(const YamlNode& root,
                                         const std::string& file,
                                         std::optional<ImageSize> size);
/// Mounts an IMU whose pose in the left camera is known. base_link lies at the left camera (axes:
/// T_body_optical). `rate_hz` 0 means unknown: assumes 200 Hz. Adds a note about this.
void mount_imu(const Pose& T_left_imu, double rate_hz, RigFile& out);

/// Returns the rig, the error of the reader, or the problem of the rig with the file name.
[[nodiscard]] Result<camera::StereoRig> checked_rig(camera::StereoRig rig, const YamlReader& yaml);
[[nodiscard]] Result<camera::StereoRig> checked_rig(camera::StereoRig rig, const std::string& file);
/// Final step for calibration files. Checks the rig, marks rectified rigs, and adds notes if the
/// focal length or the baseline is unusual.
[[nodiscard]] Result<RigFile> checked_file(RigFile out, const std::string& file);

}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/settings/yaml_tree.hpp"

/// Pieces that the rig formats share; private to them.
namespace surefoot::io {

/// Largest side of a camera image that a rig file may claim.
inline constexpr int kMaxRigSide_px = 1 << 15;

/// [width, height].
[[nodiscard]] ImageSize read_size(YamlReader& yaml, const YamlNode& node, std::string_view key);
/// A rigid 4x4 matrix, 16 numbers row by row; the rotation may be rounded to 1e-3.
[[nodiscard]] Pose read_pose(YamlReader& yaml, const YamlNode& node, std::string_view key);
[[nodiscard]] Pose pose_from_rows(YamlReader& yaml,
                                  const YamlNode& node,
                                  std::string_view key,
                                  const std::vector<double>& rows);
/// "[a, b, c]" with numbers that read back exactly.
[[nodiscard]] std::string format_list(const std::vector<double>& values);
/// 16 numbers of the matrix of a pose.
[[nodiscard]] std::string format_pose_rows(const Pose& pose);
/// A focal length or a pair of them, above 0.
[[nodiscard]] std::vector<double> read_focal(YamlReader& yaml,
                                             const YamlNode& node,
                                             std::string_view key);
/// Lens from intrinsics (fx fy cx cy) and coefficients in OpenCV's order k1 k2 p1 p2 k3 k4 k5 k6,
/// the last ones may be missing; the rational model where k4, k5 or k6 is not 0.
[[nodiscard]] camera::CameraModel make_pinhole(const std::vector<double>& intrinsics,
                                               std::vector<double> coefficients);
[[nodiscard]] camera::CameraModel make_rational(const std::vector<double>& intrinsics,
                                                std::vector<double> coefficients);
[[nodiscard]] camera::CameraModel make_kannala_brandt(const std::vector<double>& intrinsics,
                                                      std::vector<double> coefficients);
/// (fx fy cx cy) and the coefficients of a lens.
[[nodiscard]] std::vector<double> intrinsics_of(const camera::CameraModel& model);
[[nodiscard]] std::vector<double> coefficients_of(const camera::CameraModel& model);
[[nodiscard]] bool is_kannala_brandt(const camera::CameraModel& model) noexcept;
[[nodiscard]] bool is_rational(const camera::CameraModel& model) noexcept;
/// Error unless the rig is sound and has two cameras, as the files of others want it.
[[nodiscard]] Status check_pair(const camera::StereoRig& rig, std::string_view format);
/// Rigid motion of a rotation, 9 numbers row by row, and a translation [m].
[[nodiscard]] Pose pose_from_parts(YamlReader& yaml,
                                   const YamlNode& node,
                                   std::string_view key,
                                   const std::vector<double>& R,
                                   const std::vector<double>& t_m);

/// The numbers of a matrix {rows, cols, data} or of a plain list: `min` to `max` of them.
[[nodiscard]] std::vector<double> read_matrix(
    YamlReader& yaml, const YamlNode& node, std::string_view key, std::size_t min, std::size_t max);
/// The lens, or a failure of the key that holds its coefficients.
[[nodiscard]] camera::CameraModel lens_or_fail(YamlReader& yaml,
                                               const YamlNode& node,
                                               std::string_view key,
                                               const Result<camera::CameraModel>& lens);
/// Focal lengths of a camera matrix, 9 numbers row by row, must be above 0.
void check_focal(YamlReader& yaml,
                 const YamlNode& node,
                 std::string_view key,
                 const std::vector<double>& K);

/// The rectification of a pair as OpenCV and ROS write it, row by row.
struct RectifiedMatrices {
    std::vector<double> R_left, R_right;  ///< 3x3, x_rectified = R x_raw
    std::vector<double> P_left, P_right;  ///< 3x4; P_right(0, 3) = -fx * baseline [px m]
    std::vector<double> Q;                ///< 4x4, (u, v, disparity, 1) to (X, Y, Z, W) [m]
};
/// Our own rectification (see camera::Rectifier). `rig` must have two cameras and no problem().
[[nodiscard]] RectifiedMatrices rectified_matrices(const camera::StereoRig& rig);

/// parse_opencv_rig of a document that is parsed already, with its notes.
[[nodiscard]] Result<RigFile> opencv_rig(const YamlNode& root,
                                         const std::string& file,
                                         std::optional<ImageSize> size);
/// The IMU of a chain that knows its pose in the left camera: base_link becomes the left camera
/// turned to body axes. A rate of 0 is not in the file; 200 Hz are assumed, and a note says so.
void mount_imu(const Pose& T_left_imu, double rate_hz, RigFile& out);

/// The rig, or the reader's error, or the rig's own problem with the file's name.
[[nodiscard]] Result<camera::StereoRig> checked_rig(camera::StereoRig rig, const YamlReader& yaml);
[[nodiscard]] Result<camera::StereoRig> checked_rig(camera::StereoRig rig, const std::string& file);
/// Where every file of another program ends: marks the rig as rectified where it is, checks it, and
/// adds a note where its baseline is unusual.
[[nodiscard]] Result<RigFile> checked_file(RigFile out, const std::string& file);

}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/rig_file.hpp"
#include "io/yaml_tree.hpp"

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
/// Lens from intrinsics (fx fy cx cy) and coefficients, as many as the model has, in its order.
[[nodiscard]] camera::CameraModel make_pinhole(const std::vector<double>& intrinsics,
                                               std::vector<double> coefficients);
[[nodiscard]] camera::CameraModel make_kannala_brandt(const std::vector<double>& intrinsics,
                                                      std::vector<double> coefficients);
/// (fx fy cx cy) and the coefficients of a lens.
[[nodiscard]] std::vector<double> intrinsics_of(const camera::CameraModel& model);
[[nodiscard]] std::vector<double> coefficients_of(const camera::CameraModel& model);
[[nodiscard]] bool is_kannala_brandt(const camera::CameraModel& model) noexcept;

/// parse_opencv_rig of a document that is parsed already.
[[nodiscard]] Result<camera::StereoRig> opencv_rig(const YamlNode& root,
                                                   const std::string& file,
                                                   std::optional<ImageSize> size);

/// The rig, or the reader's error, or the rig's own problem with the file's name.
[[nodiscard]] Result<camera::StereoRig> checked_rig(camera::StereoRig rig, const YamlReader& yaml);
[[nodiscard]] Result<camera::StereoRig> checked_rig(camera::StereoRig rig, const std::string& file);

}  // namespace surefoot::io

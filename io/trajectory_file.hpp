// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::io {

/// TUM trajectory: "stamp_s tx ty tz qx qy qz qw" per line, '#' comments, stamps strictly growing.
[[nodiscard]] Result<Trajectory> parse_tum_trajectory(std::string_view text,
                                                      const std::string& file);
[[nodiscard]] Result<Trajectory> read_tum_trajectory(const std::string& path);
/// Stamps with 9 decimals are exact; lengths to 1e-9 m.
[[nodiscard]] std::string format_tum_trajectory(const Trajectory& trajectory);
[[nodiscard]] Status write_tum_trajectory(const std::string& path, const Trajectory& trajectory);

/// KITTI poses: twelve numbers per line, the upper 3x4 of T_world_camera row by row; no stamps.
[[nodiscard]] Result<std::vector<Pose>> parse_kitti_poses(std::string_view text,
                                                          const std::string& file);
[[nodiscard]] Result<std::vector<Pose>> read_kitti_poses(const std::string& path);
/// One stamp in seconds per line (KITTI times.txt). Whoever uses them checks that they grow.
[[nodiscard]] Result<std::vector<std::int64_t>> parse_times(std::string_view text,
                                                            const std::string& file);
[[nodiscard]] Result<std::vector<std::int64_t>> read_times(const std::string& path);

/// TUM or KITTI, told apart by the numbers per line. KITTI poses get their stamps from times.txt in
/// the same folder, else 10 Hz from 0.
[[nodiscard]] Result<Trajectory> read_trajectory(const std::string& path);

}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

/// Whether a baseline can be one in metres: the only place that judges the unit of a calibration.
/// Every rig passes through `baseline_problem` (StereoRig::problem), every file that is read
/// through `baseline_warning` too.
namespace surefoot::camera {

inline constexpr double kMinBaseline_m = 1e-3;
/// No stereo camera on a walking machine is wider, and every calibration in millimetres is.
inline constexpr double kMaxBaseline_m = 5.0;

/// Why a baseline of this length cannot be used, and the unit that it was probably given in: "is it
/// in mm (then 60.8 mm)?". Nothing for kMinBaseline_m .. kMaxBaseline_m.
[[nodiscard]] std::optional<std::string> baseline_problem(double length_m);

/// A baseline that is possible but unusual (shorter than 10 mm, longer than 1 m), and the unit to
/// check. Nothing for all others.
[[nodiscard]] std::optional<std::string> baseline_warning(double length_m);

/// Why a focal length cannot be one of any camera: longer than a million pixels (a telescope of 3 m
/// in front of pixels of 3 um). Camera::problem asks.
[[nodiscard]] std::optional<std::string> focal_problem(double focal_px);

/// A focal length that is so short for a pinhole image of this width [px] that it must be in
/// another unit: a field of view beyond 168 deg. Fisheyes have such views, pinholes do not.
[[nodiscard]] std::optional<std::string> focal_warning(double focal_px, int width_px);

/// Why the position of a sensor on its machine cannot be in metres: farther than 10 m away.
/// `name` is the pose's, "T_body_left".
[[nodiscard]] std::optional<std::string> mount_problem(std::string_view name, double distance_m);

}  // namespace surefoot::camera

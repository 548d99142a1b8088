// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

/// Checks of the units of a calibration: only the size of a number shows that its unit is wrong.
/// StereoRig::problem and Camera::problem use the `_problem` functions. The readers of rig files
/// also use the `_warning` functions.
namespace surefoot::camera {

inline constexpr double kMinBaseline_m = 1e-3;
/// Largest valid baseline. Cameras of walking machines have less; their baselines in mm are more.
inline constexpr double kMaxBaseline_m = 5.0;

/// Returns why a baseline cannot be used and its probable unit: "is it in mm (then 60.8 mm)?".
/// Returns nullopt from kMinBaseline_m to kMaxBaseline_m.
[[nodiscard]] std::optional<std::string> baseline_problem(double length_m);

/// Returns a warning about a valid but unusual baseline (shorter than 10 mm or longer than 1 m),
/// with the unit to check. Returns nullopt otherwise.
[[nodiscard]] std::optional<std::string> baseline_warning(double length_m);

/// Returns an error text for an impossible focal length: above a million pixels (a telescope of 3 m
/// in front of pixels of 3 um). Camera::problem calls this function.
[[nodiscard]] std::optional<std::string> focal_problem(double focal_px);

/// Returns a warning if a focal length is so short for the image width [px] that its unit must be
/// wrong: a field of view beyond 168 deg. Not for fisheye lenses, which can have such a view.
[[nodiscard]] std::optional<std::string> focal_warning(double focal_px, int width_px);

/// Returns an error if a sensor is farther than 10 m from base_link: its position is not in metres.
/// `name` is the name of the pose, for example "T_body_left".
[[nodiscard]] std::optional<std::string> mount_problem(std::string_view name, double distance_m);

}  // namespace surefoot::camera

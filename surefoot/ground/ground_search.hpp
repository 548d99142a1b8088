// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/ground/ground_observation.hpp"

namespace surefoot::ground {

/// Finds the ground when the mount of the camera is unknown. The optical axis may lie between
/// `search_up_deg` above and `search_down_deg` below the horizon. The camera may roll by
/// `search_roll_deg`, at any allowed height. Points are in camera body axes: x along the optical
/// axis, y left, z up when the axis is level. No `up_hint` is needed.
///
/// Planes are drawn through three points near each other. Of random triples, only one in a thousand
/// lies on a floor that fills a tenth of the image. Points near the best plane refine the plane
/// (`refine_plane`) and are removed; then the search continues. A plane is the ground when
/// * it fills `min_image_share` of the image and fixes its tilt (`max_search_sigma_deg`),
/// * it is a surface: few points lie just beyond it, and it scatters by at most `max_search_rms_m`,
/// * hardly any point lies more than a high step below it. This excludes table tops, beds, seats
///   and tilted backs, if the edge of the object is in view.
/// Of several such planes, the one with the largest share of the image wins.
///
/// A table that fills the whole view cannot be distinguished from a floor. The same input and seed
/// give the same bytes.
[[nodiscard]] GroundSighting search_ground(const GroundConfig& config,
                                           const FramePoints& seen,
                                           std::uint64_t seed);

/// Gives points without noise a nominal noise, seen from `sensor`; `pixels` is their number.
[[nodiscard]] FramePoints with_nominal_noise(std::span<const Eigen::Vector3d> points,
                                             const Eigen::Vector3d& sensor);

}  // namespace surefoot::ground

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/ground/ground_observation.hpp"

namespace surefoot::ground {

/// Finds the ground for a camera of which nobody says how it is mounted: looking between
/// `search_up_deg` above and `search_down_deg` below the horizon, rolled by up to
/// `search_roll_deg`, at any allowed height. Points in camera body axes: x along the optical axis,
/// y left, z up where the camera looks level; `up_hint` is not needed.
///
/// Planes are drawn through three points near each other, because a floor that fills a tenth of the
/// image holds one triple of a thousand; what is near the best one settles by its noise
/// (`refine_plane`), is taken away, and the search goes on. A plane is the ground when
/// * it fills `min_image_share` of the image,
/// * it is a surface: few points lie just beyond its roughness (`max_search_rms_m`),
/// * nothing lies farther below it than a high step: table tops, beds, seats and tilted backs have
///   something below them wherever their rim is in view.
/// Of several the lowest wins; of those a step apart the one that fills more of the image.
///
/// A table that fills the whole view cannot be told from a floor: nothing else is known here.
/// The same input and seed give the same bytes.
[[nodiscard]] GroundSighting search_ground(const GroundConfig& config,
                                           const FramePoints& seen,
                                           std::uint64_t seed);

/// The same for points without noise, seen from `sensor`; `seen.pixels` is their number.
[[nodiscard]] FramePoints with_nominal_noise(std::span<const Eigen::Vector3d> points,
                                             const Eigen::Vector3d& sensor);

}  // namespace surefoot::ground

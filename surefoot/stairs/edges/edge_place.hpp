// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// The map's knowledge of the ground where an edge should be.
enum class PlaceOfEdge : std::uint8_t {
    unknown,  ///< at least one side is unknown
    uneven,   ///< the heights of both sides differ
    level,    ///< both sides have the same height
};

/// Compares the ground on both sides of an edge. The compared strips lie outside the width over
/// which matchers spread a step and outside two sigmas of the edge's position.
[[nodiscard]] PlaceOfEdge place_of(const Edge& edge, const Terrain& terrain);

/// True if the view contains the point (View::shows). Without a view: true if its cell is known.
[[nodiscard]] bool is_observed(const Terrain& terrain, const Eigen::Vector3d& p_m);

/// True if an end or the middle of the edge lies inside the map.
[[nodiscard]] bool is_in_window(const Edge& edge, const Terrain& terrain);

}  // namespace surefoot::stairs

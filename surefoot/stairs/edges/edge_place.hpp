// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// What a map knows of the ground at the place of an edge.
enum class PlaceOfEdge : std::uint8_t {
    unknown,  ///< of one side at least
    uneven,   ///< the ground falls there, or rises
    level,    ///< as high on both sides
};

/// Compares the ground on both sides of an edge, as far away from it as matchers spread a step and
/// as two of its sigmas: level ground is level all over where the edge may be.
[[nodiscard]] PlaceOfEdge place_of(const Edge& edge, const Terrain& terrain);

/// The camera sees the place; without a camera: the map knows it.
[[nodiscard]] bool is_observed(const Terrain& terrain, const Eigen::Vector3d& p_m);

/// Some of the edge is in the map.
[[nodiscard]] bool is_in_window(const Edge& edge, const Terrain& terrain);

}  // namespace surefoot::stairs

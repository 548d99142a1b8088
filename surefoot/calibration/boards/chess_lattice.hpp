// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "surefoot/calibration/boards/chess_corners.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// Position in the lattice of a chessboard's corners. The second axis follows the first in the
/// direction of rotation from x (right) to y (down).
using Node = std::pair<int, int>;
/// Corner pixels by lattice position [px].
using Lattice = std::map<Node, Eigen::Vector2d>;

/// A group of connected corners.
struct JoinedCorners {
    Lattice lattice;
    /// True if the square between the two axes of node (0, 0) is black. The same holds for every
    /// node whose coordinates have an even sum.
    bool black_first = true;
};

/// Returns groups of corners whose edges lead to each other, with black on one side and white on
/// the other side. Every corner is part of a square of four corners. The largest group comes first.
[[nodiscard]] std::vector<JoinedCorners> joined_corners(std::span<const ChessCorner> corners,
                                                        ImageView<const std::uint8_t> image);

/// Removes corners that contradict their neighbours. Adds corners that neighbours predict and the
/// image shows, but none that makes the lattice longer than `most` nodes along an axis.
[[nodiscard]] Lattice grown_lattice(const JoinedCorners& joined,
                                    std::span<const ChessCorner> corners,
                                    ImageView<const std::uint8_t> image,
                                    int most);

/// Predicts the position of a node [px]: between its neighbours, or on the extension of the lines
/// through them. Returns nullopt with too few neighbours.
[[nodiscard]] std::optional<Eigen::Vector2d> expected_place(const Lattice& lattice,
                                                            const Node& node);

/// Returns the smallest and the largest coordinates; both are (0, 0) for an empty lattice.
[[nodiscard]] std::pair<Node, Node> bounds_of(const Lattice& lattice);

}  // namespace surefoot::calibration

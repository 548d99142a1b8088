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

/// Groups of corners whose edges lead to each other, with black on one side and white on the other.
/// Every corner belongs to a square of four. The largest group comes first.
[[nodiscard]] std::vector<JoinedCorners> joined_corners(std::span<const ChessCorner> corners,
                                                        ImageView<const std::uint8_t> image);

/// Adds corners that neighbours predict and the image shows, until no corner is added or the
/// lattice is `most` nodes long in each direction.
[[nodiscard]] Lattice grown_lattice(const JoinedCorners& joined,
                                    std::span<const ChessCorner> corners,
                                    ImageView<const std::uint8_t> image,
                                    int most);

/// Position predicted by the neighbours of a node: between them, or on the extension of the lines
/// through them. nullopt with too few neighbours.
[[nodiscard]] std::optional<Eigen::Vector2d> expected_place(const Lattice& lattice,
                                                            const Node& node);

/// Smallest and largest coordinates; (0, 0) twice for an empty lattice.
[[nodiscard]] std::pair<Node, Node> bounds_of(const Lattice& lattice);

}  // namespace surefoot::calibration

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

/// Place on the lattice of a chessboard's corners. The second axis is the first one turned onwards
/// (x right, y down).
using Node = std::pair<int, int>;
/// Corners in the image by their places on the lattice [px].
using Lattice = std::map<Node, Eigen::Vector2d>;

/// Corners that belong together.
struct JoinedCorners {
    Lattice lattice;
    /// Whether the square between the two axes of the node (0, 0) is black; so it is of every node
    /// whose coordinates have an even sum.
    bool black_first = true;
};

/// Groups of corners whose edges lead to each other, with black on one side all the way and white
/// on the other; every corner belongs to a square of four. The largest group first.
[[nodiscard]] std::vector<JoinedCorners> joined_corners(std::span<const ChessCorner> corners,
                                                        ImageView<const std::uint8_t> image);

/// The lattice with what its neighbours expect and the image shows, until nothing is added or it is
/// `most` nodes long each way.
[[nodiscard]] Lattice grown_lattice(const JoinedCorners& joined,
                                    std::span<const ChessCorner> corners,
                                    ImageView<const std::uint8_t> image,
                                    int most);

/// Where the neighbours of a node expect it: between them, or where the lines through them go on.
/// Nothing without enough of them.
[[nodiscard]] std::optional<Eigen::Vector2d> expected_place(const Lattice& lattice,
                                                            const Node& node);

/// Smallest and largest coordinates; of an empty lattice (0, 0) twice.
[[nodiscard]] std::pair<Node, Node> bounds_of(const Lattice& lattice);

}  // namespace surefoot::calibration

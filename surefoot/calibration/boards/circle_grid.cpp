// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/circle_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <map>

namespace surefoot::calibration {
namespace {

using Spots = std::vector<Eigen::Vector2d>;
/// Position in the lattice of nearest neighbours.
using Node = std::pair<int, int>;

/// Largest distance from the predicted position, as a share of the step. A spot farther away is
/// another spot.
constexpr double kCapture = 0.35;

/// Returns the nodes of the board's points. Rows of staggered circles run along the lattice
/// diagonals.
std::vector<Node> nodes_of(const Board& board) {
    std::vector<Node> nodes;
    for (int row = 0; row < board.rows; ++row) {
        for (int column = 0; column < board.columns; ++column) {
            if (board.kind == BoardKind::circles) {
                nodes.emplace_back(column, row);
            } else {
                // x = column + (row odd) / 2, y = row / 2: nodes are x + y and x - y.
                const int up = (row + 1) / 2;
                nodes.emplace_back(column + up, column + row % 2 - up);
            }
        }
    }
    return nodes;
}

struct Nearest {
    std::size_t index = 0;
    double distance_px = 0.0;
};
template <typename Accept>
std::optional<Nearest> nearest_spot(const Spots& spots,
                                    const Eigen::Vector2d& to,
                                    const Accept& accept) {
    std::optional<Nearest> best;
    for (std::size_t i = 0; i < spots.size(); ++i) {
        const double distance_px = (spots[i] - to).norm();
        if (!accept(i) || (best && distance_px >= best->distance_px)) continue;
        best = Nearest{i, distance_px};
    }
    return best;
}

/// A spot in the lattice, with the steps to its neighbours.
struct Placed {
    std::size_t spot = 0;
    Node node;
    Eigen::Vector2d steps_px[2];
};

/// Finds the spot nearest to the middle of all spots, and its two nearest neighbours in different
/// directions.
std::optional<Placed> seed_of(const Spots& spots) {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const auto& spot : spots) middle += spot / static_cast<double>(spots.size());
    const auto any = [](std::size_t) { return true; };
    const auto first = nearest_spot(spots, middle, any);
    if (!first) return std::nullopt;
    const Eigen::Vector2d& origin = spots[first->index];
    const auto along =
        nearest_spot(spots, origin, [&](std::size_t i) { return i != first->index; });
    if (!along || along->distance_px <= 0.0) return std::nullopt;
    const Eigen::Vector2d u = spots[along->index] - origin;
    const auto across = nearest_spot(spots, origin, [&](std::size_t i) {
        constexpr double kLeastSine = 0.6;
        const Eigen::Vector2d v = spots[i] - origin;
        return std::abs(u.x() * v.y() - u.y() * v.x()) > kLeastSine * u.norm() * v.norm();
    });
    if (!across) return std::nullopt;
    return Placed{first->index, {0, 0}, {u, spots[across->index] - origin}};
}

std::map<Node, std::size_t> grown_lattice(const Spots& spots, const Placed& seed) {
    std::map<Node, std::size_t> lattice = {{seed.node, seed.spot}};
    std::vector<bool> taken(spots.size(), false);
    taken[seed.spot] = true;
    std::deque<Placed> front = {seed};
    while (!front.empty()) {
        const Placed here = front.front();
        front.pop_front();
        for (int axis = 0; axis < 2; ++axis) {
            for (const int sign : {-1, 1}) {
                Node node = here.node;
                (axis == 0 ? node.first : node.second) += sign;
                if (lattice.contains(node)) continue;
                const Eigen::Vector2d& step_px = here.steps_px[axis];
                const Eigen::Vector2d expected = spots[here.spot] + sign * step_px;
                const auto found =
                    nearest_spot(spots, expected, [&](std::size_t i) { return !taken[i]; });
                if (!found || found->distance_px > kCapture * step_px.norm()) continue;
                Placed next{found->index, node, {here.steps_px[0], here.steps_px[1]}};
                next.steps_px[axis] = sign * (spots[found->index] - spots[here.spot]);
                taken[found->index] = true;
                lattice.emplace(node, found->index);
                front.push_back(next);
            }
        }
    }
    return lattice;
}

Node turned(const Node& node, int variant) {
    Node out = (variant & 4) != 0 ? Node{node.second, node.first} : node;
    if ((variant & 1) != 0) out.first = -out.first;
    if ((variant & 2) != 0) out.second = -out.second;
    return out;
}

/// Returns the smallest coordinates of the nodes.
Node corner_of(const std::vector<Node>& nodes) {
    Node corner = nodes.front();
    for (const Node& node : nodes)
        corner = {std::min(corner.first, node.first), std::min(corner.second, node.second)};
    return corner;
}

}  // namespace

std::optional<Spots> grown_grid(const Board& board, const Spots& spots) {
    const auto seed = seed_of(spots);
    if (!seed) return std::nullopt;
    const std::map<Node, std::size_t> lattice = grown_lattice(spots, *seed);
    const std::vector<Node> wanted = nodes_of(board);
    if (lattice.size() != wanted.size()) return std::nullopt;
    std::vector<Node> grown;
    grown.reserve(lattice.size());
    for (const auto& [node, spot] : lattice) grown.push_back(node);
    const Node low = corner_of(grown);
    for (int variant = 0; variant < 8; ++variant) {
        std::vector<Node> nodes;
        nodes.reserve(wanted.size());
        for (const Node& node : wanted) nodes.push_back(turned(node, variant));
        const Node corner = corner_of(nodes);
        Spots ordered;
        for (const Node& node : nodes) {
            const auto at = lattice.find(
                {node.first - corner.first + low.first, node.second - corner.second + low.second});
            if (at == lattice.end()) break;
            ordered.push_back(spots[at->second]);
        }
        if (ordered.size() == wanted.size()) return ordered;
    }
    return std::nullopt;
}

}  // namespace surefoot::calibration

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/chess_lattice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include "surefoot/calibration/boards/corner_fit.hpp"

namespace surefoot::calibration {
namespace {

constexpr int kNobody = -1;
/// Cosine of the largest angle between a corner's edge and the step to the next corner: 25 deg. A
/// ring of some pixels gives the edge direction to about 5 deg; lenses bend the edge.
constexpr double kLeastCosine = 0.906;
/// Number of corners that may be the next corner along an edge. The nearest corners are tried
/// first.
constexpr std::size_t kTried = 4;
/// Positions along an edge, as shares of its length, where its two sides are compared. At four of
/// them or more, black must be on one side and white on the other.
constexpr std::array kAlong{0.2, 0.35, 0.5, 0.65, 0.8};
/// Least mean contrast of an edge, as a share of the smaller contrast of its two end corners.
constexpr double kLeastEdge = 0.25;
/// Largest distance from the predicted position, as a share of the shorter step. A corner farther
/// away is another corner.
constexpr double kCapture = 0.3;
/// Offset from a corner into the squares for their brightness, as a share of the step.
constexpr double kIntoSquare = 0.3;
/// Largest distance of an existing corner from its predicted position, as a share of the shorter
/// step. A corner farther away is removed.
constexpr double kMostMisfit = 0.4;
/// Least contrast of an added corner, as a share of the mean contrast of the corners around it.
constexpr double kLeastClear = 0.4;
constexpr int kRounds = 12;

constexpr std::array<Node, 4> kWays{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

Node operator+(const Node& a, const Node& b) {
    return {a.first + b.first, a.second + b.second};
}
Node operator*(int n, const Node& a) {
    return {n * a.first, n * a.second};
}

/// Returns the interpolated grey value; nullopt outside the image.
std::optional<double> grey_at(ImageView<const std::uint8_t> image, const Eigen::Vector2d& p) {
    if (!(p.x() >= 0.0 && p.y() >= 0.0 && p.x() < image.width - 1 && p.y() < image.height - 1))
        return std::nullopt;
    const int u = static_cast<int>(p.x());  // in range: inside the image, see above
    const int v = static_cast<int>(p.y());  // in range: inside the image, see above
    const double s = p.x() - u;
    const double t = p.y() - v;
    const std::uint8_t* upper = image.row(v) + u;
    const std::uint8_t* lower = image.row(v + 1) + u;
    return (1.0 - t) * ((1.0 - s) * upper[0] + s * upper[1]) +
           t * ((1.0 - s) * lower[0] + s * lower[1]);
}

/// Returns true if an edge runs from one corner to the other. Black must be on the onwards side of
/// the edge (`black_onwards`) or on the other side. The onwards side is 90 deg from the direction
/// of the edge, rotated from x (right) to y (down).
bool is_edge(ImageView<const std::uint8_t> image,
             const ChessCorner& from,
             const ChessCorner& to,
             bool black_onwards) {
    const Eigen::Vector2d way_px = to.pixel - from.pixel;
    const double length_px = way_px.norm();
    const double beside_px = std::clamp(0.12 * length_px, 1.2, 8.0);
    const Eigen::Vector2d onwards = Eigen::Vector2d(-way_px.y(), way_px.x()) / length_px;
    double sum = 0.0;
    int right = 0;
    for (const double share : kAlong) {
        const Eigen::Vector2d on_px = from.pixel + share * way_px;
        const auto one = grey_at(image, on_px + beside_px * onwards);
        const auto other = grey_at(image, on_px - beside_px * onwards);
        if (!one || !other) return false;
        const double step = black_onwards ? *other - *one : *one - *other;
        sum += step;
        right += step > 0.0 ? 1 : 0;
    }
    const auto places = static_cast<int>(kAlong.size());
    const double contrast_dn = std::min(from.contrast_dn, to.contrast_dn);
    return right + 1 >= places && sum > kLeastEdge * contrast_dn * places;
}

/// The next corner along an edge, and the number of the edge of that corner that leads back.
struct Link {
    int to = kNobody;
    int back = 0;
};
using Links = std::array<Link, 4>;

/// Returns the edge of a corner in a direction (unit vector); nullopt if the corner has none.
std::optional<int> edge_towards(const ChessCorner& corner, const Eigen::Vector2d& direction) {
    for (int k = 0; k < 4; ++k)
        if (corner.edges[static_cast<std::size_t>(k)].dot(direction) > kLeastCosine) return k;
    return std::nullopt;
}

Links links_of(std::span<const ChessCorner> corners,
               std::size_t from,
               ImageView<const std::uint8_t> image) {
    struct Candidate {
        double distance_px;
        Link link;
    };
    std::array<std::vector<Candidate>, 4> all;
    for (std::size_t to = 0; to < corners.size(); ++to) {
        if (to == from) continue;
        const Eigen::Vector2d way_px = corners[to].pixel - corners[from].pixel;
        const double distance_px = way_px.norm();
        if (distance_px < 2.0) continue;
        const Eigen::Vector2d direction = way_px / distance_px;
        const auto edge = edge_towards(corners[from], direction);
        if (!edge) continue;
        const auto back = edge_towards(corners[to], -direction);
        // Black lies on one side of the edge. If this is the onwards side on the way there, it is
        // not the onwards side on the way back.
        if (!back || (*edge + *back) % 2 == 0) continue;
        auto& mine = all[static_cast<std::size_t>(*edge)];
        const Candidate candidate{distance_px, {static_cast<int>(to), *back}};
        const auto at = std::upper_bound(
            mine.begin(), mine.end(), candidate, [](const Candidate& a, const Candidate& b) {
                return a.distance_px < b.distance_px;
            });
        mine.insert(at, candidate);
        if (mine.size() > kTried) mine.pop_back();
    }
    Links links;
    for (std::size_t k = 0; k < 4; ++k) {
        for (const Candidate& candidate : all[k]) {
            const ChessCorner& to = corners[static_cast<std::size_t>(candidate.link.to)];
            if (!is_edge(image, corners[from], to, k % 2 == 0)) continue;
            links[k] = candidate.link;
            break;
        }
    }
    return links;
}

/// Returns the links that both corners confirm.
std::vector<Links> mutual_links(std::span<const ChessCorner> corners,
                                ImageView<const std::uint8_t> image) {
    std::vector<Links> all;
    all.reserve(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) all.push_back(links_of(corners, i, image));
    std::vector<Links> mutual(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
        for (std::size_t k = 0; k < 4; ++k) {
            const Link& link = all[i][k];
            if (link.to == kNobody) continue;
            const Link& back =
                all[static_cast<std::size_t>(link.to)][static_cast<std::size_t>(link.back)];
            if (back.to == static_cast<int>(i) && back.back == static_cast<int>(k))
                mutual[i][k] = link;
        }
    }
    return mutual;
}

/// Returns the links that are a side of a closed square of four corners. Links into clutter do not
/// close a square.
std::vector<Links> sides_of_squares(const std::vector<Links>& links) {
    std::vector<Links> sides(links.size());
    const auto link = [&](int corner, int edge) -> const Link& {
        return links[static_cast<std::size_t>(corner)][static_cast<std::size_t>(edge & 3)];
    };
    const auto keep = [&](int corner, int edge) {
        const Link& kept = link(corner, edge);
        sides[static_cast<std::size_t>(corner)][static_cast<std::size_t>(edge & 3)] = kept;
        sides[static_cast<std::size_t>(kept.to)][static_cast<std::size_t>(kept.back)] = {corner,
                                                                                         edge & 3};
    };
    for (int corner = 0; corner < static_cast<int>(links.size()); ++corner) {
        for (int edge = 0; edge < 4; ++edge) {
            const Link& ahead = link(corner, edge);
            const Link& aside = link(corner, edge + 1);
            if (ahead.to == kNobody || aside.to == kNobody) continue;
            // Takes the sideways step at the corner ahead, and the step ahead at the corner aside.
            // Both must lead to the same corner.
            const Link& first = link(ahead.to, ahead.back + 3);
            const Link& second = link(aside.to, aside.back + 1);
            if (first.to == kNobody || first.to != second.to) continue;
            keep(corner, edge);
            keep(corner, edge + 1);
            keep(ahead.to, ahead.back + 3);
            keep(aside.to, aside.back + 1);
        }
    }
    return sides;
}

/// Walks from one corner to all connected corners. Direction number w of the lattice leaves a
/// corner along the corner's edge number w - turn.
JoinedCorners walked_from(std::span<const ChessCorner> corners,
                          const std::vector<Links>& links,
                          std::size_t start,
                          std::vector<bool>& seen) {
    struct Visit {
        std::size_t corner;
        Node node;
        int turn;
    };
    JoinedCorners joined;
    joined.lattice.emplace(Node{0, 0}, corners[start].pixel);
    seen[start] = true;
    std::deque<Visit> front = {{start, {0, 0}, 0}};
    while (!front.empty()) {
        const Visit here = front.front();
        front.pop_front();
        for (int way = 0; way < 4; ++way) {
            const Link& link = links[here.corner][static_cast<std::size_t>((way - here.turn) & 3)];
            if (link.to == kNobody) continue;
            const auto to = static_cast<std::size_t>(link.to);
            const Node node = here.node + kWays[static_cast<std::size_t>(way)];
            if (seen[to] || joined.lattice.contains(node)) continue;
            seen[to] = true;
            joined.lattice.emplace(node, corners[to].pixel);
            front.push_back({to, node, (way + 2 - link.back) & 3});
        }
    }
    return joined;
}

/// Returns the nodes that are a corner of a complete square of nodes.
Lattice in_squares(const Lattice& lattice) {
    Lattice kept;
    for (const auto& [node, pixel] : lattice) {
        for (const Node& square : {Node{1, 1}, Node{-1, 1}, Node{1, -1}, Node{-1, -1}}) {
            if (!lattice.contains(node + square) ||
                !lattice.contains(node + Node{square.first, 0}) ||
                !lattice.contains(node + Node{0, square.second}))
                continue;
            kept.emplace(node, pixel);
            break;
        }
    }
    return kept;
}

/// Returns the step to the next node along an axis [px]: the step of the node itself, or of a
/// neighbour across the axis. Returns nullopt if both are unknown.
std::optional<Eigen::Vector2d> step_px(const Lattice& lattice,
                                       const Node& node,
                                       const Eigen::Vector2d& pixel,
                                       const Node& axis,
                                       const Node& across) {
    const auto after = lattice.find(node + axis);
    const auto before = lattice.find(node + -1 * axis);
    if (after != lattice.end() && before != lattice.end())
        return Eigen::Vector2d(0.5 * (after->second - before->second));
    if (after != lattice.end()) return Eigen::Vector2d(after->second - pixel);
    if (before != lattice.end()) return Eigen::Vector2d(pixel - before->second);
    for (const int side : {1, -1}) {
        const Node beside = node + side * across;
        const auto middle = lattice.find(beside);
        if (middle == lattice.end()) continue;
        const auto next = lattice.find(beside + axis);
        if (next != lattice.end()) return Eigen::Vector2d(next->second - middle->second);
        const auto last = lattice.find(beside + -1 * axis);
        if (last != lattice.end()) return Eigen::Vector2d(middle->second - last->second);
    }
    return std::nullopt;
}

/// Removes corners that differ from the prediction of their neighbours, the worst first.
void drop_misfits(Lattice& lattice) {
    while (true) {
        auto worst = lattice.end();
        double most = kMostMisfit;
        for (auto at = lattice.begin(); at != lattice.end(); ++at) {
            const auto expected = expected_place(lattice, at->first);
            const auto first_px = step_px(lattice, at->first, at->second, {1, 0}, {0, 1});
            const auto second_px = step_px(lattice, at->first, at->second, {0, 1}, {1, 0});
            if (!expected || !first_px || !second_px) continue;
            const double misfit =
                (at->second - *expected).norm() / std::min(first_px->norm(), second_px->norm());
            if (!(misfit > most)) continue;
            most = misfit;
            worst = at;
        }
        if (worst == lattice.end()) return;
        lattice.erase(worst);
    }
}

/// Returns the brightness of the darkest white square around a corner minus that of the brightest
/// black square [grey values]; nullopt at the border of the image.
std::optional<double> contrast_dn(ImageView<const std::uint8_t> image,
                                  const Eigen::Vector2d& pixel,
                                  const Eigen::Vector2d& first_px,
                                  const Eigen::Vector2d& second_px,
                                  bool black_first) {
    double darkest_white = 255.0;
    double brightest_black = 0.0;
    for (const int a : {-1, 1}) {
        for (const int b : {-1, 1}) {
            const auto grey = grey_at(image, pixel + kIntoSquare * (a * first_px + b * second_px));
            if (!grey) return std::nullopt;
            if ((a == b) == black_first)
                brightest_black = std::max(brightest_black, *grey);
            else
                darkest_white = std::min(darkest_white, *grey);
        }
    }
    return darkest_white - brightest_black;
}

/// Returns true if the contrast at a lattice position is at least kLeastClear of the mean contrast
/// of the corners within two nodes. Light changes gently over a board; objects beside a board are
/// paler or uniform.
bool is_as_clear(const JoinedCorners& joined,
                 const Lattice& lattice,
                 const Node& node,
                 const Eigen::Vector2d& place,
                 ImageView<const std::uint8_t> image) {
    const auto contrast_at = [&](const Node& at, const Eigen::Vector2d& pixel) {
        const auto first_px = step_px(lattice, at, pixel, {1, 0}, {0, 1});
        const auto second_px = step_px(lattice, at, pixel, {0, 1}, {1, 0});
        const bool black_first = joined.black_first == ((at.first + at.second) % 2 == 0);
        return first_px && second_px ? contrast_dn(image, pixel, *first_px, *second_px, black_first)
                                     : std::nullopt;
    };
    const auto own = contrast_at(node, place);
    if (!own || *own <= 0.0) return false;
    double sum = 0.0;
    int count = 0;
    for (int row = -2; row <= 2; ++row) {
        for (int column = -2; column <= 2; ++column) {
            const auto beside = lattice.find(node + Node{column, row});
            if (beside == lattice.end()) continue;
            sum += contrast_at(beside->first, beside->second).value_or(0.0);
            ++count;
        }
    }
    return count > 0 && *own > kLeastClear * sum / count;
}

/// Returns the position of a node in the image [px], near its predicted position. Returns nullopt
/// if the image shows no corner there.
std::optional<Eigen::Vector2d> shown_place(const JoinedCorners& joined,
                                           const Lattice& lattice,
                                           const Node& node,
                                           std::span<const ChessCorner> corners,
                                           ImageView<const std::uint8_t> image) {
    const auto expected = expected_place(lattice, node);
    if (!expected) return std::nullopt;
    const auto first_px = step_px(lattice, node, *expected, {1, 0}, {0, 1});
    const auto second_px = step_px(lattice, node, *expected, {0, 1}, {1, 0});
    if (!first_px || !second_px) return std::nullopt;
    const double reach_px = kCapture * std::min(first_px->norm(), second_px->norm());
    std::optional<Eigen::Vector2d> place;
    for (const ChessCorner& corner : corners)
        if ((corner.pixel - *expected).norm() < (place ? (*place - *expected).norm() : reach_px))
            place = corner.pixel;
    if (!place) place = fit_corner(image, {*expected, *first_px, *second_px});
    if (!place || !((*place - *expected).norm() < reach_px)) return std::nullopt;
    return is_as_clear(joined, lattice, node, *place, image) ? place : std::nullopt;
}

}  // namespace

std::vector<JoinedCorners> joined_corners(std::span<const ChessCorner> corners,
                                          ImageView<const std::uint8_t> image) {
    const std::vector<Links> links = sides_of_squares(mutual_links(corners, image));
    std::vector<bool> seen(corners.size(), false);
    std::vector<JoinedCorners> all;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if (seen[i]) continue;
        JoinedCorners joined = walked_from(corners, links, i, seen);
        joined.lattice = in_squares(joined.lattice);
        if (!joined.lattice.empty()) all.push_back(std::move(joined));
    }
    std::stable_sort(all.begin(), all.end(), [](const JoinedCorners& a, const JoinedCorners& b) {
        return a.lattice.size() > b.lattice.size();
    });
    return all;
}

Lattice grown_lattice(const JoinedCorners& joined,
                      std::span<const ChessCorner> corners,
                      ImageView<const std::uint8_t> image,
                      int most) {
    Lattice lattice = joined.lattice;
    drop_misfits(lattice);
    for (int round = 0; round < kRounds; ++round) {
        const auto [low, high] = bounds_of(lattice);
        Lattice more;
        for (const auto& [here, pixel] : lattice) {
            for (const Node& way : kWays) {
                const Node node = here + way;
                if (lattice.contains(node) || more.contains(node)) continue;
                if (high.first - node.first >= most || node.first - low.first >= most ||
                    high.second - node.second >= most || node.second - low.second >= most)
                    continue;
                const auto place = shown_place(joined, lattice, node, corners, image);
                if (place) more.emplace(node, *place);
            }
        }
        if (more.empty()) break;
        lattice.merge(more);
        drop_misfits(lattice);
    }
    return lattice;
}

std::optional<Eigen::Vector2d> expected_place(const Lattice& lattice, const Node& node) {
    const auto at = [&](const Node& place) {
        const auto found = lattice.find(place);
        return found == lattice.end() ? nullptr : &found->second;
    };
    Eigen::Vector2d between = Eigen::Vector2d::Zero();
    Eigen::Vector2d beyond = Eigen::Vector2d::Zero();
    int betweens = 0;
    int beyonds = 0;
    for (const Node& way : kWays) {
        const auto* one = at(node + way);
        if (one == nullptr) continue;
        if (const auto* other = at(node + -1 * way)) {
            between += 0.5 * (*one + *other);
            ++betweens;
        }
        const auto* two = at(node + 2 * way);
        const auto* three = at(node + 3 * way);
        if (two != nullptr) {
            beyond += three != nullptr ? Eigen::Vector2d(3.0 * *one - 3.0 * *two + *three)
                                       : Eigen::Vector2d(2.0 * *one - *two);
            ++beyonds;
        }
        const Node across{-way.second, way.first};
        const auto* side = at(node + across);
        const auto* far = at(node + way + across);
        if (side != nullptr && far != nullptr) {
            beyond += *one + *side - *far;
            ++beyonds;
        }
    }
    if (betweens > 0) return Eigen::Vector2d(between / betweens);
    if (beyonds > 0) return Eigen::Vector2d(beyond / beyonds);
    return std::nullopt;
}

std::pair<Node, Node> bounds_of(const Lattice& lattice) {
    if (lattice.empty()) return {};
    Node low = lattice.begin()->first;
    Node high = low;
    for (const auto& [node, pixel] : lattice) {
        low = {std::min(low.first, node.first), std::min(low.second, node.second)};
        high = {std::max(high.first, node.first), std::max(high.second, node.second)};
    }
    return {low, high};
}

}  // namespace surefoot::calibration

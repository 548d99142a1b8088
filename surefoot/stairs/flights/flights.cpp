// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/flights/flights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/stairs/edges/edge_relations.hpp"
#include "surefoot/stairs/edges/step_evidence.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr double kNothing = std::numeric_limits<double>::infinity();
/// Largest height error over the depth of a tread, from its tilt and from map distortion.
constexpr double kTread_m = 0.035;
/// Largest difference of the risers of a flight: twice the 5 mm of the code (NZ D1/AS1, Table 6).
constexpr double kUnevenRiser_m = 0.01;
constexpr double kUnevenGoing_m = 0.015;
constexpr double kMaxSigma_m = 0.03;  ///< largest height sigma of a single step
constexpr double kLeastStand_m = 0.08;
constexpr double kBeside_m = 0.25;
/// Smallest sigma of a tread, from errors that the cells of a map share.
constexpr double kTreadSigma_m = 0.001;
/// One sigma of a riser error that all treads of a flight share: matching errors change slowly over
/// the image. Exact maps do not have this error.
constexpr double kRiserShared_m = 0.001;
/// If less than this share of a tread is visible, only a strip near the camera height is measured.
/// The measured strip lies about 30 mm too low.
constexpr double kStrip = 0.5;
constexpr double kStripSigma_m = 0.03;
constexpr double kAlike = 0.2;  ///< largest relative difference of a flight's goings
constexpr double kParallel_rad = 10.0 * kRadPerDeg;

double cross(const Vector2d& a, const Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

struct Line {
    double at_0 = 0.0;
    double slope = 0.0;
    double slope_sigma = 0.0;
};

/// Regression of y over x = 0, 1, 2 ..., weighted by the sigmas of y. Needs at least two values.
Line regress(std::span<const double> y, std::span<const double> sigma) {
    double w = 0.0, wx = 0.0, wy = 0.0, wxx = 0.0, wxy = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i) {
        const auto x = static_cast<double>(i);
        const double weight = 1.0 / (sigma[i] * sigma[i]);
        w += weight;
        wx += weight * x;
        wy += weight * y[i];
        wxx += weight * x * x;
        wxy += weight * x * y[i];
    }
    const double determinant = w * wxx - wx * wx;
    Line line;
    line.slope = (w * wxy - wx * wy) / determinant;
    line.at_0 = (wy - line.slope * wx) / w;
    line.slope_sigma = std::sqrt(w / determinant);
    // Steps that vary more than their sigmas make the result less certain.
    double square = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i)
        square += std::pow((y[i] - line.at_0 - line.slope * static_cast<double>(i)) / sigma[i], 2);
    if (y.size() > 2)
        line.slope_sigma *= std::max(1.0, std::sqrt(square / static_cast<double>(y.size() - 2)));
    return line;
}

/// Returns the number of values, from the first on, that lie on one line. A value lies on the line
/// if it differs from the prediction of the earlier values by at most `uneven` plus three sigma.
/// The far end of a flight is measured worst, so the first value off the line and all later values
/// are not used.
std::size_t steady(std::span<const double> y, std::span<const double> sigma, double uneven) {
    std::size_t count = std::min<std::size_t>(2, y.size());
    while (count < y.size()) {
        const Line line = regress(y.first(count), sigma.first(count));
        const double foretold = line.at_0 + line.slope * static_cast<double>(count);
        if (!(std::abs(y[count] - foretold) <= uneven + 3.0 * sigma[count])) break;
        ++count;
    }
    return count;
}

double scatter_of(const std::vector<double>& values) {
    if (values.size() < 2) return 0.0;
    const auto n = static_cast<double>(values.size());
    double mean = 0.0, square = 0.0;
    for (const double value : values) mean += value / n;
    for (const double value : values) square += (value - mean) * (value - mean);
    return std::sqrt(square / (n - 1.0));
}

double median_of(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

}  // namespace

bool FlightFinder::may_be_step(const Edge& edge) const {
    // An edge without visible lower ground can only be the last edge of a flight.
    const bool is_step = !edge.lower_seen || is_step_of(config_, edge);
    return is_step && edge.height_m() <= config_.max_riser_m &&
           edge.length_m() >= config_.min_width_m;
}

double FlightFinder::going_to(const Edge& edge, const Edge& next) const {
    const double turn_rad =
        std::atan2(cross(edge.along(), next.along()), edge.along().dot(next.along()));
    if (!(std::abs(turn_rad) <= config_.max_turn_deg * kRadPerDeg)) return kNothing;
    const double going_m = -edge.below_m(next.middle_m());
    if (!(going_m >= config_.min_going_m && going_m <= config_.max_going_m)) return kNothing;
    if (overlap_m(edge, next) < 0.5 * std::min(edge.length_m(), next.length_m())) return kNothing;
    const double least_m =
        std::max(kTread_m, 3.0 * std::hypot(edge.height_sigma_m, next.height_sigma_m));
    const double step_m = next.lower_m - edge.upper_m;
    if (next.lower_seen ? !(std::abs(step_m) <= least_m) : !(step_m >= -least_m)) return kNothing;
    return going_m;
}

/// True if `edge` is the next step below or above the chain, at the distance of the chain's steps.
bool FlightFinder::is_next(const Edge& edge, std::span<const Edge> chain, bool below) const {
    const Edge& end = below ? chain.front() : chain.back();
    if (chain.size() < 2 || !may_be_step(edge) || !is_parallel(edge, end)) return false;
    const double mean_m =
        -chain.front().below_m(chain.back().middle_m()) / static_cast<double>(chain.size() - 1);
    const double going_m = below ? going_to(edge, end) : going_to(end, edge);
    return std::abs(going_m - mean_m) <= kAlike * mean_m;
}

void FlightFinder::lengthen(std::vector<Edge>& chain, std::vector<Edge>& edges) const {
    for (Edge& step : chain) {
        std::erase_if(edges, [&](const Edge& edge) {
            const bool same = is_part_of(edge, step) || is_part_of(step, edge);
            if (!same || !same_ground(edge, step) || !is_parallel(edge, step)) return false;
            step = joined(step, edge);
            return true;
        });
    }
    for (std::size_t i = 0; i < edges.size();) {
        const bool below = is_next(edges[i], chain, true);
        if (!below && !is_next(edges[i], chain, false)) {
            ++i;
            continue;
        }
        chain.insert(below ? chain.begin() : chain.end(), edges[i]);
        edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(i));
        i = 0;  // the chain has a new end, so all edges are tried again
    }
}

void FlightFinder::find(std::span<const Edge> edges,
                        const Vector2d& stance_m,
                        std::vector<Flight>& flights,
                        std::vector<bool>& used) {
    used.assign(edges.size(), false);
    next_.assign(edges.size(), -1);
    previous_.assign(edges.size(), -1);
    const auto nearest = [&](int of, bool above) {
        int best = -1;
        double least_m = kNothing;
        for (std::size_t k = 0; k < edges.size(); ++k) {
            if (static_cast<int>(k) == of || !may_be_step(edges[k])) continue;
            const Edge& edge = edges[static_cast<std::size_t>(of)];
            const double going_m = above ? going_to(edge, edges[k]) : going_to(edges[k], edge);
            if (going_m >= least_m) continue;
            least_m = going_m;
            best = static_cast<int>(k);
        }
        return best;
    };
    for (std::size_t i = 0; i < edges.size(); ++i) {
        if (!may_be_step(edges[i])) continue;
        next_[i] = nearest(static_cast<int>(i), true);
        previous_[i] = nearest(static_cast<int>(i), false);
    }
    for (std::size_t i = 0; i < edges.size(); ++i) {
        if (!may_be_step(edges[i])) continue;
        const bool begins = previous_[i] < 0 ||
                            next_[static_cast<std::size_t>(previous_[i])] != static_cast<int>(i);
        if (!begins) continue;
        chain_.clear();
        std::vector<std::size_t> members;
        for (int k = static_cast<int>(i); k >= 0;) {
            chain_.push_back(edges[static_cast<std::size_t>(k)]);
            members.push_back(static_cast<std::size_t>(k));
            const int next = next_[static_cast<std::size_t>(k)];
            k = next >= 0 && previous_[static_cast<std::size_t>(next)] == k ? next : -1;
        }
        if (!add_chain(chain_, stance_m, flights)) continue;
        for (const std::size_t k : members) used[k] = true;
    }
}

bool FlightFinder::add_chain(std::span<const Edge> from_below,
                             const Vector2d& stance_m,
                             std::vector<Flight>& flights) const {
    // Edges with the stance on their upper side lead down.
    std::size_t below = 0;
    while (below < from_below.size() && from_below[below].below_m(stance_m) < 0.0) ++below;
    const std::size_t before = flights.size();
    if (below > 0) add_flight(from_below.first(below), FlightKind::down, stance_m, flights);
    if (below < from_below.size())
        add_flight(from_below.subspan(below), FlightKind::up, stance_m, flights);
    return flights.size() > before;
}

/// True for a single step that the machine can walk to straight, and stand on.
bool FlightFinder::is_step_ahead(const Edge& edge,
                                 FlightKind kind,
                                 const Vector2d& stance_m) const {
    const bool up = kind == FlightKind::up;
    if (!edge.lower_seen || (up ? !edge.lower_walkable : !edge.upper_walkable)) return false;
    // A raised edge at the foot of a wall is no step, because it leaves no room to stand on.
    if ((up ? edge.upper_depth_m : edge.lower_depth_m) < kLeastStand_m ||
        edge.height_sigma_m > kMaxSigma_m)
        return false;
    // The straight way must meet the edge: the side of a ramp is no stair.
    const double along_m = (stance_m - edge.from_m).dot(edge.along());
    if (along_m < -kBeside_m || along_m > edge.length_m() + kBeside_m) return false;
    const Vector2d way = up ? Vector2d(-edge.down()) : edge.down();
    const Vector2d to_m = edge.middle_m() - stance_m;
    return to_m.dot(way) >= std::cos(config_.max_facing_deg * kRadPerDeg) * to_m.norm();
}

void FlightFinder::add_flight(std::span<const Edge> from_below,
                              FlightKind kind,
                              const Vector2d& stance_m,
                              std::vector<Flight>& flights) const {
    // A single step at an end may be lower or higher than the others, for example a kerb. So the
    // median height decides.
    std::vector<double> heights_m;
    for (const Edge& edge : from_below) heights_m.push_back(edge.height_m());
    if (median_of(heights_m) < config_.min_riser_m) return;
    if (from_below.size() == 1 && !is_step_ahead(from_below.front(), kind, stance_m)) return;

    const bool up = kind == FlightKind::up;
    Flight flight;
    flight.kind = kind;
    flight.edges.assign(from_below.begin(), from_below.end());
    if (!up) std::reverse(flight.edges.begin(), flight.edges.end());
    flight.steps = static_cast<int>(from_below.size());
    const Edge& first = flight.edges.front();
    const Edge& last = flight.edges.back();

    Vector2d down = Vector2d::Zero();
    for (const Edge& edge : from_below) down += std::pow(edge.length_m(), 3) * edge.down();
    down.normalize();
    flight.turn_rad = std::atan2(cross(first.down(), last.down()), first.down().dot(last.down()));
    const Vector2d way = up ? Vector2d(-down) : down;
    flight.pose.p_m << first.middle_m(), up ? first.lower_m : first.upper_m;
    flight.pose.yaw_rad = std::atan2(way.y(), way.x());
    measure_goings(way, flight);
    measure_risers(flight);
    std::vector<double> length_m;
    for (const Edge& edge : from_below) length_m.push_back(edge.length_m());
    flight.width_m = median_of(length_m);
    flight.landing_m = up ? last.upper_depth_m : last.lower_depth_m;
    const auto open = std::count_if(
        from_below.begin(), from_below.end(), [](const Edge& edge) { return edge.open; });
    flight.open = 2 * open >= flight.steps;
    flight.cut = up ? last.upper_depth_m < config_.max_going_m
                    : !last.lower_seen || last.lower_depth_m < config_.max_going_m;
    flights.push_back(std::move(flight));
}

void FlightFinder::measure_goings(const Vector2d& way, Flight& flight) {
    flight.going_m = flight.going_sigma_m = flight.going_spread_m = kNan;
    const bool straight = std::abs(flight.turn_rad) <= kParallel_rad;
    std::vector<double> at_m;
    std::vector<double> sigma_m;
    for (std::size_t i = 0; i < flight.edges.size(); ++i) {
        const Edge& edge = flight.edges[i];
        sigma_m.push_back(edge.across_sigma_m);
        if (i == 0) {
            at_m.push_back(0.0);
            continue;
        }
        const Vector2d step_m = edge.middle_m() - flight.edges[i - 1].middle_m();
        const double turned = (edge.down() + flight.edges[i - 1].down()).normalized().dot(step_m);
        at_m.push_back(at_m.back() + (straight ? way.dot(step_m) : std::abs(turned)));
    }
    const std::size_t count = steady(at_m, sigma_m, kUnevenGoing_m);
    if (count < 2) return;
    const Line line = regress(std::span(at_m).first(count), std::span(sigma_m).first(count));
    flight.going_m = line.slope;
    flight.going_sigma_m = line.slope_sigma;
    std::vector<double> goings_m;
    for (std::size_t i = 1; i < count; ++i) goings_m.push_back(at_m[i] - at_m[i - 1]);
    flight.going_spread_m = scatter_of(goings_m);
}

void FlightFinder::measure_risers(Flight& flight) {
    const bool up = flight.kind == FlightKind::up;
    const auto near_m = [&](const Edge& edge) { return up ? edge.lower_m : edge.upper_m; };
    const auto far_m = [&](const Edge& edge) { return up ? edge.upper_m : edge.lower_m; };
    std::vector<double> level_m;  // heights of the treads, in the direction of the flight
    std::vector<double> sigma_m;
    const auto add = [&](double height_m, double edge_sigma_m) {
        level_m.push_back(up ? height_m : -height_m);
        sigma_m.push_back(std::hypot(edge_sigma_m / std::sqrt(2.0), kTreadSigma_m));
    };
    const std::vector<Edge>& edges = flight.edges;
    add(near_m(edges.front()), edges.front().height_sigma_m);
    for (std::size_t i = 0; i < edges.size(); ++i) {
        if (!edges[i].lower_seen) break;
        // Each tread was measured from both of its edges.
        const bool measured_twice = i + 1 < edges.size();
        const double height_m =
            measured_twice ? 0.5 * (far_m(edges[i]) + near_m(edges[i + 1])) : far_m(edges[i]);
        // The last visible tread of a flight up may show only a strip near the camera height.
        const double depth_m = edges[i].upper_depth_m;
        if (up && !measured_twice && i > 0 && depth_m < 0.6 * flight.going_m) break;
        const bool strip = up && depth_m < kStrip * flight.going_m;
        add(height_m,
            strip ? std::hypot(edges[i].height_sigma_m, kStripSigma_m) : edges[i].height_sigma_m);
    }
    if (level_m.size() < 2) {  // no ground below the first edge was seen
        flight.riser_m = edges.front().height_m();
        flight.riser_sigma_m = edges.front().height_sigma_m;
        return;
    }
    std::vector<double> risers_m;
    for (std::size_t i = 1; i < level_m.size(); ++i)
        risers_m.push_back(level_m[i] - level_m[i - 1]);
    // The first riser may differ from the others: the first step may be almost level with the
    // floor.
    const bool odd_first =
        risers_m.size() > 2 && std::abs(risers_m.front() - median_of(risers_m)) >
                                   kUnevenRiser_m + 2.0 * std::hypot(sigma_m[0], sigma_m[1]);
    const auto levels = std::span<const double>(level_m).subspan(odd_first ? 1 : 0);
    const auto sigmas = std::span<const double>(sigma_m).subspan(odd_first ? 1 : 0);
    const std::size_t count = steady(levels, sigmas, kUnevenRiser_m);
    const Line line = regress(levels.first(count), sigmas.first(count));
    flight.riser_m = line.slope;
    const bool exact = std::all_of(
        edges.begin(), edges.end(), [](const Edge& edge) { return !(edge.height_sigma_m > 0.0); });
    flight.riser_sigma_m = std::hypot(line.slope_sigma, exact ? 0.0 : kRiserShared_m);
    risers_m.resize(std::min(risers_m.size(), count - 1 + (odd_first ? 1 : 0)));
    flight.riser_spread_m = scatter_of(risers_m);
}

}  // namespace surefoot::stairs

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/stairs/feature_errors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::eval {
namespace {

using stairs::FeaturePose;

/// Common properties of all kinds of features, for the comparison.
struct Placed {
    FeaturePose pose;
    double height_m = 0.0;
    bool down = false;     ///< leads down; matches only a feature that also leads down
    bool two_way = false;  ///< keeps its meaning if its pose is turned by 180 deg
};

struct Pair {
    std::size_t found = 0;
    std::size_t truth = 0;
    double across_m = 0.0;
    double along_m = 0.0;
};

double turn_between(const Placed& found, const Placed& truth) {
    const double turn =
        std::abs(std::remainder(found.pose.yaw_rad - truth.pose.yaw_rad, 2.0 * std::numbers::pi));
    return truth.two_way ? std::min(turn, std::numbers::pi - turn) : turn;
}

/// Returns the possible pairs, the nearest first.
std::vector<Pair> candidates(const std::vector<Placed>& found,
                             const std::vector<Placed>& truth,
                             const FeatureMatch& match) {
    std::vector<Pair> pairs;
    for (std::size_t f = 0; f < found.size(); ++f) {
        for (std::size_t t = 0; t < truth.size(); ++t) {
            if (found[f].down != truth[t].down) continue;
            if (turn_between(found[f], truth[t]) > match.turn_deg * kRadPerDeg) continue;
            const double yaw = truth[t].pose.yaw_rad;
            const Eigen::Vector2d way(std::cos(yaw), std::sin(yaw));
            const Eigen::Vector2d off_m = (found[f].pose.p_m - truth[t].pose.p_m).head<2>();
            const double across_m = off_m.dot(way);
            const double along_m = way.x() * off_m.y() - way.y() * off_m.x();
            if (std::abs(across_m) <= match.across_m && std::abs(along_m) <= match.along_m)
                pairs.push_back({f, t, across_m, along_m});
        }
    }
    const auto key = [](const Pair& pair) {
        return std::tuple(std::hypot(pair.across_m, pair.along_m), pair.found, pair.truth);
    };
    std::sort(
        pairs.begin(), pairs.end(), [&](const Pair& a, const Pair& b) { return key(a) < key(b); });
    return pairs;
}

MatchErrors figures_of(const std::vector<double>& all_m) {
    MatchErrors figures{0, kNan, kNan, kNan};
    std::vector<double> errors_m;
    for (const double error_m : all_m) {
        if (!std::isnan(error_m)) errors_m.push_back(error_m);
    }
    figures.count = errors_m.size();
    if (errors_m.empty()) return figures;
    const auto n = static_cast<double>(errors_m.size());
    double sum_m = 0.0;
    double squares_m2 = 0.0;
    figures.max_abs_m = 0.0;
    for (const double error_m : errors_m) {
        sum_m += error_m;
        figures.max_abs_m = std::max(figures.max_abs_m, std::abs(error_m));
    }
    figures.mean_m = sum_m / n;
    for (const double error_m : errors_m)
        squares_m2 += (error_m - figures.mean_m) * (error_m - figures.mean_m);
    figures.std_m = std::sqrt(squares_m2 / n);
    return figures;
}

/// Fills the fields that all kinds share, and returns the pairs.
std::vector<Pair> compare(const std::vector<Placed>& found,
                          const std::vector<Placed>& truth,
                          const FeatureMatch& match,
                          KindErrors& out) {
    std::vector<char> taken_found(found.size(), 0);
    std::vector<char> taken_truth(truth.size(), 0);
    std::vector<Pair> pairs;
    std::vector<double> across_m;
    std::vector<double> height_m;
    for (const Pair& pair : candidates(found, truth, match)) {
        if (taken_found[pair.found] != 0 || taken_truth[pair.truth] != 0) continue;
        taken_found[pair.found] = taken_truth[pair.truth] = 1;
        pairs.push_back(pair);
        across_m.push_back(pair.across_m);
        height_m.push_back(found[pair.found].height_m - truth[pair.truth].height_m);
    }
    out.truth = truth.size();
    out.found = found.size();
    out.matched = pairs.size();
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (taken_truth[i] != 0) continue;
        out.missed.push_back(truth[i].pose);
        out.missed_at.push_back(i);
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (taken_found[i] != 0) continue;
        out.extra.push_back(found[i].pose);
        out.extra_at.push_back(i);
    }
    out.across = figures_of(across_m);
    out.height = figures_of(height_m);
    return pairs;
}

template <typename Feature, typename Value>
MatchErrors errors_of(const std::vector<Pair>& pairs,
                      const std::vector<Feature>& found,
                      const std::vector<Feature>& truth,
                      const Value& value) {
    std::vector<double> errors_m;
    errors_m.reserve(pairs.size());
    for (const Pair& pair : pairs)
        errors_m.push_back(value(found[pair.found]) - value(truth[pair.truth]));
    return figures_of(errors_m);
}

template <typename Feature, typename AsPlaced>
std::vector<Placed> placed(const std::vector<Feature>& features, const AsPlaced& as_placed) {
    std::vector<Placed> out;
    out.reserve(features.size());
    for (const Feature& feature : features) out.push_back(as_placed(feature));
    return out;
}

/// The height of a drop whose bottom was not observed is a lower bound. It is not compared.
Placed of_line(const stairs::LineFeature& line) {
    return {line.pose,
            line.bottom_seen ? std::abs(line.height_m) : kNan,
            std::signbit(line.height_m),
            false};
}

Placed of_edge(const stairs::Edge& edge) {
    const Eigen::Vector2d middle_m = edge.middle_m();
    const Eigen::Vector2d down = edge.down();
    return {{{middle_m.x(), middle_m.y(), edge.upper_m}, std::atan2(down.y(), down.x())},
            edge.lower_seen ? edge.height_m() : kNan,
            true,
            false};
}

double share(std::size_t part, std::size_t whole) {
    return whole == 0 ? kNan : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

double KindErrors::recall() const {
    return share(matched, truth);
}

double KindErrors::precision() const {
    return share(matched, found);
}

FeatureErrors feature_errors(const stairs::TerrainFeatures& found,
                             const stairs::TerrainFeatures& truth,
                             const FeatureMatch& match) {
    const auto of_flight = [](const stairs::Flight& flight) {
        return Placed{flight.pose, flight.riser_m, flight.kind == stairs::FlightKind::down, false};
    };
    const auto of_door = [](const stairs::Door& door) {
        return Placed{door.pose, door.sill_m, false, true};
    };
    FeatureErrors out;
    const auto flights = compare(
        placed(found.flights, of_flight), placed(truth.flights, of_flight), match, out.flights);
    for (const Pair& pair : flights) {
        if (found.flights[pair.found].steps == truth.flights[pair.truth].steps)
            ++out.flights.steps_right;
    }
    out.flights.going = errors_of(
        flights, found.flights, truth.flights, [](const auto& flight) { return flight.going_m; });
    out.flights.width = errors_of(
        flights, found.flights, truth.flights, [](const auto& flight) { return flight.width_m; });
    compare(placed(found.drops, of_line), placed(truth.drops, of_line), match, out.drops);
    compare(placed(found.kerbs, of_line), placed(truth.kerbs, of_line), match, out.kerbs);
    compare(placed(found.sills, of_line), placed(truth.sills, of_line), match, out.sills);
    const auto doors =
        compare(placed(found.doors, of_door), placed(truth.doors, of_door), match, out.doors);
    out.doors.width =
        errors_of(doors, found.doors, truth.doors, [](const auto& door) { return door.width_m; });
    compare(placed(found.edges, of_edge), placed(truth.edges, of_edge), match, out.edges);
    return out;
}

}  // namespace surefoot::eval

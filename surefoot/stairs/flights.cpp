// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/flights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr double kNothing = std::numeric_limits<double>::infinity();
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kRadPerDeg = std::numbers::pi / 180.0;
/// Treads lean and maps are bent by less, over the depth of a tread.
constexpr double kTread_m = 0.035;
constexpr double kParallel_rad = 10.0 * kRadPerDeg;

double cross(const Vector2d& a, const Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

/// Length that two edges share, along the first.
double overlap_m(const Edge& a, const Edge& b) {
    const Vector2d along = a.along();
    const double from_m = (b.from_m - a.from_m).dot(along);
    const double to_m = (b.to_m - a.from_m).dot(along);
    return std::min(a.length_m(), std::max(from_m, to_m)) - std::max(0.0, std::min(from_m, to_m));
}

struct Line {
    double slope = 0.0;
    double sigma = 0.0;  ///< of the slope
};

/// y over 0, 1, 2 ... ; `least_sigma` of a y.
Line regress(const std::vector<double>& x, const std::vector<double>& y, double least_sigma) {
    const auto n = static_cast<double>(x.size());
    double mean_x = 0.0, mean_y = 0.0, xx = 0.0, xy = 0.0, square = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        mean_x += x[i] / n;
        mean_y += y[i] / n;
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
        xx += (x[i] - mean_x) * (x[i] - mean_x);
        xy += (x[i] - mean_x) * (y[i] - mean_y);
    }
    Line line;
    line.slope = xy / xx;
    for (std::size_t i = 0; i < x.size(); ++i)
        square += std::pow(y[i] - mean_y - line.slope * (x[i] - mean_x), 2);
    const double scatter = n > 2.0 ? std::sqrt(square / (n - 2.0)) : 0.0;
    line.sigma = std::max(scatter, least_sigma) / std::sqrt(xx);
    return line;
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
    return edge.height_m() <= config_.max_riser_m && edge.length_m() >= config_.min_width_m;
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
    // Those that the stance lies above lead down.
    std::size_t below = 0;
    while (below < from_below.size() && from_below[below].below_m(stance_m) < 0.0) ++below;
    const std::size_t before = flights.size();
    if (below > 0) add_flight(from_below.first(below), FlightKind::down, flights);
    if (below < from_below.size()) add_flight(from_below.subspan(below), FlightKind::up, flights);
    return flights.size() > before;
}

void FlightFinder::add_flight(std::span<const Edge> from_below,
                              FlightKind kind,
                              std::vector<Flight>& flights) const {
    // Single low or high steps at the ends may be kerbs; a flight has real steps.
    std::vector<double> heights_m;
    for (const Edge& edge : from_below) heights_m.push_back(edge.height_m());
    if (median_of(heights_m) < config_.min_riser_m) return;

    Flight flight;
    flight.kind = kind;
    flight.edges.assign(from_below.begin(), from_below.end());
    Vector2d down = Vector2d::Zero();
    for (const Edge& edge : from_below) down += std::pow(edge.length_m(), 3) * edge.down();
    down.normalize();
    const Edge& lowest = from_below.front();
    const Edge& highest = from_below.back();
    flight.turn_rad =
        std::atan2(cross(lowest.down(), highest.down()), lowest.down().dot(highest.down()));
    const bool straight = std::abs(flight.turn_rad) <= kParallel_rad;

    // Places of the edges along the way up, heights of the ground between them.
    std::vector<double> at_m{0.0};
    std::vector<double> level_m{lowest.lower_m};
    std::vector<double> length_m;
    double least_across_m = 0.0, least_level_m = 0.0;
    for (std::size_t i = 0; i < from_below.size(); ++i) {
        const Edge& edge = from_below[i];
        length_m.push_back(edge.length_m());
        least_across_m += edge.across_sigma_m / static_cast<double>(from_below.size());
        least_level_m +=
            edge.height_sigma_m / std::sqrt(2.0) / static_cast<double>(from_below.size());
        if (i > 0) {
            const Vector2d step_m = edge.middle_m() - from_below[i - 1].middle_m();
            const Vector2d mean_down = (edge.down() + from_below[i - 1].down()).normalized();
            at_m.push_back(at_m.back() - step_m.dot(straight ? down : mean_down));
        }
        level_m.push_back(i + 1 < from_below.size() && from_below[i + 1].lower_seen
                              ? 0.5 * (edge.upper_m + from_below[i + 1].lower_m)
                              : edge.upper_m);
    }
    // An edge that was missed leaves a going that is twice as deep.
    std::vector<double> goings_m;
    for (std::size_t i = 1; i < at_m.size(); ++i) goings_m.push_back(at_m[i] - at_m[i - 1]);
    flight.steps = static_cast<int>(from_below.size());
    std::vector<double> number(level_m.size());
    for (std::size_t i = 0; i < number.size(); ++i) number[i] = static_cast<double>(i);
    const bool bottom_known = lowest.lower_seen;
    if (!bottom_known && from_below.size() > 1) {
        level_m.erase(level_m.begin());
        number.erase(number.begin());
    }
    std::vector<double> risers_m;
    for (std::size_t i = 1; i < level_m.size(); ++i)
        risers_m.push_back(level_m[i] - level_m[i - 1]);
    if (risers_m.size() > 1) {
        const Line rise = regress(number, level_m, least_level_m);
        flight.riser_m = rise.slope;
        flight.riser_sigma_m = rise.sigma;
        flight.riser_spread_m = scatter_of(risers_m);
    } else {
        flight.riser_m = risers_m.front();
        flight.riser_sigma_m = std::max(lowest.height_sigma_m, highest.height_sigma_m);
    }
    if (goings_m.size() > 1) {
        number.resize(at_m.size());
        for (std::size_t i = 0; i < number.size(); ++i) number[i] = static_cast<double>(i);
        const Line going = regress(number, at_m, least_across_m);
        flight.going_m = going.slope;
        flight.going_sigma_m = going.sigma;
        flight.going_spread_m = scatter_of(goings_m);
    } else if (goings_m.size() == 1) {
        flight.going_m = goings_m.front();
        flight.going_sigma_m = std::sqrt(2.0) * least_across_m;
        flight.going_spread_m = 0.0;
    } else {
        flight.going_m = flight.going_sigma_m = flight.going_spread_m = kUnknown;
    }
    flight.width_m = median_of(length_m);
    flight.width_complete = std::all_of(from_below.begin(), from_below.end(), [](const Edge& edge) {
        return edge.from_end_seen && edge.to_end_seen;
    });
    const bool up = kind == FlightKind::up;
    if (!up) std::reverse(flight.edges.begin(), flight.edges.end());
    const Edge& first = flight.edges.front();
    const Edge& last = flight.edges.back();
    const Vector2d way = up ? Vector2d(-down) : down;
    flight.pose.p_m << first.middle_m(), up ? first.lower_m : first.upper_m;
    flight.pose.yaw_rad = std::atan2(way.y(), way.x());
    flight.landing_m = up ? last.upper_depth_m : last.lower_depth_m;
    flight.cut = up ? last.upper_depth_m < config_.max_going_m
                    : !last.lower_seen || last.lower_depth_m < config_.max_going_m;
    flights.push_back(std::move(flight));
}

}  // namespace surefoot::stairs

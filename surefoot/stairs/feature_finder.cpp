// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/feature_finder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "surefoot/stairs/edges/edge_relations.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr double kStance_m = 0.3;

}  // namespace

FeatureFinder::FeatureFinder(const StairsConfig& config)
    : config_(config),
      point_finder_(config),
      line_finder_(config),
      profiler_(config),
      step_fitter_(config),
      ray_steps_(config),
      evidence_(config),
      flight_finder_(config),
      door_finder_(config.doors),
      reachability_({.max_step_m = config.walk_step_m, .stance_radius_m = kStance_m}) {}

void FeatureFinder::find(const Terrain& terrain, TerrainFeatures& out) {
    out.edges.clear();
    out.drops.clear();
    out.kerbs.clear();
    out.sills.clear();
    out.flights.clear();
    out.doors.clear();
    if (terrain.geometry.nx < 2 || terrain.geometry.ny < 2) return;
    find_edges(terrain, out.edges);
    fit_steps(terrain, out.edges);
    see_faces(terrain, out.edges);
    see_steps_down(terrain, out.edges);
    join_pieces(out.edges);
    weigh(terrain, out.edges);
    for (std::vector<Edge>& chain : chains_) flight_finder_.lengthen(chain, out.edges);
    for (const std::vector<Edge>& chain : chains_)
        std::erase_if(out.edges, [&](const Edge& edge) { return is_among(edge, chain); });
    reachability_.reach(terrain.geometry, terrain.height_m, terrain.stance_m, walk_step_m_);
    find_walkable(terrain, out.edges);
    for (std::vector<Edge>& chain : chains_) find_walkable(terrain, chain);
    flight_finder_.find(out.edges, terrain.stance_m, out.flights, in_flight_);
    for (const std::vector<Edge>& chain : chains_) {
        const bool is_flight = flight_finder_.add_chain(chain, terrain.stance_m, out.flights);
        out.edges.insert(out.edges.end(), chain.begin(), chain.end());
        in_flight_.insert(in_flight_.end(), chain.size(), is_flight);
    }
    std::stable_sort(out.flights.begin(), out.flights.end(), [&](const Flight& a, const Flight& b) {
        return (a.pose.p_m.head<2>() - terrain.stance_m).norm() <
               (b.pose.p_m.head<2>() - terrain.stance_m).norm();
    });
    for (Flight& flight : out.flights) flight_sides_.find(terrain, flight);
    name_lines(terrain, out);
    door_finder_.find(terrain, out.doors, out.sills);
}

void FeatureFinder::find_edges(const Terrain& terrain, std::vector<Edge>& edges) {
    point_finder_.find(terrain, points_);
    line_finder_.find(terrain.geometry, points_, lines_);
    guesses_.clear();
    for (const EdgeLine& line : lines_) {
        const std::optional<Edge> edge = profiler_.measure(terrain, line);
        if (!edge) continue;
        if (edge->height_m() > 0.0)
            edges.push_back(*edge);
        else if (edge->length_m() >= config_.min_width_m)
            guesses_.push_back(*edge);
    }
}

void FeatureFinder::find_walkable(const Terrain& terrain, std::vector<Edge>& edges) const {
    constexpr double kLeastShare = 0.25;
    /// Cells on each side, from the third on; nearer cells may mix both levels.
    constexpr int kDeep_cells = 6;
    // Other ground lies behind an object that is narrower than the tested depth. Walkable floor
    // behind a bar does not make the bar walkable.
    constexpr double kSame_m = 0.06;
    const double cell_m = terrain.geometry.resolution_m;
    for (Edge& edge : edges) {
        const Vector2d along = edge.along();
        const Vector2d down = edge.down();
        const double length_m = edge.length_m();
        const auto walkable = [&](double way, std::optional<double> level_m) {
            int known = 0, reached = 0;
            for (double t_m = 0.5 * cell_m; t_m < length_m; t_m += cell_m) {
                for (int k = 3; k < 3 + kDeep_cells; ++k) {
                    const Vector2d p_m = edge.from_m + t_m * along + way * k * cell_m * down;
                    const auto cell = terrain.geometry.cell_at(p_m.x(), p_m.y());
                    if (!cell || !terrain.known(cell->ix, cell->iy)) continue;
                    ++known;
                    const auto z_m = static_cast<double>(terrain.height_m.row(cell->iy)[cell->ix]);
                    const double sloping_m = StepEvidenceFinder::kSteepest * k * cell_m;
                    const bool is_other = level_m && std::abs(z_m - *level_m) > kSame_m + sloping_m;
                    const float step_m = walk_step_m_.at(cell->ix, cell->iy);
                    reached += !is_other && step_m == step_m ? 1 : 0;
                }
            }
            return known > 0 && reached >= kLeastShare * known;
        };
        // Lower ground that was not seen has no level, only an upper bound.
        edge.upper_walkable = walkable(-1.0, edge.upper_m);
        edge.lower_walkable =
            walkable(+1.0, edge.lower_seen ? std::optional(edge.lower_m) : std::nullopt);
    }
}

/// Returns true if another chain already has a step of this chain. A ragged edge gives several
/// seeds for the same steps.
bool FeatureFinder::shares_a_step(std::span<const Edge> chain) const {
    for (const std::vector<Edge>& other : chains_)
        for (const Edge& step : other)
            if (std::any_of(chain.begin(), chain.end(), [&](const Edge& edge) {
                    return is_part_of(edge, step);
                }))
                return true;
    return false;
}

/// Returns true for a spiral: near a step of the chain lies a longer edge between the same heights,
/// turned by 12 deg to `max_turn_deg`.
bool FeatureFinder::turns(std::span<const Edge> chain, std::span<const Edge> edges) const {
    constexpr double kLeast_rad = 0.21;  // 12 deg
    constexpr double kNear_m = 0.9;
    const double most_rad = config_.max_turn_deg * std::numbers::pi / 180.0;
    return std::any_of(chain.begin(), chain.end(), [&](const Edge& step) {
        return std::any_of(edges.begin(), edges.end(), [&](const Edge& edge) {
            const double turn_rad =
                std::acos(std::clamp(edge.along().dot(step.along()), -1.0, 1.0));
            return turn_rad > kLeast_rad && turn_rad < most_rad && same_ground(edge, step) &&
                   edge.length_m() > step.length_m() &&
                   (edge.middle_m() - step.middle_m()).norm() < kNear_m;
        });
    });
}

void FeatureFinder::fit_steps(const Terrain& terrain, std::vector<Edge>& edges) {
    chains_.clear();
    std::vector<bool> taken(edges.size(), false);
    std::vector<Edge> chain;
    for (std::size_t i = 0; i < edges.size(); ++i) {  // the edge of the longest line comes first
        const Edge& seed = edges[i];
        // An edge higher than a riser may be a board without a riser. A board is no deeper than a
        // tread.
        if (taken[i] || seed.length_m() < config_.min_width_m ||
            (seed.height_m() > config_.max_riser_m && seed.upper_depth_m > config_.max_going_m))
            continue;
        step_fitter_.fit(terrain, seed, chain);
        if (chain.empty() || shares_a_step(chain) || turns(chain, edges)) continue;
        for (std::size_t k = 0; k < edges.size(); ++k)
            taken[k] = taken[k] || std::any_of(chain.begin(), chain.end(), [&](const Edge& step) {
                           return is_part_of(edges[k], step);
                       });
        chains_.push_back(chain);
    }
    std::size_t left = 0;
    for (std::size_t i = 0; i < edges.size(); ++i)
        if (!taken[i]) edges[left++] = edges[i];
    edges.resize(left);
}

void FeatureFinder::see_faces(const Terrain& terrain, std::vector<Edge>& edges) {
    for (std::vector<Edge>& chain : chains_) ray_faces_.place(terrain, chain);
    for (Edge& edge : edges) {
        if (edge.height_m() > config_.max_riser_m) continue;
        Edge seen = edge;
        ray_faces_.place(terrain, {&seen, 1});
        if (seen.across_sigma_m < edge.across_sigma_m) edge = seen;
    }
}

void FeatureFinder::see_steps_down(const Terrain& terrain, std::vector<Edge>& edges) {
    constexpr std::size_t kEnough = 3;
    constexpr int kTries = 4;  // each call costs 0.1 to 0.2 ms
    for (std::vector<Edge>& chain : chains_) {
        if (chain.size() >= kEnough) continue;
        from_above_.assign(chain.rbegin(), chain.rend());
        ray_steps_.find(terrain, from_above_, seen_);
        if (!seen_.empty()) chain.assign(seen_.rbegin(), seen_.rend());
    }
    for (std::size_t i = 0; i < edges.size();) {
        seen_.clear();
        if (edges[i].length_m() >= config_.min_width_m)
            ray_steps_.find(terrain, std::span(edges).subspan(i, 1), seen_);
        if (seen_.size() == 1) edges[i] = seen_.front();
        if (!add_seen(edges)) ++i;
    }
    // An edge below the noise of cells and slices may still be clear in the image.
    int tries = 0;
    for (const Edge& guess : guesses_) {
        const auto has = [&](const Edge& edge) { return is_part_of(guess, edge); };
        if (std::any_of(edges.begin(), edges.end(), has) || shares_a_step({&guess, 1})) continue;
        if (tries++ == kTries) break;
        ray_steps_.find(terrain, {&guess, 1}, seen_);
        if (seen_.size() == 1 &&
            seen_[0].height_m() >=
                std::max(config_.min_height_m, config_.sigma_factor * seen_[0].height_sigma_m))
            edges.push_back(seen_.front());
        else
            add_seen(edges);
    }
}

/// Moves the flight in `seen_` to `chains_` and removes its parts from `edges`. Returns false if
/// `seen_` has fewer than two steps, or if another chain already has one of these steps.
bool FeatureFinder::add_seen(std::vector<Edge>& edges) {
    if (seen_.size() < 2 || shares_a_step(seen_)) return false;
    std::erase_if(edges, [&](const Edge& edge) {
        return std::any_of(
            seen_.begin(), seen_.end(), [&](const Edge& step) { return is_part_of(edge, step); });
    });
    chains_.emplace_back(seen_.rbegin(), seen_.rend());
    return true;
}

void FeatureFinder::weigh_one(const Terrain& terrain, Edge& edge) {
    if (!edge.lower_seen) return;       // the lower ground is not visible: nothing to test
    constexpr double kBeside_m = 0.05;  ///< smear of the next riser over its tread
    constexpr double kLeast_m = 0.15;
    constexpr double kMost_m = 1.2;
    const auto observed_at_m = [&](double depth_m) {
        return std::clamp(depth_m - kBeside_m, kLeast_m, kMost_m);
    };
    const StepEvidence evidence = evidence_.weigh(
        terrain, edge, observed_at_m(edge.upper_depth_m), observed_at_m(edge.lower_depth_m));
    // The current frame may have given stronger evidence than the map.
    if (!(edge.log_step_ratio >= evidence.log_ratio)) edge.log_step_ratio = evidence.log_ratio;
    edge.hidden = evidence.is_hidden;
}

void FeatureFinder::weigh(const Terrain& terrain, std::vector<Edge>& edges) {
    for (std::vector<Edge>& chain : chains_) {
        for (Edge& step : chain) weigh_one(terrain, step);
        keep_steps(chain, edges);
    }
    std::erase_if(chains_, [](const std::vector<Edge>& chain) { return chain.empty(); });
    for (Edge& edge : edges) weigh_one(terrain, edge);
    const double least = std::log(config_.drop_ratio);
    std::erase_if(edges, [&](const Edge& edge) {
        return edge.lower_seen && !edge.hidden && edge.log_step_ratio < least;
    });
}

/// Keeps the longest run of acceptable steps in `chain` and moves all other steps to `edges`. A
/// step is acceptable if its likelihood ratio reaches `drop_ratio` or is NaN, if it is hidden, or
/// if it lies between two proven steps. A run needs two steps or more, and at least half of them
/// must be proven.
void FeatureFinder::keep_steps(std::vector<Edge>& chain, std::vector<Edge>& edges) const {
    const auto is_step = [&](std::size_t k) { return is_step_of(config_, chain[k]); };
    const double likely = std::log(config_.drop_ratio);
    const auto goes_on = [&](std::size_t k) {
        const bool is_between = k > 0 && k + 1 < chain.size() && is_step(k - 1) && is_step(k + 1);
        return is_between || chain[k].hidden || !(chain[k].log_step_ratio < likely);
    };
    std::size_t begin = 0, end = 0;
    for (std::size_t first = 0; first < chain.size();) {
        std::size_t last = first;
        std::size_t steps = 0;
        for (; last < chain.size() && goes_on(last); ++last)
            if (is_step(last)) ++steps;
        if (last - first > end - begin && 2 * steps >= last - first) {
            begin = first;
            end = last;
        }
        first = std::max(last, first + 1);
    }
    if (end - begin < 2) begin = end = 0;
    for (std::size_t k = 0; k < chain.size(); ++k)
        if (k < begin || k >= end) edges.push_back(chain[k]);
    chain.erase(chain.begin() + static_cast<std::ptrdiff_t>(end), chain.end());
    chain.erase(chain.begin(), chain.begin() + static_cast<std::ptrdiff_t>(begin));
}

void FeatureFinder::join_pieces(std::vector<Edge>& edges) const {
    for (std::size_t i = 0; i < edges.size(); ++i) {
        for (std::size_t k = i + 1; k < edges.size();) {
            const bool same = same_ground(edges[k], edges[i]);
            if (same && is_part_of(edges[k], edges[i])) {
                edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(k));
            } else if (same && goes_on(edges[i], edges[k], config_.max_gap_m)) {
                edges[i] = joined(edges[i], edges[k]);
                edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(k));
                k = i + 1;
            } else {
                ++k;
            }
        }
    }
}

void FeatureFinder::name_lines(const Terrain& terrain, TerrainFeatures& out) const {
    for (std::size_t i = 0; i < out.edges.size(); ++i) {
        const Edge& edge = out.edges[i];
        if (in_flight_[i]) continue;
        // If only the upper side is walkable, the edge is crossed downwards, wherever the stance
        // is. If both sides are walkable, the side of the stance decides.
        const bool both = edge.upper_walkable && edge.lower_walkable;
        const bool goes_down = both ? edge.below_m(terrain.stance_m) < 0.0 : edge.upper_walkable;
        if (!goes_down && !edge.lower_walkable) continue;
        const LineFeature feature = line_feature(edge, goes_down);
        if (feature.height_m < -config_.drop_m) out.drops.push_back(feature);
        if (edge.lower_seen && edge.height_m() <= config_.kerb_m && is_step_of(config_, edge))
            out.kerbs.push_back(feature);
    }
    // The near edge of a flight down is also reported as a drop.
    for (const Flight& flight : out.flights) {
        const LineFeature feature =
            line_feature(flight.edges.front(), flight.kind == FlightKind::down);
        if (feature.height_m < -config_.drop_m) out.drops.push_back(feature);
        if (flight.steps == 1 && std::abs(feature.height_m) <= config_.kerb_m)
            out.kerbs.push_back(feature);
    }
}

}  // namespace surefoot::stairs

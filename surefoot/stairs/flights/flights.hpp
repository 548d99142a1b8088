// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/stairs_config.hpp"

namespace surefoot::stairs {

/// Chains edges into flights. Consecutive edges are parallel (in a spiral they turn), one going
/// apart. The upper ground of an edge is the lower ground of the next edge. A chain with the stance
/// inside becomes a flight up and a flight down. A single edge is a chain of one.
class FlightFinder {
  public:
    explicit FlightFinder(const StairsConfig& config) : config_(config) {}
    /// `used[i]` = edge i is part of a flight.
    void find(std::span<const Edge> edges,
              const Eigen::Vector2d& stance_m,
              std::vector<Flight>& flights,
              std::vector<bool>& used);
    /// Adds the flights of one chain of edges, seen from the stance. Returns false and adds nothing
    /// if the chain forms no flight.
    bool add_chain(std::span<const Edge> from_below,
                   const Eigen::Vector2d& stance_m,
                   std::vector<Flight>& flights) const;
    /// Moves edges that belong to a chain into the chain: pieces of its steps, and the next steps
    /// at its ends. `chain`: lowest step first.
    void lengthen(std::vector<Edge>& chain, std::vector<Edge>& edges) const;

  private:
    [[nodiscard]] bool may_be_step(const Edge& edge) const;
    /// Horizontal distance to `next` [m]; infinite if `next` is not the next step up.
    [[nodiscard]] double going_to(const Edge& edge, const Edge& next) const;
    [[nodiscard]] bool is_next(const Edge& edge, std::span<const Edge> chain, bool below) const;
    void add_flight(std::span<const Edge> from_below,
                    FlightKind kind,
                    const Eigen::Vector2d& stance_m,
                    std::vector<Flight>& flights) const;
    static void measure_goings(const Eigen::Vector2d& way, Flight& flight);
    static void measure_risers(Flight& flight);
    [[nodiscard]] bool is_step_ahead(const Edge& edge,
                                     FlightKind kind,
                                     const Eigen::Vector2d& stance_m) const;

    StairsConfig config_;
    std::vector<int> next_;
    std::vector<int> previous_;
    std::vector<Edge> chain_;
};

}  // namespace surefoot::stairs

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/stairs_config.hpp"

namespace surefoot::stairs {

/// Chains of edges that follow each other as steps do: parallel (or turning, in a spiral), a going
/// apart, the upper ground of one the lower ground of the next. Where the stance lies between two
/// of them the chain is a flight up and a flight down. Single edges are chains of one.
class FlightFinder {
  public:
    explicit FlightFinder(const StairsConfig& config) : config_(config) {}
    /// `used` says of each edge whether it is part of a flight.
    void find(std::span<const Edge> edges,
              const Eigen::Vector2d& stance_m,
              std::vector<Flight>& flights,
              std::vector<bool>& used);
    /// Adds the flights that a chain of edges makes, seen from the stance. False, and nothing, if
    /// it makes none.
    bool add_chain(std::span<const Edge> from_below,
                   const Eigen::Vector2d& stance_m,
                   std::vector<Flight>& flights) const;
    /// Takes those edges into a chain from below that belong to it, though they were not placed
    /// with it: pieces of its steps, and the next steps at its ends.
    void lengthen(std::vector<Edge>& chain, std::vector<Edge>& edges) const;

  private:
    [[nodiscard]] bool may_be_step(const Edge& edge) const;
    /// How far `next` lies above and behind `edge` [m]; infinite if it is not its next step.
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

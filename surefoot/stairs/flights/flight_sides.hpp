// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Says what lies beside the steps of flights, and whether a rail runs along them. Looked at is a
/// strip beside the ends of each tread, up to 0.25 m away.
///
/// A step's side is a wall where something stands 0.3 m or more above the tread, open where the
/// ground, or a line of sight over unknown cells, lies 0.1 m or more below it, level else; unknown
/// where less than a third of the strip says anything. A flight's side is what most of its steps
/// say that say anything; of as many, the one that is more dangerous.
///
/// A rail is what stands, or hangs, 0.75 to 1.1 m above the line of the noses (NZ D1/AS1: handrails
/// at 0.9 to 1.0 m) along half of the steps or more, on a band of 0.1 m. What a map does not hold
/// is not told: a camera 1 m high sees rails only where it looks up to them.
class FlightSides {
  public:
    void find(const Terrain& terrain, Flight& flight);

  private:
    FlightSide observe_beside(const Terrain& terrain, const Flight& flight, bool left);

    std::vector<double> rails_m_;  ///< heights above the noses, one a step
};

}  // namespace surefoot::stairs

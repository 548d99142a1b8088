// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Finds the kind of ground beside the steps of a flight, and rails along the flight. Examines a
/// strip beside the ends of each tread, up to 0.25 m away.
///
/// A side of a step is a wall if at least a third of its known cells stand 0.3 m or more above the
/// tread. It is open if at least a third lie 0.1 m or more below (unknown cells: a free ray); else
/// it is level. It is unknown if less than a third of its cells are known. The flight takes the
/// kind of most known steps. Of two equally frequent kinds, the more dangerous counts.
///
/// A rail is an object 0.75 to 1.1 m above the nosing line (NZ D1/AS1: handrails at 0.9 to 1.0 m)
/// along half of the steps, at least two, within a band of 0.1 m. Rails that the map lacks are not
/// reported: a camera 1 m high sees a rail only when it looks up to it.
class FlightSides {
  public:
    void find(const Terrain& terrain, Flight& flight);

  private:
    FlightSide observe_beside(const Terrain& terrain, const Flight& flight, bool left);

    std::vector<double> rails_m_;  ///< heights above the nosing line, one per step
};

}  // namespace surefoot::stairs

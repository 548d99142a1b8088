// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Places the risers of a flight up by what one look shows of their faces. The map's points of a
/// face hold its top too, which a matcher finds too far, the more the farther: goings came out 5 mm
/// too long. Pixels are chosen by where the face should be in the image, not by what was measured
/// there, so that noise does not choose them.
class SightFaces {
  public:
    /// Moves those edges whose faces are seen. Nothing without `Terrain::view` and
    /// `Terrain::disparity_px`.
    void place(const Terrain& terrain, std::span<Edge> steps);

  private:
    struct Face {
        double behind_m = 0.0;  ///< where the edge was, away from the camera; 0 = open
        double sigma_m = 0.0;
        bool open = false;
    };
    std::size_t gather(const Terrain& terrain, const Edge& edge, double at_m);
    /// `level_m`: by how much that leans, see there.
    [[nodiscard]] bool shows_level_ground(double level_m);
    [[nodiscard]] std::optional<Face> see(const Terrain& terrain, const Edge& edge);

    std::vector<float> runs_m_;
    std::vector<float> lower_m_;  ///< of them, in the lower half of the face
    std::vector<float> upper_m_;
};

}  // namespace surefoot::stairs

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Places the risers of a flight up by the visible part of their faces in the current frame. The
/// map's face points include the top of the face. A matcher places this top too far away, which
/// makes goings 5 mm too long. Pixels are selected by the expected position of the face in the
/// image, not by their disparity, so noise does not bias the selection.
class RayFaces {
  public:
    /// Moves the edges whose faces are visible. Does nothing without `Terrain::view` and
    /// `Terrain::disparity_px`.
    void place(const Terrain& terrain, std::span<Edge> steps);

  private:
    struct Face {
        double behind_m = 0.0;  ///< distance of the face behind the old edge; unused if open
        double sigma_m = 0.0;
        bool open = false;
    };
    std::size_t gather(const Terrain& terrain, const Edge& edge, double at_m);
    /// `level_m`: extra distance of the upper half for level ground (level_m() in the .cpp file).
    [[nodiscard]] bool shows_level_ground(double level_m);
    [[nodiscard]] std::optional<Face> see(const Terrain& terrain, const Edge& edge);

    std::vector<float> runs_m_;
    std::vector<float> lower_m_;  ///< distances in the lower half of the face
    std::vector<float> upper_m_;
};

}  // namespace surefoot::stairs

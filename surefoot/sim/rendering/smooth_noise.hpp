// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/sim/rendering/imaging.hpp"

namespace surefoot::sim {

/// Gaussian noise that changes slowly over an image. The cubic B-spline low-passes independent
/// numbers on a lattice in both directions. The variance is scaled to 1 everywhere. The correlation
/// along a row or a column falls to 1/e at `length_px`. The lattice has a random offset, so that no
/// pixel is special. The order in which rows are written does not change the values.
class SmoothNoise {
  public:
    /// Prepares every `stride`-th pixel of an image; there are `columns` by `rows` such pixels.
    SmoothNoise(const PixelNoise& noise,
                std::uint64_t seed,
                int columns,
                int rows,
                int stride,
                double length_px);
    /// Writes the values of a row; `out` has one entry per column. `nodes` is scratch memory.
    void row(int v, std::vector<float>& nodes, std::span<float> out) const;

  private:
    struct Tap {
        int first = 0;
        std::array<float, 4> weight;
    };
    [[nodiscard]] static Tap tap(double place);

    int nodes_x_ = 0;
    std::vector<float> nodes_;
    std::vector<Tap> columns_;
    std::vector<Tap> rows_;
};

/// Gaussian noise of unit variance attached to the surfaces of a scene: a function of (seed,
/// surface, position on it). Interpolated on a lattice with spacing `size_m`, scaled to variance 1.
class SurfaceNoise {
  public:
    SurfaceNoise(std::uint64_t seed, double size_m);
    [[nodiscard]] float at(const PixelNoise& noise, int surface, double u_m, double v_m) const;
    /// Cache of the corner numbers of the last lattice square that was used. Neighbouring pixels
    /// lie in the same square.
    struct Square {
        int surface = -1;  ///< -1 = no surface yet
        double u0 = 0.0;
        double v0 = 0.0;
        std::array<float, 4> corners{};
    };
    /// Bit-identical to the function above; faster if most positions share one square.
    [[nodiscard]] float at(
        const PixelNoise& noise, int surface, double u_m, double v_m, Square& square) const;

  private:
    void look_up(const PixelNoise& noise, int surface, double u0, double v0, Square& square) const;

    std::uint64_t seed_ = 0;
    double per_m_ = 1.0;
};

}  // namespace surefoot::sim

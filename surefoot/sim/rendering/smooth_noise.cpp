// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/smooth_noise.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/sim/rendering/counter_random.hpp"

namespace surefoot::sim {
namespace {

/// Distance in lattice steps at which the mean correlation of the normalised spline noise is 1/e.
/// Computed from the weights by bisection.
constexpr double kLengthInSteps = 1.1857971;
enum Stream : std::uint64_t { shift, values };

/// Random numbers of a lattice. Each number depends on the seed and on its position, not on the
/// lattice size.
std::vector<float> lattice(const PixelNoise& noise, std::uint64_t seed, int width, int height) {
    std::vector<float> nodes;
    nodes.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto place =
                (static_cast<std::uint32_t>(y) << 16U) | static_cast<std::uint32_t>(x);
            nodes.push_back(noise.normal(PixelNoise::key(seed, values), place));
        }
    }
    return nodes;
}

}  // namespace

SmoothNoise::SmoothNoise(const PixelNoise& noise,
                         std::uint64_t seed,
                         int columns,
                         int rows,
                         int stride,
                         double length_px) {
    const double steps_per_pixel = stride * kLengthInSteps / std::max(length_px, 1e-3);
    const double shift_u = uniform_at(seed, shift, 0);
    const double shift_v = uniform_at(seed, shift, 1);
    for (int u = 0; u < columns; ++u) columns_.push_back(tap(u * steps_per_pixel + shift_u));
    for (int v = 0; v < rows; ++v) rows_.push_back(tap(v * steps_per_pixel + shift_v));
    nodes_x_ = columns_.empty() ? 0 : columns_.back().first + 4;
    const int nodes_y = rows_.empty() ? 0 : rows_.back().first + 4;
    nodes_ = lattice(noise, seed, nodes_x_, nodes_y);
}

/// Weights of the cubic B-spline at a position in lattice steps. The sum of their squares is 1.
SmoothNoise::Tap SmoothNoise::tap(double place) {
    const double first = std::floor(place);
    const double f = place - first;
    const double g = 1.0 - f;
    const std::array<double, 4> weight{g * g * g,
                                       4.0 - 6.0 * f * f + 3.0 * f * f * f,
                                       4.0 - 6.0 * g * g + 3.0 * g * g * g,
                                       f * f * f};
    double squares = 0.0;
    for (const double w : weight) squares += w * w;
    Tap tap;
    tap.first = static_cast<int>(first);
    for (std::size_t i = 0; i < 4; ++i) {
        tap.weight[i] = static_cast<float>(weight[i] / std::sqrt(squares));
    }
    return tap;
}

void SmoothNoise::row(int v, std::vector<float>& nodes, std::span<float> out) const {
    const auto width = static_cast<std::size_t>(nodes_x_);
    const Tap& down = rows_[static_cast<std::size_t>(v)];
    const float* line = nodes_.data() + static_cast<std::size_t>(down.first) * width;
    nodes.resize(width);
    for (std::size_t x = 0; x < width; ++x) {
        nodes[x] = down.weight[0] * line[x] + down.weight[1] * line[x + width] +
                   down.weight[2] * line[x + 2 * width] + down.weight[3] * line[x + 3 * width];
    }
    for (std::size_t u = 0; u < out.size(); ++u) {
        const Tap& across = columns_[u];
        const float* node = nodes.data() + across.first;
        out[u] = across.weight[0] * node[0] + across.weight[1] * node[1] +
                 across.weight[2] * node[2] + across.weight[3] * node[3];
    }
}

SurfaceNoise::SurfaceNoise(std::uint64_t seed, double size_m)
    : seed_(seed), per_m_(1.0 / std::max(size_m, 1e-6)) {}

float SurfaceNoise::at(const PixelNoise& noise, int surface, double u_m, double v_m) const {
    Square square;
    return at(noise, surface, u_m, v_m, square);
}

void SurfaceNoise::look_up(
    const PixelNoise& noise, int surface, double u0, double v0, Square& square) const {
    const std::uint64_t key = PixelNoise::key(seed_, static_cast<std::uint64_t>(surface));
    // Lattices repeat after 2^16 steps; with 0.1 m between nodes that is 6.5 km.
    const auto first_x = static_cast<std::uint32_t>(saturated_integer<std::int64_t>(u0));
    const auto first_y = static_cast<std::uint32_t>(saturated_integer<std::int64_t>(v0));
    const auto node = [&](std::uint32_t du, std::uint32_t dv) {
        const std::uint32_t x = (first_x + du) & 0xFFFFU;
        const std::uint32_t y = (first_y + dv) & 0xFFFFU;
        return noise.normal(key, (y << 16U) | x);
    };
    square = {surface, u0, v0, {node(0, 0), node(1, 0), node(0, 1), node(1, 1)}};
}

float SurfaceNoise::at(
    const PixelNoise& noise, int surface, double u_m, double v_m, Square& square) const {
    const double u = u_m * per_m_;
    const double v = v_m * per_m_;
    const double u0 = std::floor(u);
    const double v0 = std::floor(v);
    if (square.surface != surface || square.u0 != u0 || square.v0 != v0)
        look_up(noise, surface, u0, v0, square);
    const auto fu = static_cast<float>(u - u0);
    const auto fv = static_cast<float>(v - v0);
    const auto& corners = square.corners;
    const float sum = (1.0F - fv) * ((1.0F - fu) * corners[0] + fu * corners[1]) +
                      fv * ((1.0F - fu) * corners[2] + fu * corners[3]);
    const float squares =
        (fu * fu + (1.0F - fu) * (1.0F - fu)) * (fv * fv + (1.0F - fv) * (1.0F - fv));
    return sum / std::sqrt(squares);
}

}  // namespace surefoot::sim

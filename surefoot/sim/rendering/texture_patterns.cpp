// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/texture_patterns.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::sim {
namespace {

float uniform(Rng& rng, float low, float high) {
    return static_cast<float>(rng.uniform(static_cast<double>(low), static_cast<double>(high)));
}

/// Wraps an index into a tile whose size is a power of two.
int wrap(int i, int size) {
    return i & (size - 1);
}

float length(float x, float y) {
    return std::sqrt(x * x + y * y);
}

/// Adds one octave of value noise (random lattice, smoothstep between). Its cells have cell_u x
/// cell_v texels, which must divide the size.
void add_noise(Image<float>& field, int cell_u, int cell_v, float amplitude, Rng& rng) {
    const int nu = field.width() / cell_u;
    const int nv = field.height() / cell_v;
    Image<float> lattice(nu, nv);
    for (int y = 0; y < nv; ++y) {
        for (int x = 0; x < nu; ++x) lattice.at(x, y) = uniform(rng, -amplitude, amplitude);
    }
    const auto smooth = [](int i, int cell) {
        const float t = (static_cast<float>(i % cell) + 0.5F) / static_cast<float>(cell);
        return t * t * (3.0F - 2.0F * t);
    };
    std::vector<float> share(static_cast<std::size_t>(cell_u));
    for (int i = 0; i < cell_u; ++i) share[static_cast<std::size_t>(i)] = smooth(i, cell_u);
    for (int y = 0; y < field.height(); ++y) {
        const float fy = smooth(y, cell_v);
        const float* low = lattice.row(y / cell_v);
        const float* high = lattice.row((y / cell_v + 1) % nv);
        float* out = field.row(y);
        for (int a = 0; a < nu; ++a) {
            const int b = (a + 1) % nu;
            const float begin = low[a] + fy * (high[a] - low[a]);
            const float end = low[b] + fy * (high[b] - low[b]);
            for (const float fx : share) *out++ += begin + fx * (end - begin);
        }
    }
}

/// A turned rectangle or, if `round` is true, an ellipse. Its rim is one texel soft.
struct Patch {
    float x = 0.0F;
    float y = 0.0F;
    float half_u = 0.0F;
    float half_v = 0.0F;
    float yaw_rad = 0.0F;
    float value = 0.0F;
    bool round = false;
};

void paint(Image<float>& field, const Patch& patch) {
    const float c = std::cos(patch.yaw_rad);
    const float s = std::sin(patch.yaw_rad);
    // in range: no patch of the patterns below has a half side of more than 60 texels
    const int reach = static_cast<int>(std::ceil(length(patch.half_u, patch.half_v))) + 1;
    const int cx = static_cast<int>(patch.x);
    const int cy = static_cast<int>(patch.y);
    for (int y = cy - reach; y <= cy + reach; ++y) {
        for (int x = cx - reach; x <= cx + reach; ++x) {
            const float dx = static_cast<float>(x) - patch.x;
            const float dy = static_cast<float>(y) - patch.y;
            const float u = c * dx + s * dy;
            const float v = -s * dx + c * dy;
            const float depth =
                patch.round ? (1.0F - length(u / patch.half_u, v / patch.half_v)) *
                                  std::min(patch.half_u, patch.half_v)
                            : std::min(patch.half_u - std::abs(u), patch.half_v - std::abs(v));
            const float cover = std::clamp(depth + 0.5F, 0.0F, 1.0F);
            float& out = field.at(wrap(x, field.width()), wrap(y, field.height()));
            out += cover * (patch.value - out);
        }
    }
}

void scatter(Image<float>& field, int count, float smallest, float largest, bool round, Rng& rng) {
    for (int i = 0; i < count; ++i) {
        Patch patch;
        patch.x = uniform(rng, 0.0F, static_cast<float>(field.width()));
        patch.y = uniform(rng, 0.0F, static_cast<float>(field.height()));
        // Many patches are small and few are large: log-uniform sizes look alike at every distance.
        const float ratio = largest / smallest;
        patch.half_u = smallest * std::pow(ratio, uniform(rng, 0.0F, 1.0F));
        patch.half_v = patch.half_u * uniform(rng, 0.4F, 1.0F);
        patch.yaw_rad = uniform(rng, 0.0F, std::numbers::pi_v<float>);
        patch.value = uniform(rng, -1.0F, 1.0F);
        patch.round = round;
        paint(field, patch);
    }
}

void draw_carpet(Image<float>& field, Rng& rng) {
    for (const int cell : {2, 4, 8, 32, 128}) add_noise(field, cell, cell, 0.5F, rng);
    scatter(field, 6000, 1.5F, 6.0F, true, rng);
}

/// Draws square tiles of 128 texels, each with its own shade, dark joints and worn spots.
void draw_tiles(Image<float>& field, Rng& rng) {
    constexpr int kTile = 128;
    add_noise(field, 4, 4, 0.25F, rng);
    add_noise(field, 16, 16, 0.35F, rng);
    add_noise(field, 64, 64, 0.25F, rng);
    scatter(field, 1500, 1.5F, 10.0F, false, rng);
    Image<float> shade(field.width() / kTile, field.height() / kTile);
    for (int y = 0; y < shade.height(); ++y) {
        for (int x = 0; x < shade.width(); ++x) shade.at(x, y) = uniform(rng, -0.5F, 0.5F);
    }
    for (int y = 0; y < field.height(); ++y) {
        for (int x = 0; x < field.width(); ++x) {
            const bool joint = x % kTile < 3 || y % kTile < 3;
            field.at(x, y) = joint ? -1.2F : field.at(x, y) + shade.at(x / kTile, y / kTile);
        }
    }
}

/// Draws grain along u, boards of 128 texels, and knots.
void draw_wood(Image<float>& field, Rng& rng) {
    constexpr int kBoard = 128;
    add_noise(field, 64, 2, 0.5F, rng);
    add_noise(field, 128, 8, 0.5F, rng);
    add_noise(field, 16, 4, 0.4F, rng);
    add_noise(field, 4, 2, 0.25F, rng);
    scatter(field, 900, 1.5F, 9.0F, true, rng);
    std::vector<float> shade(static_cast<std::size_t>(field.height() / kBoard));
    for (float& value : shade) value = uniform(rng, -0.4F, 0.4F);
    for (int y = 0; y < field.height(); ++y) {
        const float board = shade[static_cast<std::size_t>(y / kBoard)];
        for (int x = 0; x < field.width(); ++x) {
            field.at(x, y) = y % kBoard < 2 ? -1.2F : field.at(x, y) + board;
        }
    }
}

void draw_concrete(Image<float>& field, Rng& rng) {
    for (const int cell : {2, 4, 16, 64, 256}) add_noise(field, cell, cell, 0.4F, rng);
    scatter(field, 2500, 1.5F, 12.0F, true, rng);
}

void draw_patches(Image<float>& field, Rng& rng) {
    scatter(field, 2500, 3.0F, 60.0F, false, rng);
    scatter(field, 4000, 1.5F, 8.0F, false, rng);
    for (const int cell : {2, 8, 64}) add_noise(field, cell, cell, 0.2F, rng);
}

void draw_plaster(Image<float>& field, Rng& rng) {
    for (const int cell : {4, 8, 32, 256}) add_noise(field, cell, cell, 0.5F, rng);
    scatter(field, 400, 2.0F, 30.0F, false, rng);
}

/// Draws the marks of a paint roller: dimples some texels wide, and patches that were painted
/// twice.
void draw_white_wall(Image<float>& field, Rng& rng) {
    for (const int cell : {4, 8, 256}) add_noise(field, cell, cell, 0.5F, rng);
    scatter(field, 3000, 2.0F, 5.0F, true, rng);
}

/// Draws chips of stone in a ground paste. They have sharp corners and sizes within a factor of
/// six.
void draw_terrazzo(Image<float>& field, Rng& rng) {
    add_noise(field, 4, 4, 0.15F, rng);
    scatter(field, 5000, 2.0F, 12.0F, false, rng);
    add_noise(field, 256, 256, 0.1F, rng);
}

/// Draws fine noise, dark and bright grains up to 7 texels long, and worn areas.
void draw_asphalt(Image<float>& field, Rng& rng) {
    for (const int cell : {2, 2, 4}) add_noise(field, cell, cell, 0.5F, rng);
    scatter(field, 9000, 1.0F, 3.5F, true, rng);
    add_noise(field, 128, 128, 0.25F, rng);
}

/// Draws stones that lie on each other, each lit on one side and dark at its rim.
void draw_gravel(Image<float>& field, Rng& rng) {
    field.fill(-1.0F);
    for (int i = 0; i < 7000; ++i) {
        Patch stone;
        stone.x = uniform(rng, 0.0F, static_cast<float>(field.width()));
        stone.y = uniform(rng, 0.0F, static_cast<float>(field.height()));
        stone.half_u = uniform(rng, 5.0F, 16.0F);
        stone.half_v = stone.half_u * uniform(rng, 0.6F, 1.0F);
        stone.yaw_rad = uniform(rng, 0.0F, std::numbers::pi_v<float>);
        stone.value = -1.0F;
        stone.round = true;
        paint(field, stone);
        const float shade = uniform(rng, -0.5F, 0.8F);
        stone.half_u *= 0.8F;
        stone.half_v *= 0.8F;
        stone.value = shade;
        paint(field, stone);
        stone.x += 0.2F * stone.half_v;
        stone.y -= 0.2F * stone.half_v;
        stone.half_u *= 0.5F;
        stone.half_v *= 0.5F;
        stone.value = shade + 0.3F;
        paint(field, stone);
    }
    add_noise(field, 2, 2, 0.15F, rng);
}

/// Draws blades in all directions, longer than they are wide, and thin and thick areas of the lawn.
void draw_grass(Image<float>& field, Rng& rng) {
    add_noise(field, 8, 8, 0.3F, rng);
    for (int i = 0; i < 14000; ++i) {
        Patch blade;
        blade.x = uniform(rng, 0.0F, static_cast<float>(field.width()));
        blade.y = uniform(rng, 0.0F, static_cast<float>(field.height()));
        blade.half_u = uniform(rng, 6.0F, 16.0F);
        blade.half_v = uniform(rng, 0.7F, 1.4F);
        blade.yaw_rad = uniform(rng, 0.0F, std::numbers::pi_v<float>);
        blade.value = uniform(rng, -1.0F, 1.0F);
        paint(field, blade);
    }
    for (const int cell : {64, 256}) add_noise(field, cell, cell, 0.3F, rng);
}

void normalise(Image<float>& field) {
    double sum = 0.0;
    double sum_squares = 0.0;
    const auto count = static_cast<double>(field.size());
    for (int y = 0; y < field.height(); ++y) {
        for (int x = 0; x < field.width(); ++x) {
            const auto value = static_cast<double>(field.at(x, y));
            sum += value;
            sum_squares += value * value;
        }
    }
    const double mean = sum / count;
    const double sigma = std::sqrt(std::max(sum_squares / count - mean * mean, 1e-12));
    for (int y = 0; y < field.height(); ++y) {
        for (int x = 0; x < field.width(); ++x) {
            float& value = field.at(x, y);
            value = (value - static_cast<float>(mean)) * kPatternSigma / static_cast<float>(sigma);
            value = std::clamp(value, -1.0F, 1.0F);
        }
    }
}

}  // namespace

Image<float> draw_pattern(Pattern pattern, int size, std::uint64_t seed) {
    Rng rng(mix_seed(seed, static_cast<std::uint64_t>(pattern)));
    Image<float> field(size, size);
    switch (pattern) {
        case Pattern::carpet: draw_carpet(field, rng); break;
        case Pattern::tiles: draw_tiles(field, rng); break;
        case Pattern::wood: draw_wood(field, rng); break;
        case Pattern::concrete: draw_concrete(field, rng); break;
        case Pattern::patches: draw_patches(field, rng); break;
        case Pattern::plaster: draw_plaster(field, rng); break;
        case Pattern::white_wall: draw_white_wall(field, rng); break;
        case Pattern::terrazzo: draw_terrazzo(field, rng); break;
        case Pattern::asphalt: draw_asphalt(field, rng); break;
        case Pattern::gravel: draw_gravel(field, rng); break;
        case Pattern::grass: draw_grass(field, rng); break;
    }
    normalise(field);
    return field;
}

}  // namespace surefoot::sim

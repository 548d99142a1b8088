// SPDX-License-Identifier: Apache-2.0
// Any heights, radii and changed rectangles. Updating the rating after a change gives the same
// bytes as rating the whole map, on every instruction set and in any order of blocks. The plain
// filters rate the same cells and agree within the tolerances of traversability_fast_test. A cell
// of unknown height is not traversable, and all ratings are within 0 to 1.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "fuzz/choices.hpp"
#include "fuzz/must.hpp"
#include "fuzz/twin.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace {

using namespace surefoot;
using namespace surefoot::traversability;
using fuzz::Choices;
using fuzz::OnTarget;

constexpr int kMostChanges = 3;
// Tolerances of traversability_fast_test. A normal with another rounding changes a slope near 0 by
// 3.5e-4 rad, so no critical slope here is below 1 rad.
constexpr float kTolerance = 3e-7F;
constexpr float kSlopeTolerance = 4e-4F;

bool same(float a, float b) {
    return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) ||
           (std::isnan(a) && std::isnan(b));
}

template <typename Visit>
void for_each_layer(const TraversabilityLayers& a, const TraversabilityLayers& b, Visit visit) {
    visit(a.normal_x, b.normal_x);
    visit(a.normal_y, b.normal_y);
    visit(a.normal_z, b.normal_z);
    visit(a.slope, b.slope);
    visit(a.step, b.step);
    visit(a.roughness, b.roughness);
    visit(a.traversability, b.traversability);
}

bool same_bytes(const TraversabilityLayers& a, const TraversabilityLayers& b) {
    bool equal = true;
    for_each_layer(a, b, [&](const grid::Layer& one, const grid::Layer& other) {
        for (std::size_t i = 0; i < one.size(); ++i)
            equal = equal && same(one.data()[i], other.data()[i]);
    });
    return equal;
}

/// The fast and the plain filters differ only by rounding.
void must_be_close(const TraversabilityLayers& fast, const TraversabilityLayers& plain) {
    for_each_layer(fast, plain, [&](const grid::Layer& one, const grid::Layer& other) {
        const bool of_slope = &one == &fast.slope || &one == &fast.traversability;
        const float tolerance = of_slope ? kSlopeTolerance : kTolerance;
        for (std::size_t i = 0; i < one.size(); ++i) {
            const float a = one.data()[i];
            const float b = other.data()[i];
            must(std::isnan(a) == std::isnan(b), "fast and plain filters rate different cells");
            must(std::isnan(a) || std::abs(a - b) <= tolerance,
                 "fast and plain filters differ by more than the tolerance");
        }
    });
}

TraversabilityConfig config_of(Choices& choices, double resolution_m) {
    TraversabilityConfig config =
        choices.yes() ? TraversabilityConfig{}
                      : *preset(kPresetNames[static_cast<std::size_t>(choices.below(4))]);
    if (choices.yes()) {
        const auto radius_m = [&] { return resolution_m * (0.5 + 0.125 * choices.below(28)); };
        config.normals.radius_m = radius_m();
        config.step.first_radius_m = radius_m();
        config.step.second_radius_m = radius_m();
        config.roughness.radius_m = radius_m();
    }
    return config;
}

/// Changes a tile of ground: level, tilted, a step, or single arbitrary heights.
void change(Choices& choices, const CellRect& rect, grid::Layer& height_m) {
    const int kind = choices.below(5);
    const float z_m = choices.number(0.05F);
    const float slope = choices.number(0.01F);
    for (int iy = rect.iy0; iy < rect.iy0 + rect.ny; ++iy) {
        for (int ix = rect.ix0; ix < rect.ix0 + rect.nx; ++ix) {
            float& cell = height_m.at(ix, iy);
            if (kind == 0) cell = z_m;
            if (kind == 1) cell = z_m + slope * static_cast<float>(ix + 2 * iy);
            if (kind == 2) cell = ix % 7 < 3 ? z_m : z_m + slope;
            if (kind == 3) cell = std::numeric_limits<float>::quiet_NaN();
            if (kind == 4) cell = choices.number(0.01F);
        }
    }
}

void must_be_ratings(const grid::Layer& height_m, const TraversabilityLayers& layers) {
    for (std::size_t i = 0; i < height_m.size(); ++i) {
        const bool known = std::isfinite(height_m.data()[i]);
        for (const grid::Layer* layer :
             {&layers.slope, &layers.step, &layers.roughness, &layers.traversability}) {
            const float rating = layer->data()[i];
            must(std::isnan(rating) || (rating >= 0.0F && rating <= 1.0F),
                 "a rating is outside 0 to 1");
        }
        must(known || !(layers.traversability.data()[i] > 0.0F),
             "a cell of unknown height is traversable");
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Choices choices(data, size);
    const double resolution_m = choices.yes() ? 0.025 : 0.05;
    const TraversabilityConfig config = config_of(choices, resolution_m);
    grid::Layer height_m(1 + choices.below(24), 1 + choices.below(50));
    height_m.fill(choices.number(0.05F));
    Traversability kept(config);
    TraversabilityLayers layers;
    Backwards backwards;
    kept.rate(height_m.view(), resolution_m, serial(), layers);
    for (int i = 0; i < kMostChanges && !choices.done(); ++i) {
        const CellRect rect =
            CellRect{choices.below(24), choices.below(50), choices.below(16), choices.below(30)}
                .clipped(height_m.width(), height_m.height());
        change(choices, rect, height_m);
        kept.rate(
            height_m.view(), resolution_m, kept.affected_by(rect, resolution_m), serial(), layers);
    }
    must_be_ratings(height_m, layers);
    TraversabilityLayers other;
    {
        const OnTarget another(choices.byte());
        Traversability(config).rate(height_m.view(), resolution_m, backwards, other);
    }
    must(same_bytes(layers, other),
         "the result depends on the update, the target or the order of blocks");
    Traversability(config, Way::plain).rate(height_m.view(), resolution_m, serial(), other);
    must_be_close(layers, other);
    return 0;
}

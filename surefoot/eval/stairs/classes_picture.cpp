// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/stairs/classes_picture.hpp"

#include <fmt/format.h>

#include "surefoot/core/assert.hpp"
#include "surefoot/eval/maps/shown_part.hpp"
#include "surefoot/eval/stairs/stairs_picture.hpp"

namespace surefoot::eval {

using stairs::GroundClass;

Rgb8 color_of(GroundClass name) {
    switch (name) {
        case GroundClass::floor: return {219, 211, 188};
        case GroundClass::tread: return {140, 190, 230};
        case GroundClass::riser: return palette::kSafe;
        case GroundClass::ramp: return palette::kYellow;
        case GroundClass::kerb: return ground_palette::kKerb;
        case GroundClass::sill: return palette::kPink;
        case GroundClass::drop: return ground_palette::kDrop;
        case GroundClass::wall: return {62, 64, 70};
        case GroundClass::table: return palette::kGreen;
        case GroundClass::tunnel: return ground_palette::kDown;
        case GroundClass::unknown: break;
    }
    return palette::kFaint;
}

namespace {

std::vector<KeyEntry> key_of_classes(const stairs::GroundClasses& classes, double resolution_m) {
    const auto counts = stairs::count_classes(classes);
    std::vector<KeyEntry> key;
    for (std::size_t i = 1; i < counts.size(); ++i) {
        if (counts[i] == 0) continue;
        const double area_m2 = counts[i] * resolution_m * resolution_m;
        const std::string size =
            area_m2 >= 0.01 ? fmt::format("{:.2f} m2", area_m2)
                            : fmt::format("{} cell{}", counts[i], counts[i] == 1 ? "" : "s");
        key.push_back({Symbol::square,
                       color_of(static_cast<GroundClass>(i)),
                       fmt::format("{}, {}", stairs::kGroundClassNames[i], size),
                       {}});
    }
    key.push_back({Symbol::hatch, {}, "unknown or uncertain", {}});
    return key;
}

}  // namespace

Picture render_classes(const grid::GridGeometry& geometry,
                       const grid::Layer& height_m,
                       const stairs::GroundClasses& classes,
                       const Overlays& overlays,
                       const FigureText& text) {
    SUREFOOT_ASSERT(height_m.width() == geometry.nx && height_m.height() == geometry.ny);
    const ShownPart shown = shown_part(geometry, height_m, overlays);
    const Image<GroundClass> names = shown.of(classes.of_cell, GroundClass::unknown);
    Image<std::optional<Rgb8>> colors(names.width(), names.height());
    for (std::size_t i = 0; i < names.size(); ++i)
        if (names.data()[i] != GroundClass::unknown) colors.data()[i] = color_of(names.data()[i]);
    return render_cells(
        shown.geometry, colors, key_of_classes(classes, geometry.resolution_m), text, overlays);
}

}  // namespace surefoot::eval

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/eval/report/picture.hpp"
#include "surefoot/stairs/features.hpp"

namespace surefoot::eval {

/// Colours of ground features, distinguishable with common colour vision deficiencies. Shapes
/// differ too: the lower side of an edge has ticks; flights have an arrow and numbered steps.
namespace ground_palette {
inline constexpr Rgb8 kDrop = palette::kUnsafe;
inline constexpr Rgb8 kUp = palette::kSafe;
inline constexpr Rgb8 kDown{150, 60, 120};  ///< reddish purple, dark enough for white text on it
inline constexpr Rgb8 kKerb = palette::kOrange;
inline constexpr Rgb8 kSill{86, 180, 233};  ///< sky blue (Okabe and Ito 2008)
inline constexpr Rgb8 kDoor = palette::kGreen;
inline constexpr Rgb8 kEdge = palette::kSoftInk;
}  // namespace ground_palette

/// Formats a length with one sigma in whole mm: "180 +- 1 mm". Uses tenths if sigma is below 0.95
/// mm, and "?" if the length is not finite.
[[nodiscard]] std::string length_text(double length_m, double sigma_m);

/// Describes a flight: "up, 4 steps, 1.00 m wide\n180 +- 1 mm by 310 +- 2 mm" (riser by going).
[[nodiscard]] std::string flight_text(const stairs::Flight& flight);

/// Adds edges, flights, drops, kerbs, sills and doors as lines to `overlays`.
[[nodiscard]] Overlays with_features(const stairs::TerrainFeatures& features, Overlays overlays);

/// Draws the heights in pale colours and all ground features over them. Shows the known cells and
/// the overlays (marks, path, body), with some cells around them.
[[nodiscard]] Picture render_features(const grid::GridGeometry& geometry,
                                      const grid::Layer& height_m,
                                      const stairs::TerrainFeatures& features,
                                      const Overlays& overlays,
                                      const FigureText& text);

}  // namespace surefoot::eval

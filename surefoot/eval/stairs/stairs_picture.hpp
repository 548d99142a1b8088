// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/eval/report/picture.hpp"
#include "surefoot/stairs/features.hpp"

namespace surefoot::eval {

/// The colours of what the ground is; told apart by everybody, and drawn differently too: the side
/// of lower ground has ticks, flights have an arrow and numbered steps.
namespace ground_palette {
inline constexpr Rgb8 kDrop = palette::kUnsafe;
inline constexpr Rgb8 kUp = palette::kSafe;
inline constexpr Rgb8 kDown{150, 60, 120};  ///< reddish purple, darker than kPink: read on white
inline constexpr Rgb8 kKerb = palette::kOrange;
inline constexpr Rgb8 kSill{86, 180, 233};  ///< sky blue (Okabe and Ito 2008)
inline constexpr Rgb8 kDoor = palette::kGreen;
inline constexpr Rgb8 kEdge = palette::kSoftInk;
}  // namespace ground_palette

/// A length with one sigma of it in whole mm: "180 +- 1 mm"; tenths where sigma is below 1 mm; "?"
/// where it is no number.
[[nodiscard]] std::string length_text(double length_m, double sigma_m);

/// A flight in words: "up, 4 steps, 1.00 m wide\n180 +- 1 mm by 310 +- 2 mm" (riser by going).
[[nodiscard]] std::string flight_text(const stairs::Flight& flight);

/// Edges, flights, drops, kerbs, sills and doors as lines over a map, added to what is drawn there.
[[nodiscard]] Overlays with_features(const stairs::TerrainFeatures& features, Overlays overlays);

/// The heights in pale colours with everything that the ground is drawn over them. Shown is what is
/// known, and what the overlays name (marks, the way, the body), with some cells around it.
[[nodiscard]] Picture render_features(const grid::GridGeometry& geometry,
                                      const grid::Layer& height_m,
                                      const stairs::TerrainFeatures& features,
                                      const Overlays& overlays,
                                      const FigureText& text);

}  // namespace surefoot::eval

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "surefoot/core/views.hpp"
#include "surefoot/eval/report/colormap.hpp"

namespace surefoot::eval {

using Picture = Image<Rgb8>;

/// A position on a picture [px]; pixel (u, v) covers [u, u + 1) x [v, v + 1).
struct PointPx {
    double u = 0.0;
    double v = 0.0;
};
struct RectPx {
    int left = 0;
    int top = 0;
    int width = 0;
    int height = 0;
    [[nodiscard]] int right() const noexcept { return left + width; }
    [[nodiscard]] int bottom() const noexcept { return top + height; }
};

enum class TextAnchor : std::uint8_t { left, centre, right };
struct TextStyle {
    double cap_height_px = 14.0;  ///< height of a capital letter
    Rgb8 color = palette::kInk;
    TextAnchor anchor = TextAnchor::left;
    bool bold = false;
    bool upward = false;  ///< text rotated by 90 deg, read from bottom to top
    bool halo = false;    ///< white edge around text on a map
};

/// Rounds a position to a whole number. Positions far outside all pictures become +-2^30 px, and
/// NaN becomes 0.
[[nodiscard]] int nearest_px(double place_px) noexcept;

/// Returns the text width [px]. Text is printable ASCII; any other character appears as '?'. Text,
/// lines, polygons and circles are anti-aliased. All drawing is clipped at the picture's border.
[[nodiscard]] double text_width_px(const std::string& text, const TextStyle& style);
/// `at` is the anchor of the text, at half the height of its capital letters.
void draw_text(Picture& picture, PointPx at, const std::string& text, const TextStyle& style);
void draw_line(Picture& picture, PointPx from, PointPx to, int width_px, Rgb8 color);
void draw_polyline(Picture& picture,
                   std::span<const PointPx> points,
                   int width_px,
                   Rgb8 color,
                   bool closed = false);
void fill_polygon(Picture& picture, std::span<const PointPx> points, Rgb8 color);
void draw_circle(Picture& picture, PointPx center, double radius_px, int width_px, Rgb8 color);
void fill_circle(Picture& picture, PointPx center, double radius_px, Rgb8 color);
/// Fills a rectangle; `opacity` 1 hides the pixels below it.
void fill_rect(Picture& picture, const RectPx& rect, Rgb8 color, double opacity = 1.0);
void draw_rect(Picture& picture, const RectPx& rect, int width_px, Rgb8 color);
/// Copies `source` with its top left corner at (left, top).
void paste(Picture& picture, const Picture& source, int left, int top);

/// Colour of an unknown pixel: light grey with diagonal stripes, recognisable as "no value" in any
/// palette.
[[nodiscard]] Rgb8 hatched_grey(int u, int v) noexcept;

/// Encodes the picture as a PNG file; no bytes for an empty picture. Equal input gives equal bytes.
[[nodiscard]] std::vector<std::uint8_t> encode_png(const Picture& picture);

}  // namespace surefoot::eval

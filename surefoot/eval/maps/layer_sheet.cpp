// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/layer_sheet.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "surefoot/eval/maps/cell_colors.hpp"
#include "surefoot/eval/report/picture_range.hpp"
#include "surefoot/eval/report/ticks.hpp"

namespace surefoot::eval {
namespace {

constexpr int kMargin_px = 24;
constexpr int kHeadBand_px = 76;   ///< title of the sheet
constexpr int kTitleBand_px = 34;  ///< space above each map for its title
constexpr int kWantedSide_px = 330;
constexpr int kBar_px = 14;
constexpr int kBarGap_px = 10;
constexpr int kLabels_px = 58;  ///< space for labels right of the bar
constexpr int kGap_px = 22;     ///< space between panels
constexpr int kAround = 6;      ///< cells shown around the known cells
constexpr double kBody_px = 18.0;

TextStyle small_text(TextAnchor anchor = TextAnchor::left) {
    TextStyle style;
    style.cap_height_px = 10.0;
    style.anchor = anchor;
    return style;
}

/// Range of shown cells, half-open along both axes.
struct Shown {
    int ix0 = 0;
    int iy0 = 0;
    int ix1 = 0;
    int iy1 = 0;

    [[nodiscard]] bool empty() const { return ix1 <= ix0 || iy1 <= iy0; }
    void include(grid::Cell cell) {
        if (empty()) {
            *this = {cell.ix, cell.iy, cell.ix + 1, cell.iy + 1};
            return;
        }
        ix0 = std::min(ix0, cell.ix);
        iy0 = std::min(iy0, cell.iy);
        ix1 = std::max(ix1, cell.ix + 1);
        iy1 = std::max(iy1, cell.iy + 1);
    }
};

Shown shown_cells(const grid::GridGeometry& geometry,
                  const std::vector<SheetLayer>& layers,
                  const Overlays& overlays) {
    Shown shown;
    for (const SheetLayer& layer : layers) {
        for (int iy = 0; iy < geometry.ny; ++iy) {
            for (int ix = 0; ix < geometry.nx; ++ix) {
                if (std::isfinite(layer.values.at(ix, iy))) shown.include({ix, iy});
            }
        }
    }
    for (const Eigen::Vector2d& p_m : overlays.trajectory_m) {
        if (const auto cell = geometry.cell_at(p_m.x(), p_m.y())) shown.include(*cell);
    }
    if (shown.empty()) return {0, 0, geometry.nx, geometry.ny};
    return {std::max(0, shown.ix0 - kAround),
            std::max(0, shown.iy0 - kAround),
            std::min(geometry.nx, shown.ix1 + kAround),
            std::min(geometry.ny, shown.iy1 + kAround)};
}

/// Positions of the maps of a sheet. All maps have one size.
struct Layout {
    Shown shown;
    int cell_px = 1;
    int columns = 1;

    Layout(const Shown& cells, int wanted_columns, std::size_t layers)
        : shown(cells),
          cell_px(
              std::max(1, kWantedSide_px / std::max(cells.ix1 - cells.ix0, cells.iy1 - cells.iy0))),
          columns(std::clamp(wanted_columns, 1, static_cast<int>(layers))) {}

    [[nodiscard]] int plot_width() const { return (shown.iy1 - shown.iy0) * cell_px; }
    [[nodiscard]] int plot_height() const { return (shown.ix1 - shown.ix0) * cell_px; }
    [[nodiscard]] int panel_width() const {
        return plot_width() + kBarGap_px + kBar_px + kLabels_px;
    }
    [[nodiscard]] int panel_height() const { return kTitleBand_px + plot_height() + kGap_px; }
    [[nodiscard]] RectPx plot(int index) const {
        return {kMargin_px + index % columns * (panel_width() + kGap_px),
                kHeadBand_px + index / columns * panel_height() + kTitleBand_px,
                plot_width(),
                plot_height()};
    }
    [[nodiscard]] Picture sheet(std::size_t layers) const {
        const int rows = (static_cast<int>(layers) + columns - 1) / columns;
        Picture picture(2 * kMargin_px + columns * panel_width() + (columns - 1) * kGap_px,
                        kHeadBand_px + rows * panel_height() + kMargin_px);
        picture.fill(palette::kPaper);
        return picture;
    }
};

void paint_map(Picture& picture,
               const Layout& layout,
               const RectPx& plot,
               const Image<std::optional<Rgb8>>& colors) {
    for (int v = 0; v < plot.height; ++v) {
        for (int u = 0; u < plot.width; ++u) {
            const int ix = layout.shown.ix1 - 1 - v / layout.cell_px;
            const int iy = layout.shown.iy1 - 1 - u / layout.cell_px;
            picture.at(plot.left + u, plot.top + v) =
                colors.at(ix, iy).value_or(hatched_grey(u, v));
        }
    }
}

void draw_bar(Picture& picture, const RectPx& plot, const ColorBar& bar) {
    const RectPx rect{plot.right() + kBarGap_px, plot.top, kBar_px, plot.height};
    const double span = bar.scale.high - bar.scale.low;
    for (int v = 0; v < rect.height; ++v) {
        const double value = bar.scale.high - (v + 0.5) / rect.height * span;
        fill_rect(picture, {rect.left, rect.top + v, rect.width, 1}, bar.scale(value));
    }
    draw_rect(picture, rect, 1, palette::kInk);
    const Ticks ticks = nice_ticks(bar.scale.low, bar.scale.high, std::max(2, plot.height / 38));
    for (const double value : ticks.values) {
        const double v = rect.top + (bar.scale.high - value) / span * rect.height;
        draw_line(picture,
                  {static_cast<double>(rect.right()), v},
                  {rect.right() + 4.0, v},
                  1,
                  palette::kInk);
        draw_text(picture, {rect.right() + 8.0, v}, ticks.label(value), small_text());
    }
}

void draw_panel(Picture& picture,
                const grid::GridGeometry& geometry,
                const SheetLayer& layer,
                const Layout& layout,
                const RectPx& plot,
                const Overlays& overlays) {
    const ColorBar bar = color_bar_of(layer.values, layer.style);
    paint_map(picture, layout, plot, cell_colors(geometry, layer.values, layer.style, bar.scale));
    MapView view;
    view.plot = plot;
    view.x_max_m = geometry.origin_m.x() + layout.shown.ix1 * geometry.resolution_m;
    view.y_max_m = geometry.origin_m.y() + layout.shown.iy1 * geometry.resolution_m;
    view.px_per_m = layout.cell_px / geometry.resolution_m;
    draw_overlays(picture, view, overlays);
    draw_rect(picture, plot, 1, palette::kInk);
    if (!any_known(layer.values)) {
        TextStyle note = small_text(TextAnchor::centre);
        note.halo = true;
        draw_text(picture,
                  {plot.left + 0.5 * plot.width, plot.top + 0.4 * plot.height},
                  "no cell has a value",
                  note);
    }
    TextStyle title = small_text();
    title.cap_height_px = 12.0;
    title.bold = true;
    const double v = plot.top - 16.0;
    draw_text(picture, {static_cast<double>(plot.left), v}, layer.style.text.title, title);
    if (!layer.style.unit.empty()) {
        const double right = plot.left + text_width_px(layer.style.text.title, title) + 10.0;
        TextStyle unit = small_text();
        unit.color = palette::kSoftInk;
        draw_text(picture, {right, v}, "[" + layer.style.unit + "]", unit);
    }
    draw_bar(picture, plot, bar);
}

LayerStyle plain_style(std::string title, std::string unit, ColorMap map) {
    LayerStyle style;
    style.text.title = std::move(title);
    style.unit = std::move(unit);
    style.map = map;
    return style;
}

LayerStyle share_style(std::string title, ColorMap map = ColorMap::viridis) {
    LayerStyle style = plain_style(std::move(title), "", map);
    style.range = ValueRange{0.0, 1.0};
    return style;
}

LayerStyle direction_style(std::string title) {
    LayerStyle style = plain_style(std::move(title), "", ColorMap::balance);
    style.range = ValueRange{-1.0, 1.0};
    style.centre = 0.0;
    return style;
}

LayerStyle height_style(std::string title) {
    LayerStyle style = elevation_style();
    style.text.title = std::move(title);
    return style;
}

LayerStyle millimetre_style(std::string title) {
    LayerStyle style = height_sigma_style();
    style.text.title = std::move(title);
    return style;
}

}  // namespace

LayerStyle style_of_layer(std::string_view name, double safe_threshold) {
    if (name == "elevation") return height_style("Elevation");
    if (name == "highest") return height_style("Highest point");
    if (name == "lowest") return height_style("Lowest point");
    if (name == "lower_bound") return height_style("Lower bound");
    if (name == "upper_bound") return height_style("Upper bound");
    if (name == "variance") return millimetre_style("Sigma of the height");
    if (name == "drift") return millimetre_style("Horizontal drift");
    if (name == "clearance") return plain_style("Clearance", "m", ColorMap::magma);
    if (name == "count") return plain_style("Count", "observations", ColorMap::viridis);
    if (name == "confidence") return share_style("Confidence");
    if (name == "density_ratio") return plain_style("Density ratio", "", ColorMap::magma);
    if (name == "normal_x") return direction_style("Normal, x");
    if (name == "normal_y") return direction_style("Normal, y");
    if (name == "normal_z") return share_style("Normal, z");
    if (name == "free_above") return height_style("Height of rays over unknown ground");
    if (name == "rating_confidence") return share_style("Confidence of the rating");
    if (name == "smallest_step") return millimetre_style("Smallest step that can be resolved");
    if (name == "not_resolvable") return share_style("Sill not resolvable");
    if (name == "reach_step") return millimetre_style("Largest step on the way to the cell");
    LayerStyle rating = traversability_style(safe_threshold);
    if (name == "slope") rating.text.title = "Slope rating";
    if (name == "step") rating.text.title = "Step rating";
    if (name == "roughness") rating.text.title = "Roughness rating";
    if (name == "foothold") rating.text.title = "Foothold";
    const bool is_rating = name == "foothold" || name == "traversability" || name == "slope" ||
                           name == "step" || name == "roughness";
    return is_rating ? rating : plain_style(std::string(name), "", ColorMap::viridis);
}

Picture render_layer_sheet(const grid::GridGeometry& geometry,
                           const std::vector<SheetLayer>& layers,
                           int columns,
                           const FigureText& text,
                           const Overlays& overlays) {
    if (layers.empty()) return {};
    const Layout layout(shown_cells(geometry, layers, overlays), columns, layers.size());
    Picture sheet = layout.sheet(layers.size());
    TextStyle title;
    title.cap_height_px = 17.0;
    title.bold = true;
    draw_text(sheet, {static_cast<double>(kMargin_px), 30.0}, text.title, title);
    TextStyle subtitle = small_text();
    subtitle.color = palette::kSoftInk;
    draw_text(sheet, {static_cast<double>(kMargin_px), 56.0}, text.subtitle, subtitle);
    Overlays drawn = overlays;
    drawn.body_px = kBody_px;
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const SheetLayer& layer = layers[i];
        SUREFOOT_ASSERT(layer.values.width() == geometry.nx &&
                        layer.values.height() == geometry.ny);
        drawn.scale_bar = overlays.scale_bar && i == 0;
        // Only the first map shows the path: on every map, the path would hide cells.
        if (i == 1) drawn.trajectory_m.clear();
        draw_panel(sheet, geometry, layer, layout, layout.plot(static_cast<int>(i)), drawn);
    }
    return sheet;
}

}  // namespace surefoot::eval

// SPDX-License-Identifier: Apache-2.0
#include "service/live/explain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "service/live/ground_box.hpp"
#include "surefoot/eval/report/picture.hpp"
#include "surefoot/grid/whole_cells.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {
namespace {

constexpr double kViewHalf_m = 1.5;

/// Heights around the position of the query.
struct View {
    grid::GridGeometry geometry;
    grid::Layer height_m;
};

View view_around(const gate::Query& query, const grid::MapSnapshot& map) {
    const double resolution_m = kTenthMm_m * map.resolution_tenth_mm;
    const auto first = [&](std::int64_t center, std::int64_t origin) {
        return grid::whole_cells(std::floor(
            (kTenthMm_m * static_cast<double>(center - origin) - kViewHalf_m) / resolution_m));
    };
    const int side = grid::whole_cells(2.0 * kViewHalf_m / resolution_m);
    const int ix0 = first(query.x_tenth_mm, map.origin_x_tenth_mm);
    const int iy0 = first(query.y_tenth_mm, map.origin_y_tenth_mm);
    View view{{resolution_m,
               side,
               side,
               {kTenthMm_m * static_cast<double>(map.origin_x_tenth_mm) + ix0 * resolution_m,
                kTenthMm_m * static_cast<double>(map.origin_y_tenth_mm) + iy0 * resolution_m}},
              grid::Layer(side, side, std::nanf(""))};
    for (int iy = 0; iy < side; ++iy) {
        for (int ix = 0; ix < side; ++ix) {
            const int mx = ix0 + ix;
            const int my = iy0 + iy;
            if (mx < 0 || my < 0 || mx >= map.nx || my >= map.ny) continue;
            const auto cell = static_cast<std::size_t>(my) * static_cast<std::size_t>(map.nx) +
                              static_cast<std::size_t>(mx);
            if (map.is_measured(cell))
                view.height_m.at(ix, iy) =
                    static_cast<float>(kTenthMm_m * map.height_tenth_mm[cell]);
        }
    }
    return view;
}

/// Returns the cells of the view below an overhang, for example the floor below a table top that
/// the camera saw from a distance.
eval::Dots hanging(const View& view, const grid::MapSnapshot& map) {
    eval::Dots dots;
    dots.label = "overhang";
    dots.color = {255, 255, 255};
    const double resolution_m = view.geometry.resolution_m;
    for (int iy = 0; iy < map.ny; ++iy) {
        for (int ix = 0; ix < map.nx; ++ix) {
            const auto at = static_cast<std::size_t>(iy) * static_cast<std::size_t>(map.nx) +
                            static_cast<std::size_t>(ix);
            if (map.clearance_tenth_mm[at] == grid::MapSnapshot::kNoCeiling) continue;
            const Eigen::Vector2d center_m =
                kTenthMm_m * Eigen::Vector2d(static_cast<double>(map.origin_x_tenth_mm),
                                             static_cast<double>(map.origin_y_tenth_mm)) +
                resolution_m * Eigen::Vector2d(ix + 0.5, iy + 0.5);
            if (view.geometry.cell_at(center_m.x(), center_m.y()))
                dots.points_m.push_back(center_m);
        }
    }
    return dots;
}

Pose planar(double x_m, double y_m, double cos_yaw, double sin_yaw) {
    return {Eigen::Quaterniond(
                Eigen::AngleAxisd(std::atan2(sin_yaw, cos_yaw), Eigen::Vector3d::UnitZ())),
            Eigen::Vector3d(x_m, y_m, 0.0)};
}

eval::Outline outline(const GroundBox& box,
                      const Pose& T_odom_body,
                      eval::Rgb8 color,
                      const char* label) {
    eval::Outline result;
    result.points_m = box_outline(box, T_odom_body);
    result.color = color;
    result.label = label;
    return result;
}

}  // namespace

Status write_explanation(const std::string& file,
                         const Machine& machine,
                         const gate::Query& query,
                         const grid::MapSnapshot& map,
                         const gate::Verdict& verdict,
                         const std::string& text) {
    const View view = view_around(query, map);
    const Pose T_odom_body = planar(kTenthMm_m * static_cast<double>(query.x_tenth_mm),
                                    kTenthMm_m * static_cast<double>(query.y_tenth_mm),
                                    query.cos_yaw,
                                    query.sin_yaw);
    eval::Overlays overlays;
    overlays.dots = hanging(view, map);
    overlays.T_odom_body = T_odom_body;
    constexpr eval::Rgb8 kPresent{90, 90, 90};
    constexpr eval::Rgb8 kLanding{213, 94, 0};
    constexpr eval::Rgb8 kBody{0, 114, 178};
    for (const GroundBox* foot : {&machine.left_foot, &machine.right_foot}) {
        overlays.outlines.push_back(outline(*foot, T_odom_body, kPresent, "feet now"));
    }
    if (query.command < Machine::kMovementCodes && machine.movements[query.command].configured) {
        const Movement& m = machine.movements[query.command];
        const Pose T_odom_target = T_odom_body * planar(kTenthMm_m * m.forward_tenth_mm,
                                                        kTenthMm_m * m.left_tenth_mm,
                                                        m.cos_turn,
                                                        m.sin_turn);
        for (const GroundBox* foot : {&machine.left_foot, &machine.right_foot}) {
            overlays.outlines.push_back(
                outline(*foot, T_odom_target, kLanding, "feet after the step"));
        }
        for (const BodyPart& part : machine.body.all())
            overlays.outlines.push_back(
                outline(part.box, T_odom_target, kBody, "body after the step"));
    }
    if (verdict.evidence.has_worst_cell) {
        overlays.marks.push_back(
            {{kTenthMm_m * static_cast<double>(verdict.evidence.worst_x_tenth_mm),
              kTenthMm_m * static_cast<double>(verdict.evidence.worst_y_tenth_mm)},
             "deciding cell"});
    }
    eval::LayerStyle style = eval::elevation_style();
    style.text = {fmt::format("Command {}: {}", query.command, to_string(verdict.decision)), text};
    const auto png = encode_png(render_layer(view.geometry, view.height_m, style, overlays));
    return io::write_file(file, png);
}

}  // namespace surefoot::app

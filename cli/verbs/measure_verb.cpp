// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "cli/json/cloud_json.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/numbers.hpp"
#include "service/console/option_settings.hpp"
#include "studies/clouds/cloud_pictures.hpp"
#include "surefoot/core/angles.hpp"
#include "surefoot/eval/clouds/cloud_measures.hpp"
#include "surefoot/io/clouds/cloud_stream.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {
namespace {

struct MeasureOptions {
    CommonOptions common;
    std::string cloud;
    std::string door;  ///< "x,y,yaw" of a doorway [m, m, deg]; empty = no door
    std::string box;   ///< "x0,y0,x1,y1" [m]; empty = the whole cloud
    double bin_m = 0.005;
    std::string histogram_file;  ///< file for an SVG picture; empty = not written
};

/// Reads the position of the door and subtracts the shift of the cloud. The lowest level surface is
/// the floor.
Result<eval::DoorPlace> parse_door(const std::string& text,
                                   const eval::HeightHistogram& heights,
                                   const Eigen::Vector3d& shift_m) {
    const auto xyyaw = parse_three_numbers("--door", text, "x,y,yaw (m, m, deg)");
    if (!xyyaw) return xyyaw.error();
    if (heights.levels.empty()) {
        return input_error(
            "--door: the cloud has no level surface, so the heights of the door frame have no "
            "zero; give a cloud that shows the floor");
    }
    return eval::DoorPlace{Eigen::Vector2d((*xyyaw)[0], (*xyyaw)[1]) - shift_m.head<2>(),
                           kRadPerDeg * (*xyyaw)[2],
                           heights.levels.front().height_m};
}

/// Keeps only the points inside a box in the x-y plane.
Status keep_box(const std::string& text, io::ShiftedCloud& cloud) {
    if (text.empty()) return {};
    const auto numbers = parse_four_numbers("--box", text, "x0,y0,x1,y1 (m)");
    if (!numbers) return numbers.error();
    const Eigen::Vector2d low_m((*numbers)[0], (*numbers)[1]);
    const Eigen::Vector2d high_m((*numbers)[2], (*numbers)[3]);
    std::erase_if(cloud.points_m, [&](const Eigen::Vector3f& p_m) {
        const Eigen::Vector2d xy_m = p_m.head<2>().cast<double>() + cloud.shift_m.head<2>();
        return (xy_m.array() < low_m.array()).any() || (xy_m.array() > high_m.array()).any();
    });
    if (!cloud.points_m.empty()) return {};
    return usage_error(
        fmt::format("--box {}: the box contains no point of the cloud; give two corners around "
                    "points, smaller x and y first",
                    text));
}

void print_repeated(const char* what, const eval::Repeated& r) {
    if (r.values_m.empty()) return;
    fmt::print(
        "{}: mean {:.1f} mm (standard error {:.1f} mm), standard deviation of one value {:.1f} mm, "
        "number of values {}\n",
        what,
        1e3 * r.mean_m,
        1e3 * r.std_error_m,
        1e3 * r.spread_m,
        r.values_m.size());
}

void print_figures(const eval::HeightHistogram& heights,
                   const eval::StairMeasures& stairs,
                   const std::optional<std::optional<double>>& door_width_m,
                   const Eigen::Vector3d& shift_m) {
    if (heights.levels.empty()) fmt::print("the cloud has no level surface\n");
    for (const eval::Level& level : heights.levels) {
        fmt::print(
            "level surface at {:.4f} m: {} points, rms distance of the points to its plane {:.1f} "
            "mm, tilt {:.2f} deg\n",
            level.height_m + shift_m.z(),
            level.points,
            1e3 * level.rms_m,
            level.tilt_rad * 180.0 / M_PI);
    }
    print_repeated("riser", stairs.riser);
    print_repeated("going", stairs.going);
    if (door_width_m && *door_width_m)
        fmt::print("clear width of the door: {:.1f} mm\n", 1e3 * **door_width_m);
    tell_shift(shift_m);
}

/// `surefoot measure`: finds level surfaces, risers, goings and the width of a door in a cloud.
int measure_cloud(const MeasureOptions& options) {
    auto cloud = io::read_shifted(options.cloud);
    if (!cloud) return report(cloud.error());
    eval::LevelConfig config;
    config.bin_m = options.bin_m;
    if (auto status = keep_box(options.box, *cloud); !status) return report(status.error());
    const geometry::PointBox box = geometry::box_of(cloud->points_m);
    if (auto status = check_voxels(box, eval::kSurfaceVoxel_m, options.cloud); !status)
        return report(status.error());
    const auto executor = make_executor(options.common);
    const eval::SortedSurfaces surfaces = eval::sort_surfaces(cloud->points_m, *executor);
    const eval::HeightHistogram heights = eval::height_histogram(surfaces.level_m, config);
    const eval::StairMeasures stairs = eval::measure_stairs(surfaces, heights.levels);
    std::optional<std::optional<double>> door_width_m;
    if (!options.door.empty()) {
        const auto door = parse_door(options.door, heights, cloud->shift_m);
        if (!door) return report(door.error());
        door_width_m = eval::door_width_m(cloud->points_m, *door);
        if (!*door_width_m)
            log_warning(
                "--door: the width is unknown, because one side of the doorway has too few points "
                "within 3 m; check the position and the direction");
    }
    if (!options.histogram_file.empty()) {
        const auto status = io::write_file(
            options.histogram_file,
            heights_svg(heights, static_cast<std::int64_t>(surfaces.level_m.size()), "Heights"));
        if (!status) return report(status.error());
    }
    if (options.common.json) {
        print_answer(measure_json(heights, stairs, door_width_m, cloud->shift_m));
    } else {
        print_figures(heights, stairs, door_width_m, cloud->shift_m);
    }
    return kExitOk;
}

}  // namespace

void add_measure(VerbGroup verbs) {
    auto [verb, o] = verbs.add<MeasureOptions>(
        "measure",
        "measure a point cloud with z up: heights and planes of its level surfaces, risers and "
        "goings of a straight flight of stairs, and the width of a door",
        "surefoot measure out/stairs_10mm.ply --histogram "
        "out/heights.svg --json",
        measure_cloud,
        Reads::no_settings);
    verb.option("cloud",
                o.cloud,
                "point cloud: PLY, PCD, LAS, VTK or XYZ, for example map.ply of a run")
        .required()
        .value("CLOUD");
    verb.option("--door",
                o.door,
                "measure the clear width of a doorway: a position in the doorway, in m, and the "
                "walking direction through it, in deg")
        .value("X,Y,YAW");
    verb.option("--box",
                o.box,
                "measure only the points in this rectangle, seen from above: the corner with the "
                "smallest x and y, then the opposite corner, in m (default: the whole cloud)")
        .value("X0,Y0,X1,Y1");
    verb.option(
            "--bin", o.bin_m, "width of a bin of the histogram of heights, in m (default 0.005)")
        .value("M")
        .in(1e-4, 0.05);
    verb.option("--histogram", o.histogram_file, "file for a picture of the histogram of heights")
        .value("F.svg");
}

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#include "studies/simulation/scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <span>

#include "service/console/interrupt.hpp"
#include "service/console/log.hpp"
#include "service/console/numbers.hpp"
#include "service/console/option_settings.hpp"
#include "service/console/progress.hpp"
#include "studies/simulation/scan_tiles.hpp"
#include "studies/simulation/sim_options.hpp"
#include "surefoot/io/clouds/ply_stream.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/sim/scenes/scene_stations.hpp"
#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/sensors/laser_scanner.hpp"

namespace surefoot::app {
namespace {

using Eigen::Vector3d;

Result<std::vector<Vector3d>> chosen_stations(const SimOptions& options,
                                              const sim::ScriptedScene& script) {
    if (options.stations.empty()) return stations_of(script);
    std::vector<Vector3d> stations_m;
    for (const std::string& text : options.stations) {
        const auto xyz = parse_three_numbers("--station", text, "x,y,z in metres");
        if (!xyz) return xyz.error();
        const Vector3d station_m((*xyz)[0], (*xyz)[1], (*xyz)[2]);
        if (sim::is_buried(script.scene, station_m)) {
            return usage_error(
                fmt::format("--station {}: this position is under the ground or inside an object "
                            "of {}; choose a free position",
                            text,
                            options.scene));
        }
        stations_m.push_back(station_m);
    }
    return stations_m;
}

/// Converts the points of one scan column to the layout of the file: x, y, z, station, mixed.
void flatten(const sim::ScanColumn& column,
             const Pose& T_world_scanner,
             int station,
             std::vector<float>& out) {
    out.clear();
    for (const sim::ScanPoint& point : column.points) {
        if (std::isnan(point.point_scanner_m.x())) continue;
        const Vector3d p_world_m = T_world_scanner * point.point_scanner_m;
        for (const double value : p_world_m) out.push_back(static_cast<float>(value));
        out.push_back(static_cast<float>(station));
        out.push_back(point.mixed ? 1.0F : 0.0F);
    }
}

/// Receives the points in the layout of flatten(), block by block.
using TakePoints = std::function<Status(std::span<const float> values)>;

void scan_all(const sim::LaserScanner& scanner,
              const std::vector<Vector3d>& stations_m,
              Executor& executor,
              const TakePoints& take,
              Scanned& scanned) {
    Progress progress("scan", static_cast<int>(stations_m.size()) * scanner.columns());
    std::vector<float> values;
    while (!scanned.error && scanned.stations < static_cast<int>(stations_m.size())) {
        const int station = scanned.stations++;
        Pose T_world_scanner;
        T_world_scanner.translation_m = stations_m[static_cast<std::size_t>(station)];
        scanner.scan(T_world_scanner, station, executor, [&](const sim::ScanColumn& column) {
            if (interrupted()) {
                scanned.error = Error{ErrorCode::interrupted,
                                      "interrupted by the user; the points up to here are kept"};
                return false;
            }
            flatten(column, T_world_scanner, station, values);
            if (auto status = take(values); !status) scanned.error = status.error();
            progress.advance(station * scanner.columns() + column.index + 1);
            return !scanned.error;
        });
    }
}

/// Writes the scan to one file or to a folder of tiles. Returns an error if the output cannot be
/// opened; later errors go to `scanned`.
Status write_scan(const SimOptions& options,
                  const sim::LaserScanner& scanner,
                  const std::vector<Vector3d>& stations_m,
                  Executor& executor,
                  Scanned& scanned) {
    if (options.tile_m > 0.0) {
        auto tiles = ScanTiles::create(options.scan_file, options.tile_format, options.tile_m);
        if (!tiles) return tiles.error();
        scan_all(
            scanner,
            stations_m,
            executor,
            [&](std::span<const float> values) { return tiles->add(values); },
            scanned);
        const ScanOrigin origin{
            options.scene, options.common.seed, stations_m, !scanned.error.has_value()};
        if (auto status = tiles->finish(origin); !status && !scanned.error)
            scanned.error = status.error();
        scanned.points = tiles->points();
        scanned.tiles = tiles->tiles();
        return {};
    }
    auto file = io::PlyStream::create(options.scan_file, {"station", "mixed"});
    if (!file) return file.error();
    scan_all(
        scanner,
        stations_m,
        executor,
        [&](std::span<const float> values) { return file->add(values); },
        scanned);
    if (auto status = file->close(); !status && !scanned.error) scanned.error = status.error();
    scanned.points = file->points();
    return {};
}

/// Bytes of one point in the file: x, y, z, station and mixed flag, each a float.
constexpr std::int64_t kBytesPerPoint = 5 * sizeof(float);

}  // namespace

std::vector<Vector3d> stations_of(const sim::ScriptedScene& script) {
    if (!script.stations_m.empty()) return script.stations_m;
    const Vector3d start_m = script.motion->at(0.0).T_world_body.translation_m;
    const auto ground = script.scene.height_at(start_m.x(), start_m.y());
    return {{start_m.x(), start_m.y(), (ground ? ground->z_m : 0.0) + sim::kTripod_m}};
}

Result<double> expected_points(const sim::Scene& scene,
                               const sim::LaserScannerConfig& config,
                               std::span<const Vector3d> stations_m,
                               Executor& executor) {
    constexpr double kCoarse_deg = 2.0;
    sim::LaserScannerConfig coarse_config = config;
    coarse_config.step_deg = std::max(config.step_deg, kCoarse_deg);
    const auto full = sim::LaserScanner::make(scene, config, 0);
    if (!full) return full.error();
    const auto coarse = sim::LaserScanner::make(scene, coarse_config, 0);
    if (!coarse) return coarse.error();
    std::int64_t beams = 0;
    std::int64_t returns = 0;
    for (const Vector3d& station_m : stations_m) {
        Pose T_world_scanner;
        T_world_scanner.translation_m = station_m;
        coarse->scan(T_world_scanner, 0, executor, [&](const sim::ScanColumn& column) {
            beams += std::ssize(column.points);
            returns += std::count_if(
                column.points.begin(), column.points.end(), [](const sim::ScanPoint& point) {
                    return !std::isnan(point.point_scanner_m.x());
                });
            return !interrupted();
        });
    }
    const double share =
        beams > 0 ? static_cast<double>(returns) / static_cast<double>(beams) : 1.0;
    return share * static_cast<double>(std::ssize(stations_m)) *
           static_cast<double>(full->columns()) * static_cast<double>(full->rows());
}

Status check_room(const std::string& file, const ScanSize& size, double free_bytes) {
    if (size.bytes <= free_bytes) return {};
    return input_error(fmt::format(
        "{}: the scan needs about {:.1f} GB ({:.3g} points), but the disk has {:.1f} GB free; use "
        "coarser steps (--set sim.laser.step_deg=...), fewer stations, or another disk",
        file,
        1e-9 * size.bytes,
        size.points,
        1e-9 * free_bytes));
}

int scan(const SimOptions& options) {
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const auto script = sim::make_scene(options.scene, options.common.seed);
    if (!script) return report(script.error());
    const auto stations_m = chosen_stations(options, *script);
    if (!stations_m) return report(stations_m.error());
    const auto scanner =
        sim::LaserScanner::make(script->scene, settings->laser, options.common.seed);
    if (!scanner) return report(scanner.error());

    watch_for_interrupts();
    const auto executor = make_executor(options.common);
    const auto points = expected_points(script->scene, settings->laser, *stations_m, *executor);
    if (!points) return report(points.error());
    const ScanSize size{*points, *points * kBytesPerPoint};
    log_info(fmt::format("{}: about {:.3g} points, {:.0f} MB",
                         options.scan_file,
                         size.points,
                         std::ceil(1e-6 * size.bytes)));
    const auto free_bytes = io::free_bytes(io::folder_of(options.scan_file));
    if (free_bytes) {  // no value on some file systems: then only writing detects a full disk
        if (auto status = check_room(options.scan_file, size, static_cast<double>(*free_bytes));
            !status)
            return report(status.error());
    }
    Scanned scanned{.file = options.scan_file, .error = std::nullopt};
    if (auto status = write_scan(options, *scanner, *stations_m, *executor, scanned); !status)
        return report(status.error());
    if (options.common.json) {
        print_answer(scan_json(scanned));
    } else {
        const std::string tiles =
            scanned.tiles > 0 ? fmt::format("{} tiles in ", scanned.tiles) : std::string();
        fmt::print("{} points of {} from {} station{} in {}{}\n",
                   scanned.points,
                   options.scene,
                   scanned.stations,
                   scanned.stations == 1 ? "" : "s",
                   tiles,
                   options.scan_file);
    }
    return scanned.error ? report(*scanned.error) : kExitOk;
}

}  // namespace surefoot::app

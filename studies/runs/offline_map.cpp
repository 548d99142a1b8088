// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/offline_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "service/live/ground_box.hpp"
#include "surefoot/grid/snapshot_builder.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/io/maps/snapshot_file.hpp"

namespace surefoot::app {
namespace {

Result<OfflineMap> map_from_grids(const std::string& folder) {
    const std::string height_file = folder + "/elevation.asc";
    const std::string variance_file = folder + "/variance.asc";
    if (!io::is_file(height_file) || !io::is_file(variance_file)) {
        return input_error(
            fmt::format("{}: the folder has no map.snapshot and no elevation.asc with "
                        "variance.asc; give the output folder of 'surefoot run'",
                        folder));
    }
    if (io::is_file(folder + "/report.json")) {
        return input_error(
            fmt::format("{}: this run has no map.snapshot, so its health and gravity are unknown "
                        "and there is no verdict; its report.json says what failed",
                        folder));
    }
    const auto height = io::read_height_grid(height_file);
    if (!height) return height.error();
    const auto variance = io::read_esri_grid(variance_file);
    if (!variance) return variance.error();
    const auto& a = height->geometry;
    const auto& b = variance->geometry;
    if (a.nx != b.nx || a.ny != b.ny || a.resolution_m != b.resolution_m ||
        a.origin_m != b.origin_m) {
        return input_error(
            fmt::format("{}: the cells differ from those of {}; give the files of one run",
                        variance_file,
                        height_file));
    }
    const grid::Layer no_drift(a.nx, a.ny, 0.0F);
    grid::SnapshotInput input;
    input.geometry = a;
    input.height_m = height->values.view();
    input.variance_m2 = variance->values.view();
    input.drift_m = no_drift.view();
    input.gravity_source = grid::GravitySource::plane;
    input.tilt_sigma_rad = 0.0;
    input.health = grid::SnapshotHealth::ok;
    input.camera = CameraState::ok;
    input.version = 1;
    OfflineMap map{std::make_unique<grid::MapSnapshot>(), {}};
    if (auto status = grid::build_snapshot(input, *map.snapshot); !status) return status.error();
    map.assumed = height->notes;
    for (const char* assumed : {"no drift since the last observation of the cells",
                                "the z axis of the grid points up",
                                "odometry and camera were healthy"})
        map.assumed.emplace_back(assumed);
    return map;
}

/// Returns the heights of the known cells around the pose of the query [0.1 mm], sorted.
std::vector<std::int64_t> heights_around(const gate::Query& query,
                                         const grid::MapSnapshot& map,
                                         std::int64_t radius) {
    std::vector<std::int64_t> heights;
    for (int iy = 0; iy < map.ny; ++iy) {
        for (int ix = 0; ix < map.nx; ++ix) {
            const auto cell = static_cast<std::size_t>(iy) * static_cast<std::size_t>(map.nx) +
                              static_cast<std::size_t>(ix);
            if (!map.is_measured(cell)) continue;
            const std::int64_t half = map.resolution_tenth_mm / 2;
            const std::int64_t dx =
                map.origin_x_tenth_mm + ix * map.resolution_tenth_mm + half - query.x_tenth_mm;
            const std::int64_t dy =
                map.origin_y_tenth_mm + iy * map.resolution_tenth_mm + half - query.y_tenth_mm;
            if (dx * dx + dy * dy <= radius * radius) heights.push_back(map.height_tenth_mm[cell]);
        }
    }
    std::sort(heights.begin(), heights.end());
    return heights;
}

/// Returns the distance of the farthest corner of the standing feet from base_link [0.1 mm].
double reach_of(const Machine& machine) {
    double reach = 0.0;
    for (const GroundBox* foot : {&machine.left_foot, &machine.right_foot}) {
        reach =
            std::max(reach,
                     std::hypot(std::abs(foot->center_x_tenth_mm) + 0.5 * foot->length_tenth_mm,
                                std::abs(foot->center_y_tenth_mm) + 0.5 * foot->width_tenth_mm));
    }
    return reach;
}

}  // namespace

Result<OfflineMap> load_offline_map(const std::string& folder) {
    const std::string snapshot_file = folder + "/map.snapshot";
    if (!io::is_file(snapshot_file)) return map_from_grids(folder);
    auto snapshot = io::read_snapshot(snapshot_file);
    if (!snapshot) return snapshot.error();
    return OfflineMap{std::move(snapshot).value(), {}};
}

Result<gate::AttestedArea> attest_start(const Machine& machine,
                                        const gate::Query& query,
                                        const grid::MapSnapshot& map,
                                        double radius_m,
                                        std::vector<std::string>& assumed) {
    const double limit_m = kTenthMm_m * machine.limits.attestation_radius_tenth_mm;
    if (!(radius_m <= limit_m)) {
        return usage_error(fmt::format(
            "--attest {:g}: the machine file allows at most {:g} m", radius_m, limit_m));
    }
    gate::AttestedArea area;
    area.active = true;
    area.center_x_tenth_mm = query.x_tenth_mm;
    area.center_y_tenth_mm = query.y_tenth_mm;
    // Only cells that lie wholly inside the area count. So the default radius exceeds the reach of
    // the feet by 1.5 cells, which is more than a cell diagonal.
    const double feet_m = kTenthMm_m * (reach_of(machine) + 1.5 * map.resolution_tenth_mm);
    // in range: at most limit_m, or what the feet of a machine reach
    area.radius_tenth_mm = static_cast<std::int32_t>(
        (radius_m < 0.0 ? std::min(feet_m, limit_m) : radius_m) / kTenthMm_m);
    // Takes the lower quartile, because the machine stands on the lower ground around it and not on
    // furniture beside it.
    const auto heights = heights_around(query, map, area.radius_tenth_mm);
    if (!heights.empty())
        area.height_tenth_mm = static_cast<std::int32_t>(heights[heights.size() / 4]);
    assumed.push_back(fmt::format(
        "start area: flat ground at z = {:.3f} m ({}) within {:.2f} m of base_link "
        "wherever no ground was measured",
        kTenthMm_m * area.height_tenth_mm,
        heights.empty() ? "the ground plane of odom" : "from the measured cells around base_link",
        kTenthMm_m * area.radius_tenth_mm));
    return area;
}

OfflineMoment moment_of(const grid::MapSnapshot& map) {
    OfflineMoment moment;
    moment.now_ns = std::max(map.frame_time_ns, map.pose_time_ns);
    return moment;
}

gate::Verdict decide_offline(const Machine& machine,
                             const gate::Query& query,
                             const grid::MapSnapshot& map) {
    const OfflineMoment moment = moment_of(map);
    return gate::decide(machine, query, map, moment.health, moment.now_ns);
}

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/run_output.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>

#include "service/console/writes.hpp"
#include "studies/runs/map_layers.hpp"
#include "studies/runs/run_features.hpp"
#include "studies/runs/run_json.hpp"
#include "studies/runs/run_report.hpp"
#include "studies/runs/stairs_json.hpp"
#include "studies/runs/stairs_text.hpp"
#include "studies/runs/terrain_map.hpp"
#include "surefoot/camera/reproject.hpp"
#include "surefoot/elevation/region/region_transfer.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/io/maps/map_file.hpp"
#include "surefoot/io/maps/snapshot_file.hpp"
#include "surefoot/io/recordings/trajectory_file.hpp"
#include "surefoot/io/settings/config_yaml.hpp"
#include "surefoot/stairs/feature_finder.hpp"

namespace surefoot::app {
namespace {

/// Returns one point for each known cell with its variance and rating.
io::PointCloud map_cloud(const pipeline::Pipeline& pipeline) {
    const grid::GridGeometry& geometry = pipeline.map().geometry();
    const auto& layers = pipeline.map().layers();
    const grid::Layer surface_m = pipeline.surface_m();
    const grid::Layer& rating = pipeline.rating().traversability;
    io::PointCloud cloud;
    io::CloudScalar variance{.name = "variance_m2", .values = {}};
    io::CloudScalar traversability{.name = "traversability", .values = {}};
    for (int iy = 0; iy < geometry.ny; ++iy) {
        for (int ix = 0; ix < geometry.nx; ++ix) {
            const float z_m = surface_m.at(ix, iy);
            if (std::isnan(z_m)) continue;
            const Eigen::Vector2d center_m = geometry.center_m({ix, iy});
            cloud.points_m.emplace_back(center_m.x(), center_m.y(), z_m);
            variance.floats().push_back(layers.height_var_m2.at(ix, iy));
            traversability.floats().push_back(rating.empty() ? std::nanf("") : rating.at(ix, iy));
        }
    }
    cloud.width = static_cast<int>(cloud.points_m.size());
    cloud.scalars = {std::move(variance), std::move(traversability)};
    return cloud;
}

/// Returns values that are not settings but affect the result, as a comment above the settings.
std::string command_line(const RunOptions& options) {
    std::string line = fmt::format("# surefoot {}: run {}", SUREFOOT_VERSION, options.source);
    const auto add = [&](const char* option, const std::string& value) {
        if (!value.empty()) line += fmt::format(" {} {}", option, value);
    };
    const auto add_number = [&](const char* option, double value, double by_default) {
        if (value != by_default) line += fmt::format(" {} {:g}", option, value);
    };
    add("--rig", options.rig_file);
    add("--machine", options.machine);
    add_number("--rate", options.rate_hz, 0.0);
    add_number("--max-frames", options.max_frames, 0.0);
    add_number("--depth-every", options.depth_every, 1.0);
    add("--place", options.place);
    return line + fmt::format(" --seed {}\n", options.common.seed);
}

/// Writes all layers except the three that every run writes.
void write_all_layers(const std::string& out,
                      const grid::GridGeometry& geometry,
                      std::span<const NamedLayer> layers,
                      Writes& writes) {
    for (const NamedLayer& layer : layers) {
        const std::string_view name = layer.name;
        if (name == "elevation" || name == "variance" || name == "traversability") continue;
        writes += io::write_esri_grid(fmt::format("{}/{}.asc", out, name), geometry, layer.values);
    }
}

/// Returns the horizontal distance from base_link to the nearest trusted pixel of the last frame
/// with depth [m]. Ignores the nearest percent of the pixels as possible outliers. Empty if there
/// is no such frame.
std::optional<double> nearest_seen_m(const RunRecord& record, const pipeline::Pipeline& pipeline) {
    constexpr double kChance = 0.01;
    const DepthImage& depth = pipeline.depth();
    const auto full =
        std::find_if(record.frames.rbegin(), record.frames.rend(), [](const FrameReport& frame) {
            return frame.work == Work::full;
        });
    if (full == record.frames.rend() || depth.disparity_px.empty()) return std::nullopt;
    Image<Eigen::Vector3f> points_m;
    camera::Reprojector(pipeline.rig()).points(depth.disparity_px.view(), points_m);
    const Pose& T_odom_body = full->motion.T_odom_body;
    const Pose T_odom_camera = T_odom_body * pipeline.rig().T_body_camera;
    std::vector<double> distances_m;
    for (std::size_t i = 0; i < points_m.size(); ++i) {
        const Eigen::Vector3f& p_camera_m = points_m.data()[i];
        if (!p_camera_m.allFinite() ||
            depth.outlier_probability.data()[i] > kTrustedOutlierProbability)
            continue;
        const Eigen::Vector3d p_odom_m = T_odom_camera * p_camera_m.cast<double>();
        distances_m.push_back((p_odom_m - T_odom_body.translation_m).head<2>().norm());
    }
    if (distances_m.empty()) return std::nullopt;
    const auto nearest =
        distances_m.begin() +
        // in range: kChance is below 1
        static_cast<std::ptrdiff_t>(kChance * static_cast<double>(distances_m.size()));
    std::nth_element(distances_m.begin(), nearest, distances_m.end());
    return *nearest;
}

/// If all visible points lie outside the map, returns a sentence with their distance and the map
/// length that would reach them.
std::optional<std::string> beyond_the_map(const RunRecord& record,
                                          const pipeline::Pipeline& pipeline) {
    const double length_m = pipeline.config().elevation.length_m;
    const auto nearest_m = nearest_seen_m(record, pipeline);
    // The map is centred on the machine (to a cell), so half of its length lies ahead.
    if (!nearest_m || *nearest_m < 0.5 * length_m) return std::nullopt;
    return fmt::format(
        "the nearest visible point is {:.1f} m from base_link, but the map ends at {:.1f} m, so no "
        "pixel falls into it; raise elevation.length_m ({:g} m) above {:.0f} m",
        *nearest_m,
        0.5 * length_m,
        length_m,
        std::ceil(2.0 * *nearest_m));
}

/// Writes the map after the last frame. Its odom frame belongs to this run only and is identified
/// by the first stamp of the run.
Status save_map(const std::string& path,
                std::uint64_t config_hash,
                const pipeline::Pipeline& pipeline,
                const RunRecord& record) {
    if (record.frames.empty())
        return output_error(path + ": not written, because no frame was processed");
    grid::MapRegion region = elevation::region_of(pipeline.map());
    region.frame_since_ns = record.frames.front().time_ns;
    region.stamp_ns = record.frames.back().time_ns;
    region.T_frame_body = record.frames.back().motion.T_odom_body;
    region.config_hash = config_hash;
    return io::write_map(path, region);
}

}  // namespace

grid::Layer or_unknown(const grid::Layer& layer, const grid::GridGeometry& geometry) {
    return layer.empty() ? grid::Layer(geometry.nx, geometry.ny, std::nanf("")) : layer;
}

/// Compares the tracked features with those in the written map files. `surefoot stairs` on the
/// folder reads the same files.
RunFeatures run_features(const RunOptions& options,
                         const Settings& settings,
                         const pipeline::Pipeline& pipeline) {
    TerrainRequest map_of_run;
    map_of_run.map = options.out_dir;
    const auto map = load_terrain(map_of_run);
    if (!map) return split_by_confirmation(pipeline.features());  // empty map or full disk
    stairs::TerrainFeatures final_map;
    stairs::FeatureFinder(settings.pipeline.stairs).find(map->terrain(), final_map);
    return compare_with_final_map(pipeline.features(), final_map);
}

Status write_results(const RunOptions& options,
                     const Settings& settings,
                     const std::optional<io::MachineFile>& machine,
                     const pipeline::Pipeline& pipeline,
                     const RunRecord& record) {
    const std::string& out = options.out_dir;
    const grid::GridGeometry& geometry = pipeline.map().geometry();
    const auto& layers = pipeline.map().layers();
    Writes writes;
    writes += io::write_file(out + "/config.yaml",
                             command_line(options) + io::format_config_of(settings));
    writes += io::write_tum_trajectory(out + "/trajectory.tum", trajectory_of(record.frames));
    writes += io::write_tum_trajectory(out + "/trajectory_camera.tum",
                                       trajectory_of(record.frames, record.rig.body_from_left()));
    writes += io::write_esri_grid(out + "/elevation.asc", geometry, pipeline.surface_m());
    writes += io::write_esri_grid(out + "/ground.asc", geometry, layers.height_m.copy());
    writes += io::write_esri_grid(out + "/variance.asc", geometry, layers.height_var_m2.copy());
    writes += io::write_esri_grid(out + "/traversability.asc",
                                  geometry,
                                  or_unknown(pipeline.rating().traversability, geometry));
    if (options.all_layers) {
        const std::vector<NamedLayer> named = all_layers(pipeline);
        write_all_layers(out, geometry, named, writes);
        const auto png = layer_sheet_png(geometry,
                                         named,
                                         settings.maps.safe_threshold,
                                         3,
                                         {fmt::format("All layers: {}", record.source.path), ""},
                                         overlays_of(machine, record));
        writes += io::write_file(out + "/layers.png", png);
    }
    writes += io::write_ply(out + "/map.ply", map_cloud(pipeline));
    const stairs::GroundClasses classes = pipeline.ground_classes();
    writes += io::write_esri_grid(out + "/treads.asc", geometry, classes.tread_height_m);

    const auto snapshot = std::make_unique<grid::MapSnapshot>();
    Status sealed = pipeline.snapshot(hash_of(settings), *snapshot);
    writes +=
        sealed.ok() ? io::write_snapshot(out + "/map.snapshot", *snapshot) : std::move(sealed);

    const RunFeatures features = run_features(options, settings, pipeline);
    writes += io::write_file(out + "/stairs.json",
                             stairs_json(features.confirmed,
                                         classes,
                                         {.resolution_m = geometry.resolution_m,
                                          .gravity_source = pipeline.alignment().gravity_source,
                                          .assumed = {},
                                          .unconfirmed = &features.unconfirmed}) +
                                 "\n");
    if (!options.save_map.empty())
        writes += save_map(options.save_map, hash_of(settings), pipeline, record);
    writes += write_pictures_and_report(options, settings, machine, pipeline, record);
    writes +=
        io::write_file(out + "/report.json", report_json(record, pipeline, writes.first()) + "\n");
    return writes.first();
}

std::string empty_map_reason(const RunRecord& record, const pipeline::Pipeline& pipeline) {
    if (pipeline.map().known_cells() > 0) return "";
    const FusionCounts& f = record.fusion;
    const auto& config = pipeline.config().elevation;
    const auto lost =
        std::count_if(record.frames.begin(), record.frames.end(), [](const FrameReport& frame) {
            return frame.motion.health == Health::lost;
        });
    if (f.points == 0 && lost > 0) {
        return fmt::format(
            "odometry was lost in {} of {} frames, and the map leaves out such frames",
            lost,
            record.frames.size());
    }
    if (f.points == 0)
        return "no frame had any depth; check depth_pixels and camera of each frame (per_frame in "
               "report.json)";
    if (const auto reason = beyond_the_map(record, pipeline)) return *reason;
    const std::pair<std::int64_t, std::string> causes[] = {
        {f.outside,
         fmt::format("are outside the map (elevation.length_m = {:g} m, centred on base_link)",
                     config.length_m)},
        {f.gated_range, "are nearer or farther than elevation.prefilter allows"},
        {f.gated_height, "are above or below the height cut of elevation.prefilter"},
        {f.gated_confidence,
         "are at depth edges, at too flat an angle, or likely outliers (elevation.pixels)"},
        {f.gated_density, "have too few neighbours (elevation.prefilter)"},
        {f.gated_border, "are in cells that reach beyond the image (elevation.reduction)"},
    };
    const auto& worst =
        *std::max_element(std::begin(causes), std::end(causes), [](const auto& a, const auto& b) {
            return a.first < b.first;
        });
    if (worst.first == 0) {
        return fmt::format(
            "none of the {} depth points was rejected, but no cell received enough points",
            f.points);
    }
    return fmt::format("{} of {} depth points {}", worst.first, f.points, worst.second);
}

Percentiles percentiles(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const auto at = [&](double share) {
        const double rank = std::round(share * static_cast<double>(values.size() - 1));
        return values[static_cast<std::size_t>(rank)];  // in range: share is 0.5 or 0.99
    };
    const double sum = std::accumulate(values.begin(), values.end(), 0.0);
    return {sum / static_cast<double>(values.size()), at(0.5), at(0.99), values.size()};
}

Percentiles stage_percentiles(const RunRecord& record, Stage stage) {
    std::vector<double> values;
    for (const FrameReport& frame : record.frames) {
        if (frame.work == Work::full || stage == Stage::odometry) {
            values.push_back(frame.stage_ms[static_cast<std::size_t>(stage)]);
        }
    }
    return percentiles(std::move(values));
}

Percentiles frame_percentiles(const RunRecord& record) {
    std::vector<double> values;
    for (const FrameReport& frame : record.frames) {
        if (frame.work != Work::full) continue;
        double sum_ms = 0.0;
        for (const double ms : frame.stage_ms) sum_ms += ms;
        values.push_back(sum_ms);
    }
    return percentiles(std::move(values));
}

double peak_memory_mb() {
    rusage usage = {};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;  // Linux reports this value in kB
}

std::string modelled_note(const camera::SourceInfo& source) {
    if (source.modelled_depth) {
        return "Odometry and depth were modelled from the truth; no image was rendered, matched or "
               "tracked.";
    }
    return source.modelled_motion ? "The motion was not measured: the source provides a known pose."
                                  : "";
}

std::string broken_text(const camera::BrokenFrames& broken) {
    if (broken.count == 0) return "";
    return fmt::format("{} broken frame{} skipped (--skip-broken); the first: {}\n",
                       broken.count,
                       broken.count == 1 ? " was" : "s were",
                       broken.first);
}

std::string run_summary(const RunRecord& record, const pipeline::Pipeline& pipeline) {
    const Percentiles frame = frame_percentiles(record);
    std::string text =
        fmt::format("{} frames, {:.1f} ms per full frame (median), {} cells known\n{}\n",
                    record.frames.size(),
                    frame.median,
                    pipeline.map().known_cells(),
                    pipeline.alignment().reason);
    if (record.waited_frames > 0) {
        text += fmt::format(
            "the run leaves out the first {} frames, because they were too bright, too dark or "
            "showed no ground; the settings mount.wait_for_exposure_s, mount.wait_for_ground_s "
            "and mount.wait_for_search_s limit this wait\n",
            record.waited_frames);
    }
    if (const auto& self_calibration = pipeline.self_calibration()) {
        text += fmt::format(
            "self-calibration corrects the right camera by {:+.3f} deg about the line of sight, "
            "{:+.3f} deg up and down and {:+.3f} % of the focal length. Median difference of "
            "corresponding rows: {:.2f} px without the correction, {:.2f} px with it. To switch "
            "self-calibration off, set self_calibration.enabled=false\n",
            self_calibration->camera.roll_rad * 180.0 / std::numbers::pi,
            self_calibration->camera.pitch_rad * 180.0 / std::numbers::pi,
            100.0 * self_calibration->camera.focal_share,
            self_calibration->row_error_px,
            self_calibration->row_error_left_px);
    }
    if (!pipeline.features().edges.empty()) {
        text += features_count_text(split_by_confirmation(pipeline.features())) + "\n";
        const std::string note = gravity_note(pipeline.alignment().gravity_source);
        if (!note.empty()) text += note + "\n";
    }
    text += broken_text(record.source.broken);
    if (const std::string note = modelled_note(record.source); !note.empty()) text += note + "\n";
    if (const std::string reason = empty_map_reason(record, pipeline); !reason.empty()) {
        text += fmt::format("the map is empty: {}\n", reason);
    }
    if (record.truth) {
        const TruthFigures& t = *record.truth;
        text += fmt::format(
            "compared with the truth, without alignment: median |height error| {:.1f} mm, 90th "
            "percentile {:.1f} mm; {:.2f} % of the height errors away from edges are above 50 mm; "
            "{:.1f} % of the cells visible within 2.5 m are known; trajectory error {:.1f} mm "
            "rmse; {:.1f} % of the depths are within 3 sigma\n",
            1e3 * t.maps.elevation.median_abs_m,
            1e3 * t.maps.elevation.p90_abs_m,
            100.0 * t.maps.elevation_away_from_edges.share_over_50mm,
            100.0 * t.coverage_within_2_5_m,
            1e3 * t.trajectory.ate_rmse_m,
            100.0 * t.depth.within_3_sigma);
    }
    return text;
}

}  // namespace surefoot::app

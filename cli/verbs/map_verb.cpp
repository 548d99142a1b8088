// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "cli/json/map_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/numbers.hpp"
#include "service/console/option_settings.hpp"
#include "surefoot/core/angles.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/elevation/region/region_merge.hpp"
#include "surefoot/elevation/region/region_transfer.hpp"
#include "surefoot/io/maps/map_file.hpp"

namespace surefoot::app {
namespace {

struct MapInfoOptions {
    CommonOptions common;
    std::string file;
};

struct MapMergeOptions {
    CommonOptions common;
    std::string first;
    std::string second;
    std::string out_file;
    /// One sigma of the motion between the poses of the maps: horizontal [m], vertical [m], angle
    /// [deg].
    std::string motion_sigma = "0,0,0";
    bool independent = false;  ///< the maps come from two runs with the same odom frame
};

void warn_of_skipped(const io::MapFile& map, const std::string& file) {
    for (const std::string& layer : map.skipped_layers) {
        log_warning(
            fmt::format("{}: this program does not know the layer {} of the newer format version "
                        "{}.{} and ignores the layer",
                        file,
                        layer,
                        io::kMapFileMajor,
                        map.minor));
    }
}

/// Reads a horizontal [m], a vertical [m] and an angular [deg] sigma and returns their covariance.
Result<Matrix6> motion_covariance(const std::string& text) {
    const auto sigma = parse_three_numbers(
        "--motion-sigma", text, "(horizontal in m, vertical in m, angle in deg)");
    if (!sigma) return sigma.error();
    const auto [horizontal_m, vertical_m, angle_deg] = *sigma;
    if (horizontal_m < 0.0 || vertical_m < 0.0 || angle_deg < 0.0)
        return usage_error(fmt::format(
            "--motion-sigma {}: a standard deviation is negative; give three numbers of at least 0",
            text));
    const double angle_rad = angle_deg * kRadPerDeg;
    Vector6 sigmas;
    sigmas << horizontal_m, horizontal_m, vertical_m, angle_rad, angle_rad, angle_rad;
    return Matrix6(sigmas.cwiseAbs2().asDiagonal());
}

/// Increases the variances of the older map by the uncertainty of the motion from its pose to the
/// pose of the younger map. If this uncertainty is zero, logs a warning and changes nothing.
Status pay_for_the_way(const Matrix6& covariance,
                       const MapMergeOptions& options,
                       grid::MapRegion& first,
                       grid::MapRegion& second) {
    if (first.stamp_ns == second.stamp_ns) return {};
    const bool first_is_older = first.stamp_ns < second.stamp_ns;
    grid::MapRegion& older = first_is_older ? first : second;
    const grid::MapRegion& younger = first_is_older ? second : first;
    if (covariance.isZero(0.0)) {
        log_warning(
            fmt::format("{}: this map is {:.3f} s older than the other map, and its variances do "
                        "not include the motion between the two maps; give the uncertainty of this "
                        "motion with --motion-sigma",
                        first_is_older ? options.first : options.second,
                        seconds_from_ns(younger.stamp_ns - older.stamp_ns)));
        return {};
    }
    return elevation::pay_for_motion(older, younger.T_frame_body, covariance);
}

/// `surefoot map info`: describes a saved map.
int map_info(const MapInfoOptions& options) {
    const auto map = io::read_map(options.file);
    if (!map) return report(map.error());
    if (options.common.json) {
        print_answer(map_info_json(*map, options.file));
        return kExitOk;
    }
    const grid::MapRegion& r = map->region;
    const Eigen::Vector2d origin_m = r.geometry().origin_m;
    const Eigen::Vector3d& body_m = r.T_frame_body.translation_m;
    fmt::print("saved map in format version {}.{}: {} x {} cells of {:g} m, {} cells are known\n",
               io::kMapFileMajor,
               map->minor,
               r.box.nx,
               r.box.ny,
               r.resolution_m,
               r.known_cells());
    fmt::print(
        "the map uses the frame {} of the run that began at {:.3f} s; the corner with the smallest "
        "x and y is at ({:.3f}, {:.3f}) m\n",
        r.frame,
        seconds_from_ns(r.frame_since_ns),
        origin_m.x(),
        origin_m.y());
    fmt::print(
        "saved at {:.3f} s with base_link at ({:.3f}, {:.3f}, {:.3f}) m, yaw {:.1f} deg; hash of "
        "the settings {:016x}\n",
        seconds_from_ns(r.stamp_ns),
        body_m.x(),
        body_m.y(),
        body_m.z(),
        yaw_rad(r.T_frame_body) / kRadPerDeg,
        r.config_hash);
    warn_of_skipped(*map, options.file);
    return kExitOk;
}

/// `surefoot map merge`: merges two saved maps.
int map_merge(const MapMergeOptions& options) {
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const auto covariance = motion_covariance(options.motion_sigma);
    if (!covariance) return report(covariance.error());
    auto first = io::read_map(options.first);
    if (!first) return report(first.error());
    auto second = io::read_map(options.second);
    if (!second) return report(second.error());
    warn_of_skipped(*first, options.first);
    warn_of_skipped(*second, options.second);
    grid::MapRegion& merged = first->region;
    if (Status paid = pay_for_the_way(*covariance, options, merged, second->region); !paid)
        return report(paid.error());
    const auto counts = elevation::merge(merged,
                                         second->region,
                                         settings->pipeline.elevation.fusion,
                                         options.independent ? elevation::RegionErrors::independent
                                                             : elevation::RegionErrors::shared);
    if (!counts) {
        const Error& error = counts.error();
        return report({error.code,
                       fmt::format("{} and {}: {}", options.first, options.second, error.message)});
    }
    if (Status written = io::write_map(options.out_file, merged); !written)
        return report(written.error());
    if (options.common.json) {
        print_answer(map_merge_json(merged, *counts, options.out_file));
    } else {
        fmt::print(
            "{} known cells in {}: {} were known only in the second map; the heights of the two "
            "maps agree in {} cells and disagree in {}\n",
            merged.known_cells(),
            options.out_file,
            counts->taken,
            counts->agreed,
            counts->disagreed);
    }
    return kExitOk;
}

}  // namespace

void add_map_info(VerbGroup verbs) {
    auto [verb, o] =
        verbs.add<MapInfoOptions>("info",
                                  "show the contents of a saved map and the run that made it",
                                  "surefoot map info out/modelled/floor.region --json",
                                  map_info,
                                  Reads::no_settings);
    verb.option("file", o.file, "saved map, written by 'surefoot run --save-map'")
        .required()
        .value("FILE");
}

void add_map_merge(VerbGroup verbs) {
    auto [verb, o] = verbs.add<MapMergeOptions>(
        "merge",
        "merge two saved maps of one run, or of two runs with the same odom frame, into one map",
        "surefoot map merge out/modelled/floor.region "
        "out/modelled/floor.region --out out/modelled/both.region",
        map_merge);
    verb.option("first", o.first, "first saved map, written by 'surefoot run --save-map'")
        .required()
        .value("A");
    verb.option("second", o.second, "second saved map; the order of the two maps does not matter")
        .required()
        .value("B");
    verb.option("--out", o.out_file, "file for the merged map").required().value("C");
    verb.option("--motion-sigma",
                o.motion_sigma,
                "standard deviation of the motion between the poses at which the two maps were "
                "saved: horizontal in m, vertical in m, angle in deg (default 0,0,0). The verb "
                "adds this uncertainty to the variances of the older map")
        .value("H,V,DEG");
    verb.flag("--independent",
              o.independent,
              "treat the maps as independent: they come from two runs, and you know that both runs "
              "have the same odom frame. The verb averages heights that agree");
}

}  // namespace surefoot::app

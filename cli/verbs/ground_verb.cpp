// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <vector>

#include "cli/json/map_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/numbers.hpp"
#include "service/console/option_settings.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/ground/ground_search.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"

namespace surefoot::app {
namespace {

struct GroundOptions {
    CommonOptions common;
    std::string cloud;
    std::string origin = "0,0,0";  ///< position of the sensor, in the axes of the cloud [m]
    std::string frame;             ///< axes of the cloud, optical or body; empty = detected
};

/// Searches the ground plane for a camera of unknown pitch. config.search_down_deg limits the
/// pitch. Points and result are in the camera's optical axes.
ground::GroundSighting searched(const ground::GroundConfig& config,
                                const std::vector<Eigen::Vector3d>& points_optical_m,
                                const Eigen::Vector3d& sensor_optical_m,
                                std::uint64_t seed) {
    const Pose T_body_optical = surefoot::T_body_optical();
    std::vector<Eigen::Vector3d> points_body_m;
    points_body_m.reserve(points_optical_m.size());
    for (const auto& p : points_optical_m)
        points_body_m.push_back(T_body_optical.rotation * (p - sensor_optical_m));
    ground::GroundSighting sighting = ground::search_ground(
        config, ground::with_nominal_noise(points_body_m, Eigen::Vector3d::Zero()), seed);
    GroundObservation& plane = sighting.observation;
    plane.normal = T_body_optical.rotation.conjugate() * plane.normal;
    return sighting;
}

/// Returns the error message: the reason why no ground was found, and the limits that the user can
/// change.
std::string failure(const GroundOptions& options,
                    const ground::GroundConfig& config,
                    const ground::GroundSighting& sighting,
                    bool optical) {
    if (optical)
        return fmt::format(
            "{}: no ground plane: {}. The search covers tilts of 0-{:g} deg; {:.0f} % of the "
            "points look like floor. Check that --origin ({}) is the position of the sensor, and "
            "that the cloud has optical axes (--frame). You can increase ground.search_down_deg, "
            "decrease ground.min_image_share = {:g} or increase ground.max_search_rms_m = {:g}",
            options.cloud,
            to_string(sighting.reason),
            config.search_down_deg,
            100.0 * sighting.image_share,
            options.origin,
            config.min_image_share,
            config.max_search_rms_m);
    return fmt::format(
        "{}: no ground plane: {}. Check that --origin ({}) is the position of the sensor, and that "
        "the cloud has body axes with z up (--frame). You can increase ground.max_tilt_deg = {:g}, "
        "ground.max_range_m = {:g} or ground.tolerance_m = {:g}",
        options.cloud,
        to_string(sighting.reason),
        options.origin,
        config.max_tilt_deg,
        config.max_range_m,
        config.tolerance_m);
}

/// `surefoot ground`: estimates the ground plane of a cloud.
int ground(const GroundOptions& options) {
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const auto origin = parse_three_numbers("--origin", options.origin, "x,y,z (m)");
    if (!origin) return report(origin.error());
    auto cloud = io::read_cloud(options.cloud);
    if (!cloud) return report(cloud.error());
    // Organised clouds come from a camera and have optical axes (y down). Other clouds have z up.
    const bool optical = options.frame.empty() ? cloud->organised() : options.frame == "optical";
    const Eigen::Vector3d sensor((*origin)[0], (*origin)[1], (*origin)[2]);
    const ground::GroundConfig& config = settings->pipeline.ground;
    // If the cloud has optical axes, the mounting of the camera is unknown, so the tilt is
    // searched.
    const auto sighting =
        optical
            ? searched(config, cloud->points_m, sensor, options.common.seed)
            : ground::sight_ground(
                  config, cloud->points_m, Eigen::Vector3d::UnitZ(), sensor, options.common.seed);
    if (options.common.json) {
        print_answer(ground_json(sighting));
    } else if (sighting.observation.accepted) {
        fmt::print(
            "ground plane: tilt {:.2f} deg, height {:.3f} m, {:.0f} % of the points are inliers, "
            "rms distance of the inliers {:.1f} mm\n",
            sighting.tilt_rad * 180.0 / M_PI,
            sighting.observation.height_m,
            100.0 * sighting.observation.inlier_ratio,
            1e3 * sighting.observation.rms_m);
    }
    if (!sighting.observation.accepted) {
        return report(input_error(failure(options, config, sighting, optical)));
    }
    return kExitOk;
}

}  // namespace

void add_ground(VerbGroup verbs) {
    auto [verb, o] = verbs.add<GroundOptions>(
        "ground",
        "estimate the ground plane of a point cloud: its tilt, its height and the share of inliers",
        "surefoot ground out/floor/map.ply --origin 0,0,0.95 --json",
        ground);
    verb.option("cloud", o.cloud, "point cloud: PCD, PLY or XYZ").required().value("CLOUD");
    verb.option("--origin",
                o.origin,
                "position of the sensor in the coordinates of the cloud, in m (default 0,0,0); the "
                "height of the ground is measured from the sensor")
        .value("X,Y,Z");
    verb.option("--frame",
                o.frame,
                "axes of the cloud: optical (z forward, y down) or body (z up). Default: optical "
                "for a cloud that is organised in image rows, otherwise body")
        .one_of({"optical", "body"});
}

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <vector>

#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/numbers.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/verbs.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/ground/ground_search.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"

namespace surefoot::app {
namespace {

/// Searches the ground plane for a camera of unknown pitch (config.search_down_deg gives the
/// range). Points and result are in the camera's optical axes.
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

/// Error message: why no ground was found, with the limits that the user can change.
std::string failure(const GroundOptions& options,
                    const ground::GroundConfig& config,
                    const ground::GroundSighting& sighting,
                    bool optical) {
    if (optical)
        return fmt::format(
            "{}: no ground plane: {}: tilt 0-{:g} deg is searched; {:.0f} % of the points look "
            "like floor; is --origin ({}) where the sensor was, and is the cloud in optical axes "
            "as taken (--frame)? ground.search_down_deg, ground.min_image_share = {:g} and "
            "ground.max_search_rms_m = {:g} can be set wider",
            options.cloud,
            to_string(sighting.reason),
            config.search_down_deg,
            100.0 * sighting.image_share,
            options.origin,
            config.min_image_share,
            config.max_search_rms_m);
    return fmt::format(
        "{}: no ground plane: {}; is --origin ({}) where the sensor was, and is the cloud in body "
        "axes as taken (--frame)? ground.max_tilt_deg = {:g}, ground.max_range_m = {:g} and "
        "ground.tolerance_m = {:g} can be set wider",
        options.cloud,
        to_string(sighting.reason),
        options.origin,
        config.max_tilt_deg,
        config.max_range_m,
        config.tolerance_m);
}

}  // namespace

int ground(const GroundOptions& options) {
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const auto origin = parse_three_numbers("--origin", options.origin, "x,y,z (m)");
    if (!origin) return report(origin.error());
    auto cloud = io::read_cloud(options.cloud);
    if (!cloud) return report(cloud.error());
    // Organised clouds come from a camera and have optical axes (y down). Others have z up.
    const bool optical = options.frame.empty() ? cloud->organised() : options.frame == "optical";
    const Eigen::Vector3d sensor((*origin)[0], (*origin)[1], (*origin)[2]);
    const ground::GroundConfig& config = settings->pipeline.ground;
    // With optical axes the mounting of the camera is unknown, so its tilt is searched.
    const auto sighting =
        optical
            ? searched(config, cloud->points_m, sensor, options.common.seed)
            : ground::sight_ground(
                  config, cloud->points_m, Eigen::Vector3d::UnitZ(), sensor, options.common.seed);
    if (options.common.json) {
        print_answer(ground_json(sighting));
    } else if (sighting.observation.accepted) {
        fmt::print("tilt {:.2f} deg, height {:.3f} m, {:.0f} % inliers, rms {:.1f} mm\n",
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

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/numbers.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/verbs.hpp"
#include "io/point_cloud.hpp"
#include "surefoot/ground/ground_observation.hpp"

namespace surefoot::app {

int ground(const GroundOptions& options) {
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const auto origin = parse_three_numbers("--origin", options.origin, "x,y,z (m)");
    if (!origin) return report(origin.error());
    auto cloud = io::read_cloud(options.cloud);
    if (!cloud) return report(cloud.error());
    // Organised clouds come straight from a camera: optical axes, y down. Others have z up.
    const bool optical = options.frame.empty() ? cloud->organised() : options.frame == "optical";
    const Eigen::Vector3d up =
        optical ? Eigen::Vector3d(0.0, -1.0, 0.0) : Eigen::Vector3d(0.0, 0.0, 1.0);
    // A camera may look far down: with optical axes the hint is only a direction to begin with.
    constexpr double kAnyMountTilt_deg = 60.0;
    ground::GroundConfig config = settings->pipeline.ground;
    if (optical) config.max_tilt_deg = std::max(config.max_tilt_deg, kAnyMountTilt_deg);

    const auto sighting =
        ground::sight_ground(config,
                             cloud->points_m,
                             up,
                             Eigen::Vector3d((*origin)[0], (*origin)[1], (*origin)[2]),
                             options.common.seed);
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
        return report(input_error(fmt::format(
            "{}: no ground plane: {}; is --origin ({}) where the sensor was, and is the cloud in "
            "{} axes as taken (--frame)? ground.max_tilt_deg = {:g}, ground.max_range_m = {:g} and "
            "ground.tolerance_m = {:g} can be set wider",
            options.cloud,
            to_string(sighting.reason),
            options.origin,
            optical ? "optical" : "body",
            config.max_tilt_deg,
            config.max_range_m,
            config.tolerance_m)));
    }
    return kExitOk;
}

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace surefoot::eval {

/// A stereo camera that points down at the floor.
struct DepthDesign {
    double baseline_m = 0.12;
    double focal_px = 342.0;
    int width = 672;
    int height = 376;
    double sigma_px = 0.1;  ///< one sigma of a disparity
    double camera_height_m = 1.0;
    double pitch_deg = 32.0;  ///< camera pitch below the horizon

    /// Describes the first impossible value; no value if the design is valid.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// Smallest vertical step ahead that is distinguishable from a flat floor.
///
/// Camera height H, range R, focal length f, baseline b, disparity sigma_d. A floor point at R is L
/// = sqrt(R^2 + H^2) away, phi = atan(H / R) below the horizon, at depth Z = L cos(phi - pitch).
/// Its sigma_Z is Z^2 sigma_d / (f b) (Matthies and Shafer, "Error modeling in stereo navigation",
/// 1987). One sigma moves the point by the share sigma_d Z / (f b) along the ray, and in height by
///   sigma_h = H Z sigma_d / (f b).
/// Noise limit: 3 sigma of the difference between two such heights, 3 sqrt(2) sigma_h, without
/// averaging. Pixel limit: the step must cover 3 rows of the image: 3 L / (f cos(phi)).
/// ASSUMPTION: rows near the axis; independent errors of neighbouring pixels. Averaging n pixels
/// would divide the noise limit by sqrt(n), but the smoothing of a matcher cancels this gain.
struct ResolvableHeight {
    double range_m = 0.0;
    bool in_view = false;  ///< the floor point lies between the lower and upper image border
    double depth_m = 0.0;
    double sigma_depth_m = 0.0;
    double noise_limit_m = 0.0;
    double pixel_limit_m = 0.0;
    double height_m = 0.0;  ///< the larger of the two limits
};
/// Precondition: `design` has no problem(), and the range is above 0.
[[nodiscard]] ResolvableHeight resolvable_height(const DepthDesign& design, double range_m);

/// Returns the distance of the nearest floor point in the image, straight ahead [m].
[[nodiscard]] double nearest_floor_m(const DepthDesign& design);

}  // namespace surefoot::eval

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/ground_observation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <vector>

#include "surefoot/geometry/plane_fit.hpp"
#include "surefoot/geometry/ransac_plane.hpp"
#include "surefoot/ground/cloud.hpp"
#include "surefoot/ground/near_side.hpp"
#include "surefoot/ground/refine_plane.hpp"
#include "surefoot/ground/thinning.hpp"

namespace surefoot::ground {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr int kMaxPlanes = 5;  // floor, ramp, table, seat, step; further planes are not the ground
constexpr int kMaxLevels = 3;  // largest number of levels in one plane: pavement, kerb stone, road
constexpr std::size_t kMinPoints = 20;
/// Levels up to this far apart are kerbs, treads, platforms; tables are higher. ASSUMPTION.
constexpr double kHighestStep_m = 0.35;

/// A plane that might be the ground. Points are relative to the sensor.
struct Candidate {
    geometry::Plane plane;        ///< normal up
    std::vector<NearSide> sides;  ///< the parts of the plane in use
    geometry::PlaneFit extent;    ///< fit to the points within the tolerance
    double inlier_ratio = 0.0;
    double area_m2 = 0.0;
    double begin_m = 0.0;   ///< horizontal distance to the nearest inliers
    double contrast = 0.0;  ///< points within the tolerance / points between one and two tolerances
    double height_m = 0.0;  ///< height of base_link above the plane
    GroundReason reason = GroundReason::accepted;
};

/// Narrows the inliers to the measured noise. Otherwise a ramp or a kerb that begins within the
/// search tolerance would tilt the plane.
geometry::Plane narrowed(const Points& points, const geometry::Plane& start, double tolerance_m) {
    constexpr double kSigmas = 3.0;
    constexpr double kSigmaPerMedian = 1.4826;  // sigma / median of a normal distribution
    constexpr double kFloor_m = 0.005;          // smallest band
    geometry::Plane plane = start;
    double band_m = tolerance_m;
    std::vector<double> residuals_m;
    std::vector<int> inliers;
    for (int round = 0; round < 3; ++round) {
        residuals_m.clear();
        for (const auto& p : points) {
            const double residual_m = std::abs(plane.signed_distance_m(p));
            if (residual_m <= band_m) residuals_m.push_back(residual_m);
        }
        if (residuals_m.empty()) break;
        const auto middle =
            residuals_m.begin() + static_cast<std::ptrdiff_t>(residuals_m.size() / 2);
        std::nth_element(residuals_m.begin(), middle, residuals_m.end());
        band_m = std::clamp(kSigmas * kSigmaPerMedian * *middle, kFloor_m, tolerance_m);
        inliers.clear();
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (std::abs(plane.signed_distance_m(points[i])) <= band_m) {
                inliers.push_back(static_cast<int>(i));
            }
        }
        const auto refit = geometry::fit_plane(points, inliers);
        if (!refit) break;
        plane = refit->plane.facing(start.normal);
    }
    return plane;
}

/// The plane with the most inliers. The noise of a point, if known, gives its tolerance. With
/// unknown noise, a search with the wide tolerance puts one plane across the floor and a following
/// ramp. A second search with a third of the tolerance, among the points near that plane, then
/// selects one of the two.
std::optional<geometry::Plane> search(const Cloud& cloud,
                                      geometry::RansacPlaneOptions options,
                                      Rng& rng) {
    options.tolerance_of_m = cloud.tolerance_m;
    const auto wide = geometry::ransac_plane(cloud.points, options, rng);
    if (!wide) return std::nullopt;
    if (cloud.knows_noise()) return wide->fit.plane;
    Points near;
    for (const auto& p : cloud.points) {
        if (std::abs(wide->fit.plane.signed_distance_m(p)) <= 2.0 * options.tolerance_m)
            near.push_back(p);
    }
    options.tolerance_m /= 3.0;
    const auto sharp = geometry::ransac_plane(near, options, rng);
    return sharp ? sharp->fit.plane : wide->fit.plane;
}

/// Horizontal distance from the sensor that the nearest 5 % of the points do not exceed.
double begin_of(const Points& inliers, const Eigen::Vector3d& up) {
    std::vector<double> distances_m;
    distances_m.reserve(inliers.size());
    for (const auto& p : inliers) distances_m.push_back((p - up.dot(p) * up).norm());
    const auto nth = distances_m.begin() + static_cast<std::ptrdiff_t>(distances_m.size() / 20);
    std::nth_element(distances_m.begin(), nth, distances_m.end());
    return *nth;
}

GroundReason judge(const GroundConfig& config, const Candidate& candidate) {
    if (candidate.inlier_ratio < config.min_inlier_ratio) return GroundReason::few_inliers;
    if (candidate.area_m2 < config.min_area_m2) return GroundReason::small;
    if (candidate.extent.narrow_sigma_m < config.min_extent_m) return GroundReason::small;
    // Gravel and clutter also have many points just beyond the tolerance of a plane. A surface has
    // few.
    constexpr double kMinContrast = 3.0;  // evenly spread points have at most 2
    if (candidate.extent.rms_m > config.max_rms_m) return GroundReason::rough;
    if (candidate.contrast < kMinContrast) return GroundReason::rough;
    return GroundReason::accepted;
}

/// Removes the points that are not on this side.
void keep(const NearSide& side, Cloud& cloud) {
    cloud.keep_if([&](std::size_t i) { return side.contains(cloud.points[i]); });
}

geometry::Plane refine(const Cloud& cloud, const geometry::Plane& start) {
    return refine_plane(cloud.points, cloud.inverse_range_sigma, start, cloud.band_m)
        .value_or(start);
}

/// Refines the plane with the points near it and their noise. If the plane crosses several levels,
/// keeps only the nearest level: adds its limits to `sides` and removes the other points.
geometry::Plane refined(const GroundConfig& config,
                        const geometry::Plane& found,
                        Cloud& cloud,
                        std::vector<NearSide>& sides) {
    if (!cloud.knows_noise()) return narrowed(cloud.points, found, config.tolerance_m);
    geometry::Plane plane = refine(cloud, found);
    for (int level = 1; level < kMaxLevels; ++level) {
        const auto side = near_side(cloud.points, cloud.inverse_range_sigma, plane, cloud.band_m);
        if (!side) break;
        sides.push_back(*side);
        keep(*side, cloud);
        plane = refine(cloud, side->plane);
    }
    return plane;
}

Candidate measured(const GroundConfig& config,
                   Cloud cloud,
                   std::size_t all_points,
                   const geometry::Plane& found,
                   const Eigen::Vector3d& up) {
    Candidate candidate;
    candidate.plane = refined(config, found, cloud, candidate.sides);
    const Points& points = cloud.points;
    Points inliers;
    int fringe = 0;
    for (const auto& p : points) {
        const double distance_m = std::abs(candidate.plane.signed_distance_m(p));
        if (distance_m <= cloud.band_m) {
            inliers.push_back(p);
        } else if (distance_m <= 2.0 * cloud.band_m) {
            ++fringe;
        }
    }
    candidate.contrast = static_cast<double>(inliers.size()) / std::max(fringe, 1);
    candidate.inlier_ratio = static_cast<double>(inliers.size()) / static_cast<double>(all_points);
    candidate.area_m2 = covered_area_m2(inliers, candidate.plane.normal, 2.0 * config.voxel_m);
    candidate.begin_m = inliers.empty() ? 0.0 : begin_of(inliers, up);
    candidate.extent = geometry::fit_plane(inliers).value_or(geometry::PlaneFit{});
    candidate.height_m = candidate.plane.signed_distance_m(cloud.base);
    candidate.reason = judge(config, candidate);
    return candidate;
}

/// True if `a` is the better ground of two accepted planes.
bool is_more_ground(const GroundConfig& config, const Candidate& a, const Candidate& b) {
    if (config.expected_height_m > 0.0) {
        const double a_off_m = std::abs(a.height_m - config.expected_height_m);
        const double b_off_m = std::abs(b.height_m - config.expected_height_m);
        // If both planes fit the expected height about equally well (for example floor and a ramp
        // that begins at the feet), the rules below decide.
        if (std::abs(a_off_m - b_off_m) > config.max_disagreement_m) return a_off_m < b_off_m;
    }
    const double a_at_b = -a.plane.signed_distance_m(b.extent.centroid_m);  // a above b's points
    const double b_at_a = -b.plane.signed_distance_m(a.extent.centroid_m);
    const bool a_below = a_at_b < 0.0 && b_at_a > 0.0;  // a is below b wherever there are points
    const bool b_below = a_at_b > 0.0 && b_at_a < 0.0;
    // If one plane lies farther below the other than any step, the lower one is the ground.
    // Otherwise the machine stands on the plane that begins nearer, even if it is the upper one.
    if ((a_below || b_below) && std::abs(a.height_m - b.height_m) > kHighestStep_m) return a_below;
    return a.begin_m < b.begin_m;
}

/// An accepted plane wins over a rejected plane. Of two rejected planes the first (larger) stays.
bool is_better(const GroundConfig& config, const Candidate& a, const Candidate& b) {
    if (a.reason != GroundReason::accepted) return false;
    return b.reason != GroundReason::accepted || is_more_ground(config, a, b);
}

/// Removes the points on a plane; twice the tolerance also removes the noisy points around it.
void erase_near(const geometry::Plane& plane, double tolerance_m, Cloud& cloud) {
    cloud.keep_if([&](std::size_t i) {
        const double own_m = cloud.knows_noise() ? cloud.tolerance_m[i] : tolerance_m;
        return !(std::abs(plane.signed_distance_m(cloud.points[i])) <= 2.0 * own_m);
    });
}

/// Finds planes one after the other, largest first, each without the points of the earlier planes.
std::optional<Candidate> best_plane(const GroundConfig& config,
                                    const Cloud& cloud,
                                    const Eigen::Vector3d& up,
                                    Rng& rng) {
    geometry::RansacPlaneOptions options;
    options.tolerance_m = config.tolerance_m;
    options.cone = geometry::NormalCone{up, config.max_tilt_deg * std::numbers::pi / 180.0};
    std::optional<Candidate> best;
    Cloud rest = cloud;
    // A plane with fewer points would not be accepted.
    const auto least = std::max(kMinPoints,
                                // in range: GroundConfig::describe() keeps the ratio in [0, 1]
                                static_cast<std::size_t>(config.min_inlier_ratio *
                                                         static_cast<double>(rest.points.size())));
    for (int plane = 0; plane < kMaxPlanes && rest.points.size() >= least; ++plane) {
        options.least_inlier_ratio = config.min_inlier_ratio *
                                     static_cast<double>(cloud.points.size()) /
                                     static_cast<double>(rest.points.size());
        const auto found = search(rest, options, rng);
        if (!found) break;
        // With known noise, the points of earlier planes (removed from `rest`) do not count against
        // this plane.
        const Candidate candidate =
            measured(config, cloud.knows_noise() ? rest : cloud, cloud.points.size(), *found, up);
        const bool height_fits = candidate.plane.offset_m >= config.min_height_m &&
                                 candidate.plane.offset_m <= config.max_height_m;
        if (height_fits && (!best || is_better(config, candidate, *best))) best = candidate;
        erase_near(*found, config.tolerance_m, rest);
    }
    return best;
}

/// Implements `sight_ground` and `observe_ground`; empty sigmas mean unknown noise.
GroundSighting sight(const GroundConfig& config,
                     const FramePoints& seen,
                     const Eigen::Vector3d& base,
                     const Eigen::Vector3d& up_hint,
                     std::uint64_t seed) {
    const std::vector<Eigen::Vector3d>& points = seen.points_body_m;
    const std::vector<double>& inverse_range_sigma = seen.inverse_range_sigma;
    const Eigen::Vector3d& sensor = seen.camera_body_m;
    GroundSighting sighting;
    const double hint_length = up_hint.norm();
    if (!(hint_length > 0.0) || !std::isfinite(hint_length)) {
        sighting.reason = GroundReason::no_hint;
        return sighting;
    }
    const Eigen::Vector3d up = up_hint / hint_length;
    const auto chosen = thin(points,
                             sensor,
                             config.max_range_m,
                             config.voxel_m,
                             static_cast<std::size_t>(config.max_points));
    if (chosen.size() < kMinPoints) return sighting;
    Cloud cloud = cloud_of(points, inverse_range_sigma, sensor, chosen);
    cloud.base = base - sensor;
    cloud.band_m = config.tolerance_m;
    if (cloud.knows_noise()) judge_noise(config, up, cloud);

    Rng rng(seed);
    auto best = best_plane(config, cloud, up, rng);
    if (!best) {
        sighting.reason = GroundReason::no_plane;
        return sighting;
    }
    if (cloud.knows_noise()) {
        // Uses all points, not one per cube, because their noise averages out.
        std::vector<std::size_t> all(points.size());
        std::iota(all.begin(), all.end(), std::size_t{0});
        Cloud whole = cloud_of(points, inverse_range_sigma, sensor, all);
        whole.band_m = cloud.band_m;
        for (const NearSide& side : best->sides) keep(side, whole);
        best->plane = refine(whole, best->plane);
        best->height_m = best->plane.signed_distance_m(cloud.base);
        sighting.uncertainty = plane_uncertainty(
            best->plane,
            covariance_of_m(whole.points, whole.inverse_range_sigma, best->plane, whole.band_m) +
                seen.calibration_covariance,
            cloud.base);
    }
    const Eigen::Vector3d& normal = best->plane.normal;
    sighting.reason = best->reason;
    sighting.tilt_rad = std::atan2(normal.cross(up).norm(), normal.dot(up));
    sighting.area_m2 = best->area_m2;
    sighting.observation = {best->reason == GroundReason::accepted,
                            normal,
                            best->height_m,
                            best->inlier_ratio,
                            best->extent.rms_m};
    return sighting;
}

}  // namespace

const char* to_string(GroundReason reason) noexcept {
    switch (reason) {
        case GroundReason::accepted: return "accepted";
        case GroundReason::no_hint: return "no_hint";
        case GroundReason::few_points: return "few_points";
        case GroundReason::no_plane: return "no_plane";
        case GroundReason::few_inliers: return "few_inliers";
        case GroundReason::small: return "small";
        case GroundReason::not_lowest: return "not_lowest";
        case GroundReason::rough: return "rough";
    }
    return "unknown";
}

GroundSighting sight_ground(const GroundConfig& config,
                            std::span<const Eigen::Vector3d> points,
                            const Eigen::Vector3d& up_hint,
                            const Eigen::Vector3d& sensor_origin,
                            std::uint64_t seed) {
    FramePoints seen;
    seen.camera_body_m = sensor_origin;
    seen.points_body_m.assign(points.begin(), points.end());
    return sight(config, seen, sensor_origin, up_hint, seed);
}

GroundSighting observe_ground(const GroundConfig& config,
                              const FramePoints& seen,
                              const Eigen::Vector3d& up_hint_body,
                              std::uint64_t seed) {
    return sight(config, seen, Eigen::Vector3d::Zero(), up_hint_body, seed);
}

}  // namespace surefoot::ground

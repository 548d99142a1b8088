// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/ground_observation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "surefoot/geometry/plane_fit.hpp"
#include "surefoot/geometry/ransac_plane.hpp"
#include "surefoot/ground/thinning.hpp"

namespace surefoot::ground {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr int kMaxPlanes = 5;  // floor, ramp, table, seat, step: more are not the ground
constexpr std::size_t kMinPoints = 20;

/// A plane that might be the ground. Points are relative to the sensor.
struct Candidate {
    geometry::PlaneFit fit;  ///< normal up
    double inlier_ratio = 0.0;
    double area_m2 = 0.0;
    double begin_m = 0.0;   ///< horizontal distance of the nearest inliers
    double contrast = 0.0;  ///< points within the tolerance per point within it and twice it
    GroundReason reason = GroundReason::accepted;

    [[nodiscard]] double height_m() const { return fit.plane.offset_m; }
};

/// Narrows the inliers to the measured noise: a ramp or a kerb that begins within the search
/// tolerance would tilt the plane otherwise.
geometry::PlaneFit narrowed(const Points& points,
                            const geometry::PlaneFit& start,
                            double tolerance_m) {
    constexpr double kSigmas = 3.0;
    constexpr double kSigmaPerMedian = 1.4826;  // of a normal distribution
    constexpr double kFloor_m = 0.005;          // numerical floor of the band
    geometry::PlaneFit fit = start;
    double band_m = tolerance_m;
    std::vector<double> residuals_m;
    std::vector<int> inliers;
    for (int round = 0; round < 3; ++round) {
        residuals_m.clear();
        for (const auto& p : points) {
            const double residual_m = std::abs(fit.plane.signed_distance_m(p));
            if (residual_m <= band_m) residuals_m.push_back(residual_m);
        }
        if (residuals_m.empty()) break;
        const auto middle =
            residuals_m.begin() + static_cast<std::ptrdiff_t>(residuals_m.size() / 2);
        std::nth_element(residuals_m.begin(), middle, residuals_m.end());
        band_m = std::clamp(kSigmas * kSigmaPerMedian * *middle, kFloor_m, tolerance_m);
        inliers.clear();
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (std::abs(fit.plane.signed_distance_m(points[i])) <= band_m) {
                inliers.push_back(static_cast<int>(i));
            }
        }
        const auto refit = geometry::fit_plane(points, inliers);
        if (!refit) break;
        fit = *refit;
        fit.plane = fit.plane.facing(start.plane.normal);
    }
    return fit;
}

/// The plane in `points` with the most inliers. A search with the wide tolerance lays one plane
/// across the floor and the ramp that follows it; a second one with a third of it, among the points
/// near that plane, settles on one of the two.
std::optional<geometry::PlaneFit> search(const Points& points,
                                         geometry::RansacPlaneOptions options,
                                         Rng& rng) {
    const auto wide = geometry::ransac_plane(points, options, rng);
    if (!wide) return std::nullopt;
    Points near;
    for (const auto& p : points) {
        if (std::abs(wide->fit.plane.signed_distance_m(p)) <= 2.0 * options.tolerance_m)
            near.push_back(p);
    }
    options.tolerance_m /= 3.0;
    const auto sharp = geometry::ransac_plane(near, options, rng);
    return sharp ? sharp->fit : wide->fit;
}

/// Horizontal distance from the sensor within which the nearest twentieth of the points lies.
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
    if (candidate.fit.narrow_sigma_m < config.min_extent_m) return GroundReason::small;
    // A slab cut out of gravel or clutter goes on beyond its tolerance; a surface ends.
    constexpr double kMinContrast = 3.0;  // an even slab has at most 2
    if (candidate.fit.rms_m > config.max_rms_m) return GroundReason::rough;
    if (candidate.contrast < kMinContrast) return GroundReason::rough;
    return GroundReason::accepted;
}

Candidate measured(const GroundConfig& config,
                   const Points& points,
                   const geometry::PlaneFit& found,
                   const Eigen::Vector3d& up) {
    Candidate candidate;
    candidate.fit = narrowed(points, found, config.tolerance_m);
    Points inliers;
    int fringe = 0;
    for (const auto& p : points) {
        const double distance_m = std::abs(candidate.fit.plane.signed_distance_m(p));
        if (distance_m <= config.tolerance_m) {
            inliers.push_back(p);
        } else if (distance_m <= 2.0 * config.tolerance_m) {
            ++fringe;
        }
    }
    candidate.contrast = static_cast<double>(inliers.size()) / std::max(fringe, 1);
    candidate.inlier_ratio =
        static_cast<double>(inliers.size()) / static_cast<double>(points.size());
    candidate.area_m2 = covered_area_m2(inliers, candidate.fit.plane.normal, 2.0 * config.voxel_m);
    candidate.begin_m = inliers.empty() ? 0.0 : begin_of(inliers, up);
    candidate.reason = judge(config, candidate);
    return candidate;
}

/// Whether `a` is the better ground of two accepted planes.
bool is_more_ground(const GroundConfig& config, const Candidate& a, const Candidate& b) {
    if (config.expected_height_m > 0.0) {
        const double a_off_m = std::abs(a.height_m() - config.expected_height_m);
        const double b_off_m = std::abs(b.height_m() - config.expected_height_m);
        // Planes that fit about equally well (a ramp that begins at the feet) differ by the rules
        // below.
        if (std::abs(a_off_m - b_off_m) > config.max_disagreement_m) return a_off_m < b_off_m;
    }
    const double a_at_b =
        -a.fit.plane.signed_distance_m(b.fit.centroid_m);  // of plane a above b's points
    const double b_at_a = -b.fit.plane.signed_distance_m(a.fit.centroid_m);
    if (a_at_b < 0.0 && b_at_a > 0.0) return true;  // a passes below b wherever points are
    if (a_at_b > 0.0 && b_at_a < 0.0) return false;
    return a.begin_m < b.begin_m;
}

/// An accepted plane wins over a rejected one; of two rejected ones the first (largest) stays.
bool is_better(const GroundConfig& config, const Candidate& a, const Candidate& b) {
    if (a.reason != GroundReason::accepted) return false;
    return b.reason != GroundReason::accepted || is_more_ground(config, a, b);
}

/// One plane after the other, largest first, each without the points of those before it.
std::optional<Candidate> best_plane(const GroundConfig& config,
                                    const Points& points,
                                    const Eigen::Vector3d& up,
                                    Rng& rng) {
    geometry::RansacPlaneOptions options;
    options.tolerance_m = config.tolerance_m;
    options.cone = geometry::NormalCone{up, config.max_tilt_deg * std::numbers::pi / 180.0};
    std::optional<Candidate> best;
    Points rest = points;
    for (int plane = 0; plane < kMaxPlanes && rest.size() >= kMinPoints; ++plane) {
        const auto found = search(rest, options, rng);
        if (!found) break;
        const Candidate candidate = measured(config, points, *found, up);
        const bool height_fits = candidate.height_m() >= config.min_height_m &&
                                 candidate.height_m() <= config.max_height_m;
        if (height_fits && (!best || is_better(config, candidate, *best))) best = candidate;
        // Twice the tolerance takes the noisy fringe of this plane away too.
        std::erase_if(rest, [&](const Eigen::Vector3d& p) {
            return std::abs(found->plane.signed_distance_m(p)) <= 2.0 * config.tolerance_m;
        });
    }
    return best;
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
        case GroundReason::rough: return "rough";
    }
    return "unknown";
}

GroundSighting sight_ground(const GroundConfig& config,
                            std::span<const Eigen::Vector3d> points,
                            const Eigen::Vector3d& up_hint,
                            const Eigen::Vector3d& sensor_origin,
                            std::uint64_t seed) {
    GroundSighting sighting;
    const double hint_length = up_hint.norm();
    if (!(hint_length > 0.0) || !std::isfinite(hint_length)) {
        sighting.reason = GroundReason::no_hint;
        return sighting;
    }
    const Eigen::Vector3d up = up_hint / hint_length;
    const Points thinned = thin(points,
                                sensor_origin,
                                config.max_range_m,
                                config.voxel_m,
                                static_cast<std::size_t>(config.max_points));
    if (thinned.size() < kMinPoints) return sighting;

    Rng rng(seed);
    const auto best = best_plane(config, thinned, up, rng);
    if (!best) {
        sighting.reason = GroundReason::no_plane;
        return sighting;
    }
    const Eigen::Vector3d& normal = best->fit.plane.normal;
    sighting.reason = best->reason;
    sighting.tilt_rad = std::atan2(normal.cross(up).norm(), normal.dot(up));
    sighting.area_m2 = best->area_m2;
    sighting.observation = {best->reason == GroundReason::accepted,
                            normal,
                            best->height_m(),
                            best->inlier_ratio,
                            best->fit.rms_m};
    return sighting;
}

GroundObservation observe_ground(const GroundConfig& config,
                                 std::span<const Eigen::Vector3d> points_body,
                                 const Eigen::Vector3d& up_hint_body,
                                 std::uint64_t seed) {
    return sight_ground(config, points_body, up_hint_body, Eigen::Vector3d::Zero(), seed)
        .observation;
}

}  // namespace surefoot::ground

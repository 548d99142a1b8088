// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/ground_search.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/ground/cloud.hpp"
#include "surefoot/ground/near_side.hpp"
#include "surefoot/ground/refine_plane.hpp"
#include "surefoot/ground/thinning.hpp"

namespace surefoot::ground {
namespace {

using geometry::Plane;

constexpr int kMaxPlanes = 10;
constexpr int kMaxLevels = 3;  ///< a plane may cross this many levels, see near_side.hpp
constexpr int kDraws = 500;
constexpr std::size_t kLeastPoints = 40;
/// Smallest factor of all sizes. Sizes are for a camera one metre above the ground. They shrink if
/// the scene is nearer and never grow.
constexpr double kLeastScale = 0.3;
/// Ground that lies more than this below a plane is not a step, but the floor under a table.
/// ASSUMPTION.
constexpr double kHighestStep_m = 0.35;
/// A plane with a smaller share of the image is probably a shelf or a box. ASSUMPTION.
constexpr double kSmallShare = 0.15;
constexpr double kHighestStepOfFew_m = 0.15;

/// The points of a frame, relative to the sensor.
struct View {
    std::vector<Eigen::Vector3d> points;
    std::vector<double> inverse_range_sigma;
    double scale = 1.0;  ///< factor of all sizes
};

/// Points from which candidate planes are drawn, cube by cube.
struct Drawable {
    View view;
    /// For each point: first index and end index of the points in its cube.
    std::vector<std::pair<std::size_t, std::size_t>> cube_of;
};

/// A plane that might be the ground.
struct Candidate {
    Plane plane;
    double band_m = 0.0;
    GroundReason reason = GroundReason::no_plane;
    std::vector<NearSide> sides;
    double image_share = 0.0;
    double inlier_ratio = 0.0;
    double rms_m = 0.0;
    double area_m2 = 0.0;
    double support = 0.0;  ///< log-likelihood (support_of); selects the band of a plane
    Eigen::Matrix3d covariance_of_m = Eigen::Matrix3d::Zero();
    double tilt_sigma_rad = 0.0;

    [[nodiscard]] bool holds(const Eigen::Vector3d& p) const {
        return std::all_of(
            sides.begin(), sides.end(), [&](const NearSide& side) { return side.contains(p); });
    }
};

/// The data of a search.
struct Scene {
    const View& all;
    std::size_t pixels;
    Eigen::Matrix3d calibration_covariance;
};

View select(const View& all, std::span<const std::size_t> chosen) {
    View view;
    view.scale = all.scale;
    view.points.reserve(chosen.size());
    view.inverse_range_sigma.reserve(chosen.size());
    for (const std::size_t i : chosen) {
        view.points.push_back(all.points[i]);
        view.inverse_range_sigma.push_back(all.inverse_range_sigma[i]);
    }
    return view;
}

View view_of(const GroundConfig& config, const FramePoints& seen) {
    View view;
    std::vector<double> ranges_m;
    for (std::size_t i = 0; i < seen.points_body_m.size(); ++i) {
        const Eigen::Vector3d p = seen.points_body_m[i] - seen.camera_body_m;
        const double range_m = p.norm();
        if (!(range_m > 0.0 && range_m <= config.max_range_m)) continue;  // NaN too
        view.points.push_back(p);
        view.inverse_range_sigma.push_back(seen.inverse_range_sigma[i]);
        ranges_m.push_back(range_m);
    }
    if (ranges_m.empty()) return view;
    const auto near =
        ranges_m.begin() + static_cast<std::ptrdiff_t>(ranges_m.size() / 5);  // in range: a size
    std::nth_element(ranges_m.begin(), near, ranges_m.end());
    view.scale = std::clamp(*near, kLeastScale, 1.0);
    return view;
}

/// Returns the distance from the plane (one sigma, along the normal) that the noise of a point on
/// the plane causes.
double noise_of(const View& view, std::size_t i, const Plane& plane) {
    return plane.offset_m * view.points[i].norm() * view.inverse_range_sigma[i];
}

bool is_possible(const GroundConfig& config, const Plane& plane) {
    const Eigen::Vector3d& n = plane.normal;
    const double pitch_rad = std::atan2(-n.x(), n.z());
    return plane.offset_m >= config.min_height_m && plane.offset_m <= config.max_height_m &&
           pitch_rad >= -config.search_up_deg * kRadPerDeg &&
           pitch_rad <= config.search_down_deg * kRadPerDeg &&
           std::abs(n.y()) <= std::sin(config.search_roll_deg * kRadPerDeg);
}

/// Returns at most one point per voxel, sorted by the cubes from which candidate planes are drawn.
Drawable drawable(const GroundConfig& config, const View& view) {
    const auto thinned = thin(view.points,
                              Eigen::Vector3d::Zero(),
                              config.max_range_m,
                              0.5 * config.voxel_m * view.scale,
                              static_cast<std::size_t>(config.max_points));
    const double cube_m = 0.5 * view.scale;
    const auto key_of = [&](std::size_t i) {
        std::array<std::int64_t, 3> key{};
        for (int k = 0; k < 3; ++k)
            key[static_cast<std::size_t>(k)] =
                saturated_integer<std::int64_t>(std::floor(view.points[i][k] / cube_m));
        return key;
    };
    std::vector<std::pair<std::array<std::int64_t, 3>, std::size_t>> keyed;
    keyed.reserve(thinned.size());
    for (const std::size_t i : thinned) keyed.emplace_back(key_of(i), i);
    std::sort(keyed.begin(), keyed.end());
    std::vector<std::size_t> order;
    order.reserve(keyed.size());
    for (const auto& entry : keyed) order.push_back(entry.second);
    Drawable result{select(view, order), {}};
    result.cube_of.resize(keyed.size());
    for (std::size_t first = 0; first < keyed.size();) {
        std::size_t last = first;
        while (last < keyed.size() && keyed[last].first == keyed[first].first) ++last;
        for (std::size_t i = first; i < last; ++i) result.cube_of[i] = {first, last};
        first = last;
    }
    return result;
}

std::optional<Plane> draw(const Drawable& from, Rng& rng) {
    const auto& points = from.view.points;
    const std::size_t a = rng.below(points.size());
    const auto [first, last] = from.cube_of[a];
    const Eigen::Vector3d& pa = points[a];
    const Eigen::Vector3d ab = points[first + rng.below(last - first)] - pa;
    const Eigen::Vector3d ac = points[first + rng.below(last - first)] - pa;
    const Eigen::Vector3d normal = ab.cross(ac);
    constexpr double kLeastSine = 0.1;  // flatter triangles do not determine the plane
    if (!(normal.norm() > kLeastSine * ab.norm() * ac.norm())) return std::nullopt;
    const Eigen::Vector3d unit = normal.normalized();
    const double offset_m = -unit.dot(pa);
    // Orients the plane so that the sensor is above it.
    return offset_m < 0.0 ? Plane{-unit, -offset_m} : Plane{unit, offset_m};
}

/// Returns the plane with the most points near it (MSAC, Torr and Zisserman 2000); `used` points do
/// not count.
std::optional<Plane> most_supported(const GroundConfig& config,
                                    const Drawable& from,
                                    const std::vector<char>& used,
                                    Rng& rng) {
    const View& view = from.view;
    std::optional<Plane> best;
    double most = 0.0;
    for (int i = 0; i < kDraws; ++i) {
        const auto plane = draw(from, rng);
        if (!plane || plane->offset_m < config.min_height_m) continue;
        double sum = 0.0;
        for (std::size_t k = 0; k < view.points.size(); ++k) {
            if (used[k] != 0) continue;
            const double off_m = plane->signed_distance_m(view.points[k]);
            const double within_m = std::clamp(3.0 * noise_of(view, k, *plane),
                                               0.4 * config.tolerance_m * view.scale,
                                               config.tolerance_m);
            const double share = off_m / within_m;
            sum += std::max(1.0 - share * share, 0.0);
        }
        if (sum <= most) continue;
        most = sum;
        best = plane;
    }
    return best;
}

/// Distribution of the points of a view about a plane.
struct Census {
    std::vector<Eigen::Vector3d> inliers;
    std::size_t fringe = 0;  ///< number of points between one and two bands
    double square_sum_m2 = 0.0;
    double noise_sum_m2 = 0.0;  ///< sum that the noise of the points alone would give
};

Census census_of(const View& view, const Candidate& candidate) {
    Census census;
    for (std::size_t i = 0; i < view.points.size(); ++i) {
        if (!candidate.holds(view.points[i])) continue;
        // A point noisier than the band cannot be classified.
        if (noise_of(view, i, candidate.plane) > kNoisiest * candidate.band_m) continue;
        const double off_m = candidate.plane.signed_distance_m(view.points[i]);
        if (std::abs(off_m) <= candidate.band_m) {
            census.inliers.push_back(view.points[i]);
            census.square_sum_m2 += off_m * off_m;
            const double own_m = noise_of(view, i, candidate.plane);
            census.noise_sum_m2 += own_m * own_m;
        } else if (std::abs(off_m) <= 2.0 * candidate.band_m) {
            ++census.fringe;
        }
    }
    return census;
}

/// Returns the scatter of the ground itself about the plane, without the noise of the points.
double roughness_m(const Census& census) {
    const auto count = static_cast<double>(std::max<std::size_t>(census.inliers.size(), 1));
    return std::sqrt(std::max(census.square_sum_m2 - census.noise_sum_m2, 0.0) / count);
}

/// Returns true if a measured point lies more than `step_m` below a plane. Returns false if noise
/// (5 sigma of the inverse range) can explain that the point lies behind the plane.
bool is_below(const View& all, std::size_t i, const Plane& plane, double step_m) {
    if (-plane.signed_distance_m(all.points[i]) <= step_m) return false;
    // First order in the inverse range, as `Sighting::off_m`: a far point that only noise puts
    // behind the plane does not count as below it.
    const Sighting seen = sighting_of(beam_to(all.points[i]), all.inverse_range_sigma[i], plane);
    constexpr double kSure = 5.0;
    return !(seen.expected_inverse_range > 0.0) ||
           seen.expected_inverse_range - seen.inverse_range > kSure * all.inverse_range_sigma[i];
}

/// Returns the number of points that lie more than a step below a plane and form a surface. Points
/// form a surface if at least every fourth point of their tile lies below. Wrong matches also lie
/// below the plane, but singly.
std::size_t count_below(const View& all, const Candidate& candidate) {
    constexpr double kTile_rad = 0.1;
    constexpr std::size_t kSurface = 4;
    const double step_m =
        candidate.image_share < kSmallShare ? kHighestStepOfFew_m : kHighestStep_m;
    struct Counts {
        std::size_t all = 0;
        std::size_t below = 0;
    };
    std::map<std::array<std::int64_t, 3>, Counts> tiles;
    for (std::size_t i = 0; i < all.points.size(); ++i) {
        const Eigen::Vector3d ray = beam_to(all.points[i]).ray / kTile_rad;
        Counts& tile = tiles[{saturated_integer<std::int64_t>(std::floor(ray.x())),
                              saturated_integer<std::int64_t>(std::floor(ray.y())),
                              saturated_integer<std::int64_t>(std::floor(ray.z()))}];
        ++tile.all;
        if (is_below(all, i, candidate.plane, step_m)) ++tile.below;
    }
    std::size_t below = 0;
    for (const auto& [key, tile] : tiles)
        if (kSurface * tile.below >= tile.all) below += tile.below;
    return below;
}

GroundReason judge(const GroundConfig& config,
                   const View& all,
                   const Census& census,
                   const Candidate& candidate) {
    constexpr double kMinContrast = 3.0;  // evenly spread points have at most 2
    constexpr double kMostBelow = 0.03;   // points below / inliers; wrong matches lie anywhere
    if (census.inliers.size() < kLeastPoints || candidate.image_share < config.min_image_share)
        return GroundReason::few_inliers;
    const double contrast = static_cast<double>(census.inliers.size()) /
                            static_cast<double>(std::max<std::size_t>(census.fringe, 1));
    if (contrast < kMinContrast || roughness_m(census) > config.max_search_rms_m)
        return GroundReason::rough;
    if (static_cast<double>(count_below(all, candidate)) >
        kMostBelow * static_cast<double>(census.inliers.size()))
        return GroundReason::not_lowest;
    if (candidate.tilt_sigma_rad > config.max_search_sigma_deg * kRadPerDeg)
        return GroundReason::small;
    return GroundReason::accepted;
}

/// Mean squared distance of the points to which a plane was fitted.
double scatter_m2(const View& view, const Plane& plane, double band_m) {
    double sum_m2 = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < view.points.size(); ++i) {
        const Sighting seen =
            sighting_of(beam_to(view.points[i]), view.inverse_range_sigma[i], plane);
        if (!seen.is_within(band_m)) continue;
        sum_m2 += seen.off_m * seen.off_m;
        count += 1.0;
    }
    return count > 0.0 ? sum_m2 / count : 0.0;
}

/// Returns the log-likelihood of a plane with this roughness, relative to points at random
/// positions. A band that excludes half of a mulch floor gains less than a band that includes the
/// floor. A band that also includes the foot of a wall gains hardly more than one without.
double support_of(const View& view, const Candidate& candidate, double roughness_m) {
    constexpr double kAnywhere_m = 2.0;  // range over which the random points lie
    constexpr double kLeastRoughness_m = 0.001;
    double sum = 0.0;
    for (std::size_t i = 0; i < view.points.size(); ++i) {
        if (!candidate.holds(view.points[i])) continue;
        const double sigma_m = std::hypot(noise_of(view, i, candidate.plane),
                                          std::max(roughness_m, kLeastRoughness_m));
        const double off = candidate.plane.signed_distance_m(view.points[i]) / sigma_m;
        const double gain =
            std::log(kAnywhere_m * view.scale / (std::sqrt(2.0 * std::numbers::pi) * sigma_m));
        sum += std::max(0.0, gain - 0.5 * off * off);
    }
    return sum;
}

/// Fits the plane within a band and computes the evidence for it.
std::optional<Candidate> within_band(const GroundConfig& config,
                                     const Scene& scene,
                                     const View& rest,
                                     const Plane& start,
                                     double band_m) {
    Candidate candidate;
    candidate.band_m = band_m;
    View view = rest;
    const auto refine = [&](const Plane& from) {
        return refine_plane(view.points, view.inverse_range_sigma, from, band_m);
    };
    auto plane = refine(start);
    for (int level = 1; plane && level < kMaxLevels; ++level) {
        const auto side = near_side(view.points, view.inverse_range_sigma, *plane, band_m);
        if (!side) break;
        std::vector<std::size_t> kept;
        for (std::size_t i = 0; i < view.points.size(); ++i)
            if (side->contains(view.points[i])) kept.push_back(i);
        const View near = select(view, kept);
        const auto nearer =
            refine_plane(near.points, near.inverse_range_sigma, side->plane, band_m);
        // Rough ground without a step is equally rough in the near part and as a whole.
        constexpr double kMostOfScatter = 0.6;
        if (!nearer ||
            scatter_m2(near, *nearer, band_m) > kMostOfScatter * scatter_m2(view, *plane, band_m))
            break;
        candidate.sides.push_back(*side);
        view = near;
        plane = nearer;
    }
    if (!plane || !is_possible(config, *plane)) return std::nullopt;
    candidate.plane = *plane;
    const Census census = census_of(rest, candidate);
    const auto count = static_cast<double>(census.inliers.size());
    candidate.image_share = count / static_cast<double>(std::max<std::size_t>(scene.pixels, 1));
    candidate.inlier_ratio = count / static_cast<double>(scene.all.points.size());
    candidate.rms_m = std::sqrt(census.square_sum_m2 / std::max(count, 1.0));
    candidate.area_m2 =
        covered_area_m2(census.inliers, plane->normal, 2.0 * config.voxel_m * rest.scale);
    candidate.covariance_of_m =
        covariance_of_m(view.points, view.inverse_range_sigma, *plane, band_m) +
        scene.calibration_covariance;
    candidate.tilt_sigma_rad =
        plane_uncertainty(*plane, candidate.covariance_of_m, Eigen::Vector3d::Zero())
            .tilt_sigma_rad();
    candidate.support = support_of(rest, candidate, roughness_m(census));
    candidate.reason = judge(config, scene.all, census, candidate);
    return candidate;
}

/// Returns the noise that 10 % of the points on a plane do not exceed.
double least_noise_m(const View& view, const Plane& plane) {
    std::vector<double> noise_m;
    for (std::size_t i = 0; i < view.points.size(); ++i) {
        const double own_m = noise_of(view, i, plane);
        if (std::abs(plane.signed_distance_m(view.points[i])) <= 3.0 * own_m)
            noise_m.push_back(own_m);
    }
    if (noise_m.empty()) return 0.0;
    const auto tenth =
        noise_m.begin() + static_cast<std::ptrdiff_t>(noise_m.size() / 10);  // in range: a size
    std::nth_element(noise_m.begin(), tenth, noise_m.end());
    return *tenth;
}

/// Chooses the band with the largest support. Mulch and boulders need a wider band than parquet. A
/// strip of floor before a wall needs a band without the foot of the wall.
std::optional<Candidate> measured(const GroundConfig& config,
                                  const Scene& scene,
                                  const View& rest,
                                  const Plane& found) {
    const double widest_m = 2.0 * config.tolerance_m * rest.scale;
    double band_m = std::clamp(4.0 * least_noise_m(rest, found), 0.1 * widest_m, 0.25 * widest_m);
    std::optional<Candidate> best;
    for (; band_m <= widest_m; band_m *= 2.0) {
        const auto now = within_band(config, scene, rest, found, band_m);
        if (now && (!best || now->support > best->support)) best = now;
    }
    return best;
}

bool is_better(const Candidate& a, const Candidate& b) {
    const bool a_accepted = a.reason == GroundReason::accepted;
    const bool b_accepted = b.reason == GroundReason::accepted;
    if (a_accepted != b_accepted) return a_accepted;
    return a.image_share > b.image_share;
}

/// Marks the points of a plane as used.
void take(const View& view, const Plane& plane, double band_m, std::vector<char>& used) {
    for (std::size_t k = 0; k < used.size(); ++k) {
        const double within_m = std::max(band_m, 3.0 * noise_of(view, k, plane));
        if (std::abs(plane.signed_distance_m(view.points[k])) <= within_m) used[k] = 1;
    }
}

View without(const View& view, const std::vector<char>& used) {
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (used[i] == 0) kept.push_back(i);
    return select(view, kept);
}

/// Finds planes of any direction one after the other, largest first. A strip of floor before a wall
/// is found after the wall has been removed.
std::optional<Candidate> best_of(const GroundConfig& config, const Scene& scene, Rng& rng) {
    const View& all = scene.all;
    const Drawable from = drawable(config, all);
    std::vector<char> drawn(from.view.points.size(), 0);
    std::vector<char> used(all.points.size(), 0);
    std::optional<Candidate> best;
    for (int i = 0; i < kMaxPlanes; ++i) {
        if (std::count(drawn.begin(), drawn.end(), 0) < static_cast<std::ptrdiff_t>(kLeastPoints))
            break;
        const auto found = most_supported(config, from, drawn, rng);
        if (!found) break;
        const View rest = without(all, used);
        const double narrow_m = 0.5 * config.tolerance_m * all.scale;
        const Plane plane =
            refine_plane(rest.points, rest.inverse_range_sigma, *found, narrow_m).value_or(*found);
        double band_m = narrow_m;
        if (is_possible(config, plane)) {
            const auto candidate = measured(config, scene, rest, plane);
            if (candidate && (!best || is_better(*candidate, *best))) best = candidate;
            if (candidate) band_m = std::max(band_m, candidate->band_m);
        }
        take(from.view, plane, band_m, drawn);
        take(from.view, *found, narrow_m, drawn);
        take(all, plane, band_m, used);
    }
    return best;
}

}  // namespace

GroundSighting search_ground(const GroundConfig& config,
                             const FramePoints& seen,
                             std::uint64_t seed) {
    GroundSighting sighting;
    const View all = view_of(config, seen);
    if (all.points.size() < kLeastPoints) return sighting;
    Rng rng(seed);
    const auto best = best_of(config, {all, seen.pixels, seen.calibration_covariance}, rng);
    if (!best) {
        sighting.reason = GroundReason::no_plane;
        return sighting;
    }
    sighting.reason = best->reason;
    sighting.tilt_rad = std::atan2(best->plane.normal.head<2>().norm(), best->plane.normal.z());
    sighting.area_m2 = best->area_m2;
    sighting.image_share = best->image_share;
    sighting.uncertainty =
        plane_uncertainty(best->plane, best->covariance_of_m, -seen.camera_body_m);
    sighting.observation = {best->reason == GroundReason::accepted,
                            best->plane.normal,
                            best->plane.signed_distance_m(-seen.camera_body_m),
                            best->inlier_ratio,
                            best->rms_m};
    return sighting;
}

FramePoints with_nominal_noise(std::span<const Eigen::Vector3d> points,
                               const Eigen::Vector3d& sensor) {
    /// Noise of 4 mm at 1 m and 16 mm at 2 m: between the noise of a depth camera and that of a
    /// small stereo camera.
    constexpr double kInverseRangeSigma = 0.004;
    FramePoints seen;
    seen.camera_body_m = sensor;
    seen.points_body_m.assign(points.begin(), points.end());
    seen.inverse_range_sigma.assign(points.size(), kInverseRangeSigma);
    seen.pixels = points.size();
    return seen;
}

}  // namespace surefoot::ground

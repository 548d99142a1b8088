// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/ransac_plane.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "surefoot/core/assert.hpp"

namespace surefoot::geometry {
namespace {

using Points = std::span<const Eigen::Vector3d>;

/// The cone, stored as the smallest admissible |cosine|. Without a cone every normal is admissible.
struct Admissible {
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
    double min_cosine = 0.0;

    [[nodiscard]] bool operator()(const Eigen::Vector3d& normal) const {
        return std::abs(normal.dot(axis)) >= min_cosine;
    }
};

Admissible admissible(const RansacPlaneOptions& options) {
    if (!options.cone) return {};
    return {options.cone->direction.normalized(), std::cos(options.cone->max_angle_rad)};
}

/// Returns the plane through three points, or nullopt if the points are (nearly) on one line.
std::optional<Plane> plane_through(const Eigen::Vector3d& a,
                                   const Eigen::Vector3d& b,
                                   const Eigen::Vector3d& c) {
    const Eigen::Vector3d ab = b - a;
    const Eigen::Vector3d ac = c - a;
    const Eigen::Vector3d normal = ab.cross(ac);
    const double length = normal.norm();
    constexpr double kMinSine = 1e-6;
    if (!(length > kMinSine * ab.norm() * ac.norm())) return std::nullopt;
    return Plane{normal / length, -normal.dot(a) / length};
}

std::optional<Plane> draw_plane(Points points, const std::vector<int>& finite, Rng& rng) {
    const auto draw = [&]() -> const Eigen::Vector3d& {
        return points[static_cast<std::size_t>(finite[rng.below(finite.size())])];
    };
    const Eigen::Vector3d& a = draw();
    const Eigen::Vector3d& b = draw();
    const Eigen::Vector3d& c = draw();
    return plane_through(a, b, c);  // no plane if a point was drawn twice
}

bool is_inlier(Points points, int index, const Plane& plane, const RansacPlaneOptions& options) {
    const auto i = static_cast<std::size_t>(index);
    const double tolerance_m =
        options.tolerance_of_m.empty() ? options.tolerance_m : options.tolerance_of_m[i];
    return std::abs(plane.signed_distance_m(points[i])) <= tolerance_m;
}

/// Support of a plane: the number of its inliers. With a tolerance per point, near inliers count
/// more (MSAC, Torr and Zisserman 2000): a plane across two levels has many inliers near the limit.
/// Stops early, with a smaller value, if the plane cannot beat `to_beat`.
double support(Points points,
               const std::vector<int>& finite,
               const Plane& plane,
               const RansacPlaneOptions& options,
               double to_beat) {
    constexpr std::size_t kPortion = 128;
    double sum = 0.0;
    for (std::size_t first = 0; first < finite.size(); first += kPortion) {
        if (sum + static_cast<double>(finite.size() - first) <= to_beat) break;
        const std::size_t last = std::min(first + kPortion, finite.size());
        for (std::size_t k = first; k < last; ++k) {
            const auto i = static_cast<std::size_t>(finite[k]);
            const double distance_m = plane.signed_distance_m(points[i]);
            if (options.tolerance_of_m.empty()) {
                sum += std::abs(distance_m) <= options.tolerance_m ? 1.0 : 0.0;
            } else {
                const double share = distance_m / options.tolerance_of_m[i];
                sum += std::max(1.0 - share * share, 0.0);
            }
        }
    }
    return sum;
}

std::vector<int> inliers_of(Points points,
                            const std::vector<int>& finite,
                            const Plane& plane,
                            const RansacPlaneOptions& options) {
    std::vector<int> inliers;
    for (const int index : finite) {
        if (is_inlier(points, index, plane, options)) inliers.push_back(index);
    }
    return inliers;
}

struct Search {
    std::optional<Plane> best;
    int iterations = 0;
};

Search search(Points points,
              const std::vector<int>& finite,
              const RansacPlaneOptions& options,
              const Admissible& is_admissible,
              Rng& rng) {
    Search result;
    double best = 0.0;
    // Chance that all three points are inliers of the best plane so far, or of a plane with the
    // share `least_inlier_ratio`, whichever chance is larger.
    double hit = std::pow(std::min(options.least_inlier_ratio, 1.0), 3);
    double missed = 1.0;  // chance that all triples so far contained an outlier
    while (result.iterations < options.max_iterations && missed > 1.0 - options.confidence) {
        ++result.iterations;
        missed *= 1.0 - hit;
        const auto plane = draw_plane(points, finite, rng);
        if (!plane || !is_admissible(plane->normal)) continue;
        const double sum = support(points, finite, *plane, options, best);
        if (sum <= best) continue;
        best = sum;
        result.best = plane;
        const double ratio = sum / static_cast<double>(finite.size());
        hit = std::max(hit, ratio * ratio * ratio);
    }
    return result;
}

}  // namespace

std::optional<RansacPlane> ransac_plane(Points points,
                                        const RansacPlaneOptions& options,
                                        Rng& rng) {
    SUREFOOT_ASSERT(options.tolerance_of_m.empty() ||
                    options.tolerance_of_m.size() == points.size());
    std::vector<int> finite;
    finite.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points[i].allFinite()) finite.push_back(static_cast<int>(i));
    }
    if (finite.size() < 3) return std::nullopt;

    const Admissible is_admissible = admissible(options);
    const Search found = search(points, finite, options, is_admissible, rng);
    if (!found.best) return std::nullopt;

    RansacPlane result;
    result.iterations = found.iterations;
    result.inliers = inliers_of(points, finite, *found.best, options);
    for (int round = 0; round <= options.max_refinements; ++round) {
        const auto fit = fit_plane(points, result.inliers);
        if (!fit || !is_admissible(fit->plane.normal)) return std::nullopt;
        result.fit = *fit;
        auto inliers = inliers_of(points, finite, fit->plane, options);
        if (round == options.max_refinements || inliers == result.inliers) break;
        result.inliers = std::move(inliers);
    }
    if (options.cone) result.fit.plane = result.fit.plane.facing(is_admissible.axis);
    result.inlier_ratio =
        static_cast<double>(result.inliers.size()) / static_cast<double>(finite.size());
    return result;
}

}  // namespace surefoot::geometry

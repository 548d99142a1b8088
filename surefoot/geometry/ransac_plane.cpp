// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/ransac_plane.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace surefoot::geometry {
namespace {

using Points = std::span<const Eigen::Vector3d>;

/// The cone as the smallest admissible |cosine|; without a cone every normal is admissible.
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

/// Plane through three points, or nothing if they are (nearly) on one line.
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
    return plane_through(a, b, c);  // the same point twice spans no plane
}

std::size_t count_inliers(Points points,
                          const std::vector<int>& finite,
                          const Plane& plane,
                          double tolerance_m) {
    std::size_t count = 0;
    for (const int index : finite) {
        const auto& p = points[static_cast<std::size_t>(index)];
        count += std::abs(plane.signed_distance_m(p)) <= tolerance_m ? 1U : 0U;
    }
    return count;
}

std::vector<int> inliers_of(Points points,
                            const std::vector<int>& finite,
                            const Plane& plane,
                            double tolerance_m) {
    std::vector<int> inliers;
    for (const int index : finite) {
        const auto& p = points[static_cast<std::size_t>(index)];
        if (std::abs(plane.signed_distance_m(p)) <= tolerance_m) inliers.push_back(index);
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
    std::size_t best_count = 0;
    double hit = 0.0;     // chance that a triple is all inliers of the best plane so far
    double missed = 1.0;  // chance that all triples so far contained an outlier
    while (result.iterations < options.max_iterations && missed > 1.0 - options.confidence) {
        ++result.iterations;
        missed *= 1.0 - hit;
        const auto plane = draw_plane(points, finite, rng);
        if (!plane || !is_admissible(plane->normal)) continue;
        const std::size_t count = count_inliers(points, finite, *plane, options.tolerance_m);
        if (count <= best_count) continue;
        best_count = count;
        result.best = plane;
        const double ratio = static_cast<double>(count) / static_cast<double>(finite.size());
        hit = ratio * ratio * ratio;
    }
    return result;
}

}  // namespace

std::optional<RansacPlane> ransac_plane(Points points,
                                        const RansacPlaneOptions& options,
                                        Rng& rng) {
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
    result.inliers = inliers_of(points, finite, *found.best, options.tolerance_m);
    for (int round = 0; round <= options.max_refinements; ++round) {
        const auto fit = fit_plane(points, result.inliers);
        if (!fit || !is_admissible(fit->plane.normal)) return std::nullopt;
        result.fit = *fit;
        auto inliers = inliers_of(points, finite, fit->plane, options.tolerance_m);
        if (round == options.max_refinements || inliers == result.inliers) break;
        result.inliers = std::move(inliers);
    }
    if (options.cone) result.fit.plane = result.fit.plane.facing(is_admissible.axis);
    result.inlier_ratio =
        static_cast<double>(result.inliers.size()) / static_cast<double>(finite.size());
    return result;
}

}  // namespace surefoot::geometry

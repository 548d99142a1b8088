// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/cloud.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/ground/refine_plane.hpp"

namespace surefoot::ground {
namespace {

constexpr double kSearchSigmas = 3.0;        ///< limit of the distance from a plane, in sigmas
constexpr double kLeastTolerance_m = 0.005;  ///< smallest tolerance of a point, whatever its sigma

}  // namespace

Cloud cloud_of(std::span<const Eigen::Vector3d> points,
               std::span<const double> inverse_range_sigma,
               const Eigen::Vector3d& sensor,
               std::span<const std::size_t> chosen) {
    Cloud cloud;
    cloud.points.reserve(chosen.size());
    cloud.inverse_range_sigma.reserve(inverse_range_sigma.empty() ? 0 : chosen.size());
    for (const std::size_t i : chosen) {
        cloud.points.emplace_back(points[i] - sensor);
        if (!inverse_range_sigma.empty())
            cloud.inverse_range_sigma.push_back(inverse_range_sigma[i]);
    }
    return cloud;
}

void judge_noise(const GroundConfig& config, const Eigen::Vector3d& up, Cloud& cloud) {
    std::vector<double> across_m(cloud.points.size());
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
        const Eigen::Vector3d& p = cloud.points[i];
        across_m[i] = std::abs(up.dot(p)) * p.norm() * cloud.inverse_range_sigma[i];
    }
    std::vector<double> sorted_m = across_m;
    const auto tenth = sorted_m.begin() + static_cast<std::ptrdiff_t>(sorted_m.size() / 10);
    std::nth_element(sorted_m.begin(), tenth, sorted_m.end());
    cloud.band_m = std::max(0.5 * config.tolerance_m, kSearchSigmas * *tenth);
    cloud.tolerance_m.reserve(across_m.size());
    for (const double sigma_m : across_m) {
        cloud.tolerance_m.push_back(
            std::clamp(kSearchSigmas * sigma_m, kLeastTolerance_m, cloud.band_m));
    }
    cloud.keep_if([&](std::size_t i) { return !(across_m[i] > kNoisiest * cloud.band_m); });
}

}  // namespace surefoot::ground

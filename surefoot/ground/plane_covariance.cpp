// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/plane_covariance.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/ground/refine_plane.hpp"

namespace surefoot::ground {
namespace {

constexpr double kTile_rad = 0.2;  ///< smallest side of a tile; 70 px in the image of a ZED
/// Size of a bump of uneven ground. At short range a bump fills a larger tile.
constexpr double kBump_m = 0.2;
constexpr double kLargestTile_rad = 0.6;  ///< largest side of a tile
/// Assumed error of a whole tile, as a share of the scatter of single points (at least their stated
/// sigma).
constexpr double kPriorShare = 0.6;
constexpr double kPriorTiles = 4.0;  ///< weight of kPriorShare, in tiles
constexpr double kUnknowns = 3.0;

struct Member {
    std::array<std::int64_t, 3> tile;
    Eigen::Vector3d ray;
    double sigma;     ///< sigma of the inverse range
    double residual;  ///< distance from the plane [sigma]
};

std::vector<Member> members_of(std::span<const Eigen::Vector3d> points,
                               std::span<const double> inverse_range_sigma,
                               const geometry::Plane& plane,
                               double band_m) {
    const double tile_rad = std::clamp(kBump_m / plane.offset_m, kTile_rad, kLargestTile_rad);
    std::vector<Member> members;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Sighting seen = sighting_of(beam_to(points[i]), inverse_range_sigma[i], plane);
        if (!seen.is_within(band_m)) continue;
        Member member{{}, seen.ray, inverse_range_sigma[i], seen.off_m / seen.sigma_m};
        for (int k = 0; k < 3; ++k)
            member.tile[static_cast<std::size_t>(k)] =
                saturated_integer<std::int64_t>(std::floor(seen.ray[k] / tile_rad));
        members.push_back(member);
    }
    std::stable_sort(members.begin(), members.end(), [](const Member& a, const Member& b) {
        return a.tile < b.tile;
    });
    return members;
}

}  // namespace

Eigen::Matrix3d covariance_of_m(std::span<const Eigen::Vector3d> points,
                                std::span<const double> inverse_range_sigma,
                                const geometry::Plane& plane,
                                double band_m) {
    const std::vector<Member> members = members_of(points, inverse_range_sigma, plane, band_m);
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d together = Eigen::Matrix3d::Zero();
    double square_sum = 0.0;
    double scatter = 0.0;
    double tiles = 0.0;
    for (auto first = members.begin(); first != members.end();) {
        const auto last = std::find_if(
            first, members.end(), [&](const Member& m) { return m.tile != first->tile; });
        Eigen::Vector3d pull = Eigen::Vector3d::Zero();  // effect of one sigma on the whole tile
        double residual = 0.0;
        for (auto it = first; it != last; ++it) {
            information += it->ray * it->ray.transpose() / (it->sigma * it->sigma);
            pull += it->ray / it->sigma;
            residual += it->residual;
            scatter += it->residual * it->residual;
        }
        together += pull * pull.transpose();
        residual /= static_cast<double>(last - first);
        square_sum += residual * residual;
        tiles += 1.0;
        first = last;
    }
    const Eigen::LDLT<Eigen::Matrix3d> ldlt(information);
    if (members.empty() || !(ldlt.vectorD().minCoeff() > 0.0)) return Eigen::Matrix3d::Zero();
    const double excess = std::max(scatter / static_cast<double>(members.size()), 1.0);
    const double variance = (kPriorTiles * kPriorShare * kPriorShare * excess + square_sum) /
                            (kPriorTiles + std::max(tiles - kUnknowns, 0.0));
    const Eigen::Matrix3d inverse = ldlt.solve(Eigen::Matrix3d::Identity());
    return variance * inverse * together * inverse.transpose();
}

double PlaneUncertainty::tilt_sigma_rad() const {
    return std::sqrt(0.5 * normal_covariance.trace());
}

PlaneUncertainty plane_uncertainty(const geometry::Plane& plane,
                                   const Eigen::Matrix3d& covariance_of_m,
                                   const Eigen::Vector3d& base) {
    // n = -m / |m| and h = 1 / |m|: dn = -h (I - n n^T) dm, dh = h^2 n . dm.
    const Eigen::Vector3d& n = plane.normal;
    const double h = plane.offset_m;
    const Eigen::Matrix3d dn_dm = -h * (Eigen::Matrix3d::Identity() - n * n.transpose());
    const Eigen::RowVector3d dheight_dm = h * h * n.transpose() + base.transpose() * dn_dm;
    PlaneUncertainty uncertainty;
    uncertainty.normal_covariance = dn_dm * covariance_of_m * dn_dm.transpose();
    uncertainty.height_var_m2 = (dheight_dm * covariance_of_m * dheight_dm.transpose())(0, 0);
    return uncertainty;
}

}  // namespace surefoot::ground

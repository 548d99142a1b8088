// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/refine_plane.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace surefoot::ground {
namespace {

constexpr int kRounds = 8;
constexpr double kSettled_m = 2e-5;  // converged below this motion of the plane at 1 m
constexpr std::size_t kLeastPoints = 20;
constexpr double kTukey = 4.685;            // cut-off [sigma], 95 % efficient for normal noise
constexpr double kSigmaPerMedian = 1.4826;  // sigma / median of a normal distribution
constexpr double kLeastScale = 0.1;         // smallest scale, relative to the stated sigmas

struct Sample {
    Eigen::Vector3d ray;
    double inverse_range;
    double sigma;     ///< sigma of inverse_range
    double residual;  ///< in sigmas
};

void find_samples(const geometry::Plane& plane,
                  std::span<const Beam> beams,
                  std::span<const double> inverse_range_sigma,
                  double band_m,
                  std::vector<Sample>& samples) {
    samples.clear();
    for (std::size_t i = 0; i < beams.size(); ++i) {
        const Sighting seen = sighting_of(beams[i], inverse_range_sigma[i], plane);
        if (!seen.is_within(band_m)) continue;
        samples.push_back(
            {seen.ray, seen.inverse_range, inverse_range_sigma[i], seen.off_m / seen.sigma_m});
    }
}

double scatter(const std::vector<Sample>& samples) {
    std::vector<double> sizes;
    sizes.reserve(samples.size());
    for (const Sample& sample : samples) sizes.push_back(std::abs(sample.residual));
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    return std::max(kSigmaPerMedian * *middle, kLeastScale);
}

}  // namespace

std::optional<geometry::Plane> plane_of(const Eigen::Vector3d& m) {
    const double length = m.norm();
    if (!(length > 0.0) || !std::isfinite(length)) return std::nullopt;
    return geometry::Plane{-m / length, 1.0 / length};
}

std::optional<geometry::Plane> refine_plane(std::span<const Eigen::Vector3d> points,
                                            std::span<const double> inverse_range_sigma,
                                            const geometry::Plane& start,
                                            double band_m) {
    geometry::Plane plane = start;
    std::vector<Beam> beams;
    beams.reserve(points.size());
    for (const auto& p : points) beams.push_back(beam_to(p));
    std::vector<Sample> samples;
    samples.reserve(points.size());
    for (int round = 0; round < kRounds; ++round) {
        find_samples(plane, beams, inverse_range_sigma, band_m, samples);
        if (samples.size() < kLeastPoints) return std::nullopt;
        const double cut = kTukey * scatter(samples);
        Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        for (const Sample& sample : samples) {
            const double x = sample.residual / cut;
            if (!(std::abs(x) < 1.0)) continue;
            const double root = (1.0 - x * x) / sample.sigma;
            const Eigen::Vector3d weighted = root * root * sample.ray;
            information += weighted * sample.ray.transpose();
            right += sample.inverse_range * weighted;
        }
        const Eigen::LDLT<Eigen::Matrix3d> ldlt(information);
        constexpr double kSingular = 1e-12;
        const Eigen::Vector3d pivots = ldlt.vectorD();
        if (!(pivots.minCoeff() > kSingular * pivots.maxCoeff())) return std::nullopt;
        const auto next = plane_of(ldlt.solve(right));
        if (!next) return std::nullopt;
        const double moved_m =
            (next->normal - plane.normal).norm() + std::abs(next->offset_m - plane.offset_m);
        plane = *next;
        if (moved_m < kSettled_m) break;
    }
    return plane;
}

}  // namespace surefoot::ground

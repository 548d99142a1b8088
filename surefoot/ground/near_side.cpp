// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/near_side.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/ground/refine_plane.hpp"

namespace surefoot::ground {
namespace {

constexpr int kStrips = 32;             ///< number of strips; a split lies between two strips
constexpr double kRim = 0.02;           ///< share of the points beyond the strips at either end
constexpr int kLeastPoints = 100;       ///< smallest number of points on either side of a split
constexpr double kLeastLength_m = 0.3;  ///< smallest length of the returned side
/// Two planes fit better than one if one plane leaves squared residuals that are larger by more
/// than this share. At a step of four times a point's noise, two planes leave a third of the
/// squared residuals. With the distortion of a lens they leave more. ASSUMPTION.
constexpr double kLeastGain = 0.25;

/// Normal equations of the least squares problem for m in w = m . r about a plane, see
/// `refine_plane`.
struct Sums {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double square = 0.0;
    int points = 0;

    void operator+=(const Sums& other) {
        information += other.information;
        right += other.right;
        square += other.square;
        points += other.points;
    }
    void operator-=(const Sums& other) {
        information -= other.information;
        right -= other.right;
        square -= other.square;
        points -= other.points;
    }
    [[nodiscard]] Eigen::Vector3d solution() const { return information.ldlt().solve(right); }
    /// Sum of the squared residuals.
    [[nodiscard]] double rest() const { return square - right.dot(solution()); }
};

struct Sample {
    Sums sums;
    Eigen::Vector2d at_m;  ///< position ahead of the sensor and to its left, along the plane
};

struct Split {
    double rest = 0.0;
    double from_m = 0.0;  ///< start of the sensor's side along the coordinate
    double to_m = 0.0;
    Eigen::Vector3d m = Eigen::Vector3d::Zero();  ///< correction of the plane's m
};

struct Samples {
    std::vector<Sample> all;
    std::array<Eigen::Vector3d, 2> axes;  ///< ahead of the sensor and to its left, along the plane
};

Samples samples_of(std::span<const Eigen::Vector3d> points,
                   std::span<const double> inverse_range_sigma,
                   const geometry::Plane& plane,
                   double band_m) {
    std::vector<Eigen::Vector3d> near;
    Samples samples;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double sigma = inverse_range_sigma[i];
        const Sighting seen = sighting_of(beam_to(points[i]), sigma, plane);
        if (!seen.is_within(band_m)) continue;
        const double off = (seen.inverse_range - seen.expected_inverse_range) / sigma;
        Sample sample;
        sample.sums.information = seen.ray * seen.ray.transpose() / (sigma * sigma);
        sample.sums.right = seen.ray * (off / sigma);
        sample.sums.square = off * off;
        sample.sums.points = 1;
        samples.all.push_back(sample);
        near.push_back(points[i]);
        sum += seen.ray;
    }
    const Eigen::Vector3d ahead = (sum - plane.normal.dot(sum) * plane.normal).normalized();
    samples.axes = {ahead, plane.normal.cross(ahead)};
    for (std::size_t i = 0; i < near.size(); ++i)
        samples.all[i].at_m = {samples.axes[0].dot(near[i]), samples.axes[1].dot(near[i])};
    return samples;
}

/// Finds the best split along one coordinate, among the splits that leave a long enough side at the
/// sensor. A `rest` of 0 means no split.
Split best_split(const std::vector<Sample>& samples, int axis) {
    std::vector<double> at_m;
    at_m.reserve(samples.size());
    for (const Sample& sample : samples) at_m.push_back(sample.at_m[axis]);
    std::sort(at_m.begin(), at_m.end());
    // in range: a part of the size
    const auto rim = static_cast<std::size_t>(kRim * static_cast<double>(at_m.size()));
    const double first_m = at_m[rim];
    const double strip_m = (at_m[at_m.size() - 1 - rim] - first_m) / kStrips;
    if (!(strip_m > 0.0)) return {};
    std::array<Sums, kStrips> strips;
    Sums after;
    for (const Sample& sample : samples) {
        const double strip = std::floor((sample.at_m[axis] - first_m) / strip_m);
        const int k = clamped_integer<int>(strip, 0, kStrips - 1);
        strips[static_cast<std::size_t>(k)] += sample.sums;
        after += sample.sums;
    }
    Split best;
    Sums before;
    for (int i = 0; i + 1 < kStrips; ++i) {
        before += strips[static_cast<std::size_t>(i)];
        after -= strips[static_cast<std::size_t>(i)];
        const double at = first_m + (i + 1) * strip_m;
        // Both coordinates are 0 straight below the sensor.
        const bool keeps_before = at > 0.0;
        const double length_m = keeps_before ? at - at_m.front() : at_m.back() - at;
        if (std::min(before.points, after.points) < kLeastPoints || length_m < kLeastLength_m)
            continue;
        const double rest = before.rest() + after.rest();
        if (best.rest > 0.0 && !(rest < best.rest)) continue;
        best.rest = rest;
        best.m = (keeps_before ? before : after).solution();
        best.from_m = keeps_before ? at_m.front() : at;
        best.to_m = keeps_before ? at : at_m.back();
    }
    return best;
}

}  // namespace

std::optional<NearSide> near_side(std::span<const Eigen::Vector3d> points,
                                  std::span<const double> inverse_range_sigma,
                                  const geometry::Plane& plane,
                                  double band_m) {
    const Samples samples = samples_of(points, inverse_range_sigma, plane, band_m);
    if (samples.all.size() < 2 * static_cast<std::size_t>(kLeastPoints)) return std::nullopt;
    Sums sums;
    for (const Sample& sample : samples.all) sums += sample.sums;
    std::optional<NearSide> side;
    double least = sums.rest() / (1.0 + kLeastGain);
    for (const int axis : {0, 1}) {
        const Split split = best_split(samples.all, axis);
        const auto nearer = plane_of(split.m - plane.normal / plane.offset_m);
        if (!(split.rest > 0.0) || !(split.rest < least) || !nearer) continue;
        least = split.rest;
        side = NearSide{
            *nearer, samples.axes[static_cast<std::size_t>(axis)], split.from_m, split.to_m};
    }
    return side;
}

}  // namespace surefoot::ground

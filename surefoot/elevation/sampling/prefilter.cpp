// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/sampling/prefilter.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::elevation {
namespace {

float distance_sq_m2(const GridPoint& a, const GridPoint& b) {
    const float dx = a.x_m - b.x_m;
    const float dy = a.y_m - b.y_m;
    const float dz = a.z_m - b.z_m;
    return dx * dx + dy * dy + dz * dz;
}

std::int32_t lattice(float p_m, double edge_m) {
    constexpr std::int32_t kLimit = 1 << 30;
    const double index = std::floor(static_cast<double>(p_m) / edge_m);
    return clamped_integer<std::int32_t>(index, -kLimit, kLimit);
}

double offset_m(float p_m, std::int32_t index, double edge_m) {
    return static_cast<double>(p_m) - (index + 0.5) * edge_m;
}

/// Moves the kept points to the front, in order.
std::size_t compact(std::span<GridPoint> points, std::span<const std::uint8_t> keep) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (keep[i] != 0) points[kept++] = points[i];
    }
    return kept;
}

}  // namespace

void PrefilterConfig::describe(ConfigVisitor& visitor) {
    visitor.boolean(
        "range", range, "true: drop points nearer than min_range_m or farther than max_range_m");
    visitor.number("min_range_m",
                   min_range_m,
                   0.0,
                   1000.0,
                   "smallest distance of a point from the sensor; used if range is true");
    visitor.number("max_range_m",
                   max_range_m,
                   0.0,
                   1000.0,
                   "largest distance of a point from the sensor; used if range is true");
    visitor.boolean(
        "height",
        height,
        "true: drop points higher than max_height_m and cell heights lower than min_height_m");
    visitor.number("min_height_m",
                   min_height_m,
                   -100.0,
                   100.0,
                   "smallest height of a cell over base_link; lower ground gets no height and is "
                   "evidence of a drop; used if height is true");
    visitor.number("max_height_m",
                   max_height_m,
                   -100.0,
                   100.0,
                   "largest height of a point over base_link; used if height is true");
    visitor.boolean(
        "down_sampling", down_sampling, "true: keep one point per cube with sides of sampling_m");
    visitor.number(
        "sampling_m",
        sampling_m,
        0.001,
        10.0,
        "side length of the cubes of which one point each is kept; used if down_sampling is true");
    visitor.boolean("outlier_removal",
                    outlier_removal,
                    "true: drop points with fewer than outlier_min_neighbours other points within "
                    "outlier_radius_m");
    visitor.number("outlier_radius_m",
                   outlier_radius_m,
                   0.001,
                   10.0,
                   "radius around a point within which other points are counted; used if "
                   "outlier_removal is true");
    visitor.integer("outlier_min_neighbours",
                    outlier_min_neighbours,
                    1,
                    10000,
                    "smallest number of other points within outlier_radius_m that keep a point; "
                    "used if outlier_removal is true");
}

CloudFilter::Cube CloudFilter::cube_of(const GridPoint& point, double edge_m) {
    return {lattice(point.x_m, edge_m), lattice(point.y_m, edge_m), lattice(point.z_m, edge_m)};
}

void CloudFilter::reset_table(std::size_t points) {
    const std::size_t wanted = std::bit_ceil(std::max<std::size_t>(16, 2 * points));
    first_.assign(std::max(wanted, first_.size()), kNone);  // at most half full
    cubes_.resize(points);
}

std::size_t CloudFilter::slot_of(const Cube& cube) const {
    // Primes of Teschner 2003. The hash is mixed once more, because neighbouring cubes differ only
    // in low bits.
    std::uint64_t hash = static_cast<std::uint32_t>(cube.x) * 73856093ULL;
    hash ^= static_cast<std::uint32_t>(cube.y) * 19349663ULL;
    hash ^= static_cast<std::uint32_t>(cube.z) * 83492791ULL;
    hash *= 0x9e3779b97f4a7c15ULL;
    const std::size_t mask = first_.size() - 1;
    std::size_t slot = static_cast<std::size_t>(hash >> 32U) & mask;
    while (first_[slot] != kNone && !(cubes_[first_[slot]] == cube)) slot = (slot + 1) & mask;
    return slot;
}

std::size_t CloudFilter::down_sample(double sampling_m, std::span<GridPoint> points) {
    reset_table(points.size());
    keep_.assign(points.size(), 0);
    const auto off_centre_sq = [&](std::size_t i) {
        const double dx = offset_m(points[i].x_m, cubes_[i].x, sampling_m);
        const double dy = offset_m(points[i].y_m, cubes_[i].y, sampling_m);
        const double dz = offset_m(points[i].z_m, cubes_[i].z, sampling_m);
        return dx * dx + dy * dy + dz * dz;
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
        cubes_[i] = cube_of(points[i], sampling_m);
        std::uint32_t& standing = first_[slot_of(cubes_[i])];
        if (standing != kNone && off_centre_sq(standing) <= off_centre_sq(i)) continue;
        if (standing != kNone) keep_[standing] = 0;
        standing = static_cast<std::uint32_t>(i);
        keep_[i] = 1;
    }
    return compact(points, keep_);
}

void CloudFilter::link(std::span<const GridPoint> points, double edge_m) {
    reset_table(points.size());
    next_.assign(points.size(), kNone);
    for (std::size_t i = 0; i < points.size(); ++i) {
        cubes_[i] = cube_of(points[i], edge_m);
        std::uint32_t& head = first_[slot_of(cubes_[i])];
        next_[i] = head;
        head = static_cast<std::uint32_t>(i);
    }
}

int CloudFilter::count_neighbours(std::span<const GridPoint> points,
                                  std::size_t of,
                                  double radius_m,
                                  int enough) const {
    const auto radius_sq_m2 = static_cast<float>(radius_m * radius_m);
    int count = 0;
    // 27 cubes with an edge of one radius contain every neighbour; the search starts with the
    // point's own cube.
    constexpr int kOrder[3] = {0, -1, 1};
    for (const int dz : kOrder) {
        for (const int dy : kOrder) {
            for (const int dx : kOrder) {
                const Cube cube{cubes_[of].x + dx, cubes_[of].y + dy, cubes_[of].z + dz};
                for (std::uint32_t i = first_[slot_of(cube)]; i != kNone; i = next_[i]) {
                    if (i == of || !(distance_sq_m2(points[i], points[of]) <= radius_sq_m2))
                        continue;
                    if (++count >= enough) return count;
                }
            }
        }
    }
    return count;
}

std::size_t CloudFilter::remove_outliers(double radius_m,
                                         int min_neighbours,
                                         std::span<GridPoint> points) {
    link(points, radius_m);
    keep_.assign(points.size(), 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        keep_[i] = count_neighbours(points, i, radius_m, min_neighbours) >= min_neighbours ? 1 : 0;
    }
    return compact(points, keep_);
}

}  // namespace surefoot::elevation

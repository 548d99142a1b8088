// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/clouds/cloud_measures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/pieces.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/eval/clouds/voxels.hpp"
#include "surefoot/geometry/kd_tree.hpp"
#include "surefoot/geometry/plane_fit.hpp"
#include "surefoot/geometry/statistics.hpp"
#include "surefoot/geometry/surface_normal.hpp"

namespace surefoot::eval {
namespace {

using Eigen::Vector3f;

/// Returns the bins with a prominent count. Of bins closer than `least_step_m`, returns only the
/// fullest.
std::vector<std::size_t> peaks_of(const HeightHistogram& histogram,
                                  std::size_t points,
                                  const LevelConfig& config) {
    const auto& counts = histogram.counts;
    const auto around =
        saturated_integer<std::size_t>(std::ceil(3.0 * config.least_step_m / config.bin_m));
    std::vector<std::size_t> candidates;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        const auto count = static_cast<double>(counts[i]);
        if (count < config.least_share * static_cast<double>(points)) continue;
        std::vector<double> near;
        for (std::size_t k = i - std::min(i, around); k < std::min(i + around + 1, counts.size());
             ++k)
            near.push_back(static_cast<double>(counts[k]));
        if (near.size() > 4 && count < config.prominence * upper_median(near)) continue;
        candidates.push_back(i);
    }
    std::stable_sort(candidates.begin(), candidates.end(), [&](std::size_t a, std::size_t b) {
        return counts[a] > counts[b];
    });
    const auto apart =
        saturated_integer<std::size_t>(std::round(config.least_step_m / config.bin_m));
    std::vector<std::size_t> peaks;
    for (const std::size_t i : candidates) {
        const bool alone = std::none_of(peaks.begin(), peaks.end(), [&](std::size_t k) {
            return std::max(i, k) - std::min(i, k) < apart;
        });
        if (alone) peaks.push_back(i);
    }
    std::sort(peaks.begin(), peaks.end());
    return peaks;
}

/// Fits a plane to the points near a height, without outliers. Returns no value if no plane fits.
std::optional<Level> level_near(std::span<const Vector3f> points_m,
                                double height_m,
                                const LevelConfig& config) {
    std::vector<Eigen::Vector3d> near_m;
    const double reach_m = 0.5 * config.least_step_m;
    for (const Vector3f& p_m : points_m) {
        if (std::abs(static_cast<double>(p_m.z()) - height_m) <= reach_m)
            near_m.push_back(p_m.cast<double>());
    }
    std::optional<geometry::PlaneFit> fit;
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds; ++round) {
        // The first round uses only points close to the peak.
        const double limit_m = round == 0 ? 2.0 * config.bin_m : 3.0 * fit->rms_m;
        std::vector<Eigen::Vector3d> kept_m;
        for (const Eigen::Vector3d& p_m : near_m) {
            const double off_m =
                round == 0 ? p_m.z() - height_m : fit->plane.signed_distance_m(p_m);
            if (std::abs(off_m) <= limit_m) kept_m.push_back(p_m);
        }
        const auto next = geometry::fit_plane(kept_m);
        if (!next) return std::nullopt;
        fit = next;
    }
    Level level;
    level.height_m = fit->centroid_m.z();
    level.rms_m = fit->rms_m;
    level.tilt_rad = std::acos(std::min(1.0, fit->plane.normal.z()));
    level.points = fit->count;
    level.middle_m = fit->centroid_m.head<2>();
    return level;
}

Repeated repeated(std::vector<double> values_m) {
    Repeated r;
    r.values_m = std::move(values_m);
    const auto n = static_cast<double>(r.values_m.size());
    if (r.values_m.empty()) {
        r.mean_m = r.spread_m = r.std_error_m = kNan;
        return r;
    }
    for (const double v : r.values_m) r.mean_m += v / n;
    if (r.values_m.size() < 2) return r;
    double sum_m2 = 0.0;
    for (const double v : r.values_m) sum_m2 += (v - r.mean_m) * (v - r.mean_m);
    r.spread_m = std::sqrt(sum_m2 / (n - 1.0));
    r.std_error_m = r.spread_m / std::sqrt(n);
    return r;
}

constexpr double kHighestRiser_m = 0.30;

bool is_step(const Level& lower, const Level& upper) {
    return upper.height_m - lower.height_m <= kHighestRiser_m;
}

/// Chains levels that are one riser apart, upward and downward from the first level. If several
/// levels are near the expected height, the level with the most points is the tread.
std::vector<Level> chain_of(std::span<const Level> levels, std::size_t first, double riser_m) {
    constexpr double kUneven = 0.08;  // tolerance of a tread's height, as a share of the riser
    constexpr double kLeastShare = 0.15;
    const auto next_to = [&](const Level& from, double rise_m) -> const Level* {
        const Level* best = nullptr;
        const double low_m = from.height_m + rise_m - kUneven * riser_m;
        const auto first_level = std::lower_bound(
            levels.begin(), levels.end(), low_m, [](const Level& level, double height_m) {
                return level.height_m < height_m;
            });
        for (const Level& level : std::span(first_level, levels.end())) {
            if (level.height_m > low_m + 2.0 * kUneven * riser_m) break;
            // A patch with few points is not a tread next to a level with many points.
            if (static_cast<double>(level.points) < kLeastShare * static_cast<double>(from.points))
                continue;
            if (best == nullptr || level.points > best->points) best = &level;
        }
        return best;
    };
    std::vector<Level> chain{levels[first]};
    while (const Level* above = next_to(chain.back(), riser_m)) chain.push_back(*above);
    while (const Level* below = next_to(chain.front(), -riser_m))
        chain.insert(chain.begin(), *below);
    return chain;
}

/// Returns the levels of a flight: the longest chain of treads with one riser. Of chains with equal
/// length, the chain with more points counts. Surfaces beside the flight and patches of noise
/// between two treads do not fit into this chain.
std::vector<Level> flight_of(std::span<const Level> levels) {
    std::vector<Level> best;
    std::int64_t best_points = 0;
    for (std::size_t i = 0; i < levels.size(); ++i) {
        for (std::size_t k = i + 1; k < levels.size() && is_step(levels[i], levels[k]); ++k) {
            const std::vector<Level> chain =
                chain_of(levels, i, levels[k].height_m - levels[i].height_m);
            std::int64_t points = 0;
            for (const Level& level : chain) points += level.points;
            if (chain.size() < best.size() ||
                (chain.size() == best.size() && points <= best_points))
                continue;
            best = chain;
            best_points = points;
        }
    }
    return best;
}

/// Returns the position of a cluster along a line [m]: the mean of the fullest 20 mm. Returns no
/// value for fewer than 20 points, or if evenly spread points, for example of a side wall, could by
/// chance be as dense there.
std::optional<double> crowd_m(std::vector<double> along_m) {
    constexpr double kWidth_m = 0.02;
    constexpr std::size_t kFewest = 20;
    if (along_m.size() < kFewest) return std::nullopt;
    std::sort(along_m.begin(), along_m.end());
    std::size_t best = 0;
    std::size_t best_begin = 0;
    for (std::size_t begin = 0, end = 0; begin < along_m.size(); ++begin) {
        while (end < along_m.size() && along_m[end] <= along_m[begin] + kWidth_m) ++end;
        if (end - begin <= best) continue;
        best = end - begin;
        best_begin = begin;
    }
    const double span_m = std::max(along_m.back() - along_m.front(), kWidth_m);
    const double even = static_cast<double>(along_m.size()) * kWidth_m / span_m;
    constexpr double kCrowded = 3.0;
    constexpr double kSigmas = 6.0;
    if (span_m > kCrowded * kWidth_m &&
        static_cast<double>(best) < kCrowded * even + kSigmas * std::sqrt(even) + kSigmas)
        return std::nullopt;
    double sum_m = 0.0;
    for (std::size_t i = best_begin; i < best_begin + best; ++i) sum_m += along_m[i];
    return sum_m / static_cast<double>(best);
}

/// Measures positions along the uphill line [m].
class Uphill {
  public:
    Uphill(const SortedSurfaces& surfaces, const Eigen::Vector2d& direction)
        : surfaces_(surfaces), direction_(direction) {}

    /// Returns the position of the riser between two levels [m]: the face of the riser if it has
    /// points. Otherwise returns the middle between the end of the lower level and the beginning of
    /// the upper level.
    [[nodiscard]] std::optional<double> riser_m(const Level& lower, const Level& upper) const {
        const double rise_m = upper.height_m - lower.height_m;
        std::vector<double> face_m;
        for (const Vector3f& p_m : surfaces_.upright_m) {
            const double share = (static_cast<double>(p_m.z()) - lower.height_m) / rise_m;
            constexpr double kEnds = 0.3;  // share of the face that the noise of a level can reach
            if (share > kEnds && share < 1.0 - kEnds) face_m.push_back(along(p_m));
        }
        if (const auto face = crowd_m(std::move(face_m))) return face;
        const auto low_m = ends_m(lower, upper);
        const auto high_m = ends_m(upper, upper);
        if (!low_m || !high_m) return std::nullopt;
        return 0.5 * (low_m->second + high_m->first);
    }

  private:
    [[nodiscard]] double along(const Vector3f& p_m) const {
        return direction_.dot(p_m.head<2>().cast<double>());
    }
    /// Returns the first and last position of a level's points along the uphill line [m]. Uses only
    /// a strip through the middle of `beside`, for a lower level only up to this middle. Leaves out
    /// the outermost hundredth of the points at each end. Returns no value for fewer than 20
    /// points.
    [[nodiscard]] std::optional<std::pair<double, double>> ends_m(const Level& level,
                                                                  const Level& beside) const {
        constexpr double kStrip_m = 0.2;
        const Eigen::Vector2d across(-direction_.y(), direction_.x());
        const double end_m = direction_.dot(beside.middle_m);
        std::vector<double> along_m;
        for (const Vector3f& p_m : surfaces_.level_m) {
            const Eigen::Vector2d xy_m = p_m.head<2>().cast<double>();
            if (std::abs(static_cast<double>(p_m.z()) - level.height_m) > 3.0 * level.rms_m ||
                std::abs(across.dot(xy_m - beside.middle_m)) > kStrip_m)
                continue;
            if (&level != &beside && along(p_m) > end_m) continue;
            along_m.push_back(along(p_m));
        }
        constexpr std::size_t kFewest = 20;
        if (along_m.size() < kFewest) return std::nullopt;
        std::sort(along_m.begin(), along_m.end());
        const std::size_t cut = along_m.size() / 100;
        return std::pair{along_m[cut], along_m[along_m.size() - 1 - cut]};
    }

    const SortedSurfaces& surfaces_;
    Eigen::Vector2d direction_;
};

/// Returns the direction along which the centres of the levels rise.
Eigen::Vector2d uphill_of(std::span<const Level> levels) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Level& level : levels) {
        mean += Eigen::Vector3d(level.middle_m.x(), level.middle_m.y(), level.height_m) /
                static_cast<double>(levels.size());
    }
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();
    for (const Level& level : levels)
        slope += (level.height_m - mean.z()) * (level.middle_m - mean.head<2>());
    const double size = slope.norm();
    return size > 0.0 ? Eigen::Vector2d(slope / size) : Eigen::Vector2d::Zero();
}

}  // namespace

SortedSurfaces sort_surfaces(std::span<const Vector3f> points_m, Executor& executor) {
    constexpr float kRadius_m = 0.04F;  // small compared with a tread, which is about 0.25 m deep
    const float level_up = std::cos(static_cast<float>(20.0 * M_PI / 180.0));
    const float upright_up = std::sin(static_cast<float>(20.0 * M_PI / 180.0));
    const geometry::KdTree cloud(voxel_means_m(points_m, kSurfaceVoxel_m, executor), executor);
    const auto thinned_m = cloud.points_m();
    std::vector<float> upward(thinned_m.size(), std::numeric_limits<float>::quiet_NaN());
    constexpr std::size_t kTaken = 4096;
    in_pieces(thinned_m.size(), kTaken, executor, [&](std::size_t begin, std::size_t end, auto) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto normal = geometry::surface_normal(cloud, thinned_m[i], kRadius_m);
            if (normal) upward[i] = std::abs(normal->z());
        }
    });
    SortedSurfaces sorted;
    for (std::size_t i = 0; i < thinned_m.size(); ++i) {
        if (upward[i] >= level_up) sorted.level_m.push_back(thinned_m[i]);
        if (upward[i] <= upright_up) sorted.upright_m.push_back(thinned_m[i]);
    }
    return sorted;
}

HeightHistogram height_histogram(std::span<const Vector3f> points_m, const LevelConfig& config) {
    HeightHistogram histogram;
    histogram.bin_m = config.bin_m;
    if (points_m.empty()) return histogram;
    const auto [least, most] = std::minmax_element(
        points_m.begin(), points_m.end(), [](const Vector3f& a, const Vector3f& b) {
            return a.z() < b.z();
        });
    const double first = std::floor(static_cast<double>(least->z()) / config.bin_m);
    const double bins = std::floor(static_cast<double>(most->z()) / config.bin_m) - first + 1.0;
    constexpr double kMostBins = 1e6;
    if (!(bins <= kMostBins)) return histogram;
    histogram.low_m = first * config.bin_m;
    histogram.counts.assign(static_cast<std::size_t>(bins), 0);  // in range: at most kMostBins
    for (const Vector3f& p_m : points_m) {
        const double bin = std::floor(static_cast<double>(p_m.z()) / config.bin_m) - first;
        ++histogram.counts[static_cast<std::size_t>(bin)];  // in range: 0 to the last bin
    }
    for (const std::size_t peak : peaks_of(histogram, points_m.size(), config)) {
        const double height_m = histogram.low_m + (static_cast<double>(peak) + 0.5) * config.bin_m;
        if (const auto level = level_near(points_m, height_m, config))
            histogram.levels.push_back(*level);
    }
    return histogram;
}

StairMeasures measure_stairs(const SortedSurfaces& surfaces, std::span<const Level> all) {
    const std::vector<Level> flight = flight_of(all);
    const std::span<const Level> levels = flight.empty() ? all : std::span<const Level>(flight);
    constexpr double kLongestTread_m = 0.5;   // a longer level is a landing
    constexpr double kShortestTread_m = 0.1;  // shorter than a foot: not a going
    StairMeasures measures;
    std::vector<double> rises_m;
    for (std::size_t i = 1; i < levels.size(); ++i) {
        if (is_step(levels[i - 1], levels[i]))
            rises_m.push_back(levels[i].height_m - levels[i - 1].height_m);
    }
    measures.riser = repeated(std::move(rises_m));
    measures.uphill = uphill_of(levels);
    std::vector<double> goings_m;
    if (!measures.uphill.isZero()) {
        const Uphill line(surfaces, measures.uphill);
        std::optional<double> last_m;
        for (std::size_t i = 1; i < levels.size(); ++i) {
            const auto riser_m = is_step(levels[i - 1], levels[i])
                                     ? line.riser_m(levels[i - 1], levels[i])
                                     : std::nullopt;
            if (riser_m && last_m && *riser_m - *last_m >= kShortestTread_m &&
                *riser_m - *last_m <= kLongestTread_m)
                goings_m.push_back(*riser_m - *last_m);
            last_m = riser_m;
        }
    }
    measures.going = repeated(std::move(goings_m));
    return measures;
}

std::optional<double> door_width_m(std::span<const Vector3f> points_m, const DoorPlace& door) {
    constexpr double kStrip_m = 0.1;
    constexpr double kLow_m = 0.3;
    constexpr double kHigh_m = 1.8;
    constexpr double kOpen_m = 3.0;
    constexpr double kFace_m = 0.015;  // largest scatter of the points of a jamb due to noise
    const Eigen::Vector2d way(std::cos(door.yaw_rad), std::sin(door.yaw_rad));
    const Eigen::Vector2d left(-way.y(), way.x());
    std::vector<double> sides_m[2];
    for (const Vector3f& p_m : points_m) {
        const double above_m = static_cast<double>(p_m.z()) - door.floor_m;
        const Eigen::Vector2d to_m = p_m.head<2>().cast<double>() - door.middle_m;
        if (above_m < kLow_m || above_m > kHigh_m || std::abs(way.dot(to_m)) > kStrip_m) continue;
        const double aside_m = left.dot(to_m);
        if (std::abs(aside_m) <= kOpen_m)
            sides_m[aside_m > 0.0 ? 0 : 1].push_back(std::abs(aside_m));
    }
    double width_m = 0.0;
    constexpr std::size_t kFewest = 5;
    for (std::vector<double>& side_m : sides_m) {
        if (side_m.size() < kFewest) return std::nullopt;
        const double nearest_m = *std::min_element(side_m.begin(), side_m.end());
        std::erase_if(side_m, [&](double s_m) { return s_m > nearest_m + kFace_m; });
        width_m += upper_median(side_m);
    }
    return width_m;
}

}  // namespace surefoot::eval

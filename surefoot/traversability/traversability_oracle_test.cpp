// SPDX-License-Identifier: Apache-2.0
// The definitions in a slow and direct implementation: distances instead of discs, two passes about
// the mean, an iterative eigen solver.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::traversability {
namespace {

constexpr double kTolerance = 2e-6;       // float ratings, a few roundings each
constexpr double kSlopeTolerance = 1e-3;  // acos near 1 turns one rounding 6e-8 into 3.5e-4 rad

class Oracle {
  public:
    Oracle(const grid::Layer& map, double resolution_m, const TraversabilityConfig& config)
        : map_(map), resolution_m_(resolution_m), config_(config) {}

    /// Empty for unknown cells.
    [[nodiscard]] std::optional<Eigen::Vector3d> normal(int ix, int iy) const {
        if (!known(ix, iy)) return std::nullopt;
        const auto points = points_around(ix, iy, config_.normals.radius_m);
        if (points.size() < 3) return Eigen::Vector3d::UnitZ();
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance(points));
        if (solver.eigenvalues()[1] <= 1e-8) return Eigen::Vector3d::UnitZ();
        const Eigen::Vector3d n = solver.eigenvectors().col(0);
        return n.z() < 0.0 ? Eigen::Vector3d(-n) : n;
    }
    [[nodiscard]] double roughness(int ix, int iy) const {
        const auto n = normal(ix, iy);
        if (!n) return kNan;
        const auto points = points_around(ix, iy, config_.roughness.radius_m);
        if (points.size() < 2) return 0.0;
        const Eigen::Vector3d mean = mean_of(points);
        double sum = 0.0;
        for (const auto& p : points) sum += std::pow(n->dot(p - mean), 2);
        return rating(std::sqrt(sum / static_cast<double>(points.size() - 1)),
                      config_.roughness.critical_m);
    }
    [[nodiscard]] double step(int ix, int iy) const {
        std::vector<double> steps;
        for_each_near(ix, iy, config_.step.second_radius_m, [&](int jx, int jy) {
            if (known(jx, jy)) steps.push_back(step_height(jx, jy));
        });
        if (steps.empty()) return kNan;
        const double highest = *std::max_element(steps.begin(), steps.end());
        const auto n = std::count_if(
            steps.begin(), steps.end(), [&](double s) { return s > config_.step.critical_m; });
        const double share = static_cast<double>(n) / config_.step.critical_cells;
        return rating(std::min(highest, share * highest), config_.step.critical_m);
    }
    [[nodiscard]] static double rating(double value, double critical) {
        return value < critical ? 1.0 - value / critical : 0.0;
    }

  private:
    using Points = std::vector<Eigen::Vector3d>;

    [[nodiscard]] bool known(int ix, int iy) const {
        return map_.contains(ix, iy) && !std::isnan(map_.at(ix, iy));
    }
    template <typename Visit>
    void for_each_near(int ix, int iy, double radius_m, const Visit& visit) const {
        const double limit = std::pow(radius_m / resolution_m_, 2) + 1e-6;
        for (int jy = 0; jy < map_.height(); ++jy) {
            for (int jx = 0; jx < map_.width(); ++jx) {
                if (std::pow(jx - ix, 2) + std::pow(jy - iy, 2) <= limit) visit(jx, jy);
            }
        }
    }
    [[nodiscard]] Points points_around(int ix, int iy, double radius_m) const {
        Points points;
        for_each_near(ix, iy, radius_m, [&](int jx, int jy) {
            if (!known(jx, jy)) return;
            points.emplace_back(
                jx * resolution_m_, jy * resolution_m_, static_cast<double>(map_.at(jx, jy)));
        });
        return points;
    }
    [[nodiscard]] static Eigen::Vector3d mean_of(const Points& points) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const auto& p : points) sum += p;
        return sum / static_cast<double>(points.size());
    }
    [[nodiscard]] static Eigen::Matrix3d covariance(const Points& points) {
        const Eigen::Vector3d mean = mean_of(points);
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        for (const auto& p : points) sum += (p - mean) * (p - mean).transpose();
        return sum / static_cast<double>(points.size());
    }
    [[nodiscard]] double step_height(int ix, int iy) const {
        double lowest = std::numeric_limits<double>::infinity();
        double highest = -lowest;
        for (const auto& p : points_around(ix, iy, config_.step.first_radius_m)) {
            lowest = std::min(lowest, p.z());
            highest = std::max(highest, p.z());
        }
        return static_cast<double>(static_cast<float>(highest - lowest));
    }

    const grid::Layer& map_;
    double resolution_m_;
    const TraversabilityConfig& config_;
};

grid::Layer random_map(int nx, int ny, double hole_share, Rng& rng) {
    grid::Layer map(nx, ny);
    const double slope = rng.uniform(-1.0, 1.0);
    const int edge = static_cast<int>(rng.below(static_cast<std::uint64_t>(nx)));
    for (int iy = 0; iy < ny; ++iy) {
        for (int ix = 0; ix < nx; ++ix) {
            const double height_m = 0.025 * slope * iy + (ix > edge ? 0.17 : 0.0) + 3.0;
            map.at(ix, iy) = rng.uniform() < hole_share
                                 ? std::numeric_limits<float>::quiet_NaN()
                                 : static_cast<float>(height_m + 0.004 * rng.normal());
        }
    }
    return map;
}

void expect_close(float ours, double truth, double tolerance, const char* what, int ix, int iy) {
    if (std::isnan(truth)) {
        ASSERT_TRUE(std::isnan(ours)) << what << ' ' << ix << ' ' << iy << " should be unknown";
    } else {
        ASSERT_NEAR(ours, truth, tolerance) << what << ' ' << ix << ' ' << iy;
    }
}

TEST(TraversabilityOracle, FiltersEqualTheirDefinitionsOnRandomMaps) {
    constexpr std::uint64_t kSeed = 31;
    Rng rng(kSeed);
    Serial serial;
    for (int trial = 0; trial < 12; ++trial) {
        SCOPED_TRACE("seed 31 trial " + std::to_string(trial));
        const double resolution_m = trial % 3 == 0 ? 0.05 : 0.025;
        const TraversabilityConfig config =
            preset(kPresetNames[static_cast<std::size_t>(trial) % 4])->widened_to(resolution_m);
        const grid::Layer map = random_map(23, 17, (trial / 4) % 2 == 0 ? 0.05 : 0.6, rng);
        TraversabilityLayers layers;
        rate(config, map.view(), resolution_m, serial, layers);
        const Oracle oracle(map, resolution_m, config);
        for (int iy = 0; iy < map.height(); ++iy) {
            for (int ix = 0; ix < map.width(); ++ix) {
                const auto n = oracle.normal(ix, iy);
                // Cells on one line in the plan view have an upright plane, whose side is
                // arbitrary.
                const bool upright = n && n->z() < 1e-6;
                const double sign =
                    upright && n->x() * static_cast<double>(layers.normal_x.at(ix, iy)) +
                                       n->y() * static_cast<double>(layers.normal_y.at(ix, iy)) <
                                   0.0
                        ? -1.0
                        : 1.0;
                expect_close(
                    layers.normal_x.at(ix, iy), n ? sign * n->x() : kNan, kTolerance, "nx", ix, iy);
                expect_close(
                    layers.normal_y.at(ix, iy), n ? sign * n->y() : kNan, kTolerance, "ny", ix, iy);
                expect_close(
                    layers.normal_z.at(ix, iy), n ? n->z() : kNan, kTolerance, "nz", ix, iy);
                const double slope_rad = n ? std::acos(std::min(n->z(), 1.0)) : kNan;
                expect_close(layers.slope.at(ix, iy),
                             n ? Oracle::rating(slope_rad, config.slope.critical_rad) : kNan,
                             kSlopeTolerance,
                             "slope",
                             ix,
                             iy);
                expect_close(
                    layers.step.at(ix, iy), oracle.step(ix, iy), kTolerance, "step", ix, iy);
                expect_close(layers.roughness.at(ix, iy),
                             oracle.roughness(ix, iy),
                             2e-5,
                             "roughness",
                             ix,
                             iy);
                if (HasFatalFailure()) return;
            }
        }
    }
}

}  // namespace
}  // namespace surefoot::traversability

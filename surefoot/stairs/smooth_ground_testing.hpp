// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/core/rng.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs::testing {

/// Random ground without a step, defined by a seed: a ramp with a sharp or rounded crease and an
/// optional landing, a plane, a hill or dip, or waves. No point is steeper than `slope_deg`, which
/// is at most 35 deg.
class SmoothGround {
  public:
    enum class Kind { ramp, plane, hill, waves };
    static constexpr int kKinds = 4;
    static constexpr double kSteepest_deg = 35.0;

    explicit SmoothGround(std::uint64_t seed) {
        Rng rng(mix_seed(seed, 0));
        kind = static_cast<Kind>(rng.below(kKinds));
        slope_deg = rng.uniform(0.0, kSteepest_deg);
        way_rad_ = rng.uniform(-std::numbers::pi, std::numbers::pi);
        sign_ = rng.uniform() < 0.5 ? -1.0 : 1.0;
        begin_m_ = rng.uniform(0.2, 1.2);
        length_m_ = rng.uniform() < 0.5 ? 100.0 : rng.uniform(0.6, 2.0);
        round_m_ = rng.uniform() < 0.5 ? 0.0 : rng.uniform(0.1, 0.6);
        size_m_ = rng.uniform(0.5, 1.5);
        middle_m_ = {rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0)};
    }
    Kind kind = Kind::plane;
    double slope_deg = 0.0;

    [[nodiscard]] double at(double x_m, double y_m) const {
        const double slope = sign_ * std::tan(slope_deg * std::numbers::pi / 180.0);
        const double s_m = std::cos(way_rad_) * x_m + std::sin(way_rad_) * y_m;
        switch (kind) {
            case Kind::plane: return slope * s_m;
            case Kind::ramp:
                return slope * (beyond_m(s_m - begin_m_) - beyond_m(s_m - begin_m_ - length_m_));
            case Kind::waves: return slope * size_m_ * std::sin((s_m - begin_m_) / size_m_);
            case Kind::hill: {
                // exp(-r^2 / 2) is steepest at r = 1.
                const double r = (Eigen::Vector2d(x_m, y_m) - middle_m_).norm() / size_m_;
                return slope * size_m_ * std::exp(0.5 * (1.0 - r * r));
            }
        }
        return 0.0;
    }

  private:
    /// max(s, 0) with a bend of `round_m_` instead of the crease.
    [[nodiscard]] double beyond_m(double s_m) const {
        if (round_m_ <= 0.0) return std::max(s_m, 0.0);
        const double inside_m = std::clamp(s_m + 0.5 * round_m_, 0.0, round_m_);
        return 0.5 * inside_m * inside_m / round_m_ + std::max(0.0, s_m - 0.5 * round_m_);
    }
    double way_rad_ = 0.0;
    double sign_ = 1.0;
    double begin_m_ = 0.0;
    double length_m_ = 0.0;
    double round_m_ = 0.0;
    double size_m_ = 1.0;
    Eigen::Vector2d middle_m_ = Eigen::Vector2d::Zero();
};

/// Height errors of `cells` x `cells` cells. They are independent, or correlated like means over
/// squares of side `correlation_m` (0 = independent).
inline grid::Layer height_errors(
    int cells, double cell_m, double sigma_m, double correlation_m, std::uint64_t seed) {
    grid::Layer errors_m(cells, cells, 0.0F);
    if (!(sigma_m > 0.0)) return errors_m;
    Rng rng(mix_seed(seed, 1));
    for (std::size_t i = 0; i < errors_m.size(); ++i)
        errors_m.data()[i] = static_cast<float>(sigma_m * rng.normal());
    if (!(correlation_m > 0.0)) return errors_m;
    const int reach = std::max(1, static_cast<int>(std::lround(0.5 * correlation_m / cell_m)));
    for (const bool rows : {true, false}) {
        const grid::Layer from = errors_m;
        for (int iy = 0; iy < cells; ++iy) {
            for (int ix = 0; ix < cells; ++ix) {
                double sum = 0.0;
                for (int k = -reach; k <= reach; ++k)
                    sum += static_cast<double>(from.at(rows ? (ix + k + cells) % cells : ix,
                                                       rows ? iy : (iy + k + cells) % cells));
                errors_m.at(ix, iy) = static_cast<float>(sum / std::sqrt(2.0 * reach + 1.0));
            }
        }
    }
    return errors_m;
}

/// A map of 6 x 6 m about the origin, cells of 25 mm: the heights at the cell centres plus errors.
/// The stance is at the origin.
class SmoothMap {
  public:
    SmoothMap(const SmoothGround& ground,
              double sigma_m,
              double correlation_m,
              bool states_variance,
              std::uint64_t seed)
        : height_m_(height_errors(kCells, kCell_m, sigma_m, correlation_m, seed)),
          var_m2_(kCells, kCells, 0.0F) {
        geometry_ = {kCell_m, kCells, kCells, Eigen::Vector2d::Constant(-0.5 * kCells * kCell_m)};
        for (int iy = 0; iy < kCells; ++iy) {
            for (int ix = 0; ix < kCells; ++ix) {
                const Eigen::Vector2d p_m = geometry_.center_m({ix, iy});
                height_m_.at(ix, iy) += static_cast<float>(ground.at(p_m.x(), p_m.y()));
            }
        }
        if (states_variance) var_m2_.fill(static_cast<float>(sigma_m * sigma_m));
    }
    [[nodiscard]] Terrain terrain() const {
        Terrain terrain;
        terrain.geometry = geometry_;
        terrain.height_m = height_m_.view();
        terrain.height_var_m2 = var_m2_.view();
        return terrain;
    }

  private:
    static constexpr int kCells = 240;
    static constexpr double kCell_m = 0.025;

    grid::GridGeometry geometry_;
    grid::Layer height_m_;
    grid::Layer var_m2_;
};

}  // namespace surefoot::stairs::testing

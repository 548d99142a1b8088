// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/rating_confidence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::traversability {
namespace {

constexpr double kResolution_m = 0.025;

double plain_cdf(double z) {
    return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

struct Rated {
    TraversabilityLayers rating;
    grid::Layer step_height_m;
    ConfidenceLayers confidence;
};

Rated rate(const TraversabilityConfig& config, const grid::Layer& map, const grid::Layer& var_m2) {
    Rated out;
    Serial serial;
    Traversability rater(config);
    rater.rate(map.view(), kResolution_m, serial, out.rating);
    RatingConfidence(config, kResolution_m)
        .compute({map.view(), var_m2.view(), rater.rated_step_heights(), out.rating},
                 out.confidence);
    out.step_height_m = grid::Layer(map.width(), map.height());
    for (int iy = 0; iy < map.height(); ++iy)
        for (int ix = 0; ix < map.width(); ++ix)
            out.step_height_m.at(ix, iy) = *rater.rated_step_heights().cell(ix, iy);
    return out;
}

/// Calls f for every known cell within a disc around (ix, iy).
template <typename F>
void for_disc(const grid::Layer& map, double radius_m, int ix, int iy, const F& f) {
    const double limit = std::pow(radius_m / kResolution_m, 2) + 1e-6;
    for (int v = 0; v < map.height(); ++v)
        for (int u = 0; u < map.width(); ++u)
            if ((u - ix) * (u - ix) + (v - iy) * (v - iy) <= limit && !std::isnan(map.at(u, v)))
                f(u, v);
}

int cells_of(double radius_m) {
    int n = 0;
    for_disc(grid::Layer(41, 41, 0.0F), radius_m, 20, 20, [&](int, int) { ++n; });
    return n;
}

/// The definition in rating_confidence.hpp, in double and cell by cell.
class Plain {
  public:
    Plain(const TraversabilityConfig& config,
          const grid::Layer& map,
          const grid::Layer& var_m2,
          const Rated& rated)
        : c_(config), map_(map), var_m2_(var_m2), rated_(rated) {
        const grid::Layer all(41, 41, 0.0F);
        for_disc(all, c_.normals.radius_m, 20, 20, [&](int u, int) {
            moment_m2_ += std::pow((u - 20) * kResolution_m, 2);
        });
        moment_m2_ /= cells_of(c_.normals.radius_m);
    }

    [[nodiscard]] double smallest_step_m(int ix, int iy) const {
        const Mean v = mean_variance(c_.resolve.radius_m, ix, iy);
        return 3.4 * std::sqrt(v.m2 / std::min(v.n, c_.confidence.independent_cells));
    }

    [[nodiscard]] double confidence(int ix, int iy, double range) const {
        const Mean v = mean_variance(c_.normals.radius_m, ix, iy);
        const double k = std::min(v.n, c_.confidence.independent_cells);
        const double share = static_cast<double>(v.n) / cells_of(c_.normals.radius_m);
        const TraversabilityLayers& r = rated_.rating;
        const double sum = c_.weights.slope + c_.weights.step + c_.weights.roughness;
        const auto value = [&](const grid::Layer& layer) {
            return static_cast<double>(layer.at(ix, iy));
        };
        const double nz = value(r.normal_z), t = value(r.step);
        const double slope =
            nz * nz * std::sqrt(2 * v.m2 / (k * moment_m2_)) / share / c_.slope.critical_rad;
        const double rough =
            std::sqrt(v.m2 * (1 + 1.5 / std::max(k - 1, 1.0))) / c_.roughness.critical_m;
        const double step = (1 - t) * (range + 0.87) * std::sqrt(v.m2) / c_.step.critical_m;
        const double sigma =
            (c_.weights.slope * slope + c_.weights.step * step + c_.weights.roughness * rough) /
            sum;
        const double mean = (c_.weights.slope * value(r.slope) + c_.weights.step * t +
                             c_.weights.roughness * value(r.roughness)) /
                            sum;
        const double margin = mean - c_.confidence.safe_threshold;
        double right = plain_cdf(std::abs(margin) / sigma) - flips(ix, iy, range);
        if (c_.combine == Combine::zero_dominates && margin >= 0) {
            right -= plain_cdf(-value(r.slope) / slope);
            right -= plain_cdf(-value(r.roughness) / rough);
        }
        right = std::max(right, 0.0);
        const bool by_zero = r.traversability.at(ix, iy) == 0.0F;
        if (by_zero && std::isnan(mean)) return 0.5;
        return by_zero && margin >= 0 ? std::min(right, 0.5) : right;
    }

  private:
    struct Mean {
        double m2 = 0.0;
        int n = 0;
    };
    [[nodiscard]] Mean mean_variance(double radius_m, int ix, int iy) const {
        Mean mean;
        for_disc(map_, radius_m, ix, iy, [&](int u, int v) {
            const auto v_m2 = static_cast<double>(var_m2_.at(u, v));
            mean.m2 += (std::floor(1e9 * (v_m2 < 0.1 ? v_m2 : 0.1)) + 1.0) * 1e-9;
            ++mean.n;
        });
        mean.m2 /= mean.n;
        return mean;
    }
    [[nodiscard]] double flips(int ix, int iy, double range) const {
        double sum = 0.0;
        for_disc(rated_.step_height_m, c_.step.second_radius_m, ix, iy, [&](int u, int v) {
            const double sigma = std::sqrt(mean_variance(c_.normals.radius_m, u, v).m2);
            const double over =
                static_cast<double>(rated_.step_height_m.at(u, v)) - c_.step.critical_m;
            sum += over > 0 ? plain_cdf(-(over / sigma - range) / 0.87)
                            : plain_cdf(over / sigma / std::sqrt(2.0));
        });
        return sum;
    }

    const TraversabilityConfig& c_;
    const grid::Layer& map_;
    const grid::Layer& var_m2_;
    const Rated& rated_;
    double moment_m2_ = 0.0;
};

/// Slopes, steps about critical and roughness, so that ratings lie on both sides of 0.8.
grid::Layer terrain(int side, Rng& rng) {
    grid::Layer map(side, side);
    const double slope = rng.uniform(0.0, 0.7), turn = rng.uniform(0.0, 6.3);
    const double step_m = rng.below(2) == 0 ? 0.0 : rng.uniform(0.05, 0.2);
    const double rough_m = rng.below(2) == 0 ? 0.0 : rng.uniform(0.0, 0.03);
    const int edge = static_cast<int>(rng.below(static_cast<std::uint64_t>(side)));
    for (int iy = 0; iy < side; ++iy)
        for (int ix = 0; ix < side; ++ix)
            map.at(ix, iy) = static_cast<float>(
                slope * kResolution_m * (ix * std::cos(turn) + iy * std::sin(turn)) +
                (ix > edge ? step_m : 0.0) + rough_m * rng.normal());
    return map;
}

std::vector<TraversabilityConfig> configs() {
    std::vector<TraversabilityConfig> all{{}, *preset("rex_zed"), *preset("laser")};
    all.push_back(all[0]);
    all.back().confidence.independent_cells = 1000;
    all.back().weights.step = 3.0;
    return all;
}

/// Tippett's table at the first discs of `configs`: 21, 29 and 49 cells.
double range_of(const TraversabilityConfig& config) {
    const int n = cells_of(config.step.first_radius_m);
    return n <= 20 ? 3.735 : n <= 30 ? 4.086 : 4.639;
}

TEST(RatingConfidence, IsWhatTheDefinitionSays) {
    constexpr std::uint64_t kSeed = 3;
    constexpr int kSide = 28;
    Rng rng(kSeed);
    int between = 0, hidden = 0, plain_half = 0;
    for (int round = 0; round < 24; ++round) {
        const auto all = configs();
        const TraversabilityConfig& config = all[static_cast<std::size_t>(round) % all.size()];
        grid::Layer map = terrain(kSide, rng);
        grid::Layer var_m2(kSide, kSide);
        const double sigma_m = rng.uniform(0.001, 0.015);
        for (std::size_t i = 0; i < map.size(); ++i) {
            var_m2.data()[i] = static_cast<float>(std::pow(sigma_m * rng.uniform(0.5, 1.5), 2));
            if (rng.uniform() < 0.002) var_m2.data()[i] = std::numeric_limits<float>::infinity();
            if (rng.uniform() < 0.1) map.data()[i] = kNanF;
        }
        const Rated rated = rate(config, map, var_m2);
        const Plain plain(config, map, var_m2, rated);
        for (int iy = 0; iy < kSide; ++iy) {
            for (int ix = 0; ix < kSide; ++ix) {
                const auto where = testing::Message() << round << ": " << ix << " " << iy;
                const float confidence = rated.confidence.confidence.at(ix, iy);
                const float rating = rated.rating.traversability.at(ix, iy);
                ASSERT_EQ(std::isnan(confidence), std::isnan(rating)) << where;
                const float smallest_m = rated.confidence.smallest_step_m.at(ix, iy);
                ASSERT_EQ(std::isnan(smallest_m), std::isnan(map.at(ix, iy))) << where;
                if (!std::isnan(confidence)) {
                    // Cumulated roundings of 6e-8 in up to 29 flips and sigmas up to 6.
                    const double expected = plain.confidence(ix, iy, range_of(config));
                    ASSERT_NEAR(confidence, expected, 2e-5) << where;
                    between += confidence > 0.1F && confidence < 0.9F && confidence != 0.5F;
                    plain_half += confidence == 0.5F;
                }
                if (std::isnan(smallest_m)) continue;
                // A few roundings of 6e-8.
                ASSERT_NEAR(
                    static_cast<double>(smallest_m) / plain.smallest_step_m(ix, iy), 1.0, 1e-6)
                    << where;
                const float flag = rated.confidence.not_resolvable.at(ix, iy);
                ASSERT_EQ(flag, smallest_m > 0.010F ? 1.0F : 0.0F) << where;
                hidden += flag == 1.0F;
            }
        }
    }
    EXPECT_GT(between, 500);
    EXPECT_GT(hidden, 500);
    EXPECT_GT(plain_half, 20) << "the zero rule alone decides somewhere";
}

TEST(RatingConfidence, OneOfTheGatesPatchesIsResolvableUpToThreeMillimetres) {
    TraversabilityConfig config;
    config.confidence.independent_cells = 1;
    const grid::Layer map(20, 20, 0.3F);
    const auto flag = [&](float sigma_m) {
        const Rated rated = rate(config, map, grid::Layer(20, 20, sigma_m * sigma_m));
        return rated.confidence.not_resolvable.at(10, 10);
    };
    EXPECT_EQ(flag(0.0029F), 0.0F);
    EXPECT_EQ(flag(0.0030F), 1.0F);
    config.confidence.independent_cells = 4;
    EXPECT_EQ(flag(0.0058F), 0.0F);
    EXPECT_EQ(flag(0.0060F), 1.0F);
    config.resolve.step_m = 0.020;
    EXPECT_EQ(flag(0.0060F), 0.0F);
}

TEST(RatingConfidence, NoiseLooksLikeTheSmallestStepInSevenOfTenThousandPatches) {
    constexpr std::uint64_t kSeed = 17;
    constexpr int kSide = 300;
    constexpr float kSigma_m = 0.004F;
    Rng rng(kSeed);
    TraversabilityConfig config;
    config.confidence.independent_cells = 5;  // cell by cell a fresh error, as drawn here
    std::int64_t above = 0, patches = 0;
    for (int round = 0; round < 8; ++round) {
        grid::Layer map(kSide, kSide);
        for (std::size_t i = 0; i < map.size(); ++i)
            map.data()[i] = kSigma_m * static_cast<float>(rng.normal());
        const Rated rated = rate(config, map, grid::Layer(kSide, kSide, kSigma_m * kSigma_m));
        for (int iy = 2; iy + 2 < kSide; iy += 3) {  // patches that share no cell
            for (int ix = 2; ix + 2 < kSide; ix += 3) {
                const float mean_m = (map.at(ix, iy) + map.at(ix - 1, iy) + map.at(ix + 1, iy) +
                                      map.at(ix, iy - 1) + map.at(ix, iy + 1)) /
                                     5.0F;
                ++patches;
                above += std::abs(mean_m) > rated.confidence.smallest_step_m.at(ix, iy);
            }
        }
    }
    // Both sides of 3.4 sigma: 6.74e-4. The count is Poisson distributed; the limit is three of its
    // deviations.
    const double expected = 6.74e-4 * static_cast<double>(patches);
    EXPECT_NEAR(static_cast<double>(above), expected, 3.0 * std::sqrt(expected)) << patches;
    EXPECT_GT(expected, 30.0);
}

/// Shares of cells with the true rating on the measured side, by confidence in tenths.
struct Calibration {
    std::array<std::int64_t, 10> cells{};
    std::array<double, 10> claimed{};
    std::array<std::int64_t, 10> right{};

    void add(double confidence, bool same_side) {
        const auto bin = static_cast<std::size_t>(std::clamp(confidence * 10.0, 0.0, 9.0));
        ++cells[bin];
        claimed[bin] += confidence;
        right[bin] += same_side;
    }
};

TEST(RatingConfidence, IsNotMoreThanTheShareOfCellsThatAreRight) {
    constexpr std::uint64_t kSeed = 29;
    constexpr int kSide = 40;
    for (const TraversabilityConfig& config : configs()) {
        Rng rng(kSeed);
        Calibration calibration;
        for (int round = 0; round < 400; ++round) {
            const grid::Layer truth = terrain(kSide, rng);
            const double sigma_m = rng.uniform(0.001, 0.02);
            grid::Layer measured = truth;
            for (std::size_t i = 0; i < measured.size(); ++i)
                measured.data()[i] += static_cast<float>(sigma_m * rng.normal());
            const grid::Layer var_m2(kSide, kSide, static_cast<float>(sigma_m * sigma_m));
            const Rated seen = rate(config, measured, var_m2);
            const Rated is = rate(config, truth, var_m2);
            for (std::size_t i = 0; i < truth.size(); ++i) {
                const auto safe = [&](const Rated& r) {
                    return static_cast<double>(r.rating.traversability.data()[i]) >= 0.8;
                };
                calibration.add(static_cast<double>(seen.confidence.confidence.data()[i]),
                                safe(seen) == safe(is));
            }
        }
        for (std::size_t bin = 0; bin < 10; ++bin) {
            const auto n = static_cast<double>(calibration.cells[bin]);
            if (n < 2000) continue;  // neighbours share errors: about 40 independent cells
            const double claimed = calibration.claimed[bin] / n;
            const double right = static_cast<double>(calibration.right[bin]) / n;
            EXPECT_GE(right, claimed) << bin << " of ten, " << n << " cells";
        }
    }
}

TEST(RatingConfidence, FlatGroundIsSureAndNoiseTakesItAway) {
    const grid::Layer map(40, 40, 0.0F);
    const auto middle = [&](float sigma_m) {
        const Rated rated = rate({}, map, grid::Layer(40, 40, sigma_m * sigma_m));
        return rated.confidence.confidence.at(20, 20);
    };
    EXPECT_GT(middle(0.003F), 0.999F);
    EXPECT_GT(middle(0.006F), middle(0.012F));
    EXPECT_GT(middle(0.012F), middle(0.03F));
    EXPECT_LT(middle(0.03F), 0.8F);
}

TEST(RatingConfidence, NormalDistributionIsThatOfTheLibrary) {
    for (int i = -6000; i <= 6000; ++i) {
        const float z = 0.001F * static_cast<float>(i);
        // Error budget: 1.5e-7 of the polynomial. One rounding of 6e-8 before four squarings and
        // one after each give 31 roundings, of a tail of at most 1/2. One more rounding applies
        // near 1.
        EXPECT_NEAR(normal_cdf(z), plain_cdf(static_cast<double>(z)), 1.2e-6) << z;
    }
    EXPECT_EQ(normal_cdf(40.0F), 1.0F);
    EXPECT_LT(normal_cdf(-40.0F), 2e-9F);
    EXPECT_TRUE(std::isnan(normal_cdf(kNanF)));
}

}  // namespace
}  // namespace surefoot::traversability

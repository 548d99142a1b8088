// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/foothold.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::traversability {
namespace {

constexpr double kCell_m = 0.025;
constexpr int kSide = 60;

/// A map of kSide x kSide cells with a height for every cell.
struct Map {
    Image<float> height_m{kSide, kSide, 0.0F};
    Image<float> var_m2{kSide, kSide, 0.0F};
    Image<float> clearance_m{kSide, kSide, kNanF};
    Image<float> free_above_m{kSide, kSide, kNanF};
    Image<float> reach_m{kSide, kSide, 0.0F};
    Image<std::uint32_t> observations{kSide, kSide, 2U};

    template <typename F>
    explicit Map(const F& height) {
        for (int iy = 0; iy < kSide; ++iy)
            for (int ix = 0; ix < kSide; ++ix) height_m.at(ix, iy) = static_cast<float>(height(ix));
    }
    [[nodiscard]] FootholdGround ground() const {
        return {height_m.view(),
                var_m2.view(),
                clearance_m.view(),
                free_above_m.view(),
                reach_m.view(),
                kCell_m,
                observations.view()};
    }
    void forget_from(int column) {
        for (int iy = 0; iy < kSide; ++iy)
            for (int ix = column; ix < kSide; ++ix) height_m.at(ix, iy) = kNanF;
    }
};

/// F reaches 9 cells and B 13: margin of one cell, nothing for corners.
FootholdConfig narrow() {
    FootholdConfig config;
    config.margin_m = 0.025;
    config.corner_m = 0.0;
    return config;
}

Image<Foothold> found(const Map& map, const FootholdConfig& config = narrow()) {
    Image<Foothold> out;
    FootholdFinder(config).find(map.ground(), serial(), out);
    return out;
}

/// Returns the result in the middle row of a map with equal rows.
Foothold at(const Map& map, int ix, const FootholdConfig& config = narrow()) {
    return found(map, config).at(ix, kSide / 2);
}

/// The documented rules, for one cell.
class Oracle {
  public:
    Oracle(const FootholdConfig& config, const FootholdGround& ground) : c_(config), g_(ground) {}

    [[nodiscard]] Foothold judge(int cx, int cy) const {
        if (!known(cx, cy)) return Foothold::unknown;
        const double foot_m = c_.foot_radius_m + c_.margin_m;
        const double foot = foot_m / g_.resolution_m;
        const double band = (foot_m + c_.band_m) / g_.resolution_m;
        const int reach = static_cast<int>(std::ceil(band));
        double n = 0, sum = 0, xz = 0, yz = 0, xx = 0, var = 0;
        bool foot_known = true;
        bool band_known = true;
        int tight = 0;
        int tight_near = 0;
        for (int dy = -reach; dy <= reach; ++dy) {
            for (int dx = -reach; dx <= reach; ++dx) {
                if (!within(dx, dy, band)) continue;
                const bool is_known = known(cx + dx, cy + dy);
                band_known = band_known && is_known;
                if (is_known && clearance(cx + dx, cy + dy) < c_.clearance_m) ++tight_near;
                if (!within(dx, dy, foot)) continue;
                foot_known = foot_known && is_known;
                if (!is_known) continue;
                const double z = height(cx + dx, cy + dy);
                n += 1;
                sum += z;
                xz += dx * z;
                yz += dy * z;
                xx += dx * dx;
                var += variance(cx + dx, cy + dy);
                tight += clearance(cx + dx, cy + dy) < c_.clearance_m ? 1 : 0;
            }
        }
        const double k = c_.sigma_factor;
        const double middle =
            foot_known ? sum / n : height(cx, cy) - k * std::sqrt(variance(cx, cy));
        bool deep = false;
        bool perhaps_deep = false;
        for (int dy = -reach; dy <= reach; ++dy) {
            for (int dx = -reach; dx <= reach; ++dx) {
                const int x = cx + dx;
                const int y = cy + dy;
                if (!within(dx, dy, band) || !inside(x, y)) continue;
                if (!known(x, y)) {
                    deep = deep || middle - free_above(x, y) > c_.drop_m;
                    continue;
                }
                const double z = height(x, y);
                const double doubt = k * std::sqrt(variance(x, y));
                deep = deep || (g_.observations.at(x, y) > 1 && middle - (z + doubt) > c_.drop_m);
                perhaps_deep = perhaps_deep || middle - (z - doubt) > c_.drop_m;
            }
        }
        if (deep) return Foothold::drop;
        if (!foot_known || !band_known) return Foothold::unknown;
        const double ax = xz / xx / g_.resolution_m;
        const double ay = yz / xx / g_.resolution_m;
        const double slope = std::hypot(ax, ay);
        const double errors =
            std::max(1.0, M_PI * foot_m * foot_m / (c_.correlation_m * c_.correlation_m));
        const double doubt = k * std::sqrt(var / n) / (0.5 * foot_m * std::sqrt(errors));
        if (slope - doubt > c_.max_slope) return Foothold::tilted;
        const auto [rough, perhaps_rough] = patches(cx, cy, foot, middle, ax, ay);
        if (rough) return Foothold::rough;
        const double side = c_.overhead_side_m / g_.resolution_m;
        if (tight >= std::max(1.0, std::round(side * side))) return Foothold::low;
        if (tight_near > 0 || perhaps_rough || perhaps_deep || slope + doubt > c_.max_slope)
            return Foothold::unsure;
        if (drop_begins(cx, cy, middle, slope)) return Foothold::unsure;
        if (slope > 0.5 * c_.max_slope && tilts(cx, cy)) return Foothold::unsure;
        return std::isnan(g_.reach_step_m.at(cx, cy)) ? Foothold::unreachable : Foothold::safe;
    }

  private:
    [[nodiscard]] double height(int x, int y) const { return read(g_.height_m, x, y); }
    [[nodiscard]] double variance(int x, int y) const { return read(g_.height_var_m2, x, y); }
    [[nodiscard]] double clearance(int x, int y) const { return read(g_.clearance_m, x, y); }
    [[nodiscard]] double free_above(int x, int y) const { return read(g_.free_above_m, x, y); }
    static double read(ImageView<const float> layer, int x, int y) {
        return static_cast<double>(layer.at(x, y));
    }
    static bool within(int dx, int dy, double radius) {
        return dx * dx + dy * dy <= radius * radius + 1e-6;
    }
    [[nodiscard]] bool drop_begins(int cx, int cy, double middle, double slope) const {
        if (c_.corner_m == 0.0) return false;
        const double near_m = c_.foot_radius_m + c_.margin_m + c_.band_m + c_.corner_m;
        const double near = near_m / g_.resolution_m;
        const int reach = static_cast<int>(std::ceil(near));
        for (int y = cy - reach; y <= cy + reach; ++y) {
            for (int x = cx - reach; x <= cx + reach; ++x) {
                if (!within(x - cx, y - cy, near) || !inside(x, y)) continue;
                if (known(x, y) && g_.observations.at(x, y) < 2) continue;
                const double shown =
                    known(x, y) ? height(x, y) + c_.sigma_factor * std::sqrt(variance(x, y))
                                : free_above(x, y);
                if (middle - slope * near_m - shown > 0.5 * c_.drop_m) return true;
            }
        }
        return false;
    }
    /// Least squares by normal equations over the cells under the foot, yaw by yaw.
    [[nodiscard]] bool tilts(int cx, int cy) const {
        const double half_width = 0.5 * c_.foot_width_m;
        const double half_length =
            std::sqrt(c_.foot_radius_m * c_.foot_radius_m - half_width * half_width);
        for (int yaw = 0; yaw < 8; ++yaw) {
            Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
            Eigen::Vector3d right = Eigen::Vector3d::Zero();
            const Eigen::Rotation2Dd turned(M_PI * yaw / 8);
            for (int dy = -10; dy <= 10; ++dy) {
                for (int dx = -10; dx <= 10; ++dx) {
                    const Eigen::Vector2d at(dx * g_.resolution_m, dy * g_.resolution_m);
                    const Eigen::Vector2d in_foot = turned.inverse() * at;
                    if (std::abs(in_foot.x()) > half_length + 1e-9 ||
                        std::abs(in_foot.y()) > half_width + 1e-9) {
                        continue;
                    }
                    const Eigen::Vector3d row(at.x(), at.y(), 1.0);
                    normal += row * row.transpose();
                    right += height(cx + dx, cy + dy) * row;
                }
            }
            const Eigen::Vector3d plane = normal.inverse() * right;
            if (plane.head<2>().norm() > c_.max_slope) return true;
        }
        return false;
    }
    [[nodiscard]] bool inside(int x, int y) const {
        return x >= 0 && y >= 0 && x < g_.height_m.width && y < g_.height_m.height;
    }
    [[nodiscard]] bool known(int x, int y) const {
        return inside(x, y) && std::isfinite(height(x, y));
    }
    [[nodiscard]] std::pair<bool, bool> patches(
        int cx, int cy, double foot, double middle, double ax, double ay) const {
        const int side =
            std::max(1, static_cast<int>(std::lround(c_.patch_side_m / g_.resolution_m)));
        const int reach = static_cast<int>(std::ceil(foot));
        bool rough = false;
        bool perhaps = false;
        for (int dy = -reach; dy <= reach; ++dy) {
            for (int dx = -reach; dx <= reach; ++dx) {
                double z = 0;
                double var = 0;
                bool all = true;
                for (int i = 0; i < side * side; ++i) {
                    const int x = dx + i % side;
                    const int y = dy + i / side;
                    all = all && within(x, y, foot);
                    if (!all) break;
                    z += height(cx + x, cy + y);
                    var += variance(cx + x, cy + y);
                }
                if (!all) continue;
                const double cells = side * side;
                const double plane =
                    middle +
                    (ax * (dx + 0.5 * (side - 1)) + ay * (dy + 0.5 * (side - 1))) * g_.resolution_m;
                const double residual = std::abs(z / cells - plane);
                const double doubt = c_.sigma_factor *
                                     std::sqrt(var / cells / std::min(cells, c_.independent_cells));
                rough = rough || residual - doubt > c_.max_residual_m;
                perhaps = perhaps || residual + doubt > c_.max_residual_m;
            }
        }
        return {rough, perhaps};
    }

    const FootholdConfig& c_;
    const FootholdGround& g_;
};

TEST(Foothold, FloorIsSafeAsFarAsAllOfItIsKnown) {
    const Image<Foothold> holds = found(Map([](int) { return -1.7; }));
    for (int i = 0; i < kSide; ++i) {
        const bool known = i >= 13 && i < kSide - 13;
        EXPECT_EQ(holds.at(i, kSide / 2), known ? Foothold::safe : Foothold::unknown) << i;
        EXPECT_EQ(holds.at(kSide / 2, i), known ? Foothold::safe : Foothold::unknown) << i;
    }
    Map hole([](int) { return 0.0; });
    hole.height_m.at(30, 30) = kNanF;
    EXPECT_EQ(found(hole).at(30, 30 + 13), Foothold::unknown);
    EXPECT_EQ(found(hole).at(30, 30 + 14), Foothold::safe);
}

TEST(Foothold, AStepDownIsADropAsFarAsTheBandReaches) {
    const Map edge([](int ix) { return ix < 30 ? 0.0 : -0.17; });
    EXPECT_EQ(at(edge, 30 - 14), Foothold::safe);
    for (int ix = 30 - 13; ix < 30; ++ix) EXPECT_EQ(at(edge, ix), Foothold::drop) << ix;
    // On the lower side, the step blocks the foot but not the band.
    EXPECT_EQ(at(edge, 30 + 10), Foothold::safe);
    EXPECT_NE(at(edge, 30 + 8), Foothold::safe);
    const Map kerb([](int ix) { return ix < 30 ? 0.0 : -0.04; });
    EXPECT_EQ(at(kerb, 30 - 10), Foothold::safe);
    EXPECT_EQ(at(kerb, 30 - 2), Foothold::tilted);
}

TEST(Foothold, LinesOfSightShowADropThatIsNeverSeen) {
    Map edge([](int) { return 0.0; });
    edge.forget_from(30);
    EXPECT_EQ(at(edge, 30 - 8), Foothold::unknown);
    for (int iy = 0; iy < kSide; ++iy)
        for (int ix = 30; ix < kSide; ++ix)
            edge.free_above_m.at(ix, iy) = -0.024F * static_cast<float>(ix - 29);
    // Two cells behind the edge the line of sight is 0.05 m deep, and one cell farther it is
    // deeper.
    EXPECT_EQ(at(edge, 32 - 13), Foothold::drop);
    EXPECT_EQ(at(edge, 30 - 1), Foothold::drop);
    EXPECT_EQ(at(edge, 32 - 14), Foothold::unknown);
    EXPECT_EQ(at(edge, 30 - 14), Foothold::safe);
}

TEST(Foothold, RampsUpToSixDegrees) {
    EXPECT_EQ(at(Map([](int ix) { return ix * kCell_m / 12.0; }), 30), Foothold::safe);
    EXPECT_EQ(at(Map([](int ix) { return ix * kCell_m / 8.0; }), 30), Foothold::tilted);
    Map across([](int) { return 0.0; });
    for (int iy = 0; iy < kSide; ++iy)
        for (int ix = 0; ix < kSide; ++ix)
            across.height_m.at(ix, iy) = static_cast<float>(-iy * kCell_m / 9.0);
    EXPECT_EQ(at(across, 30), Foothold::tilted);
}

TEST(Foothold, ANarrowFootTiltsWhereARampBegins) {
    const auto ramp = [](double run) {
        return [run](int ix) { return std::max(0, ix - 29) * kCell_m / run; };
    };
    FootholdConfig wide = narrow();
    wide.foot_width_m = 0.29;  // square, almost as large as the disc
    int narrow_alone = 0;
    for (int ix = 14; ix < kSide - 14; ++ix) {
        EXPECT_EQ(at(Map(ramp(12.0)), ix), Foothold::safe) << ix;
        const Foothold found = at(Map(ramp(8.0)), ix);
        const Foothold found_wide = at(Map(ramp(8.0)), ix, wide);
        // A foot across the beginning of the ramp: least squares over 0.19 m, of which a smaller
        // part is flat.
        EXPECT_EQ(found == Foothold::safe, ix <= 30) << ix;
        narrow_alone += found == Foothold::unsure && found_wide == Foothold::safe ? 1 : 0;
    }
    EXPECT_GE(narrow_alone, 1);
}

TEST(Foothold, WhereADropBeginsBeyondTheBandNothingIsSure) {
    const auto pit = [](float depth_m) {
        Map map([](int) { return 0.0; });
        for (int iy = 40; iy < kSide; ++iy)
            for (int ix = 40; ix < kSide; ++ix) map.height_m.at(ix, iy) = -depth_m;
        return map;
    };
    FootholdConfig corners = narrow();
    corners.corner_m = 0.075;  // three cells
    // On the diagonal through the corner, the pit is (40 - i) cells away along each axis.
    for (const auto& [i, with, without] : {std::tuple(40 - 9, Foothold::drop, Foothold::drop),
                                           std::tuple(40 - 10, Foothold::unsure, Foothold::safe),
                                           std::tuple(40 - 11, Foothold::unsure, Foothold::safe),
                                           std::tuple(40 - 12, Foothold::safe, Foothold::safe)}) {
        EXPECT_EQ(found(pit(0.25F), corners).at(i, i), with) << i;
        EXPECT_EQ(found(pit(0.25F)).at(i, i), without) << i;
    }
    // Half a drop counts. A smaller drop does not count, and an uncertain one does not count
    // either.
    EXPECT_EQ(found(pit(0.026F), corners).at(30, 30), Foothold::unsure);
    EXPECT_EQ(found(pit(0.024F), corners).at(30, 30), Foothold::safe);
    Map unsure = pit(0.035F);
    unsure.var_m2.at(40, 40) = 0.004F * 0.004F;
    EXPECT_EQ(found(unsure, corners).at(29, 29), Foothold::safe);
    // Within the corner distance, a ramp of 1:12 falls by 31 mm.
    EXPECT_EQ(at(Map([](int ix) { return -ix * kCell_m / 12.0; }), 30, corners), Foothold::safe);
}

TEST(Foothold, ABumpUnderTheFootIsRough) {
    Map bump([](int) { return 0.0; });
    for (int i = 0; i < 4; ++i) bump.height_m.at(30 + i % 2, 30 + i / 2) = 0.03F;
    EXPECT_EQ(found(bump).at(30, 30), Foothold::rough);
    EXPECT_EQ(found(bump).at(30 - 8, 30), Foothold::rough);
    EXPECT_EQ(found(bump).at(30 - 10, 30), Foothold::safe);
    // A single cell is a quarter of a patch.
    Map peak([](int) { return 0.0; });
    peak.height_m.at(30, 30) = 0.06F;
    EXPECT_EQ(found(peak).at(30, 30), Foothold::safe);
}

TEST(Foothold, WhatCannotBeToldIsUnsure) {
    Map floor([](int) { return 0.0; });
    std::fill_n(floor.var_m2.data(), floor.var_m2.size(), 0.02F * 0.02F);
    EXPECT_EQ(at(floor, 30), Foothold::unsure);
    FootholdConfig careless = narrow();
    careless.sigma_factor = 1.0;
    EXPECT_EQ(at(floor, 30, careless), Foothold::safe);
    std::fill_n(floor.var_m2.data(), floor.var_m2.size(), 0.003F * 0.003F);
    EXPECT_EQ(at(floor, 30), Foothold::safe);
}

TEST(Foothold, UnderATableThereIsNoRoom) {
    Map table([](int) { return 0.0; });
    const auto hang = [&](float clearance_m) {
        for (const int ix : {30, 31})
            for (const int iy : {30, 31}) table.clearance_m.at(ix, iy) = clearance_m;
    };
    hang(0.7F);
    EXPECT_EQ(found(table).at(31 + 8, 30), Foothold::low);
    // The rim of the table may lie farther than observed: narrow() has a band of four cells.
    EXPECT_EQ(found(table).at(31 + 10, 30), Foothold::unsure);
    EXPECT_EQ(found(table).at(31 + 14, 30), Foothold::safe);
    hang(2.06F);
    EXPECT_EQ(found(table).at(30, 30), Foothold::safe);
}

TEST(Foothold, UnderLessThanASquareOfWhatHangsNothingIsSure) {
    Map floor([](int) { return 0.0; });
    floor.clearance_m.at(30, 30) = 0.7F;
    floor.clearance_m.at(31, 30) = 0.7F;
    floor.clearance_m.at(32, 30) = 0.7F;
    EXPECT_EQ(found(floor).at(30, 30), Foothold::unsure);
    EXPECT_EQ(found(floor).at(32 + 13, 30), Foothold::unsure);
    EXPECT_EQ(found(floor).at(32 + 14, 30), Foothold::safe);
    // A cable across the foot.
    floor.clearance_m.at(33, 30) = 0.7F;
    EXPECT_EQ(found(floor).at(30, 30), Foothold::low);
    FootholdConfig strict = narrow();
    strict.overhead_side_m = 0.0;
    floor.clearance_m.at(31, 30) = kNanF;
    EXPECT_EQ(found(floor, strict).at(30, 30), Foothold::low);
    EXPECT_EQ(found(floor, strict).at(30 - 14, 30), Foothold::safe);
}

TEST(Foothold, ADropThatOneLookAloneSawIsUnsure) {
    Map ground([](int ix) { return ix < 40 ? 0.0 : -0.8; });
    EXPECT_EQ(at(ground, 30), Foothold::drop);
    ground.observations.fill(1);
    EXPECT_EQ(at(ground, 30), Foothold::unsure);
    EXPECT_EQ(at(ground, 20), Foothold::safe);
    ground.observations.at(41, kSide / 2) = 2;
    EXPECT_EQ(at(ground, 30), Foothold::drop);
}

TEST(Foothold, ATableTopIsFlatAndOutOfReach) {
    Map floor([](int) { return 0.0; });
    floor.reach_m.at(30, 30) = kNanF;
    EXPECT_EQ(found(floor).at(30, 30), Foothold::unreachable);
    EXPECT_EQ(found(floor).at(31, 30), Foothold::safe);
}

TEST(Foothold, SameAsTheRulesOnRandomGround) {
    int seen[8] = {};
    for (std::uint64_t seed = 1; seed <= 24; ++seed) {
        Rng rng(seed);
        Map map([](int) { return 0.0; });
        const double slope = 0.12 * rng.uniform();
        const double noise_m = 0.006 * rng.uniform();
        const double step_m = seed % 3 == 0 ? 0.08 * rng.uniform() : 0.0;
        for (int iy = 0; iy < kSide; ++iy) {
            for (int ix = 0; ix < kSide; ++ix) {
                const double z = 3.0 + slope * ix * kCell_m - (ix + iy > 70 ? step_m : 0.0) +
                                 noise_m * rng.normal();
                map.height_m.at(ix, iy) = rng.uniform() < 2e-4 ? kNanF : static_cast<float>(z);
                map.var_m2.at(ix, iy) = static_cast<float>(1.5 * noise_m * noise_m * rng.uniform());
                // A single cell, or a row of six cells.
                if (rng.uniform() < 1e-4)
                    for (int i = 0; i < (seed % 2 == 0 ? 1 : 6); ++i)
                        map.clearance_m.at(std::min(ix + i, kSide - 1), iy) = 1.0F;
                if (rng.uniform() < 0.1) map.reach_m.at(ix, iy) = kNanF;
                if (rng.uniform() < 0.2) map.observations.at(ix, iy) = 1;
                if (rng.uniform() < 0.5)
                    map.free_above_m.at(ix, iy) = static_cast<float>(z - 0.12 * rng.uniform());
            }
        }
        FootholdConfig config = narrow();
        if (seed % 2 == 0) config.corner_m = 0.05;
        const Image<Foothold> holds = found(map, config);
        const FootholdGround ground = map.ground();
        const Oracle oracle(config, ground);
        for (int iy = 0; iy < kSide; ++iy) {
            for (int ix = 0; ix < kSide; ++ix) {
                const Foothold expected = oracle.judge(ix, iy);
                ++seen[static_cast<int>(expected)];
                ASSERT_EQ(to_string(holds.at(ix, iy)), to_string(expected))
                    << "seed " << seed << " cell " << ix << ", " << iy;
            }
        }
    }
    for (const int count : seen) EXPECT_GT(count, 20);
}

TEST(Foothold, OtherGridsAreUnknown) {
    FootholdConfig config;
    EXPECT_FALSE(config.problem());
    Map floor([](int) { return 0.0; });
    for (const double resolution_m : {0.005, 0.3}) {
        EXPECT_FALSE(config.fits(resolution_m));
        FootholdGround ground = floor.ground();
        ground.resolution_m = resolution_m;
        Image<Foothold> out;
        FootholdFinder(config).find(ground, serial(), out);
        EXPECT_EQ(out.at(30, 30), Foothold::unknown);
    }
    EXPECT_TRUE(config.fits(0.01));
    EXPECT_TRUE(config.fits(0.1));
    config.patch_side_m = 0.3;
    EXPECT_NE(config.problem()->find("must not exceed"), std::string::npos);
    config = {};
    config.foot_width_m = 0.3;
    EXPECT_NE(config.problem()->find("shorter side"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::traversability

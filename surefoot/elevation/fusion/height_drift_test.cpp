// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/height_drift.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::elevation {
namespace {

using Residuals = std::vector<HeightResidual>;
using enum HeightDriftReason;

constexpr std::uint32_t kMotions = 60;

grid::GridGeometry map_of(int side) {
    grid::GridGeometry geometry;
    geometry.nx = geometry.ny = side;
    geometry.resolution_m = 0.025;
    return geometry;
}

/// Residuals of every second cell of a patch that begins 2.5 m ahead of the point below the camera
/// at (1, 1).
struct Patch {
    grid::GridGeometry geometry = map_of(200);
    std::function<double(double ahead_m, double left_m)> offset_m = [](double, double) {
        return 0.03;
    };
    double noise_m = 0.003;
    double motion_m = 0.02;
    int first_ix = 60;
    int first_iy = 10;
    int cells_x = 80;
    int cells_y = 60;

    [[nodiscard]] Residuals residuals(std::uint64_t seed = 1) const {
        Rng rng(seed);
        Residuals all;
        for (int iy = first_iy; iy < first_iy + cells_y; iy += 2) {
            for (int ix = first_ix; ix < first_ix + cells_x; ix += 2) {
                HeightResidual r;
                r.at_m = geometry.center_m({ix, iy});
                r.from_camera_m = (r.at_m - Eigen::Vector2d(1.0, 1.0)).cast<float>();
                r.slope.setZero();
                const double exact_m = offset_m(static_cast<double>(r.from_camera_m.x()),
                                                static_cast<double>(r.from_camera_m.y()));
                r.offset_m = static_cast<float>(exact_m + noise_m * rng.normal());
                r.var_m2 = static_cast<float>(noise_m * noise_m);
                r.motion_var_m2 = static_cast<float>(motion_m * motion_m);
                r.step = 7;
                r.seen_step = kMotions;
                all.push_back(r);
            }
        }
        return all;
    }
};

HeightDrift::Verdict judge(const Patch& patch, const Residuals& old, const Residuals& recent = {}) {
    HeightDrift drift({});
    return drift.judge(old, recent, {patch.geometry, 1.0, 0.002, 0.001, kMotions});
}
HeightDriftReason reason(const Patch& patch, const Residuals& recent = {}) {
    return judge(patch, patch.residuals(), recent).report.reason;
}

TEST(HeightDrift, ACommonOffsetThatTheMotionAllowsMovesTheMap) {
    const Patch patch;
    const auto [report, last_step] = judge(patch, patch.residuals());
    EXPECT_EQ(report.reason, moved);
    EXPECT_NEAR(report.offset_m, 0.03, 0.0005);
    EXPECT_GT(report.sigma_m, 0.0028) << "what both sides may have wrong is in it";
    EXPECT_LT(report.sigma_m, 0.006);
    EXPECT_GT(report.cells, 1100);
    EXPECT_EQ(last_step, 7U);
}

TEST(HeightDrift, EveryReasonHasItsPatch) {
    EXPECT_EQ(judge({}, {}).report.reason, no_old_ground);
    Patch few;
    few.cells_x = few.cells_y = 10;
    EXPECT_EQ(reason(few), few_cells);
    Patch together;
    together.cells_x = together.cells_y = 32;
    EXPECT_EQ(reason(together), few_cells) << "sixteen tiles in one place";
    Patch small;
    small.offset_m = [](double, double) { return 0.005; };
    EXPECT_EQ(reason(small), not_significant);
    Patch still;
    still.motion_m = 0.009;
    EXPECT_EQ(reason(still), beyond_motion);
    still.motion_m = 0.011;
    EXPECT_EQ(reason(still), moved);
}

TEST(HeightDrift, ARaisedHalfMovesNothing) {
    for (const double left_m : {-0.2, 0.0, 0.2}) {
        Patch mat;
        mat.offset_m = [&](double, double at_m) { return at_m > left_m ? 0.02 : 0.0; };
        const HeightDriftReason why = reason(mat);
        EXPECT_TRUE(why == no_common_offset || why == not_significant) << to_string(why);
    }
}

TEST(HeightDrift, ATiltAboutTheCameraMovesNothingAndATiltWithADriftNeither) {
    for (const double tilt_rad : {0.01, -0.01}) {
        Patch pitched;
        pitched.noise_m = 0.01;  // otherwise the cells would not agree
        pitched.offset_m = [&](double ahead_m, double) { return tilt_rad * ahead_m; };
        EXPECT_EQ(reason(pitched), tilted) << tilt_rad;
        pitched.offset_m = [&](double ahead_m, double) { return 0.01 + tilt_rad * ahead_m; };
        EXPECT_NE(reason(pitched), moved) << tilt_rad;
        Patch rolled = pitched;
        rolled.offset_m = [&](double, double left_m) { return tilt_rad * (left_m - 1.0); };
        rolled.first_iy = 80;
        EXPECT_NE(reason(rolled), moved) << tilt_rad;
    }
}

TEST(HeightDrift, AFrameThatIsOffOnRecentGroundTooMovesNothing) {
    const Patch old;
    Patch recent;
    recent.first_ix = 141;
    recent.cells_x = 50;
    EXPECT_EQ(reason(old, recent.residuals(2)), frame_is_off);
    recent.offset_m = [](double, double) { return 0.0; };
    EXPECT_EQ(reason(old, recent.residuals(2)), moved);
    // A tilt that the recent ground shows, while the old ground is too narrow to show it.
    recent.offset_m = [](double ahead_m, double) { return 0.05 * (ahead_m - 2.3); };
    recent.noise_m = 0.03;
    EXPECT_EQ(reason(old, recent.residuals(2)), frame_is_off);
}

TEST(HeightDrift, OnSlopingGroundHorizontalDriftMayBeTheOffset) {
    const Patch patch;
    Residuals ramp = patch.residuals();
    for (HeightResidual& r : ramp) {
        r.slope = {0.1F, 0.0F};
        r.drift_m = 0.15F;
    }
    EXPECT_EQ(judge(patch, ramp).report.reason, not_significant);
    EXPECT_GT(judge(patch, ramp).report.sigma_m, 0.015);
}

TEST(HeightDrift, ResidualsOfALittleWhileAgoAreLessSure) {
    const Patch patch;
    Residuals earlier = patch.residuals();
    const double now_m = judge(patch, earlier).report.sigma_m;
    for (HeightResidual& r : earlier) r.seen_step = kMotions - 10;  // 43 motions made 20 mm
    const HeightDriftReport report = judge(patch, earlier).report;
    EXPECT_NEAR(report.sigma_m * report.sigma_m, now_m * now_m + 4e-4 * 10.0 / 43.0, 1e-9);
    EXPECT_EQ(report.reason, not_significant);
}

TEST(HeightDrift, YoungerCellsNeitherCountNorAreAttested) {
    const Patch patch;
    Residuals both = patch.residuals();
    const std::size_t older = both.size();
    Patch young = patch;
    young.first_iy = 80;
    young.cells_y = 50;
    young.offset_m = [](double, double) { return 0.0; };
    for (HeightResidual r : young.residuals(3)) {
        r.step = 9;
        both.push_back(r);
    }
    const auto [report, last_step] = judge(patch, both);
    EXPECT_EQ(report.reason, moved);
    EXPECT_EQ(last_step, 7U);
    EXPECT_NEAR(report.offset_m, 0.03, 0.0005);
    EXPECT_LE(report.cells, static_cast<std::int64_t>(older));
}

/// The same rule in a plain implementation: sorted lists and a map of tiles.
struct Plain {
    std::uint32_t last_step = 0;
    double offset_m = 0.0;
    std::int64_t cells = 0;
    double sigma_m = 0.0;
};
Plain plain(const Residuals& old, const grid::GridGeometry& geometry) {
    Plain all;
    std::vector<std::uint32_t> steps;
    for (const HeightResidual& r : old) steps.push_back(r.step);
    std::sort(steps.begin(), steps.end());
    all.last_step = steps[(steps.size() - 1) / 2];
    std::vector<std::pair<double, double>> weighted;
    double sum = 0.0;
    for (const HeightResidual& r : old) {
        if (r.step > all.last_step) continue;
        weighted.emplace_back(r.offset_m, 1.0 / static_cast<double>(r.var_m2));
        sum += weighted.back().second;
    }
    std::sort(weighted.begin(), weighted.end());
    double below = 0.0;
    for (const auto& [offset_m, weight] : weighted) {
        all.offset_m = offset_m;
        below += weight;
        if (below >= 0.5 * sum) break;
    }
    std::map<std::pair<int, int>, std::vector<const HeightResidual*>> tiles;
    for (const HeightResidual& r : old) {
        const double apart_m = static_cast<double>(r.offset_m) - all.offset_m;
        const bool agrees = std::abs(apart_m) <= 2.5 * std::sqrt(static_cast<double>(r.var_m2));
        if (r.step > all.last_step || !agrees) continue;
        ++all.cells;
        const auto cell = geometry.cell_at(r.at_m.x(), r.at_m.y());
        tiles[{cell->iy / 8, cell->ix / 8}].push_back(&r);
    }
    std::vector<Eigen::Vector3d> points;
    for (const auto& [at, cells] : tiles) {
        if (cells.size() < 4) continue;
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        for (const HeightResidual* r : cells)
            mean += Eigen::Vector3f(r->from_camera_m.x(), r->from_camera_m.y(), r->offset_m)
                        .cast<double>();
        points.push_back(mean / static_cast<double>(cells.size()));
    }
    const auto n = static_cast<double>(points.size());
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& p : points) mean += p / n;
    double scatter_m2 = 0.0;
    for (const auto& p : points) scatter_m2 += std::pow(p.z() - mean.z(), 2) / (n - 1.0);
    all.sigma_m = std::sqrt(1.5708 * scatter_m2 / n + 2.0 * 4e-6 +
                            1e-6 * mean.head<2>().squaredNorm() + std::pow(0.002 * 1.0, 2));
    return all;
}

TEST(HeightDrift, IsThePlainMedianOfThePlainHalf) {
    Rng rng(5);
    for (int round = 0; round < 30; ++round) {
        Patch patch;
        patch.first_ix = static_cast<int>(rng.below(100));
        patch.first_iy = static_cast<int>(rng.below(100));
        const double common_m = rng.uniform(-0.05, 0.05);
        patch.offset_m = [&](double, double) {
            return rng.uniform() < 0.15 ? rng.uniform(-0.2, 0.2) : common_m;
        };
        Residuals old = patch.residuals(10 + static_cast<std::uint64_t>(round));
        for (HeightResidual& r : old) {
            r.step = static_cast<std::uint32_t>(rng.below(20));
            r.var_m2 = static_cast<float>(rng.uniform(4e-6, 1e-4));
        }
        const auto [report, last_step] = judge(patch, old);
        const Plain expected = plain(old, patch.geometry);
        EXPECT_EQ(last_step, expected.last_step);
        EXPECT_NEAR(report.offset_m, expected.offset_m, 0.5001e-4) << "half a bin";
        // The bin width moves single cells across the limit of agreement.
        EXPECT_NEAR(static_cast<double>(report.cells),
                    static_cast<double>(expected.cells),
                    0.02 * static_cast<double>(expected.cells));
        EXPECT_NEAR(report.sigma_m, expected.sigma_m, 0.02 * expected.sigma_m);
    }
}

TEST(HeightDrift, ReasonsHaveNames) {
    EXPECT_EQ(to_string(off), "off");
    EXPECT_EQ(to_string(beyond_motion), "beyond_motion");
}

}  // namespace
}  // namespace surefoot::elevation

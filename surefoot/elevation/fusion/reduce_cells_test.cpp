// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/reduce_cells.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstring>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/elevation/fusion/cell_groups.hpp"

namespace surefoot::elevation {
namespace {

/// Samples of many cells: floors, treads with risers, pure scatter, equal heights, zeros of both
/// signs; from no sample to more samples than the limit of ranks found one by one.
struct Cells {
    std::vector<std::uint32_t> begin{0};
    std::vector<float> z_m;
    std::vector<float> var_m2;

    void add(Rng& rng, int n) {
        const double kind = rng.uniform(0.0, 1.0);
        for (int i = 0; i < n; ++i) {
            double z = 0.004 * rng.normal();
            if (kind < 0.2 && rng.uniform(0.0, 1.0) < 0.4) z += 0.18;
            if (kind > 0.6) z = rng.uniform(-0.5, 0.5);
            if (kind > 0.8) z = 0.01 * static_cast<int>(rng.uniform(-2.0, 3.0));
            z_m.push_back(kind > 0.9 && i % 3 == 0 ? -0.0F : static_cast<float>(z));
            var_m2.push_back(static_cast<float>(rng.uniform(1e-6, 1e-4)));
        }
        begin.push_back(static_cast<std::uint32_t>(z_m.size()));
    }
};

Cells many_cells() {
    Rng rng(5);
    Cells cells;
    for (int n = 0; n < 80; ++n) {
        for (int repeat = 0; repeat < 20; ++repeat) cells.add(rng, n);
    }
    for (const int n : {100, 333, 1000, 4000}) {
        for (int repeat = 0; repeat < 5; ++repeat) cells.add(rng, n);
    }
    return cells;
}

bool same_bytes(float a, float b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(ReduceCells, EveryInstructionSetGivesTheBytesOfThePlainVersion) {
    Cells cells = many_cells();
    const auto count = static_cast<int>(cells.begin.size()) - 1;
    cells.z_m.resize(cells.z_m.size() + CellGroups::kSlack, 1e30F);
    cells.var_m2.resize(cells.z_m.size(), 1e30F);
    std::vector<CellMeasurement> measured(static_cast<std::size_t>(count));
    ReductionConfig configs[3];
    configs[1].min_points = 1;
    configs[1].upper_share = 0.3;
    configs[2].surface_relief_m = 0.0;
    configs[2].window_sigma = 0.5;
    int found = 0;
    for (std::int64_t targets = hwy::SupportedTargets(); targets != 0; targets &= targets - 1) {
        hwy::SetSupportedTargetsForTest(targets & -targets);
        for (const ReductionConfig& config : configs) {
            reduce_cells(config,
                         cells.begin.data(),
                         count,
                         cells.z_m.data(),
                         cells.var_m2.data(),
                         measured.data());
            for (int i = 0; i < count; ++i) {
                const std::uint32_t first = cells.begin[static_cast<std::size_t>(i)];
                const std::uint32_t n = cells.begin[static_cast<std::size_t>(i) + 1] - first;
                const auto plain = reduce_cell(
                    config, {cells.z_m.data() + first, n}, {cells.var_m2.data() + first, n});
                const CellMeasurement& fast = measured[static_cast<std::size_t>(i)];
                ASSERT_EQ(plain.has_value(), fast.points > 0) << "cell " << i << ", " << n;
                if (!plain) continue;
                ++found;
                EXPECT_EQ(plain->points, fast.points) << "cell " << i << ", " << n;
                EXPECT_TRUE(same_bytes(plain->z_m, fast.z_m)) << plain->z_m << " " << fast.z_m;
                EXPECT_TRUE(same_bytes(plain->var_m2, fast.var_m2));
                EXPECT_TRUE(same_bytes(plain->highest_m, fast.highest_m)) << fast.highest_m;
                EXPECT_TRUE(same_bytes(plain->lowest_m, fast.lowest_m)) << fast.lowest_m;
            }
        }
    }
    hwy::SetSupportedTargetsForTest(0);
    EXPECT_GT(found, 1000);
}

TEST(ReduceCells, NothingInACellIsNoMeasurement) {
    const std::vector<std::uint32_t> begin{0, 0, 0};
    const std::vector<float> slack(CellGroups::kSlack, 0.0F);
    CellMeasurement measured[2] = {{.points = 7}, {.points = 7}};
    reduce_cells({}, begin.data(), 2, slack.data(), slack.data(), measured);
    EXPECT_EQ(measured[0].points, 0);
    EXPECT_EQ(measured[1].points, 0);
}

}  // namespace
}  // namespace surefoot::elevation

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/clouds/voxels.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/eval/clouds/clouds_testing.hpp"

namespace surefoot::eval {
namespace {

using testing::Points;

/// Reference implementation: one sum per voxel, in an ordered map.
Points means_by_definition(const Points& points_m, double size_m) {
    std::map<std::array<std::int64_t, 3>, std::pair<Eigen::Vector3d, int>> sums;
    for (const auto& p_m : points_m) {
        auto& [sum_m, count] = sums.try_emplace({voxel_number(p_m.x(), size_m),
                                                 voxel_number(p_m.y(), size_m),
                                                 voxel_number(p_m.z(), size_m)},
                                                Eigen::Vector3d(0, 0, 0),
                                                0)
                                   .first->second;
        sum_m += p_m.cast<double>();
        ++count;
    }
    Points means_m;
    for (const auto& [voxel, sum] : sums) means_m.push_back((sum.first / sum.second).cast<float>());
    return means_m;
}

TEST(Voxels, AreThoseOfTheDefinition) {
    const Points points_m = testing::steps(100000, 1);
    Backwards backwards;
    Threads threads(3);
    for (const double size_m : {0.001, 0.0137, 0.1, 50.0}) {
        const Points expected_m = means_by_definition(points_m, size_m);
        EXPECT_EQ(voxel_means_m(points_m, size_m), expected_m) << size_m;
        EXPECT_EQ(voxel_means_m(points_m, size_m, backwards), expected_m) << size_m;
        EXPECT_EQ(voxel_means_m(points_m, size_m, threads), expected_m) << size_m;
    }
}

TEST(Voxels, BordersLieOnMultiples) {
    EXPECT_EQ(voxel_number(0.0F, 0.5), 0);
    EXPECT_EQ(voxel_number(-0.1F, 0.5), -1);
    EXPECT_EQ(voxel_number(0.5F, 0.5), 1);
    // Slabs, one after another, give the result of the whole cloud.
    const Points points_m = testing::steps(20000, 2);
    Points near_m;
    Points far_m;
    for (const auto& p_m : points_m)
        (voxel_number(p_m.x(), 0.01) < 40 ? near_m : far_m).push_back(p_m);
    Points both_m = voxel_means_m(near_m, 0.01);
    const Points rest_m = voxel_means_m(far_m, 0.01);
    both_m.insert(both_m.end(), rest_m.begin(), rest_m.end());
    EXPECT_EQ(both_m, voxel_means_m(points_m, 0.01));
}

TEST(Voxels, NothingOnePlaceAndTooMany) {
    EXPECT_TRUE(voxel_means_m({}, 0.001).empty());
    EXPECT_EQ(voxel_means_m(Points(5000, {1, 2, 3}), 0.001), Points(1, {1, 2, 3}));
    EXPECT_TRUE(fits_voxels({{0, 0, 0}, {1600, 1600, 1600}}, 0.001));
    EXPECT_FALSE(fits_voxels({{0, 0, 0}, {1e7F, 1e7F, 1e7F}}, 0.001));
    EXPECT_FALSE(fits_voxels({{0, 0, 0}, {1e30F, 0, 0}}, 0.001));
}

}  // namespace
}  // namespace surefoot::eval

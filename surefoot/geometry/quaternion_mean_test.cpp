// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/quaternion_mean.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "surefoot/core/pose.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::geometry {
namespace {

using Rotations = std::vector<Eigen::Quaterniond>;
constexpr double kRounding_rad = 1e-12;

Eigen::Quaterniond random_rotation(Rng& rng) {
    return Eigen::Quaterniond(rng.normal(), rng.normal(), rng.normal(), rng.normal()).normalized();
}

TEST(QuaternionMean, NothingWithoutAUsableRotation) {
    const Rotations one{Eigen::Quaterniond::Identity()};
    EXPECT_FALSE(quaternion_mean({}));
    EXPECT_FALSE(quaternion_mean(one, std::vector<double>{0.0}));
    EXPECT_FALSE(quaternion_mean(one, std::vector<double>{-1.0}));
    EXPECT_FALSE(quaternion_mean(one, std::vector<double>{kNan}));
    EXPECT_FALSE(quaternion_mean(Rotations{Eigen::Quaterniond(kNan, 0, 0, 0)}));
    EXPECT_FALSE(
        quaternion_mean(Rotations{Eigen::Quaterniond(1, 0, 0, 0), Eigen::Quaterniond(0, 1, 0, 0)}))
        << "half a turn apart: no unique mean";
}

TEST(QuaternionMean, MeanOfOneIsItself) {
    Rng rng(1);
    for (int trial = 0; trial < 100; ++trial) {
        const Rotations one{random_rotation(rng)};
        const auto mean = quaternion_mean(one);
        ASSERT_TRUE(mean);
        EXPECT_LE(mean->angularDistance(one.front()), kRounding_rad) << "trial " << trial;
        EXPECT_GE(mean->w(), 0.0);
    }
}

TEST(QuaternionMean, SignsOfTheInputsDoNotMatter) {
    Rng rng(2);
    Rotations rotations;
    for (int i = 0; i < 20; ++i) {
        rotations.push_back(
            exp_so3(0.3 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal())));
    }
    const auto mean = quaternion_mean(rotations);
    for (std::size_t i = 0; i < rotations.size(); i += 3) rotations[i].coeffs() *= -1.0;
    const auto flipped = quaternion_mean(rotations);
    std::reverse(rotations.begin(), rotations.end());
    const auto reversed = quaternion_mean(rotations);
    ASSERT_TRUE(mean && flipped && reversed);
    EXPECT_EQ(mean->coeffs(), flipped->coeffs());
    EXPECT_LE(mean->angularDistance(*reversed), kRounding_rad);
}

TEST(QuaternionMean, SymmetricSpreadAveragesToItsCentre) {
    Rng rng(3);
    for (int trial = 0; trial < 100; ++trial) {
        const Eigen::Quaterniond centre = random_rotation(rng);
        Rotations rotations;
        for (int i = 0; i < 5; ++i) {
            const Eigen::Vector3d turn_rad =
                0.2 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
            rotations.push_back(centre * exp_so3(turn_rad));
            rotations.push_back(centre * exp_so3(-turn_rad));
        }
        const auto mean = quaternion_mean(rotations);
        ASSERT_TRUE(mean);
        EXPECT_LE(mean->angularDistance(centre), kRounding_rad) << "trial " << trial;
    }
}

TEST(QuaternionMean, WeightsActLikeRepetitions) {
    Rng rng(4);
    const Rotations two{exp_so3({0.1, 0.0, 0.0}), exp_so3({0.0, 0.4, 0.1})};
    const Rotations repeated{two[0], two[0], two[0], two[1]};
    const auto weighted = quaternion_mean(two, std::vector<double>{3.0, 1.0});
    const auto counted = quaternion_mean(repeated);
    ASSERT_TRUE(weighted && counted);
    EXPECT_LE(weighted->angularDistance(*counted), kRounding_rad);
    EXPECT_LT(weighted->angularDistance(two[0]), weighted->angularDistance(two[1]));
}

TEST(QuaternionMean, MinimisesTheSquaredAttitudeDifference) {
    // Markley eq. (5): the mean minimises the sum of |A - A_i|_F^2; no nearby rotation is better.
    Rng rng(5);
    Rotations rotations;
    for (int i = 0; i < 8; ++i) {
        rotations.push_back(
            exp_so3(0.8 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal())));
    }
    const auto cost = [&](const Eigen::Quaterniond& q) {
        double sum = 0.0;
        for (const auto& r : rotations) {
            sum += (q.toRotationMatrix() - r.toRotationMatrix()).squaredNorm();
        }
        return sum;
    };
    const auto mean = quaternion_mean(rotations);
    ASSERT_TRUE(mean);
    for (int trial = 0; trial < 200; ++trial) {
        const Eigen::Vector3d turn_rad =
            0.01 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
        EXPECT_GT(cost(*mean * exp_so3(turn_rad)), cost(*mean)) << "trial " << trial;
    }
}

}  // namespace
}  // namespace surefoot::geometry

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/tracking/observation_weight.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/rng.hpp"
#include "surefoot/stairs/tracking/drift.hpp"

namespace surefoot::stairs {
namespace {

constexpr double kSigma = 0.01;
constexpr double kVar = kSigma * kSigma;

TEST(ObservationWeight, the_first_look_is_all_there_is) {
    ObservationWeight weight;
    EXPECT_EQ(weight.take(kVar, 0.3, 8.0), 1.0);
    EXPECT_DOUBLE_EQ(weight.sigma(), kSigma);
}

TEST(ObservationWeight, looks_alike_count_as_in_a_mean_of_so_many) {
    ObservationWeight weight;
    for (int observation = 1; observation <= 30; ++observation)
        EXPECT_NEAR(weight.take(kVar, 0.0, 8.0), 1.0 / std::min(observation, 8), 1e-9)
            << observation;
}

TEST(ObservationWeight, a_mean_is_no_surer_than_its_best_look) {
    ObservationWeight weight;
    for (int observation = 0; observation < 1000; ++observation)
        (void)weight.take(observation == 500 ? 0.25 * kVar : kVar, 0.0, 8.0);
    EXPECT_DOUBLE_EQ(weight.sigma(), 0.5 * kSigma);
}

TEST(ObservationWeight, a_mean_is_no_surer_than_its_looks_agree) {
    ObservationWeight weight;
    Rng rng(5);
    double mean = 0.0;
    for (int observation = 0; observation < 200; ++observation) {
        const double off = 5.0 * kSigma * rng.normal() - mean;  // five times the stated sigma
        mean += weight.take(kVar, off, 8.0) * off;
    }
    EXPECT_GT(weight.sigma(), 3.0 * kSigma);
}

TEST(ObservationWeight, a_bad_look_hardly_moves_a_good_mean) {
    ObservationWeight weight;
    for (int observation = 0; observation < 8; ++observation) (void)weight.take(kVar, 0.0, 8.0);
    EXPECT_LT(weight.take(100.0 * kVar, kSigma, 8.0), 0.01);
}

TEST(ObservationWeight, a_look_that_cannot_agree_moves_the_mean_by_half) {
    ObservationWeight weight;
    for (int observation = 0; observation < 8; ++observation) (void)weight.take(kVar, 0.0, 8.0);
    EXPECT_EQ(weight.take(kVar, 10.0 * kSigma, 8.0), 0.5);
}

TEST(ObservationWeight, drift_adds_up_and_makes_the_next_look_count_more) {
    ObservationWeight weight;
    for (int observation = 0; observation < 20; ++observation) (void)weight.take(kVar, 0.0, 8.0);
    for (int frame = 0; frame < 3; ++frame) weight.drift(kVar);
    EXPECT_NEAR(weight.sigma(), 2.0 * kSigma, 1e-12);
    EXPECT_GT(weight.take(kVar, 0.0, 8.0), 0.7);
    EXPECT_DOUBLE_EQ(weight.sigma(), kSigma);
}

TEST(Drift, turns_the_covariance_of_the_body_into_odom_and_adds_up) {
    Matrix6 covariance = Matrix6::Zero();
    covariance.diagonal() << 4e-6, 1e-6, 9e-6, 1e-6, 4e-6, 25e-6;
    Eigen::Matrix3d quarter_turn;  // about y: the body's x is odom's -z, its z is odom's x
    quarter_turn << 0, 0, 1, 0, 1, 0, -1, 0, 0;
    Drift drift;
    drift.add(covariance, quarter_turn);
    drift.add(covariance, quarter_turn);
    EXPECT_NEAR(drift.horizontal_var_m2, 18e-6, 1e-15);
    EXPECT_NEAR(drift.height_var_m2, 8e-6, 1e-15);
    EXPECT_NEAR(drift.yaw_var_rad2, 2e-6, 1e-15);
    EXPECT_NEAR(drift.tilt_var_rad2, 50e-6, 1e-15);
    EXPECT_NEAR(drift.place_var_m2(2.0), 26e-6, 1e-15);
    EXPECT_NEAR(drift.level_var_m2(2.0), 208e-6, 1e-15);
    EXPECT_TRUE(drift.is_bounded());
}

TEST(Drift, that_says_nothing_is_not_bounded) {
    for (const double bad : {std::nan(""), static_cast<double>(INFINITY), 1e9}) {
        for (const int axis : {0, 2, 3, 5}) {
            Matrix6 covariance = 1e-6 * Matrix6::Identity();
            covariance(axis, axis) = bad;
            Drift drift;
            drift.add(covariance, Eigen::Matrix3d::Identity());
            EXPECT_FALSE(drift.is_bounded()) << bad << " " << axis;
        }
    }
}

}  // namespace
}  // namespace surefoot::stairs

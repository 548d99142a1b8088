// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/combine.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/unknown.hpp"

namespace surefoot::traversability {
namespace {

constexpr TraversabilityConfig::Weights kEqual{1.0, 1.0, 1.0};
constexpr float kRounding = 1e-7F;

float combined(Combine rule,
               const TraversabilityConfig::Weights& weights,
               float slope,
               float step,
               float roughness) {
    grid::Layer out(1, 1);
    combine(rule,
            weights,
            grid::Layer(1, 1, slope),
            grid::Layer(1, 1, step),
            grid::Layer(1, 1, roughness),
            {0, 0, 1, 1},
            out);
    return out.at(0, 0);
}

TEST(Combine, WeightsAreNormalised) {
    const TraversabilityConfig::Weights rex{0.2, 1.0, 0.2};
    for (const Combine rule : {Combine::mean_nan, Combine::zero_dominates}) {
        EXPECT_EQ(combined(rule, kEqual, 1.0F, 1.0F, 1.0F), 1.0F);
        EXPECT_NEAR(combined(rule, rex, 1.0F, 0.5F, 1.0F), (0.2 + 0.5 + 0.2) / 1.4, kRounding);
        EXPECT_NEAR(combined(rule, {20.0, 100.0, 20.0}, 1.0F, 0.5F, 1.0F),
                    combined(rule, rex, 1.0F, 0.5F, 1.0F),
                    kRounding);
    }
}

TEST(Combine, MeanIsUnknownIfAnyLayerIs) {
    for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(std::isnan(combined(Combine::mean_nan,
                                        kEqual,
                                        i == 0 ? kNanF : 0.0F,
                                        i == 1 ? kNanF : 0.0F,
                                        i == 2 ? kNanF : 0.0F)));
    }
    EXPECT_TRUE(std::isnan(combined(Combine::mean_nan, {1.0, 1.0, 0.0}, 1.0F, 1.0F, kNanF)))
        << "a weight of 0 makes no unknown cell known";
}

TEST(Combine, MeanOnlyLosesTheShareOfAZero) {
    EXPECT_NEAR(combined(Combine::mean_nan, kEqual, 1.0F, 0.0F, 1.0F), 2.0 / 3.0, kRounding);
}

TEST(Combine, ZeroDominatesAlsoOverUnknown) {
    EXPECT_EQ(combined(Combine::zero_dominates, kEqual, 1.0F, 0.0F, 1.0F), 0.0F);
    EXPECT_EQ(combined(Combine::zero_dominates, kEqual, kNanF, 0.0F, kNanF), 0.0F);
    EXPECT_TRUE(std::isnan(combined(Combine::zero_dominates, kEqual, kNanF, 1.0F, 1.0F)));
}

TEST(Combine, LayerWithoutWeightForcesNoZero) {
    EXPECT_EQ(combined(Combine::zero_dominates, {1.0, 1.0, 0.0}, 1.0F, 1.0F, 0.0F), 1.0F);
}

}  // namespace
}  // namespace surefoot::traversability

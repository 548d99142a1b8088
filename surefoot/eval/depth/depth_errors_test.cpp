// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/depth/depth_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::eval {
namespace {

constexpr double kRounding = 1e-9;  ///< shares in percent

Image<float> row(std::initializer_list<float> values) {
    Image<float> image(static_cast<int>(values.size()), 1);
    std::copy(values.begin(), values.end(), image.data());
    return image;
}

DepthErrors errors_of(const Image<float>& estimate,
                      const Image<float>& truth,
                      const Image<std::uint8_t>& mask = {},
                      const Image<float>& sigma = {}) {
    const auto errors = depth_errors({estimate.view(), truth.view(), mask.view(), sigma.view()});
    EXPECT_TRUE(errors.ok());
    return *errors;
}

bool same(float a, float b) {
    return a == b || (std::isnan(a) && std::isnan(b));
}

TEST(DepthErrors, ByHand) {
    //                              ok     0.75      1.5     2.5   unknown  no truth
    const auto truth = row({10.0F, 10.0F, 10.0F, 10.0F, 10.0F, kNanF});
    const auto estimate = row({10.0F, 10.75F, 8.5F, 12.5F, kNanF, 9.75F});
    const DepthErrors errors = errors_of(estimate, truth);
    EXPECT_EQ(errors.counted, 5);
    EXPECT_NEAR(errors.density_percent, 80.0, kRounding);
    EXPECT_NEAR(errors.known_bad.over_0_5_percent, 75.0, kRounding);
    EXPECT_NEAR(errors.known_bad.over_1_percent, 50.0, kRounding);
    EXPECT_NEAR(errors.known_bad.over_2_percent, 25.0, kRounding);
    // Filled with 9.75, the smaller of 12.5 and 9.75: right within 0.25.
    EXPECT_NEAR(errors.bad.over_0_5_percent, 60.0, kRounding);
    EXPECT_NEAR(errors.bad.over_1_percent, 40.0, kRounding);
    EXPECT_NEAR(errors.bad.over_2_percent, 20.0, kRounding);
    EXPECT_EQ(errors.known.count, 4);
    EXPECT_NEAR(errors.known.mean, (0.75 - 1.5 + 2.5) / 4.0, kRounding);
    EXPECT_EQ(errors.coverage.count, 0);
    EXPECT_TRUE(std::isnan(errors.sparsification.auc));
}

TEST(DepthErrors, AnErrorOfExactlyTheLimitIsNotBad) {
    const auto truth = row({4.0F, 4.0F, 4.0F, 4.0F});
    const auto errors = errors_of(row({4.5F, 3.0F, 6.0F, 2.0F}), truth);
    EXPECT_NEAR(errors.bad.over_0_5_percent, 75.0, kRounding);
    EXPECT_NEAR(errors.bad.over_1_percent, 50.0, kRounding);
    EXPECT_NEAR(errors.bad.over_2_percent, 0.0, kRounding);
}

TEST(DepthErrors, TheMaskChoosesPixels) {
    const auto truth = row({4.0F, 4.0F, 4.0F, 4.0F});
    const auto estimate = row({4.0F, 9.0F, kNanF, 4.0F});
    Image<std::uint8_t> mask(4, 1, 255);
    mask.at(1, 0) = 0;
    const auto errors = errors_of(estimate, truth, mask);
    EXPECT_EQ(errors.counted, 3);
    EXPECT_NEAR(errors.density_percent, 200.0 / 3.0, kRounding);
    EXPECT_NEAR(errors.bad.over_1_percent, 0.0, kRounding);  // the gap takes 4, not 9
    EXPECT_NEAR(errors.known_bad.over_1_percent, 0.0, kRounding);
}

TEST(DepthErrors, SigmaIsJudgedWhereTheEstimateIsKnown) {
    const auto truth = row({4.0F, 4.0F, 4.0F, kNanF});
    const auto estimate = row({4.5F, 6.5F, kNanF, 4.0F});
    const auto sigma = row({1.0F, 1.0F, 1.0F, 1.0F});
    const auto errors = errors_of(estimate, truth, {}, sigma);
    EXPECT_EQ(errors.coverage.count, 2);
    EXPECT_EQ(errors.coverage.within_1_sigma, 0.5);
    EXPECT_EQ(errors.coverage.within_2_sigma, 0.5);
    EXPECT_EQ(errors.coverage.within_3_sigma, 1.0);
    EXPECT_EQ(errors.sparsification.count, 2);
    EXPECT_NEAR(errors.sparsification.auc, 1.0, kRounding);  // one sigma for all
}

TEST(DepthErrors, FillingTakesTheSmallerNearestNeighbourInTheRow) {
    Rng rng(1);
    for (int trial = 0; trial < 50; ++trial) {
        Image<float> image(13, 3);
        for (std::size_t i = 0; i < image.size(); ++i)
            image.data()[i] = rng.uniform() < 0.5 ? kNanF : static_cast<float>(rng.below(9));
        if (trial == 0) std::fill(image.row(1), image.row(1) + 13, kNanF);
        const Image<float> result = filled(image.view());
        for (int v = 0; v < 3; ++v) {
            for (int u = 0; u < 13; ++u) {
                float left = kNanF, right = kNanF;
                for (int w = u; w >= 0 && std::isnan(left); --w) left = image.at(w, v);
                for (int w = u; w < 13 && std::isnan(right); ++w) right = image.at(w, v);
                const float expected = std::fmin(left, right);  // the one that is a number
                EXPECT_TRUE(same(result.at(u, v), expected)) << trial << " " << u << " " << v;
            }
        }
    }
}

TEST(DepthErrors, AnEstimateThatKnowsNothingIsAllBad) {
    const auto truth = row({4.0F, 4.0F});
    const auto errors = errors_of(row({kNanF, kNanF}), truth);
    EXPECT_EQ(errors.bad.over_2_percent, 100.0);
    EXPECT_EQ(errors.density_percent, 0.0);
    EXPECT_TRUE(std::isnan(errors.known_bad.over_2_percent));
    EXPECT_EQ(errors.known.count, 0);
}

TEST(DepthErrors, NoTruthGivesNoFigure) {
    for (const auto& errors : {errors_of(row({1.0F}), row({kNanF})), errors_of({}, {})}) {
        EXPECT_EQ(errors.counted, 0);
        EXPECT_TRUE(std::isnan(errors.bad.over_1_percent));
        EXPECT_TRUE(std::isnan(errors.density_percent));
    }
}

TEST(DepthErrors, ImagesOfDifferentSizesAreNamed) {
    const Image<float> small(2, 1, 1.0F), large(2, 2, 1.0F);
    const auto says = [](const DepthPair& pair, const char* name) {
        const auto errors = depth_errors(pair);
        ASSERT_FALSE(errors.ok());
        EXPECT_NE(errors.error().message.find(name), std::string::npos) << errors.error().message;
        EXPECT_NE(errors.error().message.find("2 x 2"), std::string::npos);
    };
    const Image<std::uint8_t> mask(2, 1, 1);
    says({small.view(), large.view(), {}, {}}, "the estimate has 2 x 1");
    says({large.view(), large.view(), mask.view(), {}}, "the mask has 2 x 1");
    says({large.view(), large.view(), {}, small.view()}, "the sigma has 2 x 1");
}

TEST(DepthErrors, NoticeATruthThatIsNotInPixels) {
    const auto estimate = row({10.0F, 20.5F, 29.0F, kNanF, 41.0F});
    const auto truth_times = [&](float factor) {
        Image<float> truth = row({10.0F, 20.0F, 30.0F, 35.0F, 40.0F});
        for (std::size_t i = 0; i < truth.size(); ++i) truth.data()[i] *= factor;
        return errors_of(estimate, truth).truth_over_estimate;
    };
    EXPECT_FALSE(suspected_factor(truth_times(1.0F)).has_value());
    for (const float factor : {3.0F, 4.0F, 16.0F, 256.0F, 1.0F / 16.0F})
        EXPECT_EQ(suspected_factor(truth_times(factor)),
                  std::optional<double>(static_cast<double>(factor)));
    // A bad estimate does not prove a wrong scale: no data set stores 1.4 times the disparity.
    EXPECT_FALSE(suspected_factor(truth_times(1.4F)).has_value());
    EXPECT_FALSE(suspected_factor(std::nan("")).has_value());
}

}  // namespace
}  // namespace surefoot::eval

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/visibility/viewpoint_history.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "surefoot/core/rng.hpp"

namespace surefoot::elevation {
namespace {

Pose at(double x_m, double yaw_deg = 0.0) {
    return {exp_so3({0.0, 0.0, yaw_deg * std::numbers::pi / 180.0}), {x_m, 0.0, 0.0}};
}

TEST(ViewpointHistory, StandingStillIsNoNewView) {
    ViewpointHistory views({});
    const auto first = views.look_from(at(0.0));
    for (int k = 0; k < 5000; ++k) views.look_from(at(0.0005 * (k % 2)));
    EXPECT_FALSE(views.is_new_since(first));
    EXPECT_TRUE(views.is_new_since(ViewpointHistory::kNever));
}

TEST(ViewpointHistory, TranslationOrRotationMakesANewView) {
    ViewpointHistory views({});
    const auto first = views.look_from(at(0.0));
    views.look_from(at(0.004));
    EXPECT_FALSE(views.is_new_since(first));
    views.look_from(at(0.0051));
    EXPECT_TRUE(views.is_new_since(first));
    views.look_from(at(0.0, 0.4));
    EXPECT_FALSE(views.is_new_since(first)) << "back at the first place";
    views.look_from(at(0.0, 0.6));
    EXPECT_TRUE(views.is_new_since(first));
}

TEST(ViewpointHistory, AgreesWithAllPosesRememberedUpToAQuarterOfTheLimit) {
    Rng rng(4);
    ViewpointHistory views({0.005, 180.0});
    std::map<ViewpointHistory::Id, double> truth;  // first pose of each id
    double x_m = 0.0;
    for (int k = 0; k < 3000; ++k) {
        x_m += rng.uniform(-0.004, 0.004);
        truth.emplace(views.look_from(at(x_m)), x_m);
        const ViewpointHistory::Id newest = truth.rbegin()->first;
        for (int probe = 0; probe < 5; ++probe) {
            const auto id = static_cast<ViewpointHistory::Id>(1 + rng.below(newest));
            const double way_m = std::abs(truth.at(id) - x_m);
            if (newest - id < 1024 && way_m < 0.005 * 0.999) {
                EXPECT_FALSE(views.is_new_since(id)) << "step " << k << " way " << way_m;
            }
            if (way_m > 0.005 * 1.001) {
                EXPECT_TRUE(views.is_new_since(id)) << "step " << k << " way " << way_m;
            }
        }
    }
}

}  // namespace
}  // namespace surefoot::elevation

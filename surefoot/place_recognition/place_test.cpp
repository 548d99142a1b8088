// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/place.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "surefoot/place_recognition/place_views_testing.hpp"

namespace surefoot::place_recognition {
namespace {

Place small_place() {
    Place place;
    place.keyframes.push_back({testing::view_of(testing::random_corners(100, 1), {}, 0.0, 1), {}});
    return place;
}

TEST(Descriptor, DistanceCountsTheBitsThatDiffer) {
    Descriptor a;
    EXPECT_EQ(distance(a, a), 0);
    Descriptor b;
    b.bits = {1, 0, 3, ~std::uint64_t{0}};
    EXPECT_EQ(distance(a, b), 1 + 2 + 64);
    b.bits.fill(~std::uint64_t{0});
    EXPECT_EQ(distance(a, b), 256);
    Rng rng(1);
    for (int i = 0; i < 1000; ++i) {
        a = testing::random_descriptor(rng);
        b = testing::random_descriptor(rng);
        int bits = 0;
        for (std::size_t k = 0; k < 4; ++k) bits += std::popcount(a.bits[k] ^ b.bits[k]);
        EXPECT_EQ(distance(a, b), bits);
    }
}

TEST(Place, SaysWhatIsWrongWithIt) {
    EXPECT_FALSE(Place{}.problem());
    EXPECT_FALSE(small_place().problem());
    const auto problem_with = [](auto&& change) {
        Place place = small_place();
        change(place.keyframes[0]);
        return place.problem().value_or("");
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(problem_with([](Keyframe& k) { k.T_map_body.translation_m.x() = 1e9; }), "");
    EXPECT_NE(problem_with([](Keyframe& k) { k.T_map_body.rotation.coeffs() *= 1.1; }), "");
    EXPECT_NE(problem_with([](Keyframe& k) { k.view.rig.width = 0; }), "");
    EXPECT_NE(problem_with([](Keyframe& k) { k.view.rig.fx_px = -1.0; }), "");
    EXPECT_NE(problem_with([](Keyframe& k) { k.view.rig.baseline_m = 0.0; }), "");
    EXPECT_NE(problem_with([nan](Keyframe& k) { k.view.features[3].pixel_px.y() = nan; }), "");
    EXPECT_NE(problem_with([](Keyframe& k) {
                  k.view.features[3].pixel_px.z() = k.view.features[3].pixel_px.x();
              }),
              "");
    EXPECT_NE(problem_with([](Keyframe& k) { k.view.features.resize(kMostFeatures + 1); }), "");
}

}  // namespace
}  // namespace surefoot::place_recognition

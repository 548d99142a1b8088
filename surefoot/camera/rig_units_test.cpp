// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/rig_units.hpp"

#include <gtest/gtest.h>

#include "surefoot/camera/rigs_testing.hpp"
#include "surefoot/camera/stereo_rig.hpp"

namespace surefoot::camera {
namespace {

bool contains(const std::optional<std::string>& text, const char* part) {
    return text && text->find(part) != std::string::npos;
}

TEST(RigUnits, AFocalLengthInMillimetresIsNamed) {
    EXPECT_TRUE(contains(focal_warning(4.0, 640),
                         "focal length 4.00 px is too short for an image of 640 px"));
    EXPECT_FALSE(focal_warning(33.0, 640));
    EXPECT_FALSE(focal_warning(350.0, 672));
}

TEST(RigUnits, NoCameraHasAFocalLengthBeyondAMillionPixels) {
    StereoRig rig = test::euroc_rig();
    EXPECT_FALSE(rig.problem());
    std::get<PinholeRadTan>(rig.right->model).fy_px = 4e13;
    EXPECT_TRUE(contains(rig.problem(), "right camera: focal length 4e+13 px exceeds 1e+06 px"));
}

TEST(RigUnits, ABaselineNamesTheUnitThatWasMeant) {
    struct Case {
        double length_m;
        const char* says;
    };
    for (const Case& c :
         {Case{60.794,
               "60.794 m exceeds 5 m: is it in cm (then 607.9 mm), or in mm (then 60.8 mm)?"},
          Case{120.0, "120.000 m exceeds 5 m: is it in mm (then 120.0 mm)?"},
          Case{12.0, "in cm (then 120.0 mm), or in mm (then 12.0 mm), or in squares"},
          Case{6.0794e-5, "0.061 mm is below 1 mm: is it in km (then 60.8 mm)?"},
          Case{0.0, "0.000 mm is below 1 mm. Give"},
          Case{1e9, "exceeds 5 m. Give it in metres"}}) {
        EXPECT_TRUE(contains(baseline_problem(c.length_m), c.says))
            << c.says << ": " << baseline_problem(c.length_m).value_or("accepted");
        EXPECT_FALSE(baseline_warning(c.length_m)) << "said once, as a problem";
    }
    EXPECT_TRUE(contains(baseline_warning(3.327), "3.327 m is longer than 1 m: is it"));
    EXPECT_TRUE(contains(baseline_warning(3.327), "in squares of a chessboard?"));
    EXPECT_TRUE(contains(baseline_warning(0.004), "0.004 m is shorter than 0.01 m"));
    for (const double usual_m : {0.018, 0.05, 0.12, 0.24, 0.537, 0.9}) {
        EXPECT_FALSE(baseline_problem(usual_m)) << usual_m;
        EXPECT_FALSE(baseline_warning(usual_m)) << usual_m;
    }
}

TEST(RigUnits, AMountInMillimetresIsRefused) {
    StereoRig rig = test::euroc_rig();
    rig.T_body_left = Pose{};
    rig.T_body_left->translation_m = {75.0, 250.0, 50.0};
    EXPECT_TRUE(contains(rig.problem(), "T_body_left is 265.8 m from base_link"));
    rig.T_body_left->translation_m *= 1e-3;
    EXPECT_FALSE(rig.problem());
    rig.imu = ImuMount{};
    rig.imu->T_body_imu.translation_m = {0.0, 11.0, 0.0};
    EXPECT_TRUE(contains(rig.problem(), "T_body_imu is 11.0 m from base_link"));
}

}  // namespace
}  // namespace surefoot::camera

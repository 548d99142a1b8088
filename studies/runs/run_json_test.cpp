// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/run_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace surefoot::app {
namespace {

const std::string kWhole =
    R"({"frames": 3, "camera": {"width": 672, "height": 376, "focal_px": [350, 351.5],
    "principal_px": [335.5, 187.5], "T_body_camera": [0.1, 0.2, 0.3, 0, 0, 0, 1]}})";

std::string with(const std::string& old_part, const std::string& new_part) {
    std::string text = kWhole;
    const std::size_t at = text.find(old_part);
    EXPECT_NE(at, std::string::npos) << old_part;
    return text.replace(at, old_part.size(), new_part);
}

TEST(ReportTilt, WhatIsDamagedIsNotKnown) {
    EXPECT_NEAR(
        parse_report_tilt_sigma_rad(R"({"tilt_sigma_deg": 90.0})"), 1.5707963267948966, 1e-15);
    EXPECT_EQ(parse_report_tilt_sigma_rad("{}"), 0.0) << "older versions";
    for (const char* text :
         {"", "{", "[]", R"({"tilt_sigma_deg": null})", R"({"tilt_sigma_deg": "1"})"})
        EXPECT_TRUE(std::isnan(parse_report_tilt_sigma_rad(text))) << text;
}

TEST(ReportCamera, IsReadAsItWasWritten) {
    const auto camera = parse_report_camera(kWhole);
    ASSERT_TRUE(camera.has_value());
    EXPECT_EQ(camera->view.width, 672);
    EXPECT_EQ(camera->view.height, 376);
    EXPECT_EQ(camera->view.fx_px, 350.0);
    EXPECT_EQ(camera->view.fy_px, 351.5);
    EXPECT_EQ(camera->view.cx_px, 335.5);
    EXPECT_EQ(camera->view.cy_px, 187.5);
    EXPECT_EQ(camera->T_body_camera.translation_m, Eigen::Vector3d(0.1, 0.2, 0.3));
    EXPECT_EQ(camera->T_body_camera.rotation.w(), 1.0);
}

TEST(ReportCamera, WhatIsNotWholeIsNoCamera) {
    for (const std::string& text : {std::string(),
                                    std::string("{"),
                                    std::string("[1, 2]"),
                                    std::string("{\"camera\": 3}"),
                                    kWhole.substr(0, kWhole.size() / 2),
                                    with("\"camera\"", "\"kamera\""),
                                    with("672", "\"wide\""),
                                    with("672", "0"),
                                    with("376", "37.5"),
                                    with("[350, 351.5]", "[350]"),
                                    with("[350, 351.5]", "[350, null]"),
                                    with("0, 0, 0, 1]", "0, 0, 0, 2]"),
                                    with(", \"T_body_camera\"", ", \"T\"")}) {
        EXPECT_FALSE(parse_report_camera(text).has_value()) << text;
    }
}

}  // namespace
}  // namespace surefoot::app

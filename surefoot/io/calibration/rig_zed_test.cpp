// SPDX-License-Identifier: Apache-2.0
// Calibration files of the ZED as users have them.
#include <gtest/gtest.h>

#include <string>

#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_testing.hpp"
#include "surefoot/io/calibration/rig_texts_testing.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io::testing {
namespace {

TEST(RigVariants, ZedThinPrismTermsAreNotLeftOut) {
    EXPECT_EQ(message(parse_rig_file(zed_file("s1=0\ns2=0\ns3=0\ns4=0\n"), "SN1.conf")),
              "accepted");
    EXPECT_TRUE(
        contains(message(parse_rig_file(zed_file("s1=0.0021\ns2=0\ns3=0\ns4=0\n"), "SN1.conf")),
                 "SN1.conf: [LEFT_DISTO] coefficient 9 is 0.0021 (s1); thin-prism"));
    EXPECT_TRUE(
        contains(message(parse_rig_file(zed_file("s4=-0.0003\n"), "SN1.conf")), "coefficient 12"));
}

TEST(RigVariants, ZedFilesOfAnyAge) {
    const std::string mode =
        "fx=699.0\nfy=699.0\ncx=626.75\ncy=360.9\nk1=-0.173733\nk2=0.0272837\n";
    const auto file = [&](const std::string& stereo, const std::string& head = "") {
        return parse_rig_file(
            head + "[LEFT_CAM_HD]\n" + mode + "[RIGHT_CAM_HD]\n" + mode + "[STEREO]\n" + stereo,
            "SN.conf");
    };
    const std::string stereo =
        "Baseline=120.123\nTY=-0.08\nTZ=-0.03\nCV_HD=0.00996\nRX_HD=0.001\nRZ_HD=0.001\n";
    EXPECT_TRUE(file(stereo).ok()) << message(file(stereo));
    EXPECT_TRUE(file(replaced(stereo, "CV_HD", "RY_HD")).ok());
    EXPECT_TRUE(file(stereo, ";comment\n#c\n").ok());
    EXPECT_TRUE(file(replaced(stereo, "\n", "\r\n")).ok());
    EXPECT_TRUE(parse_rig_file(replaced("[left_cam_hd]\n" + mode + "[right_cam_hd]\n" + mode +
                                            "[stereo]\n" + stereo,
                                        "Baseline",
                                        "baseline"),
                               "SN.conf")
                    .ok());
    EXPECT_TRUE(contains(message(file(replaced(stereo, "TY=-0.08\n", ""))),
                         "[STEREO] has no 'TY_HD'. Download the file of this serial number again"));
    EXPECT_TRUE(contains(message(file(replaced(stereo, "RX_HD=0.001\n", ""))),
                         "or add the line 'RX_HD = 0'"));
}

}  // namespace
}  // namespace surefoot::io::testing

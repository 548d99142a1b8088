// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/camera_monitor.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace surefoot::pipeline {
namespace {

/// States after each frame of a script. Frames: n = new, r = repeated, t = torn, d = new after one
/// damaged image, D = new after two, l = new and overexposed, x = new and dark. States: u(nknown),
/// o(k), f(rozen), c(orrupt), l = overexposed, x = dark.
std::string states(std::string_view script) {
    CameraMonitor monitor;
    std::string result;
    int repeated = 0;
    for (const char frame : script) {
        FrameStatus frame_status;
        repeated = frame == 'r' ? repeated + 1 : 0;
        frame_status.repeated = repeated;
        frame_status.torn = frame == 't';
        frame_status.damaged = frame == 'd' ? 1 : frame == 'D' ? 2 : 0;
        const ExposureState light = frame == 'l'   ? ExposureState::overexposed
                                    : frame == 'x' ? ExposureState::dark
                                                   : ExposureState::well_exposed;
        const CameraState state = monitor.add(frame_status, light);
        EXPECT_EQ(state, monitor.state());
        result += "ufcolx"[static_cast<std::size_t>(state)];
    }
    return result;
}

TEST(CameraMonitor, BeforeTheFirstWholeImageNothingIsKnown) {
    EXPECT_EQ(CameraMonitor().state(), CameraState::unknown);
    EXPECT_EQ(states("tn"), "uo");
    EXPECT_EQ(states("ttnnn"), "uccco");
}

TEST(CameraMonitor, OneBadImageChangesNothing) {
    EXPECT_EQ(states("nrnrntntndn"), "ooooooooooo");
}

TEST(CameraMonitor, TwoInARowInhibitAtOnceAndThreeNewOnesRelease) {
    EXPECT_EQ(states("nrrnnn"), "oofffo");
    EXPECT_EQ(states("nrrrrrrnnrnnn"), "ooffffffffffo");
    EXPECT_EQ(states("nttnnn"), "ooccco");
    EXPECT_EQ(states("nDnn"), "occo");
    EXPECT_EQ(states("nrrnndnnn"), "oofffffoo");
}

TEST(CameraMonitor, TheLastKindOfFaultIsTheReason) {
    EXPECT_EQ(states("nrt"), "ooc");
    EXPECT_EQ(states("ntr"), "oof");
    EXPECT_EQ(states("nrrtt"), "oofcc");
}

TEST(CameraMonitor, WhatShowsNothingIsAsBadAsWhatDoesNotCome) {
    EXPECT_EQ(states("nlnxn"), "ooooo") << "a flash changes nothing";
    EXPECT_EQ(states("nllnnn"), "oolllo");
    EXPECT_EQ(states("nxxxnnn"), "ooxxxxo");
    EXPECT_EQ(states("nlxrr"), "ooxff");
    EXPECT_EQ(states("llnnn"), "ulllo");
}

}  // namespace
}  // namespace surefoot::pipeline

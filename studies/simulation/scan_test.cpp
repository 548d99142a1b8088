// SPDX-License-Identifier: Apache-2.0
#include "studies/simulation/scan.hpp"

#include <gtest/gtest.h>

namespace surefoot::app {
namespace {

TEST(CheckRoom, RefusesWhatDoesNotFitAndSaysHowMuchIsMissing) {
    const ScanSize size{2e9, 40e9};
    EXPECT_TRUE(check_room("s.ply", size, 40e9).ok());
    const Status refused = check_room("s.ply", size, 12.3e9);
    ASSERT_FALSE(refused.ok());
    for (const char* part : {"s.ply", "40.0 GB", "12.3 GB", "sim.laser.step_deg"})
        EXPECT_NE(refused.error().message.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace surefoot::app

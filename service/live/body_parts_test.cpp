// SPDX-License-Identifier: Apache-2.0
// The body parts in machines/rex.yaml must contain every link of the simulated REX in all
// movements.
#include <gtest/gtest.h>

#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/sim/motion/body_trace.hpp"

namespace surefoot::app {
namespace {

TEST(BodyParts, of_the_rex_hold_every_link_at_every_moment_of_every_movement) {
    const auto file = io::read_machine("machines/rex.yaml");
    ASSERT_TRUE(file.ok()) << file.error().message;
    // The gait draws shift and sway from its seed, so the test uses other values than the file.
    const auto traced = sim::trace_body(sim::rex_movements({}), {}, 101, 3);
    ASSERT_TRUE(traced.ok()) << traced.error().message;
    ASSERT_EQ(static_cast<std::size_t>(file->machine.body.count), traced->size());
    const double sway_m = 1e-4 * file->machine.body.sway_tenth_mm;
    for (std::size_t i = 0; i < traced->size(); ++i) {
        const sim::TracedPart& moved = (*traced)[i];
        SCOPED_TRACE(moved.name);
        const BodyPart& part = file->machine.body.parts[i];
        const Eigen::Vector2d center(1e-4 * part.box.center_x_tenth_mm,
                                     1e-4 * part.box.center_y_tenth_mm);
        const Eigen::Vector2d half(0.5e-4 * part.box.length_tenth_mm + sway_m,
                                   0.5e-4 * part.box.width_tenth_mm + sway_m);
        const Eigen::Vector2d slack =
            (center + half - moved.box.max_m).cwiseMin(moved.box.min_m - (center - half));
        EXPECT_GE(slack.minCoeff(), 0.0);
        EXPECT_LE(slack.maxCoeff(), 0.06) << "larger than it need be";
        EXPECT_LE(1e-4 * part.low_tenth_mm, moved.low_m + 1e-9);
        EXPECT_GE(1e-4 * part.high_tenth_mm, moved.high_m - 1e-9);
    }
}

}  // namespace
}  // namespace surefoot::app

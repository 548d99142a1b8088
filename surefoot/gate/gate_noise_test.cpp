// SPDX-License-Identifier: Apache-2.0
// How certain the heights must be: of all cells, of single ones, and of those beside a limit.
#include <gtest/gtest.h>

#include <tuple>
#include <utility>

#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/verdict_testing.hpp"

namespace surefoot::gate::testing {
namespace {

TEST(Gate, fused_noise_of_3_to_5_mm_passes_and_20_mm_does_not_resolve) {
    Terrain floor;
    for (const double sigma_m : {0.003, 0.004, 0.005}) {
        floor.variance.fill(static_cast<float>(sigma_m * sigma_m));
        expect_ok(ask(floor, kForward));
    }
    floor.variance.fill(static_cast<float>(0.02 * 0.02));
    expect_refused(ask(floor, kForward), Reason::not_resolvable);
    // Patches are stricter than single cells: 8 mm passes in the path, not under a foot.
    floor.variance.fill(static_cast<float>(0.008 * 0.008));
    const Verdict verdict = ask(floor, kForward);
    expect_refused(verdict, Reason::not_resolvable);
    EXPECT_EQ(verdict.evidence.limit_tenth_mm, 30);
}

TEST(Gate, finer_cells_are_no_excuse_for_averaging_more) {
    Terrain fine;  // 12.5 mm: a patch holds 16 cells, credited as 4
    fine.geometry.resolution_m = 0.0125;
    fine.geometry.origin_m.setConstant(-1.5);
    fine.variance.fill(static_cast<float>(0.005 * 0.005));
    expect_ok(ask(fine, kForward));
    fine.variance.fill(static_cast<float>(0.008 * 0.008));
    expect_refused(ask(fine, kForward), Reason::not_resolvable);
}

TEST(Gate, given_two_unsure_cells_beside_the_feet_then_not_resolvable) {
    Terrain floor;
    floor.paint(floor.variance, 0.425, 0.45, 0.0, 0.05, 0.013 * 0.013);
    const Verdict verdict = ask(floor, kForward);
    expect_refused(verdict, Reason::not_resolvable);
    EXPECT_EQ(verdict.evidence.limit_tenth_mm, 120);
    expect_ok(ask(floor, kBackward));
}

TEST(Gate, what_is_not_sure_to_stay_below_a_swinging_foot_or_above_a_drop_is_not_resolvable) {
    // 30 mm up beside the path of the left foot, from the margin on; 38 mm down ahead of its toes,
    // from the band on. The limits are 40 and 50 mm. 3.4 sigma of 9.5 mm keep both limits, 20.4 mm
    // break both, even where averaging nine cells halves the error.
    for (const auto& [x0, x1, y0, y1, height_m] :
         {std::tuple{0.05, 0.15, 0.28, 0.40, 0.030}, {0.675, 0.80, 0.10, 0.25, -0.038}}) {
        for (const auto& [sigma_m, allowed] : {std::pair{0.0028, true}, std::pair{0.006, false}}) {
            Terrain floor;
            floor.box(x0, x1, y0, y1, height_m);
            for (int v = 0; v < 240; ++v) {
                for (int u = 0; u < 240; ++u) {
                    if (floor.height.at(u, v) != 0.0F)
                        floor.variance.at(u, v) = static_cast<float>(sigma_m * sigma_m);
                }
            }
            const Verdict verdict = ask(floor, kForward);
            if (allowed) {
                expect_ok(verdict);
                continue;
            }
            expect_refused(verdict, Reason::not_resolvable);
            EXPECT_EQ(verdict.reasons, ReasonSet(Reason::not_resolvable)) << words(verdict);
            EXPECT_NEAR(static_cast<double>(verdict.evidence.value_tenth_mm), 60.0, 1.0);
            EXPECT_LT(verdict.evidence.limit_tenth_mm, verdict.evidence.value_tenth_mm);
        }
    }
}

TEST(Gate, one_unsure_cell_among_sure_ones_need_not_be_as_sure_as_they) {
    // Beside the path of the left foot, where the limit is 40 mm. 3.4 sigma of the cell are 37 mm.
    struct Case {
        double height_m;
        double around_m;
        double around_sigma_m;
        bool allowed;
    };
    for (const Case& c : {Case{0.010, 0.0, 0.004, true},
                          {0.028, 0.0, 0.004, true},   // below by one sigma
                          {0.030, 0.0, 0.004, false},  // by less
                          {0.010, 0.020, 0.005, true},
                          {0.010, 0.020, 0.006, false},     // one neighbour is uncertain too
                          {0.010, 0.027, 0.004, false}}) {  // the same neighbour is higher
        Terrain floor;
        const auto paint = [&](double x, double y, double height_m, double sigma_m) {
            floor.box(x, x + 0.025, y, y + 0.025, height_m);
            floor.paint(floor.variance, x, x + 0.025, y, y + 0.025, sigma_m * sigma_m);
        };
        paint(0.075, 0.30, c.height_m, 0.011);
        paint(0.100, 0.325, c.around_m, c.around_sigma_m);
        const Verdict verdict = ask(floor, kForward);
        EXPECT_EQ(verdict.decision == Decision::ok, c.allowed)
            << c.height_m << " " << c.around_m << " " << c.around_sigma_m << words(verdict);
        if (!c.allowed) {
            EXPECT_TRUE(verdict.reasons.contains(Reason::not_resolvable)) << words(verdict);
        }
    }
    // An unknown neighbour supports nothing.
    Terrain hidden;
    hidden.paint(hidden.variance, 0.075, 0.10, 0.30, 0.325, 0.0119 * 0.0119);
    expect_ok(ask(hidden, kForward));
    hidden.box(0.075, 0.10, 0.325, 0.35, kNanF);
    EXPECT_TRUE(ask(hidden, kForward).reasons.contains(Reason::not_resolvable));
}

TEST(Gate, a_cell_that_is_hardly_sure_proves_nothing_but_alone_among_sure_ones) {
    // In the band ahead of a foot, 20 mm higher: the limits of drop and obstacle are far away.
    for (const auto& [sigma_m, beside_m, allowed] : {std::tuple{0.0125, 0.0119, true},
                                                     {0.0239, 0.0119, true},
                                                     {0.0242, 0.0119, false},
                                                     {0.0125, 0.0122, false}}) {
        Terrain floor;
        floor.box(0.70, 0.75, 0.10, 0.25, 0.020);
        floor.paint(floor.variance, 0.70, 0.725, 0.15, 0.175, sigma_m * sigma_m);
        floor.paint(floor.variance, 0.70, 0.725, 0.175, 0.20, beside_m * beside_m);
        const Verdict verdict = ask(floor, kForward);
        EXPECT_EQ(verdict.decision == Decision::ok, allowed) << sigma_m << words(verdict);
    }
    // Under the body, only the room below it counts: 0.14 m are 3.4 sigma of 41 mm.
    for (const auto& [sigma_m, allowed] : {std::pair{0.041, true}, {0.043, false}}) {
        Terrain floor;
        floor.paint(floor.variance, -0.30, -0.20, -0.05, 0.05, sigma_m * sigma_m);
        EXPECT_EQ(ask(floor, kForward).decision == Decision::ok, allowed) << sigma_m;
    }
    // The end of an object that nearly reaches the body must be certain.
    for (const auto& [sigma_m, allowed] : {std::pair{0.007, true}, {0.011, false}}) {
        Terrain box;
        box.box(-0.25, -0.15, -0.025, 0.025, 0.115);
        box.paint(box.variance, -0.25, -0.15, -0.025, 0.025, sigma_m * sigma_m);
        EXPECT_EQ(ask(box, kForward).decision == Decision::ok, allowed) << sigma_m;
    }
}

TEST(Gate, an_unsure_cell_under_a_foot_does_not_spoil_what_those_beside_it_know) {
    for (const auto& [beside_m, allowed] : {std::pair{0.004, true}, {0.007, false}}) {
        Terrain floor;
        floor.paint(floor.variance, 0.30, 0.60, 0.10, 0.26, beside_m * beside_m);
        floor.paint(floor.variance, 0.40, 0.425, 0.15, 0.175, 0.0115 * 0.0115);
        const Verdict verdict = ask(floor, kForward);
        EXPECT_EQ(verdict.decision == Decision::ok, allowed) << beside_m << words(verdict);
    }
}

}  // namespace
}  // namespace surefoot::gate::testing

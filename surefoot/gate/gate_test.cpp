// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/gate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/verdict_text.hpp"

namespace surefoot::gate::testing {
namespace {

/// Expects a refusal with the given primary reason and a cell.
void expect_refused(const Verdict& verdict, Reason primary) {
    EXPECT_EQ(verdict.decision, Decision::not_traversable) << words(verdict);
    EXPECT_EQ(verdict.primary, primary) << words(verdict);
    EXPECT_TRUE(verdict.reasons.contains(primary));
    EXPECT_TRUE(verdict.evidence.has_worst_cell) << words(verdict);
    EXPECT_FALSE(verdict.allows_step(kNowNs));
}
void expect_error(const Verdict& verdict, Reason primary) {
    EXPECT_EQ(verdict.decision, Decision::error) << words(verdict);
    EXPECT_EQ(verdict.primary, primary) << words(verdict);
    EXPECT_FALSE(verdict.allows_step(kNowNs));
}
void expect_ok(const Verdict& verdict) {
    EXPECT_EQ(verdict.decision, Decision::ok) << words(verdict);
    EXPECT_TRUE(verdict.reasons.empty()) << words(verdict);
    EXPECT_EQ(verdict.primary, Reason::none);
}

TEST(Gate, a_default_verdict_query_and_health_inhibit) {
    EXPECT_EQ(Verdict{}.decision, Decision::error);
    EXPECT_FALSE(Verdict{}.allows_step(0));
    Terrain floor;
    const auto map = floor.snapshot();
    expect_error(decide(rex(), Query{}, *map, kReady, kNowNs), Reason::bad_number);
    expect_error(decide(rex(), query_at_body(kForward, *map), *map, GateHealth{}, kNowNs),
                 Reason::not_ready);
    expect_error(decide(Machine{}, query_at_body(kForward, *map), *map, kReady, kNowNs),
                 Reason::config);
    const auto nothing = std::make_unique<grid::MapSnapshot>();
    expect_error(decide(rex(), query_at_body(kForward, *map), *nothing, kReady, kNowNs),
                 Reason::internal);
}

TEST(Gate, what_nobody_filled_in_names_no_movement_nobody_and_no_area) {
    const Query query;
    EXPECT_EQ(query.command, 0);
    EXPECT_EQ(query.connection, 0U);
    EXPECT_EQ(query.sequence, 0U);
    const AttestedArea& area = query.attested;
    EXPECT_FALSE(area.active);
    EXPECT_EQ(area.center_x_tenth_mm, 0);
    EXPECT_EQ(area.center_y_tenth_mm, 0);
    EXPECT_EQ(area.radius_tenth_mm, 0);  // active alone it covers nothing
    EXPECT_EQ(area.height_tenth_mm, 0);
}

TEST(Gate, given_a_flat_known_floor_then_every_configured_movement_is_ok) {
    Terrain floor;
    const auto map = floor.snapshot();
    for (int code = 1; code < Machine::kMovementCodes; ++code) {
        const Verdict verdict = ask(*map, static_cast<std::uint8_t>(code));
        expect_ok(verdict);
        EXPECT_EQ(verdict.evidence.known_cells, verdict.evidence.cells);
        EXPECT_EQ(verdict.evidence.attested_cells, 0);
        EXPECT_EQ(verdict.evidence.height_delta_tenth_mm, 0);
        EXPECT_EQ(verdict.map_version, 42U);
        EXPECT_EQ(verdict.config_hash, 4711U);
        EXPECT_EQ(verdict.valid_until_ns, kNowNs + 300 * kMs);
    }
}

TEST(Gate, an_ok_lives_300_ms_and_not_before_it_was_given) {
    Terrain floor;
    const Verdict verdict = ask(floor, kForward);
    EXPECT_TRUE(verdict.allows_step(kNowNs));
    EXPECT_TRUE(verdict.allows_step(kNowNs + 300 * kMs - 1));
    EXPECT_FALSE(verdict.allows_step(kNowNs + 300 * kMs));
    EXPECT_FALSE(verdict.allows_step(kNowNs - 1));
}

TEST(Gate, works_at_any_pose_yaw_and_cell_size) {
    for (const double res_m : {0.0125, 0.02, 0.025, 0.05}) {
        Terrain floor;
        floor.geometry.resolution_m = res_m;
        floor.geometry.origin_m.setConstant(-120.0 * res_m);
        // One cell of 50 mm is a whole patch: nothing is averaged, so its own sigma must be
        // smaller.
        floor.variance.fill(res_m > 0.04 ? 6e-6F : 16e-6F);
        const auto map = floor.snapshot();
        for (int deg = -180; deg < 180; deg += 17) {
            const double yaw = deg * std::numbers::pi / 180.0;
            const Query query = make_query(kForward, 0.0131, -0.0077, std::cos(yaw), std::sin(yaw));
            const Verdict verdict = decide(rex(), query, *map, kReady, kNowNs);
            expect_ok(verdict);
            EXPECT_FALSE(HasFailure()) << "resolution " << res_m << " yaw " << deg;
        }
    }
}

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

// ---- unknown ground -----------------------------------------------------------------------------

TEST(Gate, given_an_empty_map_then_nothing_is_ok) {
    Terrain nothing;
    nothing.height.fill(kNanF);
    for (int code = 1; code < Machine::kMovementCodes; ++code)
        expect_refused(ask(nothing, static_cast<std::uint8_t>(code)), Reason::unknown_cells);
}

TEST(Gate, given_one_unknown_cell_under_the_landing_foot_then_it_is_named) {
    Terrain floor;
    floor.paint(floor.height, 0.45, 0.474, 0.175, 0.199, static_cast<double>(kNanF));
    const Verdict verdict = ask(floor, kForward);
    expect_refused(verdict, Reason::unknown_cells);
    EXPECT_EQ(verdict.evidence.worst_x_tenth_mm, 4625);
    EXPECT_EQ(verdict.evidence.worst_y_tenth_mm, 1875);
    EXPECT_EQ(verdict.evidence.foot, Foot::left);
    EXPECT_LT(verdict.evidence.known_cells, verdict.evidence.cells);
    expect_ok(ask(floor, kBackward));  // backwards this ground is not needed
}

TEST(Gate, any_single_unknown_cell_of_the_swept_area_inhibits) {
    Terrain floor;
    const auto map = floor.snapshot();
    const Machine machine = rex();
    // Everything between the rear of the body at the start and the drop band ahead of the toes.
    for (double x = -0.36; x < 0.73; x += 0.025) {
        for (const double y : {-0.3, -0.18, 0.0, 0.18, 0.3}) {
            const std::size_t at = cell_at(*map, x, y);
            const auto before = map->source[at];
            map->source[at] = grid::EvidenceSource::unknown;
            seal(*map);
            const Verdict verdict =
                decide(machine, query_at_body(kForward, *map), *map, kReady, kNowNs);
            EXPECT_EQ(verdict.primary, Reason::unknown_cells) << x << " " << y << words(verdict);
            map->source[at] = before;
        }
    }
}

TEST(Gate, given_ground_never_seen_ahead_then_a_step_there_is_refused) {
    Terrain floor;
    floor.draw({"????????????",  //
                "????????????",  //
                "????????????",  //
                "............",  //
                "............",  //
                "............",  //
                "............",  //
                "............",  //
                "............",  //
                "............",  //
                "............",  //
                "............"});
    expect_refused(ask(floor, kForward), Reason::unknown_cells);
    expect_ok(ask(floor, kBackward));
    expect_ok(ask(floor, kLeft));
}

TEST(Gate, given_the_edge_of_the_map_ahead_then_outside_map) {
    Terrain floor;
    floor.input.T_odom_body.translation_m.x() = 2.4;
    expect_refused(ask(floor, kForward), Reason::outside_map);
    expect_ok(ask(floor, kBackward));
    floor.input.T_odom_body.translation_m.x() = 50.0;
    const Verdict off_the_map = ask(floor, kBackward);
    expect_refused(off_the_map, Reason::outside_map);
    EXPECT_TRUE(off_the_map.reasons.contains(Reason::unknown_cells)) << "no stance either";
}

// ---- terrain ------------------------------------------------------------------------------------

TEST(Gate, given_a_table_ahead_then_the_way_is_blocked) {
    Terrain room;
    room.draw({"...777777...",  //
               "............",  //
               "............",  //
               "............",  //
               "............",  //
               "............",  //
               "............",  //
               "............",  //
               "............",  //
               "............",  //
               "............",  //
               "............"});
    expect_ok(ask(room, kForward));  // 1.0 m away: one step does not reach it
    room.box(0.6, 1.0, -0.6, 0.6, 0.7);
    const Verdict blocked = ask(room, kForward);
    expect_refused(blocked, Reason::corridor_blocked);
    EXPECT_EQ(blocked.evidence.value_tenth_mm, 7000);
    EXPECT_TRUE(blocked.reasons.contains(Reason::body_clearance));
    expect_ok(ask(room, kBackward));
}

TEST(Gate, given_something_only_the_body_meets_then_body_clearance) {
    Terrain room;
    room.box(0.2, 0.6, 0.325, 0.5, 0.5);  // a wall beside the left foot, within the sway
    const Verdict verdict = ask(room, kForward);
    expect_refused(verdict, Reason::body_clearance);
    EXPECT_FALSE(verdict.reasons.contains(Reason::corridor_blocked)) << words(verdict);
    // A kerb there is lower than the body and outside the path of the foot.
    Terrain kerb;
    kerb.box(0.2, 0.6, 0.325, 0.5, 0.1);
    expect_ok(ask(kerb, kForward));
}

TEST(Gate, given_a_lintel_above_then_body_clearance) {
    Terrain door;
    door.paint(door.clearance, 0.4, 0.6, -0.5, 0.5, 1.9);
    const Verdict verdict = ask(door, kForward);
    expect_refused(verdict, Reason::body_clearance);
    EXPECT_EQ(verdict.evidence.limit_tenth_mm, 20500);
    door.paint(door.clearance, 0.4, 0.6, -0.5, 0.5, 2.1);
    expect_ok(ask(door, kForward));
}

TEST(Gate, given_the_top_of_a_table_then_it_is_flat_but_not_reachable) {
    Terrain top;
    top.box(0.26, 3.0, -3.0, 3.0, 0.7);
    const Verdict verdict = ask(top, kForward);
    expect_refused(verdict, Reason::step_too_high);
    EXPECT_EQ(verdict.evidence.height_delta_tenth_mm, 7000);
    EXPECT_TRUE(verdict.reasons.contains(Reason::disconnected)) << words(verdict);
    EXPECT_TRUE(verdict.reasons.contains(Reason::corridor_blocked));
}

TEST(Gate, kerbs_up_and_down_are_refused_and_small_steps_are_not) {
    struct Case {
        double height_m;
        Decision decision;
        Reason primary;
    };
    const Case cases[] = {{0.015, Decision::ok, Reason::none},
                          {0.025, Decision::not_traversable, Reason::step_too_high},
                          {0.075, Decision::not_traversable, Reason::step_too_high},
                          {-0.015, Decision::ok, Reason::none},
                          {-0.025, Decision::not_traversable, Reason::step_too_low},
                          {-0.075, Decision::not_traversable, Reason::drop_off}};
    for (const Case& c : cases) {
        Terrain street;
        street.box(0.26, 3.0, -3.0, 3.0, c.height_m);
        const Verdict verdict = ask(street, kForward);
        EXPECT_EQ(verdict.decision, c.decision) << c.height_m << " " << words(verdict);
        EXPECT_EQ(verdict.primary, c.primary) << c.height_m << " " << words(verdict);
    }
}

TEST(Gate, given_half_a_foot_over_a_platform_edge_then_drop_off) {
    for (const bool below_is_seen : {true, false}) {
        Terrain platform;
        platform.box(0.46, 3.0, -3.0, 3.0, below_is_seen ? -0.5 : static_cast<double>(kNanF));
        const Verdict verdict = ask(platform, kForward);
        expect_refused(verdict, below_is_seen ? Reason::drop_off : Reason::unknown_cells);
        expect_ok(ask(platform, kBackward));
    }
}

TEST(Gate, given_a_drop_in_the_band_beyond_the_toes_then_drop_off) {
    Terrain platform;
    platform.box(0.70, 3.0, -3.0, 3.0, -0.3);  // 0.06 m beyond the toes at 0.64 m
    expect_refused(ask(platform, kForward), Reason::drop_off);
    Terrain farther;
    farther.box(0.80, 3.0, -3.0, 3.0, -0.3);
    expect_ok(ask(farther, kForward));
}

TEST(Gate, given_only_the_far_side_of_a_drop_was_seen_then_its_edge_is_a_drop) {
    Terrain platform;
    platform.box(0.70, 1.0, -3.0, 3.0, static_cast<double>(kNanF));  // in the shadow of the edge
    platform.box(1.0, 3.0, -3.0, 3.0, -0.3);
    const Verdict verdict = ask(platform, kForward);
    expect_refused(verdict, Reason::drop_off);
    EXPECT_EQ(verdict.evidence.value_tenth_mm, 0) << "the edge shows no depth";
    EXPECT_TRUE(verdict.reasons.contains(Reason::unknown_cells));
}

TEST(Gate, given_a_hole_under_one_foot_then_drop_off) {
    Terrain floor;
    floor.box(0.4, 0.5, -0.2, -0.1, -0.3);
    const Verdict verdict = ask(floor, kForward);
    expect_refused(verdict, Reason::drop_off);
    EXPECT_EQ(verdict.evidence.foot, Foot::right);
    EXPECT_EQ(verdict.evidence.value_tenth_mm, 3000);
}

TEST(Gate, given_a_table_beside_the_way_then_its_edge_is_no_drop) {
    Terrain room;  // the table's rim carries drop evidence; the floor is where we stand
    room.box(-1.0, 2.0, 0.40, 1.0, 0.7);
    expect_ok(ask(room, kForward));
}

TEST(Gate, slopes_up_to_the_limit_pass_and_beyond_are_refused) {
    const auto ramp = [](double deg) {
        Terrain terrain;
        for (int v = 0; v < 240; ++v) {
            for (int u = 0; u < 240; ++u) {
                const double y_m = terrain.geometry.center_m({u, v}).y();
                terrain.height.at(u, v) =
                    static_cast<float>(std::tan(deg * std::numbers::pi / 180.0) * y_m);
            }
        }
        return ask(terrain, kForward);
    };
    // Across the path: each foot stands 18 cm to the side, so only small angles keep the step
    // limits.
    expect_ok(ramp(4.0));
    const Verdict steep = ramp(8.0);
    EXPECT_EQ(steep.decision, Decision::not_traversable);
    EXPECT_TRUE(steep.reasons.contains(Reason::slope)) << words(steep);
}

TEST(Gate, slope_alone_is_a_reason_of_its_own) {
    // A wedge under the toes of the left foot: 7 deg, its middle at stance height.
    Terrain wedge;
    for (int v = 0; v < 240; ++v) {
        for (int u = 0; u < 240; ++u) {
            const Eigen::Vector2d c = wedge.geometry.center_m({u, v});
            if (c.x() > 0.26 && c.x() < 0.66 && c.y() > 0.05 && c.y() < 0.31)
                wedge.height.at(u, v) = static_cast<float>(std::tan(0.122) * (c.x() - 0.457));
        }
    }
    const Verdict verdict = ask(wedge, kForward);
    expect_refused(verdict, Reason::slope);
    // tan(0.122) = 0.1226, tan(6 deg) = 0.1051; 0.124 with the cells that only touch the foot.
    const std::string text = text_of(verdict, Query{}, rex());
    EXPECT_NE(text.find("ground sloping 12."), text.npos) << text;
    EXPECT_NE(text.find("(limit 10.5 %)"), text.npos) << text;
}

/// A ridge, 75 mm wide, across the middle of one landing foot: no drop, no step, no tilt.
Verdict ridge_under(double y0, double y1, double height_m, double sigma_m) {
    Terrain floor;
    floor.variance.fill(static_cast<float>(sigma_m * sigma_m));
    floor.box(0.425, 0.50, y0, y1, height_m);
    return ask(floor, kForward);
}

TEST(Gate, given_a_ridge_under_either_foot_then_roughness) {
    for (const bool left : {true, false}) {
        const Verdict verdict = ridge_under(left ? 0.05 : -0.30, left ? 0.30 : -0.05, 0.036, 0.001);
        expect_refused(verdict, Reason::roughness);
        EXPECT_EQ(verdict.reasons, ReasonSet(Reason::roughness)) << words(verdict);
        EXPECT_EQ(verdict.evidence.foot, left ? Foot::left : Foot::right);
        EXPECT_GT(verdict.evidence.value_tenth_mm, 250);
    }
}

TEST(Gate, a_toe_on_the_beginning_of_a_ramp_is_a_step_though_the_middle_of_the_foot_is_none) {
    // The landing feet reach from 0.274 to 0.640 m; 1:8 from x on lifts the toes by 14 or 26 mm.
    for (const auto& [begin_m, allowed] : {std::pair{0.53, true}, std::pair{0.43, false}}) {
        for (const double sign : {1.0, -1.0}) {
            Terrain ramp;
            for (int v = 0; v < 240; ++v) {
                for (int u = 0; u < 240; ++u) {
                    const double x_m = ramp.geometry.center_m({u, v}).x();
                    if (x_m > begin_m)
                        ramp.height.at(u, v) = static_cast<float>(sign * (x_m - begin_m) / 8.0);
                }
            }
            const Verdict verdict = ask(ramp, kForward);
            if (allowed) {
                expect_ok(verdict);
                continue;
            }
            expect_refused(verdict, sign > 0.0 ? Reason::step_too_high : Reason::step_too_low);
            EXPECT_EQ(verdict.evidence.limit_tenth_mm, 200);
            EXPECT_NEAR(static_cast<double>(verdict.evidence.value_tenth_mm), 260.0, 16.0);
            EXPECT_NEAR(static_cast<double>(verdict.evidence.worst_x_tenth_mm), 6375.0, 1.0);
            EXPECT_NE(verdict.evidence.foot, Foot::none);
        }
    }
}

TEST(Gate, the_noise_of_a_patch_counts_against_its_residual) {
    // Highest patch of a 20 mm ridge: about 16 mm over the plane; 3.4 sigma = 1.7 or 9.7 mm on top.
    expect_ok(ridge_under(0.05, 0.30, 0.020, 0.001));
    const Verdict noisy = ridge_under(0.05, 0.30, 0.020, 0.0057);
    EXPECT_EQ(noisy.reasons, ReasonSet(Reason::roughness)) << words(noisy);
    EXPECT_LE(noisy.evidence.value_tenth_mm, 250);
}

TEST(Gate, a_gentle_wedge_along_or_across_the_foot_is_a_plane_not_roughness) {
    constexpr double kGentle = 0.0875;  // tan 5 deg
    for (const double yaw : {0.0, std::numbers::pi / 2.0}) {
        for (const bool along : {true, false}) {
            Terrain wedge;
            // In the axes of the machine: under the left landing foot, its middle at stance height.
            for (int v = 0; v < 240; ++v) {
                for (int u = 0; u < 240; ++u) {
                    const Eigen::Vector2d c = wedge.geometry.center_m({u, v});
                    const double forward = std::cos(yaw) * c.x() + std::sin(yaw) * c.y();
                    const double left = std::cos(yaw) * c.y() - std::sin(yaw) * c.x();
                    if (forward < 0.26 || forward > 0.66 || left < 0.05 || left > 0.31) continue;
                    wedge.height.at(u, v) =
                        static_cast<float>(kGentle * (along ? forward - 0.457 : left - 0.18));
                }
            }
            const auto map = wedge.snapshot();
            const Query query = make_query(kForward, 0.0, 0.0, std::cos(yaw), std::sin(yaw));
            expect_ok(decide(rex(), query, *map, kReady, kNowNs));
            EXPECT_FALSE(HasFailure()) << "yaw " << yaw << (along ? " along" : " across");
        }
    }
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
    // Under the body, which would pass over an object of 0.14 m.
    for (const auto& [sigma_m, beside_m, allowed] : {std::tuple{0.0125, 0.0119, true},
                                                     {0.0239, 0.0119, true},
                                                     {0.0242, 0.0119, false},
                                                     {0.0125, 0.0122, false}}) {
        Terrain floor;
        floor.paint(floor.variance, -0.20, -0.175, 0.0, 0.025, sigma_m * sigma_m);
        floor.paint(floor.variance, -0.20, -0.175, -0.025, 0.0, beside_m * beside_m);
        const Verdict verdict = ask(floor, kForward);
        EXPECT_EQ(verdict.decision == Decision::ok, allowed) << sigma_m << words(verdict);
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

TEST(Gate, one_cell_alone_above_or_below_the_step_is_no_step_but_two_are) {
    for (const double sign : {1.0, -1.0}) {
        const Reason step = sign > 0.0 ? Reason::step_too_high : Reason::step_too_low;
        Terrain pebble;
        pebble.box(0.40, 0.425, 0.15, 0.175, sign * 0.030);
        expect_ok(ask(pebble, kForward));
        for (const auto& [x0, y0] : {std::pair{0.425, 0.15}, {0.425, 0.175}, {0.375, 0.175}}) {
            Terrain two = pebble;
            two.box(x0, x0 + 0.025, y0, y0 + 0.025, sign * 0.030);
            EXPECT_TRUE(ask(two, kForward).reasons.contains(step)) << x0 << " " << y0;
        }
        Terrain unseen = pebble;
        unseen.box(0.425, 0.45, 0.15, 0.175, kNanF);
        expect_refused(ask(unseen, kForward), Reason::unknown_cells);
    }
    // On rows of pegs the whole foot would stand: one peg under a foot is a pebble, two are not.
    Terrain pegs;
    pegs.box(0.40, 0.425, 0.15, 0.175, 0.036);
    expect_ok(ask(pegs, kForward));
    pegs.box(0.50, 0.525, 0.15, 0.175, 0.036);
    EXPECT_TRUE(ask(pegs, kForward).reasons.contains(Reason::step_too_high));
    Terrain one_each;
    one_each.box(0.40, 0.425, 0.15, 0.175, 0.036).box(0.40, 0.425, -0.175, -0.15, 0.036);
    expect_ok(ask(one_each, kForward));
    Terrain post;
    post.box(0.40, 0.425, 0.15, 0.175, 0.041);
    EXPECT_TRUE(ask(post, kForward).reasons.contains(Reason::step_too_high));
    Terrain pit;
    pit.box(0.40, 0.425, 0.15, 0.175, -0.051);
    EXPECT_TRUE(ask(pit, kForward).reasons.contains(Reason::step_too_low));
}

// The stance height is the mean of both feet, but each foot must keep the limits alone, too.
TEST(Gate, a_foot_that_stood_high_may_not_step_down_by_twice_the_limit) {
    struct Case {
        double left_m, right_m;            // positions of the feet
        double left_then_m, right_then_m;  // positions of the feet after the landing
        Reason reason;
    };
    const Case cases[] = {{0.0, 0.0, 0.0, 0.0, Reason::none},
                          {0.010, -0.010, 0.010, -0.010, Reason::none},
                          {0.010, -0.010, -0.010, 0.010, Reason::none},
                          {0.010, -0.010, -0.0099, -0.010, Reason::none},
                          {0.010, -0.010, -0.0101, -0.010, Reason::step_too_low},
                          {0.0, -0.030, -0.030, -0.030, Reason::step_too_low},
                          {-0.015, 0.015, 0.015, -0.015, Reason::step_too_high}};
    for (const Case& c : cases) {
        Terrain floor;
        floor.box(-1.0, 0.25, 0.0, 1.0, c.left_m).box(-1.0, 0.25, -1.0, 0.0, c.right_m);
        floor.box(0.25, 1.0, 0.0, 1.0, c.left_then_m).box(0.25, 1.0, -1.0, 0.0, c.right_then_m);
        const Verdict verdict = ask(floor, kForward);
        EXPECT_EQ(verdict.decision == Decision::ok, c.reason == Reason::none)
            << c.left_m << " " << c.left_then_m << words(verdict);
        if (c.reason != Reason::none) {
            EXPECT_TRUE(verdict.reasons.contains(c.reason))
                << c.left_m << " " << c.left_then_m << words(verdict);
        }
    }
}

TEST(Gate, given_an_island_at_floor_height_then_disconnected) {
    Terrain gap;
    const auto map = gap.snapshot();
    for (double x = 0.26; x < 0.9; x += 0.025) {
        for (double y = -0.5; y < 0.5; y += 0.025) map->component[cell_at(*map, x, y)] = 7;
    }
    seal(*map);
    expect_refused(ask(*map, kForward), Reason::disconnected);
    map->component[cell_at(*map, 0.0, 0.18)] = 7;  // one cell under a foot connects the surfaces
    seal(*map);
    expect_ok(ask(*map, kForward));
}

TEST(Gate, given_too_much_drift_since_a_cell_was_seen_then_memory_uncertain) {
    Terrain floor;
    floor.drift.fill(0.024F);
    expect_ok(ask(floor, kBackward));
    floor.paint(floor.drift, -0.4, -0.3, -0.3, 0.3, 0.03);
    const Verdict verdict = ask(floor, kBackward);
    expect_refused(verdict, Reason::memory_uncertain);
    EXPECT_EQ(verdict.evidence.value_tenth_mm, 300);
    floor.drift.fill(kNanF);
    expect_refused(ask(floor, kForward), Reason::memory_uncertain);
}

TEST(Gate, what_drifted_may_stand_nearer_than_the_map_says) {
    // Body and sway reach 0.40 m to the side; 3.4 sigma of the drift beyond 10 mm are 48 mm.
    for (const auto& [drift_m, y_m, allowed] : {std::tuple{0.010, 0.40, true},
                                                {0.024, 0.40, false},
                                                {0.024, 0.425, false},
                                                {0.024, 0.45, true}}) {
        Terrain wall;
        wall.box(-3.0, 3.0, y_m, 3.0, 0.8);
        wall.drift.fill(static_cast<float>(drift_m));
        const Verdict verdict = ask(wall, kForward);
        EXPECT_EQ(verdict.decision == Decision::ok, allowed) << drift_m << " " << y_m;
        if (!allowed) expect_refused(verdict, Reason::body_clearance);
    }
    // The drifted cell need not be the obstacle.
    Terrain wall;
    wall.box(-3.0, 3.0, 0.425, 3.0, 0.8);
    wall.paint(wall.drift, 0.4, 0.425, -0.1, -0.075, 0.024);
    expect_refused(ask(wall, kForward), Reason::body_clearance);
}

TEST(Gate, given_something_under_the_present_feet_then_it_counts_too) {
    Terrain floor;
    floor.box(0.0, 0.05, 0.15, 0.2, 0.3);
    EXPECT_TRUE(ask(floor, kForward).reasons.contains(Reason::corridor_blocked));
    Terrain hole;
    hole.box(0.0, 0.05, 0.15, 0.2, -0.3);
    EXPECT_TRUE(ask(hole, kForward).reasons.contains(Reason::drop_off));
}

TEST(Gate, the_height_of_the_stance_comes_from_the_map_or_from_the_caller) {
    Terrain low;
    low.height.fill(-0.2F);
    const auto map = low.snapshot();
    Query query = query_at_body(kForward, *map);
    const Verdict by_map = decide(rex(), query, *map, kReady, kNowNs);
    expect_ok(by_map);
    EXPECT_EQ(by_map.evidence.stance_height_tenth_mm, -2000);
    query.stance_source = StanceHeight::given;
    query.stance_height_tenth_mm = -1950;
    expect_ok(decide(rex(), query, *map, kReady, kNowNs));
    query.stance_height_tenth_mm = 0;
    expect_refused(decide(rex(), query, *map, kReady, kNowNs), Reason::drop_off);
    query.stance_source = static_cast<StanceHeight>(9);
    expect_error(decide(rex(), query, *map, kReady, kNowNs), Reason::bad_number);
}

// ---- the attested start area --------------------------------------------------------------------

struct AttestedStart : ::testing::Test {
    Terrain floor;
    Query query;
    std::unique_ptr<grid::MapSnapshot> map;

    /// Floor known from 0.6 m ahead on, as at start-up.
    void SetUp() override {
        floor.box(-3.0, 0.6, -3.0, 3.0, static_cast<double>(kNanF));
        rebuild();
        query = query_at_body(kForward, *map);
        query.attested = {true, 0, 0, 8500, 0};
    }
    void rebuild() { map = floor.snapshot(); }
    [[nodiscard]] Verdict ask_now() const { return decide(rex(), query, *map, kReady, kNowNs); }
};

TEST_F(AttestedStart, is_off_by_default_and_the_first_step_is_then_refused) {
    query.attested.active = false;
    expect_refused(ask_now(), Reason::unknown_cells);
}

TEST_F(AttestedStart, lets_the_first_step_go_onto_remembered_floor_and_says_so) {
    const Verdict verdict = ask_now();
    expect_ok(verdict);
    EXPECT_GT(verdict.evidence.attested_cells, 0);
    EXPECT_LT(verdict.evidence.attested_cells, verdict.evidence.known_cells);
}

TEST_F(AttestedStart, is_void_outside_and_too_small_where_it_does_not_reach) {
    // All unknown ground lies in the area, but base_link has just left it.
    Terrain spot;
    spot.box(-0.35, -0.25, -0.05, 0.05, static_cast<double>(kNanF));
    map = spot.snapshot();
    query.attested = {true, -6000, 0, 6000, 0};
    expect_ok(ask_now());
    query.attested = {true, -6001, 0, 6000, 0};
    expect_refused(ask_now(), Reason::unknown_cells);
    rebuild();
    query.attested = {true, 0, 0, 3000, 0};
    expect_refused(ask_now(), Reason::unknown_cells);
}

TEST_F(AttestedStart, never_covers_what_was_measured) {
    floor.box(0.40, 0.45, 0.15, 0.20, 0.3);
    rebuild();
    EXPECT_TRUE(ask_now().reasons.contains(Reason::corridor_blocked)) << words(ask_now());
    floor.box(0.40, 0.45, 0.15, 0.20, -0.3);
    rebuild();
    EXPECT_TRUE(ask_now().reasons.contains(Reason::drop_off)) << words(ask_now());
}

TEST_F(AttestedStart, stands_for_a_measurement_that_is_unsure_and_agrees) {
    // The row of cells at the lower image border: few points, seen from one position.
    const auto row_with = [&](double height_m, std::uint16_t sigma_tenth_mm, double x_m) {
        floor = Terrain();
        floor.box(-3.0, 0.6, -3.0, 3.0, static_cast<double>(kNanF));
        floor.box(x_m, x_m + 0.025, -1.0, 1.0, height_m);
        rebuild();
        for (double y_m = -0.99; y_m < 1.0; y_m += 0.025)
            map->sigma_tenth_mm[cell_at(*map, x_m + 0.01, y_m)] = sigma_tenth_mm;
        seal(*map);
    };
    constexpr std::uint16_t kUnsure = 150;
    row_with(0.0, kUnsure, 0.6);
    expect_ok(ask_now());
    query.attested.radius_tenth_mm = 6000;  // the row lies outside
    EXPECT_TRUE(ask_now().reasons.contains(Reason::not_resolvable)) << words(ask_now());
    query.attested.radius_tenth_mm = 8500;
    row_with(0.015, kUnsure, 0.6);
    expect_ok(ask_now());
    row_with(0.0151, kUnsure, 0.6);
    EXPECT_TRUE(ask_now().reasons.contains(Reason::not_resolvable)) << words(ask_now());
    row_with(-0.0151, kUnsure, 0.6);
    EXPECT_TRUE(ask_now().reasons.contains(Reason::not_resolvable)) << words(ask_now());
    // A cell with a smaller sigma counts as measured, whatever the attestation says.
    row_with(0.0, 79, 0.5);
    const std::int64_t measured = ask_now().evidence.attested_cells;
    row_with(0.0, 80, 0.5);
    EXPECT_GT(ask_now().evidence.attested_cells, measured);
}

TEST_F(AttestedStart, leaves_what_hangs_over_an_unsure_cell_and_evidence_of_a_drop) {
    constexpr std::uint16_t kUnsure = 150;
    const auto unsure_cell = [&] {
        floor = Terrain();
        floor.box(-3.0, 0.4, -3.0, 3.0, static_cast<double>(kNanF));
        rebuild();
        const std::size_t at = cell_at(*map, 0.51, 0.18);
        map->sigma_tenth_mm[at] = kUnsure;
        return at;
    };
    std::size_t at = unsure_cell();
    seal(*map);
    expect_ok(ask_now());
    at = unsure_cell();
    map->clearance_tenth_mm[at] = 10'000;
    seal(*map);
    EXPECT_TRUE(ask_now().reasons.contains(Reason::body_clearance)) << words(ask_now());
    at = unsure_cell();
    map->drop_evidence[at] = 255;
    seal(*map);
    EXPECT_TRUE(ask_now().reasons.contains(Reason::drop_off)) << words(ask_now());
}

TEST_F(AttestedStart, does_not_tie_in_a_floor_at_another_height) {
    query.attested.height_tenth_mm = 450;
    const Verdict verdict = ask_now();
    EXPECT_EQ(verdict.decision, Decision::not_traversable);
    EXPECT_TRUE(verdict.reasons.contains(Reason::disconnected)) << words(verdict);
}

TEST_F(AttestedStart, a_proven_drop_beats_the_word) {
    floor.input.drop_evidence = {};
    const std::size_t at = cell_at(*map, 0.4, 0.18);
    map->drop_evidence[at] = 255;
    seal(*map);
    expect_refused(ask_now(), Reason::drop_off);
}

TEST_F(AttestedStart, must_be_bounded) {
    query.attested.radius_tenth_mm = 10001;
    expect_error(ask_now(), Reason::bad_number);
    query.attested.radius_tenth_mm = 0;
    expect_error(ask_now(), Reason::bad_number);
    query.attested = {true, std::numeric_limits<std::int64_t>::min(), 0, 8500, 0};
    expect_error(ask_now(), Reason::bad_number);
}

// ---- readiness ----------------------------------------------------------------------------------

TEST(GateReadiness, ages_are_two_sided) {
    struct Case {
        std::int64_t frame_age_ms;
        std::int64_t pose_age_ms;
        Reason primary;
    };
    const Case cases[] = {{200, 200, Reason::none},
                          {201, 0, Reason::frame_stale},
                          {0, 201, Reason::pose_stale},
                          {-5, -5, Reason::none},
                          {-6, 0, Reason::time_skew},
                          {0, -6, Reason::time_skew},
                          {4999, 10, Reason::frame_stale}};
    for (const Case& c : cases) {
        Terrain floor;
        floor.input.frame_time_ns = kNowNs - c.frame_age_ms * kMs;
        floor.input.pose_time_ns = kNowNs - c.pose_age_ms * kMs;
        const Verdict verdict = ask(floor, kForward);
        EXPECT_EQ(verdict.primary, c.primary)
            << c.frame_age_ms << " " << c.pose_age_ms << " " << words(verdict);
    }
}

TEST(GateReadiness, extreme_stamps_do_not_overflow) {
    constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();
    constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
    for (const std::int64_t stamp : {kMin, std::int64_t{0}, kMax}) {
        for (const std::int64_t now : {kMin, std::int64_t{-1}, kNowNs, kMax}) {
            Terrain floor;
            floor.input.frame_time_ns = stamp;
            const auto map = floor.snapshot();
            const Verdict verdict = decide(rex(), query_at_body(kForward, *map), *map, kReady, now);
            EXPECT_EQ(verdict.decision, Decision::error) << stamp << " " << now;
        }
    }
}

TEST(GateReadiness, only_ready_can_say_ok) {
    Terrain floor;
    const auto map = floor.snapshot();
    for (int state = 0; state < 256; ++state) {
        const GateHealth health{static_cast<GateState>(state), {}};
        const Verdict verdict = decide(rex(), query_at_body(kForward, *map), *map, health, kNowNs);
        if (health.state == GateState::ready)
            expect_ok(verdict);
        else
            expect_error(verdict,
                         health.state == GateState::warmup ? Reason::warmup : Reason::not_ready);
    }
}

TEST(GateReadiness, every_raised_fault_is_an_error_under_its_own_name) {
    Terrain floor;
    const auto map = floor.snapshot();
    for (int i = 0; i < kReasonCount; ++i) {
        const auto fault = static_cast<Reason>(i);
        const GateHealth health{GateState::ready, ReasonSet(fault)};
        const Verdict verdict = decide(rex(), query_at_body(kForward, *map), *map, health, kNowNs);
        expect_error(verdict, is_error(fault) ? fault : Reason::internal);
    }
}

TEST(GateReadiness, gravity_must_be_measured) {
    for (int source = 0; source < 5; ++source) {
        Terrain floor;
        floor.input.gravity_source = static_cast<grid::GravitySource>(source);
        const Verdict verdict = ask(floor, kForward);
        if (source == 1 || source == 2)
            expect_ok(verdict);
        else
            expect_error(verdict, Reason::plane_invalid);
    }
}

TEST(GateReadiness, odometry_must_be_healthy) {
    Terrain floor;
    floor.input.health = grid::SnapshotHealth::lost;
    expect_error(ask(floor, kForward), Reason::pose_lost);
    floor.input.health = grid::SnapshotHealth::degraded;
    expect_error(ask(floor, kForward), Reason::not_ready);
    floor.input.health = static_cast<grid::SnapshotHealth>(77);
    expect_error(ask(floor, kForward), Reason::pose_lost);
}

TEST(GateReadiness, the_camera_must_bring_new_and_whole_images) {
    Terrain floor;
    floor.input.camera = CameraState::frozen;
    expect_error(ask(floor, kForward), Reason::frame_frozen);
    floor.input.camera = CameraState::corrupt;
    expect_error(ask(floor, kForward), Reason::frame_corrupt);
    floor.input.camera = CameraState::overexposed;
    expect_error(ask(floor, kForward), Reason::exposure);
    floor.input.camera = CameraState::dark;
    expect_error(ask(floor, kForward), Reason::blind);
    floor.input.camera = CameraState::moved;
    expect_error(ask(floor, kForward), Reason::mount_moved);
    floor.input.camera = CameraState::leaning;
    expect_error(ask(floor, kForward), Reason::plane_invalid);
    for (const int camera : {0, 8, 255}) {
        floor.input.camera = static_cast<CameraState>(camera);
        expect_error(ask(floor, kForward), Reason::not_ready);
    }
    // A freeze begins before its symptoms, so it is the reason even if the map has aged too.
    floor.input.camera = CameraState::frozen;
    floor.input.frame_time_ns = floor.input.pose_time_ns = kNowNs - 1000 * kMs;
    expect_error(ask(floor, kForward), Reason::frame_frozen);
}

TEST(GateReadiness, a_damaged_map_is_an_internal_error) {
    Terrain floor;
    const auto map = floor.snapshot();
    std::int32_t& height = map->height_tenth_mm[cell_at(*map, 0.3, 0.2)];
    height ^= 1;
    const Verdict verdict = ask(*map, kForward);
    expect_error(verdict, Reason::internal);
    EXPECT_TRUE(verdict.evidence.lacks(Proof::cells_intact));
    EXPECT_EQ(verdict.evidence.cells, 0) << "nothing is judged on it";
    height ^= 1;
    expect_ok(ask(*map, kForward));
    map->version ^= 1;
    expect_error(ask(*map, kForward), Reason::internal);
    map->version ^= 1;
    // The verdict does not read cells far from the step; a reader of the whole map does.
    map->height_tenth_mm[cell_at(*map, 2.0, 2.9)] ^= 1;
    expect_ok(ask(*map, kForward));
    EXPECT_TRUE(snapshot_faults(rex(), *map, kNowNs).contains(Reason::internal));
}

/// A changed bit in any cell that decide() may read is detected, or has no effect.
TEST(GateReadiness, no_verdict_is_made_of_a_changed_cell) {
    Terrain floor;
    const auto map = floor.snapshot();
    for (const std::uint8_t command : {kForward, kBackward, kLeft, kTurnRight}) {
        Query query = query_at_body(command, *map);
        query.attested = {true, 0, 0, 6000, 0};
        const Verdict before = decide(rex(), query, *map, kReady, kNowNs);
        expect_ok(before);
        for (std::size_t i = 0; i < 240UL * 240UL; i += 37) {
            map->source[i] = grid::EvidenceSource::unknown;
            map->component[i] ^= 1;
            const Verdict after = decide(rex(), query, *map, kReady, kNowNs);
            map->source[i] = grid::EvidenceSource::measured;
            map->component[i] ^= 1;
            if (after.decision == Decision::error) continue;
            ASSERT_EQ(after.decision, Decision::ok) << "cell " << i << ": " << words(after);
            ASSERT_EQ(after.evidence.known_cells, before.evidence.known_cells) << "cell " << i;
            ASSERT_EQ(after.evidence.attested_cells, before.evidence.attested_cells)
                << "cell " << i;
        }
    }
}

TEST(GateReadiness, numbers_must_be_finite_and_small) {
    Terrain floor;
    const auto map = floor.snapshot();
    const double nan = std::nan("");
    const double inf = std::numeric_limits<double>::infinity();
    const Query bad[] = {make_query(kForward, nan, 0, 1, 0),
                         make_query(kForward, 0, inf, 1, 0),
                         make_query(kForward, 0, 0, nan, 0),
                         make_query(kForward, 0, 0, 1, nan),
                         make_query(kForward, 0, 0, inf, 0),
                         make_query(kForward, 0, 0, 0, 0),
                         make_query(kForward, 0, 0, 0.9, 0),
                         make_query(kForward, 0, 0, 1, 0.1),
                         make_query(kForward, 1e300, 0, 1, 0),
                         make_query(kForward, -1e6, 0, 1, 0)};
    for (const Query& query : bad)
        expect_error(decide(rex(), query, *map, kReady, kNowNs), Reason::bad_number);
}

TEST(GateReadiness, all_256_codes_are_either_configured_or_an_error) {
    Terrain floor;
    const auto map = floor.snapshot();
    Machine four = rex();
    for (std::size_t code = 0; code < four.movements.size(); ++code) {
        if (code != kForward && code != kRight && code != kBackward && code != kLeft)
            four.movements[code] = Movement{};
    }
    for (int code = 0; code < 256; ++code) {
        const auto command = static_cast<std::uint8_t>(code);
        const Query query = query_at_body(command, *map);
        const Verdict all = decide(rex(), query, *map, kReady, kNowNs);
        if (code >= 1 && code <= 26)
            expect_ok(all);
        else
            expect_error(all, Reason::unknown_command);
        const Verdict few = decide(four, query, *map, kReady, kNowNs);
        if (four.movements.size() > command && four.movements[command].configured)
            expect_ok(few);
        else
            expect_error(few, Reason::unknown_command);
    }
}

TEST(GateReadiness, a_class_that_is_off_has_no_movements) {
    Terrain floor;
    const auto map = floor.snapshot();
    Machine machine = rex();
    machine.movements[kForward].movement_class = MovementClass::stair;
    const Query query = query_at_body(kForward, *map);
    expect_error(decide(machine, query, *map, kReady, kNowNs), Reason::unknown_command);
    machine.limits.step[1].enabled = true;
    expect_ok(decide(machine, query, *map, kReady, kNowNs));
}

TEST(GateReadiness, an_error_hides_no_terrain_and_beats_it) {
    Terrain nothing;
    nothing.height.fill(kNanF);
    nothing.input.frame_time_ns = 0;
    expect_error(ask(nothing, kForward), Reason::frame_stale);
}

// ---- the text -----------------------------------------------------------------------------------

TEST(VerdictText, says_what_where_value_and_limit) {
    Terrain hole;
    hole.box(0.55, 0.60, 0.15, 0.20, -0.17);
    const auto map = hole.snapshot();
    const Query query = query_at_body(kForward, *map);
    const Verdict verdict = decide(rex(), query, *map, kReady, kNowNs);
    // The cell's centre at 0.5625 m, the toes at 0.240 m.
    EXPECT_EQ(text_of(verdict, query, rex()),
              "drop of 0.17 m, 0.32 m ahead of the left foot (limit 0.050 m)");
}

TEST(VerdictText, every_reason_has_a_sentence_and_a_code) {
    for (int i = 0; i < kReasonCount; ++i) {
        Verdict verdict;
        verdict.primary = static_cast<Reason>(i);
        verdict.decision = is_error(verdict.primary) ? Decision::error : Decision::not_traversable;
        const std::string text = text_of(verdict, Query{}, rex());
        EXPECT_GT(text.size(), 12U) << to_string(verdict.primary);
        EXPECT_NE(text, to_string(verdict.primary));
        for (int j = 0; j < i; ++j)
            EXPECT_STRNE(to_string(static_cast<Reason>(j)), to_string(verdict.primary));
    }
    EXPECT_STREQ(to_string(static_cast<Reason>(200)), "INTERNAL");
    EXPECT_STREQ(to_string(static_cast<Decision>(200)), "ERROR");
}

/// A rim that the map shows one cell too far away is still an obstacle.
TEST(Gate, what_the_map_shows_a_cell_beside_its_place_still_counts) {
    const double body_m = 0.4 + 0.33 + 0.05;  // step, half the box, sway
    const auto table_at = [](double x_m) {
        Terrain room;
        room.box(x_m, x_m + 0.2, 0.25, 0.3, 0.7);
        return ask(room, kForward);
    };
    expect_refused(table_at(body_m + 0.02), Reason::body_clearance);
    expect_ok(table_at(body_m + 0.05));
    const auto drop_at = [](double x_m) {
        Terrain room;
        room.box(x_m, 3.0, -3.0, 3.0, -0.3);
        return ask(room, kForward).reasons.contains(Reason::drop_off);
    };
    const double toes_m = 0.4 + 0.057 + 0.183;
    EXPECT_TRUE(drop_at(toes_m + 0.10 + 0.02));
    EXPECT_FALSE(drop_at(toes_m + 0.10 + 0.05));
}

// ---- parts of the body --------------------------------------------------------------------------

/// Legs 0.5 m wide up to the hips, above them a frame of 1.0 m.
Machine with_legs_and_frame() {
    Machine machine = rex();
    machine.body.parts[0] = {{0, 0, 4000, 5000}, 1440, 9900};
    machine.body.parts[1] = {{0, 0, 6600, 10000}, 7000, 20500};
    machine.body.count = 2;
    machine.body.sway_tenth_mm = 0;
    return machine;
}
Verdict ask_with(const Machine& machine, Terrain& terrain) {
    const auto map = terrain.snapshot();
    return decide(machine, query_at_body(kForward, *map), *map, kReady, kNowNs);
}

TEST(GateBody, each_part_has_its_own_box_and_heights) {
    const Machine machine = with_legs_and_frame();
    const auto beside = [&](double height_m) {  // 0.35 m to the side: frame, but no leg
        Terrain floor;
        floor.box(-0.1, 0.3, 0.33, 0.40, height_m);
        return ask_with(machine, floor);
    };
    expect_ok(beside(0.68));
    expect_refused(beside(0.69), Reason::not_resolvable);  // 3.4 sigma are 14 mm
    expect_refused(beside(0.72), Reason::body_clearance);
    EXPECT_EQ(beside(0.72).evidence.limit_tenth_mm, 7000);
    const auto far = [&](double height_m) {  // beyond the frame
        Terrain floor;
        floor.box(-0.1, 0.3, 0.55, 0.60, height_m);
        return ask_with(machine, floor);
    };
    expect_ok(far(1.5));
    // Both parts at once: the reported part is the one whose limit is broken by more.
    Terrain wall;
    wall.box(0.5, 0.6, -0.5, 0.5, 1.5);
    expect_refused(ask_with(machine, wall), Reason::corridor_blocked);
    EXPECT_TRUE(ask_with(machine, wall).reasons.contains(Reason::body_clearance));
}

TEST(GateBody, what_hangs_meets_the_part_that_is_as_high_and_is_said_to_hang) {
    const Machine machine = with_legs_and_frame();
    const auto hanging = [&](double y0, double y1, double clearance_m) {
        Terrain floor;
        floor.paint(floor.clearance, -0.1, 0.3, y0, y1, clearance_m + 1e-5);
        return ask_with(machine, floor);
    };
    expect_ok(hanging(0.33, 0.40, 2.06));
    const Verdict frame = hanging(0.33, 0.40, 1.9);
    expect_refused(frame, Reason::body_clearance);
    EXPECT_TRUE(frame.evidence.overhead);
    EXPECT_EQ(frame.evidence.value_tenth_mm, 19'000);
    EXPECT_EQ(frame.evidence.limit_tenth_mm, 20'500);
    Terrain floor;
    floor.paint(floor.clearance, -0.1, 0.3, 0.33, 0.40, 1.9);
    const auto map = floor.snapshot();
    const Query query = query_at_body(kForward, *map);
    EXPECT_NE(text_of(frame, query, machine).find("only 1.90 m of room"), std::string::npos)
        << text_of(frame, query, machine);
    expect_ok(hanging(0.55, 0.60, 0.5));
}

TEST(GateBody, what_hangs_low_meets_a_lifted_foot_where_no_part_of_the_body_comes) {
    Machine machine = with_legs_and_frame();
    machine.body.parts[0].box = machine.body.parts[1].box = {-2000, 0, 1000, 1000};
    const auto hanging = [&](double clearance_m) {  // over the landing toes
        Terrain floor;
        floor.paint(floor.clearance, 0.58, 0.62, 0.1, 0.25, clearance_m);
        return ask_with(machine, floor);
    };
    expect_ok(hanging(0.19));  // legs begin at 0.144, a foot is lifted by 0.04
    const Verdict low = hanging(0.18);
    expect_refused(low, Reason::corridor_blocked);
    EXPECT_TRUE(low.evidence.overhead);
}

}  // namespace
}  // namespace surefoot::gate::testing

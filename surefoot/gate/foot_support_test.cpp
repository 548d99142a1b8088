// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/foot_support.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

/// The rule for one landing foot alone, on a map that is set cell by cell.
struct FootOnGround {
    Terrain terrain;
    std::unique_ptr<grid::MapSnapshot> map;
    Machine machine = rex();
    Query query = make_query(kForward, 0.0, 0.0, 1.0, 0.0);
    std::size_t foot = 0;

    explicit FootOnGround(double resolution_m = kResolutionM) {
        terrain.geometry.resolution_m = resolution_m;
        terrain.geometry.origin_m.setConstant(-120.0 * resolution_m);
        map = terrain.snapshot();
        map->sigma_tenth_mm.fill(0);
    }
    [[nodiscard]] Sweep sweep() const {
        return sweep_of(
            machine,
            fixed_pose(query.x_tenth_mm, query.y_tenth_mm, query.cos_yaw, query.sin_yaw),
            machine.movements[query.command]);
    }
    [[nodiscard]] Findings look() const {
        const Sweep all = sweep();
        const Ground ground(*map, query, machine.limits);
        const Scene scene{machine,
                          machine.movements[query.command],
                          ground,
                          all,
                          Stance::level_at(query.stance_height_tenth_mm)};
        ReachableSurfaces reachable;
        reachable.add(1);
        Findings findings;
        check_landing(scene,
                      all.feet[foot],
                      foot == 0 ? machine.left_foot : machine.right_foot,
                      reachable,
                      findings);
        return findings;
    }
    [[nodiscard]] ReasonSet reasons() const { return look().reasons(); }
    /// Moves the machine by less than a cell: the middle of the foot lies on the last 0.1 mm of its
    /// cell, so a finding must be that exact to name this cell.
    void go_to_the_end_of_a_cell() {
        const grid::FixedPoint p = sweep().feet[foot].landing_center;
        const std::int64_t side = map->resolution_tenth_mm;
        const auto missing = [side](std::int64_t place, std::int64_t origin) {
            return side - 1 - (place - origin) % side;
        };
        query.x_tenth_mm += missing(p.x, map->origin_x_tenth_mm);
        query.y_tenth_mm += missing(p.y, map->origin_y_tenth_mm);
    }
    [[nodiscard]] bool is_in_the_middle(const Finding* where) const {
        return where != nullptr &&
               static_cast<std::size_t>(where->cell_y * map->nx + where->cell_x) == middle();
    }
    /// The cell at the middle of the landing foot, or a cell at an offset from it.
    [[nodiscard]] std::size_t middle(int dx = 0, int dy = 0) const {
        const grid::FixedPoint p = sweep().feet[foot].landing_center;
        const std::int64_t side = map->resolution_tenth_mm;
        const std::int64_t ix = grid::floor_div(p.x - map->origin_x_tenth_mm, side) + dx;
        const std::int64_t iy = grid::floor_div(p.y - map->origin_y_tenth_mm, side) + dy;
        return static_cast<std::size_t>(iy * map->nx + ix);
    }
};

struct PlainPatch {
    double n = 0.0, weight = 0.0, x = 0.0, y = 0.0, z = 0.0, variance = 0.0;
};

/// Computes the same rule in plain floating point, as the reference for the integers.
struct PlainFoot {
    double height = 0.0, tilt_tan_sq = 0.0, largest_variance = 0.0;
    double largest_residual = 0.0, second_residual = 0.0;  ///< values of rough patches
    double rough_x = 0.0, rough_y = 0.0;  ///< place of the largest residual among rough patches
    bool rough = false, unsure = false;
    double nearest_to_a_limit =
        1e9;  ///< where rounding could decide otherwise, nothing is compared

    PlainFoot(const FootOnGround& on, const GroundBox& box) {
        const Sweep sweep = on.sweep();
        const FootSweep& foot = sweep.feet[on.foot];
        const GateLimits& limits = on.machine.limits;
        const double yaw = std::atan2(static_cast<double>(sweep.target.sin_yaw),
                                      static_cast<double>(sweep.target.cos_yaw));
        const int along = std::max(1, box.length_tenth_mm / limits.patch_side_tenth_mm);
        const int across = std::max(1, box.width_tenth_mm / limits.patch_side_tenth_mm);
        std::vector<PlainPatch> patches(static_cast<std::size_t>(along * across));
        std::vector<Eigen::Vector3d> cells;
        const double side = on.map->resolution_tenth_mm;
        const Ground ground(*on.map, on.query, on.machine.limits);
        grid::for_each_overlapped_cell(
            foot.landing, ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
                const auto at = static_cast<std::size_t>(iy * on.map->nx + ix);
                const double x = static_cast<double>(on.map->origin_x_tenth_mm) +
                                 (static_cast<double>(ix) + 0.5) * side -
                                 static_cast<double>(foot.landing_center.x);
                const double y = static_cast<double>(on.map->origin_y_tenth_mm) +
                                 (static_cast<double>(iy) + 0.5) * side -
                                 static_cast<double>(foot.landing_center.y);
                const double z = on.map->height_tenth_mm[at] - on.query.stance_height_tenth_mm;
                const double sigma = on.map->sigma_tenth_mm[at];
                cells.emplace_back(x, y, z);
                const double u = std::cos(yaw) * x + std::sin(yaw) * y;
                const double v = std::cos(yaw) * y - std::sin(yaw) * x;
                const double row = (u / box.length_tenth_mm + 0.5) * along;
                const double column = (v / box.width_tenth_mm + 0.5) * across;
                for (const double border : {row, column}) {
                    if (std::abs(border - std::round(border)) < 1e-4) nearest_to_a_limit = 0.0;
                }
                PlainPatch& patch = patches[static_cast<std::size_t>(
                    std::clamp(static_cast<int>(std::floor(row)), 0, along - 1) * across +
                    std::clamp(static_cast<int>(std::floor(column)), 0, across - 1))];
                const double sure = limits.patch_sigma_tenth_mm;
                const double w = sigma > sure ? sure * sure / (sigma * sigma) : 1.0;
                patch.n += 1.0;
                patch.weight += w;
                patch.x += w * x;
                patch.y += w * y;
                patch.z += w * z;
                patch.variance += w * w * sigma * sigma;
                return true;
            });
        Eigen::MatrixXd a(cells.size(), 3);
        Eigen::VectorXd b(cells.size());
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            a.row(row) << 1.0, cells[i].x(), cells[i].y();
            b(row) = cells[i].z();
        }
        const Eigen::Vector3d plane = a.colPivHouseholderQr().solve(b);
        height = plane[0];
        tilt_tan_sq = plane[1] * plane[1] + plane[2] * plane[2];
        for (const PlainPatch& patch : patches) judge(patch, plane, limits);
    }

  private:
    void judge(const PlainPatch& patch, const Eigen::Vector3d& plane, const GateLimits& limits) {
        if (patch.n == 0.0) return;
        const double alike =
            patch.n / std::min(patch.n, static_cast<double>(limits.patch_independent_cells));
        const double variance = alike * patch.variance / (patch.weight * patch.weight);
        const double sure = limits.patch_sigma_tenth_mm;
        const double x = patch.x / patch.weight;
        const double y = patch.y / patch.weight;
        const double size =
            std::abs(patch.z / patch.weight - (plane[0] + plane[1] * x + plane[2] * y));
        const double noise =
            variance <= sure * sure ? limits.sigma_factor * std::sqrt(variance) : 0.0;
        const double over = size + noise - limits.patch_residual_tenth_mm;
        nearest_to_a_limit =
            std::min({nearest_to_a_limit, std::abs(over), std::abs(std::sqrt(variance) - sure)});
        largest_variance = std::max(largest_variance, variance);
        unsure = unsure || variance > sure * sure;
        if (over <= 0.0) return;
        rough = true;
        second_residual = std::max(second_residual, std::min(size, largest_residual));
        if (size > largest_residual) {
            largest_residual = size;
            rough_x = x;
            rough_y = y;
        }
    }
};

TEST(FootSupport, agrees_with_a_plain_least_squares_plane_and_plain_patches) {
    Rng rng(31);
    int rough = 0;
    int unsure = 0;
    int compared = 0;
    for (int round = 0; round < 300; ++round) {
        FootOnGround on(round % 5 == 4 ? 0.0125 : kResolutionM);
        on.foot = static_cast<std::size_t>(round % 2);
        on.query.command = static_cast<std::uint8_t>(1 + rng.below(26));
        const double yaw = rng.uniform(-3.1, 3.1);
        on.query.cos_yaw = std::cos(yaw);
        on.query.sin_yaw = std::sin(yaw);
        on.query.x_tenth_mm = std::llround(rng.uniform(-3000.0, 3000.0));
        on.query.y_tenth_mm = std::llround(rng.uniform(-3000.0, 3000.0));
        on.query.stance_height_tenth_mm = 500;
        on.machine.limits.patch_independent_cells = static_cast<std::int32_t>(1 + rng.below(8));
        on.machine.limits.patch_residual_tenth_mm = static_cast<std::int32_t>(60 + rng.below(120));
        on.machine.limits.patch_side_tenth_mm = 400 + 100 * (round % 3);
        for (GroundBox* box : {&on.machine.left_foot, &on.machine.right_foot}) {
            box->length_tenth_mm = static_cast<std::int32_t>(600 + rng.below(3100));
            box->width_tenth_mm = static_cast<std::int32_t>(600 + rng.below(1400));
        }
        const double tilt_x = rng.uniform(-0.04, 0.04);
        const double tilt_y = rng.uniform(-0.04, 0.04);
        const double noise = rng.uniform(10.0, 130.0);
        const double most_sigma = rng.uniform(20.0, 90.0);
        const std::int64_t reach = 11'000 / on.map->resolution_tenth_mm;
        for (std::int64_t iy = 120 - reach; iy < 120 + reach; ++iy) {
            for (std::int64_t ix = 120 - reach; ix < 120 + reach; ++ix) {
                const auto at = static_cast<std::size_t>(iy * 240 + ix);
                const double side = on.map->resolution_tenth_mm;
                on.map->height_tenth_mm[at] = static_cast<std::int32_t>(
                    500.0 + tilt_x * side * static_cast<double>(ix - 120) +
                    tilt_y * side * static_cast<double>(iy - 120) + rng.uniform(-noise, noise));
                on.map->sigma_tenth_mm[at] =
                    static_cast<std::uint16_t>(rng.uniform(0.0, most_sigma));
            }
        }
        const GroundBox& box = on.foot == 0 ? on.machine.left_foot : on.machine.right_foot;
        const PlainFoot plain(on, box);
        const Findings findings = on.look();
        SCOPED_TRACE(round);
        EXPECT_NEAR(
            static_cast<double>(findings.evidence.height_delta_tenth_mm), plain.height, 0.5 + 1e-6);
        EXPECT_NEAR(findings.evidence.max_tilt_tan_sq, plain.tilt_tan_sq, 1e-13);
        if (plain.nearest_to_a_limit < 1e-3) continue;
        ++compared;
        EXPECT_NEAR(findings.evidence.max_patch_sigma_sq_tenth_mm2, plain.largest_variance, 1e-6);
        EXPECT_EQ(findings.reasons().contains(Reason::roughness), plain.rough);
        EXPECT_EQ(findings.reasons().contains(Reason::not_resolvable), plain.unsure);
        const double steepest = on.machine.limits.min_normal_z;
        EXPECT_EQ(findings.reasons().contains(Reason::slope),
                  plain.tilt_tan_sq > 1.0 / (steepest * steepest) - 1.0);
        rough += plain.rough ? 1 : 0;
        unsure += plain.unsure ? 1 : 0;
        if (!plain.rough || !findings.reasons().contains(Reason::roughness)) continue;
        const Finding& worst = *findings.worst(Reason::roughness);
        EXPECT_NEAR(static_cast<double>(worst.value_tenth_mm), plain.largest_residual, 0.5 + 1e-6);
        EXPECT_EQ(worst.limit_tenth_mm, on.machine.limits.patch_residual_tenth_mm);
        if (plain.largest_residual - plain.second_residual < 1.0) continue;  // ambiguous maximum
        const grid::FixedPoint middle = on.sweep().feet[on.foot].landing_center;
        const double side = on.map->resolution_tenth_mm;
        const double cell_x =
            (static_cast<double>(middle.x - on.map->origin_x_tenth_mm) + plain.rough_x) / side;
        const double cell_y =
            (static_cast<double>(middle.y - on.map->origin_y_tenth_mm) + plain.rough_y) / side;
        EXPECT_NEAR(static_cast<double>(worst.cell_x) + 0.5, cell_x, 0.51);
        EXPECT_NEAR(static_cast<double>(worst.cell_y) + 0.5, cell_y, 0.51);
    }
    // Both results of each rule must occur, or nothing was compared.
    EXPECT_GT(compared, 200);
    EXPECT_GT(rough, 15);
    EXPECT_LT(rough, compared - 25);
    EXPECT_GT(unsure, 15);
    EXPECT_LT(unsure, compared - 25);
}

TEST(FootSupport, a_level_foot_may_stand_as_high_and_as_low_as_a_step) {
    FootOnGround on;
    on.go_to_the_end_of_a_cell();
    on.machine.limits.step[0] = {true, 200, 150};
    on.query.stance_height_tenth_mm = -40;
    const auto at_rise = [&](std::int32_t rise) {
        on.map->height_tenth_mm.fill(rise - 40);
        return on.look();
    };
    for (const std::int32_t rise : {200, -150, 0}) {
        EXPECT_TRUE(at_rise(rise).reasons().empty()) << rise;
        EXPECT_EQ(at_rise(rise).evidence.height_delta_tenth_mm, rise);
    }
    const Findings high = at_rise(201);
    EXPECT_EQ(high.reasons(), ReasonSet(Reason::step_too_high));
    EXPECT_EQ(high.worst(Reason::step_too_high)->value_tenth_mm, 201);
    EXPECT_EQ(high.worst(Reason::step_too_high)->limit_tenth_mm, 200);
    EXPECT_EQ(high.worst(Reason::step_too_high)->severity, 201);
    EXPECT_EQ(high.worst(Reason::step_too_high)->foot, Foot::left);
    EXPECT_TRUE(on.is_in_the_middle(high.worst(Reason::step_too_high)));
    const Findings low = at_rise(-151);
    EXPECT_EQ(low.reasons(), ReasonSet(Reason::step_too_low));
    EXPECT_EQ(low.worst(Reason::step_too_low)->value_tenth_mm, 151);
    EXPECT_EQ(low.worst(Reason::step_too_low)->limit_tenth_mm, 150);
}

TEST(FootSupport, the_limits_are_those_of_the_class_of_the_movement) {
    FootOnGround on;
    on.map->height_tenth_mm.fill(1000);
    EXPECT_EQ(on.reasons(), ReasonSet(Reason::step_too_high));
    on.machine.movements[kForward].movement_class = MovementClass::stair;
    EXPECT_TRUE(on.reasons().empty());
}

TEST(FootSupport, a_single_cell_beyond_the_step_limits_counts_when_it_is_no_pebble) {
    struct Case {
        std::int32_t height;
        std::int32_t beside;  // height of one of the eight neighbours
        Reason reason;
    };
    const Case cases[] = {{200, 0, Reason::none},
                          {201, 0, Reason::none},
                          {400, 0, Reason::none},
                          {401, 0, Reason::step_too_high},
                          {300, 200, Reason::none},
                          {300, 201, Reason::step_too_high},
                          {-150, 0, Reason::none},
                          {-151, 0, Reason::none},
                          {-500, 0, Reason::none},
                          {-501, 0, Reason::step_too_low},
                          {-300, -150, Reason::none},
                          {-300, -151, Reason::step_too_low}};
    for (const Case& c : cases) {
        for (const int dx : {-1, 1}) {
            FootOnGround on;
            on.machine.limits.step[0] = {true, 200, 150};
            on.machine.limits.patch_residual_tenth_mm = 500;
            on.map->height_tenth_mm[on.middle()] = c.height;
            on.map->height_tenth_mm[on.middle(dx, 1)] = c.beside;
            EXPECT_EQ(on.reasons(), ReasonSet(c.reason)) << c.height << " " << c.beside;
        }
    }
    FootOnGround on;
    on.machine.limits.patch_residual_tenth_mm = 500;
    on.query.stance_height_tenth_mm = -100;  // the step limits count from the stance
    on.map->height_tenth_mm.fill(-100);
    on.map->height_tenth_mm[on.middle()] = 150;
    EXPECT_TRUE(on.reasons().empty());
    on.map->height_tenth_mm[on.middle(1, 0)] = 120;
    EXPECT_EQ(on.reasons(), ReasonSet(Reason::step_too_high));
    EXPECT_EQ(on.look().worst(Reason::step_too_high)->value_tenth_mm, 250) << "the highest";
}

TEST(FootSupport, two_levels_under_one_foot_are_told_apart_before_a_plane_is_believed) {
    FootOnGround on;
    on.go_to_the_end_of_a_cell();
    on.map->height_tenth_mm[on.middle()] = -501;
    on.map->height_tenth_mm[on.middle(2, 0)] = on.map->height_tenth_mm[on.middle(3, 0)] = 400;
    const Findings apart = on.look();
    ASSERT_EQ(apart.reasons(), ReasonSet(Reason::roughness));
    EXPECT_EQ(apart.worst(Reason::roughness)->value_tenth_mm, 901);
    EXPECT_EQ(apart.worst(Reason::roughness)->limit_tenth_mm, 900);
    EXPECT_TRUE(on.is_in_the_middle(apart.worst(Reason::roughness)));
    on.map->height_tenth_mm[on.middle(2, 0)] = on.map->height_tenth_mm[on.middle(3, 0)] = 399;
    EXPECT_NE(on.reasons(), ReasonSet(Reason::roughness)) << "900: a plane is asked";
    EXPECT_GT(on.look().evidence.max_tilt_tan_sq, 0.0);
    EXPECT_EQ(apart.evidence.max_tilt_tan_sq, 0.0);
}

TEST(FootSupport, the_first_cell_counts_like_every_other) {
    for (const std::int32_t sign : {1, -1}) {
        FootOnGround on;
        std::size_t first = 0;
        const Sweep sweep = on.sweep();
        const Ground ground(*on.map, on.query, on.machine.limits);
        grid::for_each_overlapped_cell(
            sweep.feet[0].landing, ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
                first = static_cast<std::size_t>(iy * on.map->nx + ix);
                return false;
            });
        on.map->height_tenth_mm.fill(sign * 150);
        on.map->height_tenth_mm[first] = sign * 100;
        on.map->height_tenth_mm[on.middle()] = sign * 1001;
        const Findings findings = on.look();
        ASSERT_EQ(findings.reasons(), ReasonSet(Reason::roughness));
        EXPECT_EQ(findings.worst(Reason::roughness)->value_tenth_mm, 901);
    }
}

TEST(FootSupport, heights_beyond_three_metres_count_as_three_metres) {
    for (const std::int32_t sign : {1, -1}) {
        FootOnGround on;
        on.map->height_tenth_mm[on.middle()] = sign * 40'000;
        ASSERT_EQ(on.reasons(), ReasonSet(Reason::roughness));
        EXPECT_EQ(on.look().worst(Reason::roughness)->value_tenth_mm, 30'000);
        on.map->height_tenth_mm[on.middle()] = sign * 29'999;
        EXPECT_EQ(on.look().worst(Reason::roughness)->value_tenth_mm, 29'999);
    }
}

TEST(FootSupport, a_patch_must_be_as_sure_as_its_limit) {
    FootOnGround on;
    on.machine.limits.patch_independent_cells = 1;
    on.map->sigma_tenth_mm.fill(30);
    EXPECT_TRUE(on.reasons().empty());
    EXPECT_EQ(on.look().evidence.max_patch_sigma_sq_tenth_mm2, 900.0);
    on.map->sigma_tenth_mm.fill(31);
    const Findings unsure = on.look();
    EXPECT_EQ(unsure.reasons(), ReasonSet(Reason::not_resolvable));
    EXPECT_EQ(unsure.worst(Reason::not_resolvable)->value_tenth_mm, 0);
    EXPECT_EQ(unsure.worst(Reason::not_resolvable)->limit_tenth_mm, 30);
    EXPECT_EQ(unsure.worst(Reason::not_resolvable)->severity, 961);
}

TEST(FootSupport, a_patch_may_stand_out_as_far_as_its_limit) {
    for (const std::int32_t sign : {1, -1}) {
        FootOnGround on;  // nothing else is refused: one patch grows by a fraction of 0.1 mm
        on.machine.limits.step[0] = {true, 3000, 3000};
        on.machine.limits.swing_clearance_tenth_mm = 2000;
        on.machine.limits.min_normal_z = 0.98;
        const std::size_t cells[] = {
            on.middle(), on.middle(-1), on.middle(0, -1), on.middle(-1, -1)};
        int grown = 0;
        while (on.reasons().empty() && grown < 4000)
            on.map->height_tenth_mm[cells[grown++ % 4]] += sign;
        const Findings findings = on.look();
        ASSERT_EQ(findings.reasons(), ReasonSet(Reason::roughness));
        EXPECT_EQ(findings.worst(Reason::roughness)->value_tenth_mm, 250);
        EXPECT_EQ(findings.worst(Reason::roughness)->limit_tenth_mm, 250);
    }
}

TEST(FootSupport, ground_that_is_not_known_or_not_joined_carries_no_foot) {
    FootOnGround on;
    const std::size_t at = on.middle();
    on.map->component[at] = 2;
    EXPECT_EQ(on.reasons(), ReasonSet(Reason::disconnected));
    EXPECT_EQ(on.look().worst(Reason::disconnected)->value_tenth_mm, 0) << "no length decides";
    EXPECT_EQ(on.look().worst(Reason::disconnected)->limit_tenth_mm, 0);
    on.map->component[at] = 1;
    on.map->source[at] = grid::EvidenceSource::unknown;
    EXPECT_EQ(on.reasons(), ReasonSet(Reason::unknown_cells));
    on.query.attested = {true, 0, 0, 10'000, 0};
    EXPECT_TRUE(on.reasons().empty()) << "attested ground belongs to no surface";
    on.query.attested.active = false;
    on.query.x_tenth_mm = 28'000;
    EXPECT_EQ(on.reasons(), ReasonSet(Reason::outside_map));
}

TEST(FootSupport, fewer_cells_than_make_a_plane_resolve_nothing) {
    struct Case {
        double x_m, y_m;
        bool plane;
    };
    // Cells of 0.2 m: the left foot covers two cells, three in a row, or two rows of three.
    for (const Case& c :
         {Case{0.1429, 0.1199, false}, Case{0.0, 0.1199, false}, Case{0.0, 0.0, true}}) {
        FootOnGround on(0.2);
        on.query.x_tenth_mm = std::llround(c.x_m * 1e4);
        on.query.y_tenth_mm = std::llround(c.y_m * 1e4);
        const Findings findings = on.look();
        EXPECT_EQ(findings.reasons().empty(), c.plane) << c.x_m << " " << c.y_m;
        if (c.plane) continue;
        EXPECT_EQ(findings.reasons(), ReasonSet(Reason::not_resolvable));
        EXPECT_TRUE(on.is_in_the_middle(findings.worst(Reason::not_resolvable)));
        EXPECT_EQ(findings.worst(Reason::not_resolvable)->value_tenth_mm, 0);
        EXPECT_EQ(findings.worst(Reason::not_resolvable)->limit_tenth_mm, 0);
    }
}

TEST(FootSupport, the_steepest_tilt_is_that_of_the_limit) {
    for (const double yaw : {0.0, 0.6, 1.9}) {
        for (const auto& [tan, allowed] : {std::pair{0.1049, true}, std::pair{0.1053, false}}) {
            FootOnGround on;  // 6 deg: 0.1051
            on.machine.limits.step[0] = {true, 3000, 3000};
            on.query.cos_yaw = std::cos(yaw);
            on.query.sin_yaw = std::sin(yaw);
            on.go_to_the_end_of_a_cell();
            for (std::int64_t iy = 0; iy < 240; ++iy) {
                for (std::int64_t ix = 0; ix < 240; ++ix)
                    on.map->height_tenth_mm[static_cast<std::size_t>(iy * 240 + ix)] =
                        static_cast<std::int32_t>(
                            std::lround(tan * 250.0 *
                                        (0.6 * static_cast<double>(ix - 120) +
                                         0.8 * static_cast<double>(iy - 120))));
            }
            const Findings findings = on.look();
            EXPECT_EQ(findings.reasons().empty(), allowed) << yaw << " " << tan;
            if (allowed) continue;
            EXPECT_EQ(findings.reasons(), ReasonSet(Reason::slope));
            EXPECT_NEAR(static_cast<double>(findings.worst(Reason::slope)->severity),
                        1e6 * tan * tan,
                        30.0);
            EXPECT_TRUE(on.is_in_the_middle(findings.worst(Reason::slope)));
            EXPECT_EQ(findings.worst(Reason::slope)->value_tenth_mm, 0);
            EXPECT_EQ(findings.worst(Reason::slope)->limit_tenth_mm, 0);
        }
    }
}

}  // namespace
}  // namespace surefoot::gate::testing

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/regions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

/// A map whose cells are set to the tenth of a millimetre: level, certain, fresh. The rules are
/// tested one by one, without decide().
struct Floor {
    Terrain terrain;
    std::unique_ptr<grid::MapSnapshot> map = terrain.snapshot();
    Machine machine = rex();
    Query query = query_at_body(kForward, *map);

    Floor() {
        map->sigma_tenth_mm.fill(0);
        map->drift_tenth_mm.fill(0);
    }
    [[nodiscard]] std::size_t at(double x_m, double y_m) const { return cell_at(*map, x_m, y_m); }
    /// Sets a layer in a cell and in its eight neighbours.
    template <typename Layer, typename Value>
    void around(Layer& layer, double x_m, double y_m, Value value) const {
        for (const double dx : {-kResolutionM, 0.0, kResolutionM}) {
            for (const double dy : {-kResolutionM, 0.0, kResolutionM})
                layer[at(x_m + dx, y_m + dy)] = value;
        }
    }
    template <typename Check>
    [[nodiscard]] Findings look(Check&& check) const {
        const Movement& movement = machine.movements[query.command];
        const FixedPose start =
            fixed_pose(query.x_tenth_mm, query.y_tenth_mm, query.cos_yaw, query.sin_yaw);
        const Sweep sweep = sweep_of(machine, start, movement);
        const Ground ground(*map, query, machine.limits);
        Findings findings;
        check(
            Scene{machine, movement, ground, sweep, Stance::level_at(query.stance_height_tenth_mm)},
            findings);
        return findings;
    }
    [[nodiscard]] std::optional<std::int64_t> stance() const {
        std::optional<std::int64_t> height;
        static_cast<void>(look([&](const Scene& scene, Findings&) {
            const Stance stance = find_stance(scene.ground, query, scene.sweep, false);
            if (stance.known) height = stance.plane.height_tenth_mm;
        }));
        return height;
    }
};

constexpr double kUnderLeftX = 0.0625, kUnderLeftY = 0.1875;  // middles of cells: under the foot,
constexpr double kAheadX = 0.3625, kBetweenY = 0.0125;        // in the way, between the feet,
constexpr double kLandingX = 0.4625, kBandX = 0.6875;         // where it lands, and beyond its toes

void expect_worst(
    const Findings& findings, Reason reason, std::int64_t value, std::int64_t limit, Foot foot) {
    EXPECT_EQ(findings.reasons(), ReasonSet(reason));
    const Finding* worst = findings.worst(reason);
    ASSERT_NE(worst, nullptr);
    EXPECT_EQ(worst->value_tenth_mm, value);
    EXPECT_EQ(worst->limit_tenth_mm, limit);
    EXPECT_EQ(worst->foot, foot);
}

TEST(StanceHeight, is_the_mean_of_all_known_cells_under_both_feet_to_the_nearest) {
    Floor floor;
    std::int64_t cells = 0;
    static_cast<void>(floor.look([&](const Scene& scene, Findings&) {
        for (const FootSweep& foot : scene.sweep.feet) {
            grid::for_each_overlapped_cell(
                foot.stance, scene.ground.grid(), [&](std::int64_t, std::int64_t) {
                    ++cells;
                    return true;
                });
        }
    }));
    ASSERT_GT(cells, 200);
    for (const std::int64_t sum :
         {std::int64_t{0}, cells / 2 - 1, (cells + 1) / 2, cells, 7 * cells, -cells, -5 * cells}) {
        floor.map->height_tenth_mm[floor.at(kUnderLeftX, kUnderLeftY)] =
            static_cast<std::int32_t>(sum);
        const double mean = static_cast<double>(sum) / static_cast<double>(cells);
        EXPECT_EQ(floor.stance(), static_cast<std::int64_t>(std::floor(mean + 0.5))) << sum;
    }
    floor.map->height_tenth_mm[floor.at(kUnderLeftX, kUnderLeftY)] = 0;
    floor.map->height_tenth_mm[floor.at(kUnderLeftX, -kUnderLeftY)] =
        static_cast<std::int32_t>(3 * cells);
    EXPECT_EQ(floor.stance(), 3) << "the right foot counts as much";
}

TEST(StanceHeight, of_what_is_known_and_of_nothing_is_none) {
    Floor floor;
    floor.map->height_tenth_mm.fill(77);
    EXPECT_EQ(floor.stance(), 77);
    floor.map->source.fill(grid::EvidenceSource::unknown);
    EXPECT_EQ(floor.stance(), std::nullopt);
    const std::size_t only = floor.at(kUnderLeftX, kUnderLeftY);
    floor.map->source[only] = grid::EvidenceSource::measured;
    floor.map->height_tenth_mm[only] = 12;
    EXPECT_EQ(floor.stance(), 12);
    floor.query.stance_source = StanceHeight::given;
    floor.query.stance_height_tenth_mm = -9;
    EXPECT_EQ(floor.stance(), -9);
}

TEST(SurfacesOfStance, are_those_within_the_swing_clearance_of_the_stance) {
    for (const auto& [rise, reached] :
         {std::pair{400, true}, {401, false}, {-400, true}, {-401, false}}) {
        Floor floor;
        const std::size_t at = floor.at(kUnderLeftX, -kUnderLeftY);
        floor.map->height_tenth_mm[at] = 50 + rise;
        floor.map->component[at] = 9;
        floor.map->component[floor.at(1.0, 0.0)] = 10;  // not under a foot
        floor.query.stance_height_tenth_mm = 50;
        static_cast<void>(floor.look([&](const Scene& scene, Findings&) {
            const ReachableSurfaces surfaces = surfaces_of_stance(scene);
            EXPECT_EQ(surfaces.contains(9), reached) << rise;
            EXPECT_FALSE(surfaces.contains(10));
        }));
    }
}

TEST(SurfacesOfStance, attested_cells_are_of_none_and_the_area_ties_in_what_it_touches) {
    Floor floor;
    floor.map->component.fill(3);
    floor.map->source.fill(grid::EvidenceSource::unknown);
    floor.map->source[floor.at(0.5, 0.0)] = grid::EvidenceSource::measured;
    floor.query.attested = {true, 0, 0, 6000, 0};
    static_cast<void>(floor.look([&](const Scene& scene, Findings&) {
        EXPECT_TRUE(surfaces_of_stance(scene).contains(3));
    }));
    floor.query.attested.active = false;
    static_cast<void>(floor.look([&](const Scene& scene, Findings&) {
        EXPECT_FALSE(surfaces_of_stance(scene).contains(3));
    }));
}

TEST(Regions, every_limit_holds_to_the_tenth_of_a_millimetre) {
    struct Case {
        const char* name;
        void (*check)(const Scene&, Findings&);
        double x, y;
        std::int32_t sign;
        std::int32_t limit;
        Reason reason;
        Foot foot;
    };
    const Case cases[] = {
        {"stance", check_stance, kUnderLeftX, kUnderLeftY, -1, 500, Reason::drop_off, Foot::left},
        {"stance", check_stance, kUnderLeftX, -kUnderLeftY, -1, 500, Reason::drop_off, Foot::right},
        {"way",
         check_corridors,
         kAheadX,
         kUnderLeftY,
         1,
         400,
         Reason::corridor_blocked,
         Foot::left},
        {"way",
         check_corridors,
         kAheadX,
         -kUnderLeftY,
         1,
         400,
         Reason::corridor_blocked,
         Foot::right},
        {"body", check_body, kAheadX, kBetweenY, 1, 1440, Reason::body_clearance, Foot::none},
        {"band", check_bands, kBandX, kUnderLeftY, -1, 500, Reason::drop_off, Foot::left},
        {"band", check_bands, kBandX, -kUnderLeftY, -1, 500, Reason::drop_off, Foot::right},
    };
    for (const Case& c : cases) {
        SCOPED_TRACE(c.name);
        Floor floor;
        floor.map->height_tenth_mm.fill(30);
        floor.query.stance_height_tenth_mm = 30;
        std::int32_t& height = floor.map->height_tenth_mm[floor.at(c.x, c.y)];
        height = 30 + c.sign * c.limit;
        EXPECT_TRUE(floor.look(c.check).reasons().empty());
        height = 30 - c.sign * 3000;
        EXPECT_TRUE(floor.look(c.check).reasons().empty()) << "the other way is not its affair";
        height = 30 + c.sign * (c.limit + 1);
        const Findings findings = floor.look(c.check);
        expect_worst(findings, c.reason, c.limit + 1, c.limit, c.foot);
        EXPECT_EQ(findings.worst(c.reason)->cell_x, std::llround((c.x + 3.0) / 0.025 - 0.5));
        EXPECT_EQ(findings.worst(c.reason)->cell_y, std::llround((c.y + 3.0) / 0.025 - 0.5));
    }
}

TEST(Regions, what_hangs_must_leave_room_for_a_lifted_foot_and_for_the_body) {
    Floor floor;
    floor.map->height_tenth_mm.fill(20);
    std::uint16_t& clearance = floor.map->clearance_tenth_mm[floor.at(kAheadX, kUnderLeftY)];
    // The body begins at 1440, a foot is lifted by 400; the ground lies 20 above the stance.
    clearance = 1820;
    EXPECT_TRUE(floor.look(check_corridors).reasons().empty());
    clearance = 1819;
    const Findings low = floor.look(check_corridors);
    expect_worst(low, Reason::corridor_blocked, 1839, 1840, Foot::left);
    EXPECT_TRUE(low.worst(Reason::corridor_blocked)->overhead);
    EXPECT_EQ(low.worst(Reason::corridor_blocked)->severity, 1);
    clearance = 20480;
    EXPECT_TRUE(floor.look(check_body).reasons().empty());
    clearance = 20470;
    const Findings head = floor.look(check_body);
    expect_worst(head, Reason::body_clearance, 20490, 20500, Foot::none);
    EXPECT_TRUE(head.worst(Reason::body_clearance)->overhead);
    EXPECT_EQ(head.worst(Reason::body_clearance)->severity, 10);
}

TEST(Regions, under_an_open_sky_nothing_hangs_however_deep_the_ground) {
    Floor floor;
    floor.map->height_tenth_mm[floor.at(kAheadX, kUnderLeftY)] = -70'000;
    EXPECT_TRUE(floor.look(check_body).reasons().empty());
    EXPECT_TRUE(floor.look(check_corridors).reasons().empty());
}

TEST(Regions, evidence_of_a_drop_counts_from_its_limit_on_and_not_for_what_stands_higher) {
    Floor floor;
    const std::size_t at = floor.at(kBandX, kUnderLeftY);
    floor.map->drop_evidence[at] = 127;
    EXPECT_TRUE(floor.look(check_bands).reasons().empty());
    floor.map->drop_evidence[at] = 128;
    expect_worst(floor.look(check_bands), Reason::drop_off, 0, 500, Foot::left);
    floor.map->height_tenth_mm[at] = 400;
    EXPECT_TRUE(floor.look(check_bands).reasons().contains(Reason::drop_off));
    floor.map->height_tenth_mm[at] = 401;
    EXPECT_TRUE(floor.look(check_bands).reasons().empty()) << "a table beside the way";
    floor.map->source[at] = grid::EvidenceSource::unknown;
    EXPECT_TRUE(floor.look(check_bands).reasons().contains(Reason::drop_off)) << "an edge";
    EXPECT_TRUE(floor.look(check_bands).reasons().contains(Reason::unknown_cells));
    EXPECT_TRUE(floor.look(check_stance).reasons().empty()) << "it is not under the feet";
}

TEST(Regions, a_cell_must_be_sure_and_not_have_drifted) {
    Floor floor;
    const std::size_t at = floor.at(kUnderLeftX, kUnderLeftY);
    floor.around(floor.map->sigma_tenth_mm, kUnderLeftX, kUnderLeftY, std::uint16_t{120});
    EXPECT_TRUE(floor.look(check_stance).reasons().empty());
    floor.around(floor.map->sigma_tenth_mm, kUnderLeftX, kUnderLeftY, std::uint16_t{121});
    expect_worst(floor.look(check_stance), Reason::not_resolvable, 121, 120, Foot::left);
    floor.map->sigma_tenth_mm.fill(0);
    floor.map->drift_tenth_mm[at] = 250;
    EXPECT_TRUE(floor.look(check_stance).reasons().empty());
    floor.map->drift_tenth_mm[at] = 251;
    expect_worst(floor.look(check_stance), Reason::memory_uncertain, 251, 250, Foot::left);
}

TEST(Regions, a_single_cell_among_eight_sure_ones_may_be_half_as_sure) {
    Floor floor;
    const std::size_t at = floor.at(kUnderLeftX, kUnderLeftY);
    const auto is_refused = [&] {
        return floor.look(check_stance).reasons().contains(Reason::not_resolvable);
    };
    floor.around(floor.map->sigma_tenth_mm, kUnderLeftX, kUnderLeftY, std::uint16_t{120});
    for (const int dx : {-1, 0, 1}) {
        for (const int dy : {-1, 0, 1}) {
            const std::size_t beside =
                floor.at(kUnderLeftX + dx * kResolutionM, kUnderLeftY + dy * kResolutionM);
            floor.map->height_tenth_mm.fill(100);  // deep below no limit
            floor.map->sigma_tenth_mm[at] = 140;
            EXPECT_FALSE(is_refused());
            if (beside == at) continue;
            floor.map->sigma_tenth_mm[beside] = 121;
            EXPECT_TRUE(is_refused()) << "beside " << dx << " " << dy;
            floor.map->sigma_tenth_mm[beside] = 120;
            floor.map->source[beside] = grid::EvidenceSource::unknown;
            EXPECT_TRUE(is_refused()) << "unknown beside " << dx << " " << dy;
            floor.map->source[beside] = grid::EvidenceSource::measured;
        }
    }
    floor.machine.limits.cell_sigma_tenth_mm = 70;  // 3.4 sigma stays below the drop of 50 mm
    floor.map->sigma_tenth_mm.fill(70);
    floor.map->sigma_tenth_mm[at] = 140;
    EXPECT_FALSE(is_refused());
    floor.map->sigma_tenth_mm[at] = 141;
    EXPECT_TRUE(is_refused());
}

TEST(Regions, a_height_must_keep_its_limit_by_3_4_sigma_or_one_where_all_beside_do) {
    struct Case {
        std::int32_t depth;
        std::uint16_t sigma;
        std::int32_t depth_beside;
        std::uint16_t sigma_beside;
        bool allowed;
    };
    const Case cases[] = {{160, 100, 160, 100, true},  // 340 of slack, 3.4 sigma
                          {161, 100, 161, 100, false},
                          {400, 100, 0, 0, true},  // alone: one sigma of slack
                          {401, 100, 0, 0, false},
                          {400, 100, 160, 100, true},  // cells beside: 3.4 sigma of slack
                          {400, 100, 161, 100, false}};
    for (const Case& c : cases) {
        for (const bool up : {false, true}) {
            Floor floor;
            floor.machine.limits.swing_clearance_tenth_mm = 500;  // as high as a drop
            const std::int32_t sign = up ? 1 : -1;
            const double x = kUnderLeftX;
            const double y = kUnderLeftY;
            floor.around(floor.map->height_tenth_mm, x, y, sign * c.depth_beside);
            floor.around(floor.map->sigma_tenth_mm, x, y, c.sigma_beside);
            floor.map->height_tenth_mm[floor.at(x, y)] = sign * c.depth;
            floor.map->sigma_tenth_mm[floor.at(x, y)] = c.sigma;
            const Findings findings = up ? floor.look(check_corridors) : floor.look(check_stance);
            EXPECT_EQ(findings.reasons().empty(), c.allowed)
                << c.depth << " " << c.depth_beside << (up ? " up" : " down");
            if (!c.allowed) {
                EXPECT_EQ(findings.reasons(), ReasonSet(Reason::not_resolvable));
                EXPECT_EQ(findings.worst(Reason::not_resolvable)->value_tenth_mm, 100);
                EXPECT_LE(findings.worst(Reason::not_resolvable)->limit_tenth_mm, 99);
            }
        }
    }
    // The finding holds the sigma and the largest sigma that would pass.
    Floor floor;
    floor.map->sigma_tenth_mm.fill(100);
    floor.map->height_tenth_mm.fill(-330);
    expect_worst(floor.look(check_stance), Reason::not_resolvable, 100, 50, Foot::left);
}

TEST(Regions, count_what_they_ask_and_keep_the_worst_numbers) {
    Floor floor;
    floor.map->drift_tenth_mm.fill(10);
    floor.map->drift_tenth_mm[floor.at(kUnderLeftX, kUnderLeftY)] = 77;
    floor.map->clearance_tenth_mm[floor.at(kUnderLeftX, -kUnderLeftY)] = 30'000;
    ASSERT_EQ(floor.map->clearance_tenth_mm[0], grid::MapSnapshot::kNoCeiling);
    const Findings known = floor.look(check_stance);
    EXPECT_TRUE(known.reasons().empty());
    const std::int64_t cells = known.evidence.cells;
    EXPECT_GT(cells, 200);
    EXPECT_EQ(known.evidence.known_cells, cells);
    EXPECT_EQ(known.evidence.attested_cells, 0);
    EXPECT_EQ(known.evidence.max_drift_tenth_mm, 77);
    EXPECT_EQ(known.evidence.min_clearance_tenth_mm, 30'000);

    const std::size_t at = floor.at(kUnderLeftX, kUnderLeftY);
    floor.map->source[at] = grid::EvidenceSource::unknown;
    const Findings one_less = floor.look(check_stance);
    expect_worst(one_less, Reason::unknown_cells, 0, 0, Foot::left);
    EXPECT_EQ(one_less.evidence.cells, cells);
    EXPECT_EQ(one_less.evidence.known_cells, cells - 1);
    EXPECT_EQ(one_less.evidence.max_drift_tenth_mm, 10) << "of an unknown cell nothing counts";
    floor.query.attested = {true, 0, 0, 6000, 0};
    const Findings attested = floor.look(check_stance);
    EXPECT_TRUE(attested.reasons().empty());
    EXPECT_EQ(attested.evidence.known_cells, cells);
    EXPECT_EQ(attested.evidence.attested_cells, 1);
}

TEST(Regions, one_cell_beyond_the_map_ends_a_region) {
    Floor floor;
    floor.query.x_tenth_mm = 300'000;  // 30 m: all of it lies outside
    const Findings feet = floor.look(check_stance);
    expect_worst(feet, Reason::outside_map, 0, 0, Foot::left);
    EXPECT_EQ(feet.evidence.cells, 2) << "one for each foot";
    EXPECT_EQ(feet.evidence.known_cells, 0);
    EXPECT_FALSE(feet.reasons().contains(Reason::unknown_cells)) << "and nothing else is said";
    const Findings body = floor.look(check_body);
    expect_worst(body, Reason::outside_map, 0, 0, Foot::none);
    EXPECT_EQ(body.evidence.cells, 1);
}

TEST(Body, what_stands_between_two_parts_is_not_in_the_way) {
    Floor floor;
    floor.machine.body.parts[0] = {{0, 3500, 4000, 1000}, 1440, 20500};
    floor.machine.body.parts[1] = {{0, -3500, 4000, 1000}, 900, 15000};
    floor.machine.body.count = 2;
    // Heading across the rows, so that both parts lie in one row of cells.
    floor.query.cos_yaw = 0.0;
    floor.query.sin_yaw = 1.0;
    const auto reasons_with = [&](double left_m, std::int32_t height) {
        const std::size_t at = floor.at(-left_m, 0.0);
        floor.map->height_tenth_mm[at] = height;
        const ReasonSet reasons = floor.look(check_body).reasons();
        floor.map->height_tenth_mm[at] = 0;
        return reasons;
    };
    const ReasonSet blocked(Reason::body_clearance);
    EXPECT_TRUE(reasons_with(0.0, 8000).empty()) << "the middle";
    // Margins of 75 mm: each part reaches from 0.225 to 0.475 m to its side.
    EXPECT_TRUE(reasons_with(0.188, 8000).empty());
    EXPECT_EQ(reasons_with(0.262, 8000), blocked);
    EXPECT_EQ(reasons_with(0.438, 8000), blocked);
    EXPECT_TRUE(reasons_with(0.512, 8000).empty());
    EXPECT_TRUE(reasons_with(-0.188, 8000).empty());
    EXPECT_EQ(reasons_with(-0.262, 8000), blocked);
    EXPECT_EQ(reasons_with(-0.438, 8000), blocked);
    EXPECT_TRUE(reasons_with(-0.512, 8000).empty());
    // Each part has its own height.
    EXPECT_TRUE(reasons_with(0.35, 1000).empty());
    EXPECT_EQ(reasons_with(-0.35, 1000), blocked);
    // Unknown ground between the parts is allowed, and where they stand now; ahead of them it is
    // not.
    floor.map->source[floor.at(0.0, 0.0)] = grid::EvidenceSource::unknown;
    floor.map->source[floor.at(0.35, 0.0)] = grid::EvidenceSource::unknown;
    EXPECT_TRUE(floor.look(check_body).reasons().empty());
    floor.map->source[floor.at(0.35, 0.4)] = grid::EvidenceSource::unknown;
    floor.map->height_tenth_mm[floor.at(0.35, 0.4)] = grid::MapSnapshot::kUnknownHeight;
    EXPECT_EQ(floor.look(check_body).reasons(), ReasonSet(Reason::unknown_cells));
}

TEST(Body, asks_every_cell_of_every_part_once) {
    for (const double yaw : {0.0, 0.4, 0.7853981634, 2.0}) {  // turned, the rows of a tip hold one
        Floor floor;
        floor.query.cos_yaw = std::cos(yaw);
        floor.query.sin_yaw = std::sin(yaw);
        floor.machine.body.parts[1] = {{-3000, 500, 900, 900}, 2000, 9000};
        floor.machine.body.count = 2;
        std::set<std::pair<std::int64_t, std::int64_t>> cells;
        const Findings findings = floor.look([&](const Scene& scene, Findings& found) {
            for (const PartSweep& part : scene.sweep.body) {
                grid::for_each_overlapped_cell(
                    part.way, scene.ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
                        cells.insert({ix, iy});
                        return true;
                    });
            }
            check_body(scene, found);
        });
        EXPECT_TRUE(findings.reasons().empty());
        EXPECT_EQ(findings.evidence.cells, static_cast<std::int64_t>(cells.size())) << yaw;
    }
}

TEST(Body, of_eight_parts_each_counts) {
    for (int low = 0; low < Body::kMaxParts; ++low) {
        Floor floor;
        floor.machine.body.count = Body::kMaxParts;
        for (int i = 0; i < Body::kMaxParts; ++i)
            floor.machine.body.parts[static_cast<std::size_t>(i)] = {
                {-2000 + 700 * i, 0, 300, 4000}, i == low ? 500 : 1500, 20500};
        ASSERT_EQ(floor.machine.problem(), nullptr);
        floor.machine.movements[kForward].forward_tenth_mm = 0;
        floor.map->height_tenth_mm.fill(600);
        EXPECT_EQ(floor.look(check_body).reasons(), ReasonSet(Reason::body_clearance)) << low;
        floor.map->height_tenth_mm.fill(500);
        EXPECT_TRUE(floor.look(check_body).reasons().empty()) << low;
    }
}

TEST(Body, where_parts_lie_over_each_other_the_lowest_and_the_highest_count) {
    Floor floor;
    floor.machine.body.parts[0] = {{0, 0, 4000, 6000}, 7000, 20500};
    floor.machine.body.parts[1] = {{0, 0, 4000, 2000}, 1440, 9900};
    floor.machine.body.count = 2;
    for (const bool turned : {false, true}) {
        floor.query.cos_yaw = turned ? 0.0 : 1.0;
        floor.query.sin_yaw = turned ? 1.0 : 0.0;
        const auto worst_at = [&](double left_m, std::int32_t height, std::uint16_t clearance) {
            const std::size_t at = turned ? floor.at(-left_m, 0.0) : floor.at(0.0, left_m);
            floor.map->height_tenth_mm[at] = height;
            floor.map->clearance_tenth_mm[at] = clearance;
            const Findings findings = floor.look(check_body);
            floor.map->height_tenth_mm[at] = 0;
            floor.map->clearance_tenth_mm[at] = grid::MapSnapshot::kNoCeiling;
            const Finding* worst = findings.worst(Reason::body_clearance);
            return worst == nullptr ? std::int64_t{0} : worst->limit_tenth_mm;
        };
        constexpr std::uint16_t kOpen = grid::MapSnapshot::kNoCeiling;
        EXPECT_EQ(worst_at(0.01, 1441, kOpen), 1440);
        EXPECT_EQ(worst_at(0.01, 1440, kOpen), 0);
        EXPECT_EQ(worst_at(0.01, 0, 20'400), 20'500);
        EXPECT_EQ(worst_at(0.01, 0, 20'500), 0);
        for (const double left_m : {0.26, -0.26}) {
            EXPECT_EQ(worst_at(left_m, 7001, kOpen), 7000);
            EXPECT_EQ(worst_at(left_m, 7000, kOpen), 0);
            EXPECT_EQ(worst_at(left_m, 0, 20'400), 20'500);
        }
    }
}

}  // namespace
}  // namespace surefoot::gate::testing

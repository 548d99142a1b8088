// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/footprint.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/grid/convex_area.hpp"

namespace surefoot::traversability {
namespace {

using Points = std::vector<Eigen::Vector2d>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kResolution_m = 0.025;
const Points kFoot{{-0.2, -0.1}, {0.2, -0.1}, {0.2, 0.1}, {-0.2, 0.1}};

/// A square map of 2 m around the origin, with a rating and a height in every cell.
struct Ground {
    static constexpr int kSide = 80;
    grid::Layer rating{kSide, kSide, 1.0F};
    grid::Layer height_m{kSide, kSide, 0.0F};

    [[nodiscard]] FootprintLayers layers() const {
        return {{kResolution_m, kSide, kSide, {-1.0, -1.0}}, rating.view(), height_m.view()};
    }
    [[nodiscard]] grid::Cell cell_at(double x_m, double y_m) const {
        return *layers().geometry.cell_at(x_m, y_m);
    }
};

/// Returns a value that is not finite, which counts as unknown.
float unknown_value(Rng& rng) {
    constexpr float kValues[] = {kNanF, kNanF, kNanF, HUGE_VALF, -HUGE_VALF};
    return kValues[rng.below(5)];
}

Ground random_ground(Rng& rng, double unknown_share) {
    Ground ground;
    for (int iy = 0; iy < Ground::kSide; ++iy) {
        for (int ix = 0; ix < Ground::kSide; ++ix) {
            const bool unknown = rng.uniform() < unknown_share;
            ground.rating.at(ix, iy) =
                unknown ? unknown_value(rng) : static_cast<float>(rng.uniform());
            ground.height_m.at(ix, iy) =
                unknown ? unknown_value(rng) : static_cast<float>(rng.normal());
        }
    }
    return ground;
}

Footprint circle(double radius_m) {
    auto footprint = Footprint::circle(radius_m);
    EXPECT_TRUE(footprint.ok());
    return *footprint;
}

Footprint polygon(const Points& vertices_m) {
    auto footprint = Footprint::polygon(vertices_m);
    EXPECT_TRUE(footprint.ok()) << (footprint ? "" : footprint.error().message);
    return *footprint;
}

// ---- oracle: tests every cell of a wide area one by one -----------------------------------------

double distance_to_segment(const Eigen::Vector2d& p,
                           const Eigen::Vector2d& a,
                           const Eigen::Vector2d& b) {
    const Eigen::Vector2d along = b - a;
    const double length2 = along.squaredNorm();
    const double s = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
    return (p - (a + s * along)).norm();
}

/// Returns minus the depth of the overlap of a convex polygon and a cell, or 0 and more without
/// overlap: the widest gap along the normals of all edges of both (separating axes).
double gap_m(const Points& polygon_m, const Eigen::Vector2d& low_m) {
    const Eigen::Vector2d high_m = low_m + Eigen::Vector2d::Constant(kResolution_m);
    const Points cell_m{low_m, {high_m.x(), low_m.y()}, high_m, {low_m.x(), high_m.y()}};
    double widest_m = -kInfinity;
    for (const Points* outline : {&polygon_m, &cell_m}) {
        for (std::size_t i = 0; i < outline->size(); ++i) {
            const Eigen::Vector2d edge = (*outline)[(i + 1) % outline->size()] - (*outline)[i];
            const Eigen::Vector2d normal = Eigen::Vector2d(edge.y(), -edge.x()).normalized();
            double a_low = kInfinity, a_high = -kInfinity, b_low = kInfinity, b_high = -kInfinity;
            for (const auto& p : polygon_m) {
                a_low = std::min(a_low, normal.dot(p));
                a_high = std::max(a_high, normal.dot(p));
            }
            for (const auto& p : cell_m) {
                b_low = std::min(b_low, normal.dot(p));
                b_high = std::max(b_high, normal.dot(p));
            }
            widest_m = std::max({widest_m, b_low - a_high, a_low - b_high});
        }
    }
    return widest_m;
}

/// Returns the distance of the segment a-b from a cell.
double distance_m(const Eigen::Vector2d& a,
                  const Eigen::Vector2d& b,
                  const Eigen::Vector2d& low_m) {
    const Eigen::Vector2d high_m = low_m + Eigen::Vector2d::Constant(kResolution_m);
    // Clips the segment to the cell (Liang and Barsky) to test if it passes through.
    double from = 0.0, to = 1.0;
    for (int k = 0; k < 2; ++k) {
        const double step = b[k] - a[k];
        const double s0 = (low_m[k] - a[k]) / step, s1 = (high_m[k] - a[k]) / step;
        if (step == 0.0) {
            if (a[k] < low_m[k] || a[k] > high_m[k]) to = -1.0;
            continue;
        }
        from = std::max(from, std::min(s0, s1));
        to = std::min(to, std::max(s0, s1));
    }
    if (from <= to) return 0.0;
    double nearest_m = kInfinity;
    for (const Eigen::Vector2d& corner :
         {low_m, high_m, {low_m.x(), high_m.y()}, {high_m.x(), low_m.y()}})
        nearest_m = std::min(nearest_m, distance_to_segment(corner, a, b));
    for (const Eigen::Vector2d& end : {a, b})
        nearest_m = std::min(nearest_m, (end - end.cwiseMax(low_m).cwiseMin(high_m)).norm());
    return nearest_m;
}

enum class Overlap { no, yes, unsure };

/// Overlaps up to this depth may count or not: a query skips a sliver of 1e-5 cells, which corners
/// as sharp as 15 deg deepen eightfold.
constexpr double kShallow_m = 8.0 * grid::ConvexArea::kSliver_cells * kResolution_m;

Overlap overlap_of(double gap_m) {
    constexpr double kRounding_m = 1e-12;
    return gap_m < -kShallow_m    ? Overlap::yes
           : gap_m > -kRounding_m ? Overlap::no
                                  : Overlap::unsure;
}

/// Expected result of a query by one plain loop over all cells of 6 x 6 m, or nothing if rounding
/// decides for a cell. `overlap` takes the corner of a cell with the smallest coordinates.
template <typename OverlapOf>
std::optional<FootprintReport> expected(const Ground& ground, const OverlapOf& overlap) {
    const FootprintLayers layers = ground.layers();
    FootprintReport report;
    double rating_sum = 0.0;
    std::int64_t rated = 0;
    report.outcome = FootprintOutcome::outside_map;
    for (int iy = -80; iy < 160; ++iy) {
        for (int ix = -80; ix < 160; ++ix) {
            const Overlap answer =
                overlap(layers.geometry.origin_m + kResolution_m * Eigen::Vector2d(ix, iy));
            if (answer == Overlap::unsure) return std::nullopt;
            if (answer == Overlap::no) continue;
            ++report.cells;
            if (!layers.geometry.contains({ix, iy})) {
                ++report.outside;
                ++report.unknown;
                ++report.without_height;
                continue;
            }
            report.outcome = FootprintOutcome::rated;
            const float height_m = ground.height_m.at(ix, iy);
            if (!std::isfinite(height_m)) ++report.without_height;
            if (!(report.lowest_m <= height_m) && std::isfinite(height_m))
                report.lowest_m = height_m;
            if (!(report.highest_m >= height_m) && std::isfinite(height_m))
                report.highest_m = height_m;
            const float rating = ground.rating.at(ix, iy);
            if (!std::isfinite(rating)) {
                ++report.unknown;
                continue;
            }
            ++rated;
            rating_sum += static_cast<double>(rating);
            if (report.worst_cell && rating >= report.worst_rating) continue;
            report.worst_rating = rating;
            report.worst_cell = grid::Cell{ix, iy};
        }
    }
    if (rated > 0) report.mean_rating = rating_sum / static_cast<double>(rated);
    return report;
}

void expect_same(const FootprintReport& got,
                 const FootprintReport& want,
                 const std::string& where) {
    EXPECT_EQ(got.outcome, want.outcome) << where;
    EXPECT_EQ(got.cells, want.cells) << where;
    EXPECT_EQ(got.outside, want.outside) << where;
    EXPECT_EQ(got.unknown, want.unknown) << where;
    EXPECT_EQ(got.without_height, want.without_height) << where;
    EXPECT_EQ(got.worst_cell, want.worst_cell) << where;
    const auto bits = [](float value) {
        return std::isnan(value) ? std::uint32_t{0} : std::bit_cast<std::uint32_t>(value);
    };
    EXPECT_EQ(bits(got.worst_rating), bits(want.worst_rating)) << where;
    EXPECT_EQ(bits(got.lowest_m), bits(want.lowest_m)) << where;
    EXPECT_EQ(bits(got.highest_m), bits(want.highest_m)) << where;
    // Up to 6400 ratings below 1, added in another order: an error of 6400 * 2^-53 at most.
    constexpr double kOrderOfSum = 1e-12;
    EXPECT_EQ(std::isnan(got.mean_rating), std::isnan(want.mean_rating)) << where;
    if (!std::isnan(want.mean_rating)) {
        EXPECT_NEAR(got.mean_rating, want.mean_rating, kOrderOfSum) << where;
    }
}

FootprintPose random_pose(Rng& rng) {
    // The poses reach beyond all borders of the map, so many footprints lie half outside.
    return {rng.uniform(-1.3, 1.3), rng.uniform(-1.3, 1.3), rng.uniform(-7.0, 7.0)};
}

Points placed(const Points& vertices_m, const FootprintPose& pose) {
    Points placed_m;
    for (const auto& p : vertices_m)
        placed_m.push_back(Eigen::Vector2d(pose.x_m, pose.y_m) +
                           Eigen::Rotation2Dd(pose.yaw_rad) * p);
    return placed_m;
}

/// A convex polygon: corners on an ellipse, none sharper than 15 deg.
Points random_convex(Rng& rng) {
    const auto n = static_cast<int>(3 + rng.below(8));
    const Eigen::Vector2d axes_m(rng.uniform(0.1, 0.4), rng.uniform(0.1, 0.4));
    const Eigen::Vector2d center_m(rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1));
    Points vertices_m;
    for (int i = 0; i < n; ++i) {
        const double angle = 2.0 * std::numbers::pi * (i + 0.4 * rng.uniform()) / n;
        vertices_m.push_back(
            center_m + axes_m.cwiseProduct(Eigen::Vector2d(std::cos(angle), std::sin(angle))));
    }
    if (rng.below(2) == 0) std::reverse(vertices_m.begin(), vertices_m.end());
    return vertices_m;
}

/// Number of random rounds. At least kLeastJudged of them must not depend on rounding.
constexpr int kRounds = 60;
constexpr int kLeastJudged = kRounds * 2 / 3;

TEST(Footprint, circle_says_what_a_loop_over_all_cells_says) {
    Rng rng(31);
    int judged = 0;
    for (int round = 0; round < kRounds; ++round) {
        const Ground ground = random_ground(rng, round % 3 == 0 ? 0.0 : 0.3);
        const double radius_m = rng.uniform(0.005, 0.5);
        const FootprintPose pose = random_pose(rng);
        const Eigen::Vector2d center_m(pose.x_m, pose.y_m);
        const auto want = expected(ground, [&](const Eigen::Vector2d& low_m) {
            return overlap_of(distance_m(center_m, center_m, low_m) - radius_m);
        });
        if (!want) continue;
        ++judged;
        expect_same(query(circle(radius_m), pose, ground.layers()),
                    *want,
                    "round " + std::to_string(round));
    }
    EXPECT_GE(judged, kLeastJudged);
}

TEST(Footprint, polygon_at_any_yaw_says_what_a_loop_over_all_cells_says) {
    Rng rng(32);
    int judged = 0;
    for (int round = 0; round < kRounds; ++round) {
        const Ground ground = random_ground(rng, round % 3 == 0 ? 0.0 : 0.3);
        const Points vertices_m = round % 4 == 0 ? kFoot : random_convex(rng);
        const FootprintPose pose = random_pose(rng);
        const Points outline_m = placed(vertices_m, pose);
        const auto want = expected(ground, [&](const Eigen::Vector2d& low_m) {
            return overlap_of(gap_m(outline_m, low_m));
        });
        if (!want) continue;
        ++judged;
        expect_same(query(polygon(vertices_m), pose, ground.layers()),
                    *want,
                    "round " + std::to_string(round));
    }
    EXPECT_GE(judged, kLeastJudged);
}

TEST(Footprint, swept_circle_counts_each_cell_of_its_way_once) {
    Rng rng(33);
    int judged = 0;
    PathScratch scratch;
    for (int round = 0; round < kRounds; ++round) {
        const Ground ground = random_ground(rng, 0.2);
        const double radius_m = rng.uniform(0.02, 0.3);
        std::vector<FootprintPose> poses(1 + rng.below(5));
        for (auto& pose : poses) pose = random_pose(rng);
        const auto want = expected(ground, [&](const Eigen::Vector2d& low_m) {
            double nearest_m = kInfinity;
            for (std::size_t i = 0; i < poses.size(); ++i) {
                const FootprintPose& a = poses[i];
                const FootprintPose& b = poses[std::min(i + 1, poses.size() - 1)];
                nearest_m = std::min(nearest_m, distance_m({a.x_m, a.y_m}, {b.x_m, b.y_m}, low_m));
            }
            return overlap_of(nearest_m - radius_m);
        });
        if (!want) continue;
        ++judged;
        expect_same(query_path(circle(radius_m), poses, ground.layers(), scratch),
                    *want,
                    "round " + std::to_string(round));
    }
    EXPECT_GE(judged, kLeastJudged);
}

TEST(Footprint, path_of_one_pose_is_the_query_there_also_when_the_pose_repeats) {
    Rng rng(34);
    PathScratch scratch;
    for (int round = 0; round < 20; ++round) {
        const Ground ground = random_ground(rng, 0.2);
        const Footprint foot = polygon(random_convex(rng));
        const FootprintPose pose = random_pose(rng);
        const FootprintReport want = query(foot, pose, ground.layers());
        for (const std::size_t times : {1U, 2U, 5U}) {
            const std::vector<FootprintPose> poses(times, pose);
            expect_same(query_path(foot, poses, ground.layers(), scratch),
                        want,
                        std::to_string(times) + " times");
        }
    }
}

// ---- cells covered by a swept polygon -----------------------------------------------------------

/// Returns true if a query finds one bad cell under a path.
bool finds(const Footprint& footprint,
           const std::vector<FootprintPose>& poses,
           grid::Cell bad,
           PathScratch& scratch) {
    Ground ground;
    ground.rating.at(bad.ix, bad.iy) = 0.0F;
    const FootprintReport report = query_path(footprint, poses, ground.layers(), scratch);
    const bool found = report.worst_cell == bad && report.worst_rating == 0.0F;
    EXPECT_EQ(is_traversable(report, 0.5), !found);
    return found;
}

TEST(Footprint, swept_polygon_misses_no_cell_on_the_way_and_takes_none_beside_it) {
    // A point of a hull, (1 - s) p + s q of corners at both ends, is at most 2 s (1 - s) turn reach
    // away from the same mixture of the foot's own points at s. The hull is enlarged by the bulge,
    // and the samples leave gaps.
    const double reach_m = std::hypot(0.2, 0.1);
    const double beside_m = reach_m * (kMaxTurn_rad / 2.0 + kMaxTurn_rad * kMaxTurn_rad / 8.0);
    constexpr int kSamples = 100;  // the corners of the foot move less than 12 mm between two
    constexpr double kBetween_m = 0.012;
    constexpr double kFar_m = 0.05;  // from the circle around a sample: counts as far
    PathScratch scratch;
    const std::vector<std::vector<FootprintPose>> ways{
        {{-0.5, -0.3, 0.4}, {0.5, 0.2, 0.4}},                    // straight on
        {{0.0, 0.0, 0.0}, {0.0, 0.0, 3.0}},                      // on the spot
        {{-0.3, 0.0, 3.0}, {0.3, 0.1, -2.9}},                    // the short way past pi
        {{-0.4, -0.4, 0.0}, {0.4, -0.4, 0.0}, {0.4, 0.4, 1.6}},  // around a corner
    };
    for (const auto& way : ways) {
        std::vector<Points> outlines_m;
        for (std::size_t i = 0; i + 1 < way.size(); ++i) {
            const double turn_rad =
                std::remainder(way[i + 1].yaw_rad - way[i].yaw_rad, 2.0 * std::numbers::pi);
            for (int k = 0; k <= kSamples; ++k) {
                const double s = static_cast<double>(k) / kSamples;
                outlines_m.push_back(placed(kFoot,
                                            {std::lerp(way[i].x_m, way[i + 1].x_m, s),
                                             std::lerp(way[i].y_m, way[i + 1].y_m, s),
                                             way[i].yaw_rad + s * turn_rad}));
            }
        }
        const Footprint foot = polygon(kFoot);
        for (int iy = 8; iy < 72; ++iy) {
            for (int ix = 8; ix < 72; ++ix) {
                const Eigen::Vector2d low_m(-1.0 + kResolution_m * ix, -1.0 + kResolution_m * iy);
                double gap = kInfinity;
                for (const Points& outline_m : outlines_m) {
                    const Eigen::Vector2d middle_m = 0.5 * (outline_m[0] + outline_m[2]);
                    if ((low_m - middle_m).norm() > reach_m + kFar_m) continue;
                    gap = std::min(gap, gap_m(outline_m, low_m));
                    if (gap < -kShallow_m) break;
                }
                if (gap >= -kShallow_m && gap <= kBetween_m + beside_m) continue;
                ASSERT_EQ(finds(foot, way, {ix, iy}, scratch), gap < 0.0)
                    << "way from " << way[0].x_m << " cell " << ix << " " << iy << " gap " << gap;
            }
        }
    }
}

TEST(Footprint, turning_on_the_spot_meets_what_no_end_of_the_turn_meets) {
    // A quarter turn of a long foot: a bad cell at 45 deg, 0.19 m away, lies outside of both ends
    // and of their hull.
    const Points blade{{0.0, -0.01}, {0.2, -0.01}, {0.2, 0.01}, {0.0, 0.01}};
    const std::vector<FootprintPose> turn{{0.0, 0.0, 0.0}, {0.0, 0.0, std::numbers::pi / 2.0}};
    const double at_m = 0.19 * std::numbers::sqrt2 / 2.0;
    PathScratch scratch;
    EXPECT_TRUE(finds(polygon(blade), turn, Ground().cell_at(at_m, at_m), scratch));
    EXPECT_FALSE(finds(polygon(blade), turn, Ground().cell_at(-at_m, at_m), scratch));
}

TEST(Footprint, an_arc_meets_the_cell_that_it_bulges_into_between_two_poses) {
    // The far corners end at x = 0.79998 m and pass 0.80012 m in between; the next cell begins at
    // 0.8 m.
    const Points blade{{0.0, -0.005}, {0.8, -0.005}, {0.8, 0.005}, {0.0, 0.005}};
    const std::vector<FootprintPose> turn{{0.0001, 0.0125, -0.025}, {0.0001, 0.0125, 0.025}};
    PathScratch scratch;
    EXPECT_TRUE(finds(polygon(blade), turn, {72, 40}, scratch));
}

// ---- faults of the reference implementation -----------------------------------------------------

TEST(Footprint, the_same_question_has_the_same_answer_wherever_the_obstacle_is) {
    // The reference implementation refused an obstacle in the ring 0.3 to 0.45 m once and then
    // allowed it.
    const Footprint disc = circle(0.45);
    PathScratch scratch;
    for (const double distance_m : {0.0, 0.2, 0.35, 0.4, 0.44}) {
        Ground ground;
        const grid::Cell bad = ground.cell_at(distance_m, 0.0);
        ground.rating.at(bad.ix, bad.iy) = 0.0F;
        const Ground before = ground;
        for (int time = 0; time < 3; ++time) {
            const FootprintReport report = query(disc, {}, ground.layers());
            EXPECT_FALSE(is_traversable(report, 0.8)) << distance_m << " m, time " << time;
            EXPECT_EQ(report.worst_cell, bad) << distance_m << " m, time " << time;
            const std::vector<FootprintPose> poses{{-0.1, 0.0, 0.0}, {0.1, 0.0, 0.0}};
            EXPECT_FALSE(is_traversable(query_path(disc, poses, ground.layers(), scratch), 0.8));
        }
        EXPECT_EQ(ground.rating, before.rating);
        EXPECT_EQ(ground.height_m, before.height_m);
    }
}

TEST(Footprint, a_swept_circle_skips_no_cell_of_its_line) {
    // The reference implementation tested only every fourth cell of the line.
    const std::vector<FootprintPose> way{{-0.5, 0.0125, 0.0}, {0.5, 0.0125, 0.0}};
    PathScratch scratch;
    for (int ix = 20; ix < 60; ++ix)
        EXPECT_TRUE(finds(circle(0.03), way, {ix, 40}, scratch)) << "cell " << ix;
}

TEST(Footprint, repeated_and_simultaneous_queries_give_the_same_bytes) {
    Rng rng(35);
    const Ground ground = random_ground(rng, 0.1);
    const Footprint foot = polygon(kFoot);
    const FootprintPose pose{0.9, -0.2, 0.7};
    const std::vector<FootprintPose> way{pose, {0.2, 0.1, 2.0}, {-0.3, 0.9, -2.0}};
    PathScratch first_scratch;
    const FootprintReport stand = query(foot, pose, ground.layers());
    const FootprintReport sweep = query_path(foot, way, ground.layers(), first_scratch);
    const auto mean_bits = [](const FootprintReport& r) {
        return std::bit_cast<std::uint64_t>(r.mean_rating);
    };
    std::vector<std::thread> threads;
    std::array<int, 4> differences{};
    for (int& difference : differences) {
        threads.emplace_back([&] {
            PathScratch scratch;
            for (int i = 0; i < 50; ++i) {
                const FootprintReport a = query(foot, pose, ground.layers());
                const FootprintReport b = query_path(foot, way, ground.layers(), scratch);
                difference += mean_bits(a) != mean_bits(stand) || mean_bits(b) != mean_bits(sweep);
                difference += a.worst_cell != stand.worst_cell || b.worst_cell != sweep.worst_cell;
                difference += a.unknown != stand.unknown || b.unknown != sweep.unknown;
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(differences, (std::array<int, 4>{}));
    expect_same(query(foot, pose, ground.layers()), stand, "again");
    expect_same(query_path(foot, way, ground.layers(), first_scratch), sweep, "again");
}

TEST(Footprint, every_instruction_set_gives_the_same_bytes) {
    Rng rng(36);
    for (int round = 0; round < 40; ++round) {
        const Ground ground = random_ground(rng, 0.1);
        const Footprint foot = polygon(random_convex(rng));
        const FootprintPose pose = random_pose(rng);
        const FootprintReport want = query(foot, pose, ground.layers());
        for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
            SCOPED_TRACE(hwy::TargetName(target));
            hwy::SetSupportedTargetsForTest(target);
            const FootprintReport got = query(foot, pose, ground.layers());
            hwy::SetSupportedTargetsForTest(0);
            expect_same(got, want, "round " + std::to_string(round));
            EXPECT_TRUE(std::isnan(want.mean_rating) || got.mean_rating == want.mean_rating);
        }
    }
}

// ---- unknown is not safe ------------------------------------------------------------------------

TEST(Footprint, unknown_ground_is_unsafe_and_a_shape_outside_is_so_under_every_policy) {
    Ground ground;
    const Footprint foot = polygon(kFoot);
    const FootprintReport known = query(foot, {}, ground.layers());
    EXPECT_EQ(known.cells, 16 * 8);
    EXPECT_EQ(known.unknown_share(), 0.0);
    EXPECT_TRUE(is_traversable(known, 0.8));

    ground.rating.at(40, 40) = kNanF;
    const FootprintReport hole = query(foot, {}, ground.layers());
    EXPECT_EQ(hole.unknown, 1);
    EXPECT_EQ(hole.unknown_share(), 1.0 / 128.0);
    EXPECT_FALSE(is_traversable(hole, 0.8));
    EXPECT_TRUE(is_traversable(hole, 0.8, UnknownPolicy::ignored));

    ground.rating.at(40, 40) = 1.0F;
    ground.height_m.at(40, 40) = kNanF;
    EXPECT_FALSE(is_traversable(query(foot, {}, ground.layers()), 0.8));
    FootprintLayers without_heights = ground.layers();
    without_heights.height_m = {};
    EXPECT_TRUE(is_traversable(query(foot, {}, without_heights), 0.8));
    EXPECT_TRUE(std::isnan(query(foot, {}, without_heights).height_range_m()));

    const FootprintReport half = query(foot, {1.0, 0.0, 0.0}, ground.layers());
    EXPECT_EQ(half.outcome, FootprintOutcome::rated);
    EXPECT_EQ(half.outside, 64);
    EXPECT_FALSE(is_traversable(half, 0.8));
    EXPECT_TRUE(is_traversable(half, 0.8, UnknownPolicy::ignored));

    ground.rating.fill(kNanF);
    const FootprintReport unknown = query(foot, {}, ground.layers());
    const FootprintReport beyond = query(foot, {3.0, 0.0, 0.0}, Ground().layers());
    EXPECT_EQ(beyond.outcome, FootprintOutcome::outside_map);
    EXPECT_EQ(beyond.outside, beyond.cells);
    for (const FootprintReport& report : {unknown, beyond, FootprintReport{}}) {
        EXPECT_EQ(report.unknown_share(), 1.0);
        EXPECT_FALSE(report.worst_cell.has_value());
        for (const UnknownPolicy policy : {UnknownPolicy::unsafe, UnknownPolicy::ignored}) {
            EXPECT_FALSE(is_traversable(report, 0.0, policy));
            EXPECT_FALSE(is_traversable(report, -1.0, policy));
        }
    }
}

TEST(Footprint, worst_rating_decides_not_the_mean) {
    Ground ground;
    ground.rating.at(45, 38) = 0.4F;
    ground.height_m.at(46, 40) = 0.25F;
    ground.height_m.at(34, 41) = -0.5F;
    const FootprintReport report = query(polygon(kFoot), {}, ground.layers());
    EXPECT_EQ(report.worst_rating, 0.4F);
    EXPECT_EQ(report.worst_cell, (grid::Cell{45, 38}));
    EXPECT_GT(report.mean_rating, 0.99);
    EXPECT_EQ(report.height_range_m(), 0.75F);
    EXPECT_FALSE(is_traversable(report, 0.8));
    EXPECT_TRUE(is_traversable(report, static_cast<double>(0.4F)));
    EXPECT_FALSE(is_traversable(report, std::nan("")));
    // A rating of 0 is never traversable, whatever the threshold.
    ground.rating.at(45, 38) = 0.0F;
    EXPECT_FALSE(is_traversable(query(polygon(kFoot), {}, ground.layers()), 0.0));
}

// ---- bad input ----------------------------------------------------------------------------------

TEST(Footprint, poses_and_maps_that_mean_nothing_are_an_outcome) {
    const Ground ground;
    PathScratch scratch;
    const Footprint disc = circle(0.2);
    const Footprint foot = polygon(kFoot);
    for (const double bad : {std::nan(""), kInfinity, -kInfinity, 1e30, -1e30}) {
        std::vector<FootprintPose> poses{{bad, 0.0, 0.0}, {0.0, bad, 0.0}};
        if (!std::isfinite(bad)) poses.push_back({0.0, 0.0, bad});
        for (const FootprintPose& pose : poses) {
            for (const Footprint& footprint : {disc, foot}) {
                const std::vector<FootprintPose> way{{}, pose, {}};
                for (const FootprintReport& report :
                     {query(footprint, pose, ground.layers()),
                      query_path(footprint, way, ground.layers(), scratch)}) {
                    EXPECT_EQ(report.outcome, FootprintOutcome::invalid_pose) << bad;
                    EXPECT_EQ(report.cells, 0) << bad;
                    EXPECT_FALSE(is_traversable(report, 0.0, UnknownPolicy::ignored)) << bad;
                }
            }
        }
    }
    EXPECT_EQ(query_path(foot, {}, ground.layers(), scratch).outcome,
              FootprintOutcome::invalid_pose);
    std::vector<FootprintLayers> maps(7, ground.layers());
    maps[0].geometry.resolution_m = 0.0;
    maps[1].geometry.resolution_m = std::nan("");
    maps[2].geometry.resolution_m = kInfinity;
    maps[3].geometry.origin_m.x() = std::nan("");
    maps[4].geometry.nx = 81;
    maps[5].height_m.height = 79;
    maps[6].rating = {};
    for (const FootprintLayers& map : maps) {
        EXPECT_EQ(query(foot, {}, map).outcome, FootprintOutcome::invalid_map);
        EXPECT_EQ(query_path(foot, std::vector<FootprintPose>(2), map, scratch).outcome,
                  FootprintOutcome::invalid_map);
    }
    // A very large yaw is still a yaw, and an empty map is still a map.
    EXPECT_EQ(query(foot, {0.0, 0.0, 1e18}, ground.layers()).outcome, FootprintOutcome::rated);
    const FootprintLayers empty{{kResolution_m, 0, 0, {0.0, 0.0}}, {}, {}};
    EXPECT_EQ(query(foot, {}, empty).outcome, FootprintOutcome::outside_map);
}

void expect_refused(const Result<Footprint>& result, const std::string& words) {
    ASSERT_FALSE(result.ok()) << words;
    EXPECT_NE(result.error().message.find(words), std::string::npos) << result.error().message;
}

TEST(Footprint, degenerate_shapes_are_refused_with_a_sentence) {
    for (const double radius_m : {0.0, -0.3, std::nan(""), kInfinity, 300.0})
        expect_refused(Footprint::circle(radius_m), "the radius of a circle is");
    expect_refused(Footprint::polygon({}), "the polygon has 0 corners");
    expect_refused(Footprint::polygon(Points{{0, 0}, {1, 0}}), "the polygon has 2 corners");
    expect_refused(Footprint::polygon(Points(17, {0, 0})), "the polygon has 17 corners");
    expect_refused(Footprint::polygon(Points{{0, 0}, {1, std::nan("")}, {1, 1}}), "corner 1");
    expect_refused(Footprint::polygon(Points{{0, 0}, {1, 0}, {kInfinity, 1}}), "corner 2");
    expect_refused(Footprint::polygon(Points{{0, 0}, {400, 0}, {400, 200}}), "within 100 m");
    expect_refused(Footprint::polygon(Points{{0, 0}, {0.1, 0.1}, {0.3, 0.3}}), "lie on a line");
    expect_refused(Footprint::polygon(Points(4, {0.1, 0.1})), "lie on a line");
    expect_refused(Footprint::polygon(Points{{0, 0}, {1, 0}, {0.2, 0.2}, {0, 1}}),
                   "corner 3 (counted from 0) lies outside of the edge from corner 1");
    // A bow tie, with an area, and a star.
    expect_refused(Footprint::polygon(Points{{0, 0}, {1, 1}, {1, 0}, {0, 0.5}}), "lies outside");
    Points star;
    for (int i = 0; i < 5; ++i) star.push_back(placed({{0.3, 0.0}}, {0.0, 0.0, 2.513274 * i})[0]);
    expect_refused(Footprint::polygon(star), "lies outside");
    // Corners on a straight edge, and either direction of travel, are fine.
    EXPECT_TRUE(Footprint::polygon(Points{{0, 0}, {0.1, 0}, {0.2, 0}, {0.2, 0.2}, {0, 0.2}}).ok());
    EXPECT_TRUE(Footprint::polygon(Points{{0, 0}, {0, 0.2}, {0.2, 0.2}, {0.2, 0}}).ok());
}

}  // namespace
}  // namespace surefoot::traversability

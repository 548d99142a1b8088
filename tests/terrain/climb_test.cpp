// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "surefoot/geometry/statistics.hpp"
#include "surefoot/sim/scenes/truth.hpp"
#include "tests/terrain/scene_cameras.hpp"

namespace surefoot::terrain {
namespace {

constexpr double kStep_m = 0.15;   ///< between two observations
constexpr double kBefore_m = 1.3;  ///< distance from the start of the path to the first edge
constexpr double kBeyond_m = 0.7;

/// Two flights of ten steps with a landing between them, and the path over them.
class Climb {
  public:
    explicit Climb(const std::string& name) : scene_(sim::make_scene(name, 3).value()) {
        distance_m_ = drawn(scene_, "distance_m");
        angle_rad_ = drawn(scene_, "angle_deg") * std::numbers::pi / 180.0;
        lateral_m_ = drawn(scene_, "lateral_m");
        half_width_m_ = 0.5 * drawn(scene_, "width_m");
        rise_m_ = drawn(scene_, "rise_m");
        length_m_ = drawn(scene_, "second_m") + 10.0 * drawn(scene_, "going_m");
    }
    [[nodiscard]] const sim::Scene& scene() const { return scene_.scene; }
    [[nodiscard]] double rise_m() const { return rise_m_; }
    [[nodiscard]] double length_m() const { return length_m_; }
    [[nodiscard]] int looks() const {
        return static_cast<int>((length_m_ + kBefore_m + kBeyond_m) / kStep_m);
    }
    [[nodiscard]] double way_m(int look) const { return -kBefore_m + kStep_m * look; }

    /// The body follows the middle of the flight. Its height above the nosing line equals its
    /// height above a floor.
    [[nodiscard]] Pose T_world_body(double s_m) const {
        double ground_m = 0.0;
        constexpr int kSamples = 25;
        for (int i = 0; i < kSamples; ++i) {
            const Eigen::Vector2d at = world(s_m + 0.03 * (i - kSamples / 2), 0.0);
            ground_m += scene_.scene.height_at(at.x(), at.y()).value().z_m / kSamples;
        }
        const Eigen::Vector2d at = world(s_m, 0.0);
        return {exp_so3({0.0, 0.0, angle_rad_}), {at.x(), at.y(), ground_m + sim::kBodyHeight_m}};
    }
    /// Position in the axes of the flight: along it from the first edge, and to the left of its
    /// middle.
    [[nodiscard]] Eigen::Vector2d place(const Eigen::Vector2d& world_m) const {
        return Eigen::Rotation2Dd(-angle_rad_) * (world_m - Eigen::Vector2d(distance_m_, 0.0)) -
               Eigen::Vector2d(0.0, lateral_m_);
    }
    /// Whether a place is at least 0.1 m from the walls of the flight, on the judged part of the
    /// path.
    [[nodiscard]] bool on_the_way(const Eigen::Vector2d& place_m) const {
        return place_m.x() > -kBefore_m + 0.7 && place_m.x() < length_m_ + kBeyond_m &&
               std::abs(place_m.y()) < half_width_m_ - 0.1;
    }

  private:
    [[nodiscard]] Eigen::Vector2d world(double s_m, double left_m) const {
        return Eigen::Vector2d(distance_m_, 0.0) +
               Eigen::Rotation2Dd(angle_rad_) * Eigen::Vector2d(s_m, lateral_m_ + left_m);
    }
    sim::ScriptedScene scene_;
    double distance_m_ = 0.0;
    double angle_rad_ = 0.0;
    double lateral_m_ = 0.0;
    double half_width_m_ = 0.0;
    double rise_m_ = 0.0;
    double length_m_ = 0.0;
};

/// Map content of one tread or landing, in cells at least two cells from every edge.
struct Tread {
    int cells = 0;
    int passed = 0;                ///< cells behind the body
    int passed_known = 0;          ///< known cells among these
    int misplaced = 0;             ///< known cells whose height is nearer to another tread
    std::vector<double> errors_m;  ///< errors of the known cells
    [[nodiscard]] double median_m() { return upper_median_in_place(errors_m); }
};

/// Calls f(true height, cell, distance ahead of the body) for cells on the path that are two cells
/// from every edge, also for a margin outside the window.
template <typename F>
void for_level_cells(const Climb& climb, const grid::GridGeometry& grid, double s_m, const F& f) {
    const sim::Lattice lattice{grid.origin_m, grid.nx, grid.ny, grid.resolution_m};
    const Image<float> truth_m = sim::dem(climb.scene(), lattice, sim::DemReduce::center);
    const sim::EdgeConfig apart;
    const Image<std::uint8_t> edges = sim::edge_mask(truth_m, apart);
    for (int iy = apart.margin_cells; iy < grid.ny - apart.margin_cells; ++iy) {
        for (int ix = apart.margin_cells; ix < grid.nx - apart.margin_cells; ++ix) {
            const Eigen::Vector2d place_m = climb.place(grid.center_m({ix, iy}));
            if (edges.at(ix, iy) != 0 || !climb.on_the_way(place_m)) continue;
            f(static_cast<double>(truth_m.at(ix, iy)), grid::Cell{ix, iy}, place_m.x() - s_m);
        }
    }
}

/// Treads by number up to `ahead_m`; the number counts steps above the ground at the start of the
/// path.
std::map<int, Tread> treads(const Climb& climb,
                            const elevation::ElevationMap& map,
                            double s_m,
                            double ahead_m) {
    std::map<int, Tread> found;
    const auto look = [&](double true_m, grid::Cell cell, double beyond_m) {
        if (beyond_m > ahead_m) return;
        Tread& tread = found[static_cast<int>(std::lround(true_m / climb.rise_m()))];
        const auto height_m = static_cast<double>(map.layers().height_m.at(cell.ix, cell.iy));
        const bool known = !std::isnan(height_m);
        ++tread.cells;
        tread.passed += beyond_m < 0.0 ? 1 : 0;
        tread.passed_known += beyond_m < 0.0 && known ? 1 : 0;
        if (!known) return;
        tread.errors_m.push_back(height_m - true_m);
        tread.misplaced += std::abs(height_m - true_m) > 0.5 * climb.rise_m() ? 1 : 0;
    };
    for_level_cells(climb, map.geometry(), s_m, look);
    return found;
}

struct Wanted {
    double ahead_m = 3.0;    ///< going down, farther treads are seen edge-on
    double median_m = 0.01;  ///< median of the errors on one tread, in every check
    double known = 0.99;     ///< share of a tread behind the body
};

/// Checks all treads in the window, and adds the passed ones to `passed`.
void check_treads(const Climb& climb,
                  const elevation::ElevationMap& map,
                  double s_m,
                  const Wanted& wanted,
                  std::set<int>& passed) {
    constexpr int kFew = 40;  ///< a tread has about 170 to 250 cells
    for (auto& [number, tread] : treads(climb, map, s_m, wanted.ahead_m)) {
        const auto where = testing::Message() << "tread " << number << " seen from " << s_m;
        const auto known = static_cast<int>(tread.errors_m.size());
        if (known >= kFew) {
            EXPECT_LE(std::abs(tread.median_m()), wanted.median_m) << where;
            EXPECT_LE(tread.misplaced, 0.05 * known) << where;
        }
        if (tread.cells < kFew || tread.passed < tread.cells) continue;
        EXPECT_GE(tread.passed_known, wanted.known * tread.passed) << where;
        passed.insert(number);
    }
}

constexpr int kCheckEvery = 4;

TEST(Climb, TwentyStepsUpKeepACorrectMap) {
    const Climb climb("flight_20_up");
    SceneCameras cameras(climb.scene());
    elevation::ElevationMap map{elevation::ElevationConfig{}};
    std::set<int> passed;
    for (int look = 0; look < climb.looks(); ++look) {
        const double s_m = climb.way_m(look);
        const Pose T_world_body = climb.T_world_body(s_m);
        add_look(cameras, cameras.look_from(T_world_body), T_world_body, map);
        if (look % kCheckEvery == 0) check_treads(climb, map, s_m, {}, passed);
    }
    for (int number = 0; number < 20; ++number) EXPECT_EQ(passed.count(number), 1U) << number;
    EXPECT_GT(climb.T_world_body(climb.length_m()).translation_m.z(), 4.0)
        << "the path climbs higher than any height cut";
}

/// Cells of treads below the cut: how many have a height, and how many have free-space evidence.
struct BelowTheCut {
    int cells = 0;
    int known = 0;
    int evidence = 0;
    int wrong_evidence = 0;  ///< ground where the map claims free space
};

void look_below(const Climb& climb,
                const elevation::ElevationMap& map,
                double s_m,
                double cut_m,
                BelowTheCut& out) {
    constexpr double kSlack_m = 0.05;  // noise at the farthest cell
    for_level_cells(climb, map.geometry(), s_m, [&](double true_m, grid::Cell cell, double) {
        if (true_m > cut_m - kSlack_m) return;
        ++out.cells;
        if (!std::isnan(map.layers().height_m.at(cell.ix, cell.iy))) ++out.known;
        const auto free_m = static_cast<double>(map.layers().free_above_m.at(cell.ix, cell.iy));
        if (std::isnan(free_m)) return;
        ++out.evidence;
        if (free_m < true_m - kSlack_m) ++out.wrong_evidence;
    });
}

// With the default cut, and with one that keeps only the nearest five treads below the feet.
// Without the ramps that a matcher invents behind every nosing: docs/lab/correlated_depth.md
// measures these.
TEST(Climb, TwentyStepsDownKeepACorrectMapAndWhatIsBelowTheCutADrop) {
    const Climb climb("flight_20_down");
    sim::AnalyticStereoConfig errors;
    errors.invented_share = 0.0;
    SceneCameras cameras(climb.scene(), errors);
    elevation::ElevationConfig narrow;
    narrow.prefilter.min_height_m = -1.9;
    elevation::ElevationMap map{elevation::ElevationConfig{}};
    elevation::ElevationMap cut{narrow};
    // A nosing hides half of the tread below it.
    const Wanted wanted{.ahead_m = 1.2, .median_m = 0.015, .known = 0.4};
    const Wanted near{.ahead_m = 0.5, .median_m = 0.015, .known = 0.4};
    std::set<int> passed;
    std::set<int> passed_cut;
    BelowTheCut below;
    for (int look = 0; look < climb.looks(); ++look) {
        const double s_m = climb.way_m(look);
        const Pose T_world_body = climb.T_world_body(s_m);
        const DepthImage& depth = cameras.look_from(T_world_body);
        add_look(cameras, depth, T_world_body, map);
        add_look(cameras, depth, T_world_body, cut);
        if (look % kCheckEvery != 0) continue;
        check_treads(climb, map, s_m, wanted, passed);
        check_treads(climb, cut, s_m, near, passed_cut);
        const double cut_m = T_world_body.translation_m.z() + narrow.prefilter.min_height_m;
        look_below(climb, cut, s_m, cut_m, below);
    }
    for (int number = 0; number > -20; --number) {
        EXPECT_EQ(passed.count(number), 1U) << number;
        EXPECT_EQ(passed_cut.count(number), 1U) << number;
    }
    EXPECT_GT(below.cells, 5000);
    EXPECT_LT(below.known, below.cells / 200) << "only noise may pass the height cut";
    EXPECT_GT(below.evidence, below.cells / 4);
    EXPECT_EQ(below.wrong_evidence, 0);
    EXPECT_LT(climb.T_world_body(climb.length_m()).translation_m.z(), -2.0);
}

}  // namespace
}  // namespace surefoot::terrain

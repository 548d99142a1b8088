// SPDX-License-Identifier: Apache-2.0
#include "studies/lange2016/thesis_map.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "studies/clouds/cloud_pictures.hpp"
#include "surefoot/core/angles.hpp"
#include "surefoot/eval/clouds/cloud_distance.hpp"
#include "surefoot/eval/clouds/cloud_measures.hpp"
#include "surefoot/eval/maps/map_edges.hpp"
#include "surefoot/eval/report/percentile.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::app {
namespace {

/// Height differences above this multiple of their median belong to another surface.
constexpr double kOutlier =
    4.5;  // 4.5 median absolute deviations are 3 sigma of a normal distribution
constexpr double kLeastSigma_m = 1e-4;
/// Cells whose live height differs by more than this from the scan belong to an object, not to an
/// uneven floor.
constexpr double kOtherThing_m = 0.15;
/// Diameter of an M3C2 cylinder in cells. Such a cylinder holds about a dozen cells; it needs five.
constexpr double kCellsAcross = 4.0;

/// Peak detection for stairs. No riser is lower than 80 mm. The noise of a map needs bins of 10 mm.
constexpr eval::LevelConfig kStepLevels{.bin_m = 0.01, .least_step_m = 0.08};

std::vector<double> sorted_sizes(const std::vector<float>& values) {
    std::vector<double> sizes;
    for (const float value : values) {
        if (!std::isnan(value)) sizes.push_back(std::abs(static_cast<double>(value)));
    }
    std::sort(sizes.begin(), sizes.end());
    return sizes;
}

double percentile(const std::vector<double>& sorted, double fraction) {
    return sorted.empty() ? std::nan("") : eval::percentile_of_sorted(sorted, fraction);
}

/// Returns the height and tilt that align the live heights with the truth. They are the plane
/// through the height differences of the cells. Each round drops differences farther than three
/// sigma from the plane. Examples are a wall top that the camera did not see, or a step that is off
/// by one cell.
Pose height_and_tilt(const RatedMap& truth, const RatedMap& live) {
    struct Difference {
        Eigen::Vector3d at;  // x, y, 1
        double rise_m;       // truth minus live height [m]
    };
    const RatedMap there = laid_onto(truth, live, Pose{});
    std::vector<Difference> all;
    for (int iy = 0; iy < truth.geometry.ny; ++iy) {
        for (int ix = 0; ix < truth.geometry.nx; ++ix) {
            const double rise_m = static_cast<double>(truth.height_m.at(ix, iy)) -
                                  static_cast<double>(there.height_m.at(ix, iy));
            if (std::isnan(rise_m)) continue;
            const Eigen::Vector2d at_m = truth.geometry.center_m({ix, iy});
            all.push_back({{at_m.x(), at_m.y(), 1.0}, rise_m});
        }
    }
    constexpr int kRounds = 20;
    constexpr std::size_t kFewest = 50;
    Eigen::Vector3d plane = Eigen::Vector3d::Zero();
    double limit_m = std::numeric_limits<double>::infinity();
    std::vector<double> off_m;
    for (int round = 0; round < kRounds; ++round) {
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        std::size_t used = 0;
        for (const Difference& d : all) {
            if (std::abs(d.rise_m - plane.dot(d.at)) > limit_m) continue;
            normal += d.at * d.at.transpose();
            right += d.at * d.rise_m;
            ++used;
        }
        if (used < kFewest) return {};
        // The first round uses only the median height, because steps and walls must not tilt the
        // plane.
        off_m.clear();
        if (round == 0) {
            for (const Difference& d : all) off_m.push_back(d.rise_m);
            std::nth_element(off_m.begin(), off_m.begin() + std::ssize(off_m) / 2, off_m.end());
            plane = {0.0, 0.0, off_m[off_m.size() / 2]};
        } else {
            plane = normal.ldlt().solve(right);
        }
        off_m.clear();
        for (const Difference& d : all) off_m.push_back(std::abs(d.rise_m - plane.dot(d.at)));
        std::nth_element(off_m.begin(), off_m.begin() + std::ssize(off_m) / 2, off_m.end());
        limit_m = kOutlier * std::max(off_m[off_m.size() / 2], kLeastSigma_m);
    }
    Pose T_truth_live;
    T_truth_live.rotation = Eigen::Quaterniond::FromTwoVectors(
        Eigen::Vector3d::UnitZ(), Eigen::Vector3d(-plane.x(), -plane.y(), 1.0));
    T_truth_live.translation_m.z() = plane.z();
    return T_truth_live;
}

void add_cloud_figures(std::span<const Eigen::Vector3f> live_m,
                       const geometry::KdTree& truth,
                       const eval::M3c2Config& config,
                       ComparedMap& out) {
    const eval::DistanceFigures c2c =
        eval::distance_figures(eval::cloud_distances_m(truth, live_m));
    out.figures.set("c2c_mean_m", c2c.mean_m);
    out.figures.set("c2c_p50_m", c2c.p50_m);
    out.figures.set("c2c_p90_m", c2c.p90_m);
    const geometry::KdTree live({live_m.begin(), live_m.end()});
    const auto values = eval::m3c2(truth, live, live_m, config);
    const grid::GridGeometry& g = out.live.geometry;
    out.m3c2_m = grid::Layer(g.nx, g.ny, std::nanf(""));
    std::vector<float> distances_m;
    int significant = 0;
    int known = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        distances_m.push_back(static_cast<float>(values[i].distance_m));
        if (std::isnan(values[i].distance_m)) continue;
        ++known;
        significant += values[i].significant ? 1 : 0;
        const auto cell =
            g.cell_at(static_cast<double>(live_m[i].x()), static_cast<double>(live_m[i].y()));
        if (cell) out.m3c2_m.at(cell->ix, cell->iy) = distances_m.back();
    }
    const eval::DistanceFigures signed_m = eval::distance_figures(distances_m);
    out.figures.set("m3c2_mean_m", signed_m.mean_m);
    out.figures.set("m3c2_p50_m", signed_m.median_abs_m);
    out.figures.set("m3c2_p90_m", signed_m.p90_abs_m);
    out.figures.set("m3c2_significant",
                    known > 0 ? static_cast<double>(significant) / known : std::nan(""));
}

void add_floor_figures(const RatedMap& truth,
                       const eval::EvalMapsConfig& config,
                       ComparedMap& out) {
    eval::CellMask floor = eval::level_floor(truth.height_m, config);
    for (std::size_t i = 0; i < floor.size(); ++i) {
        const double off_m = static_cast<double>(out.live.height_m.data()[i]) -
                             static_cast<double>(truth.height_m.data()[i]);
        if (std::abs(off_m) > kOtherThing_m) floor.data()[i] = 0;
    }
    const eval::HeightJumps jumps = eval::height_jumps(out.live.height_m, floor, {});
    const std::vector<double> sizes = sorted_sizes(jumps.jump_m);
    out.figures.set("edges_p99_m", percentile(sizes, 0.99));
    out.figures.set("edges_most_m", percentile(sizes, 1.0));
    out.figures.set("floor_spread_m",
                    eval::floor_spread(out.live.geometry, out.live.height_m, floor).spread_m);
}

void add_rating_figures(const RatedMap& truth,
                        const eval::EvalMapsConfig& config,
                        ComparedMap& out) {
    const eval::ElevationErrors heights =
        eval::elevation_errors(out.live.height_m, truth.height_m, {}, config);
    out.figures.set("height_p50_m", heights.median_abs_m);
    out.figures.set("height_p90_m", heights.p90_abs_m);
    out.figures.set("height_mean_m", heights.mean_m);
    out.calls =
        eval::classify(out.live.traversability, truth.traversability, config.safe_threshold);
    const eval::TraversabilityErrors errors = eval::traversability_errors(out.calls, {});
    out.figures.set("false_safe", errors.false_safe);
    out.figures.set("false_unsafe", errors.false_unsafe);
    out.figures.set("known_cells",
                    static_cast<double>(errors.truly_safe_cells + errors.truly_unsafe_cells));
}

std::vector<Eigen::Vector3f> inside(std::span<const Eigen::Vector3f> points_m,
                                    const GroundBox& box) {
    std::vector<Eigen::Vector3f> kept_m;
    for (const Eigen::Vector3f& p_m : points_m) {
        const Eigen::Vector2d at_m = p_m.head<2>().cast<double>();
        if ((at_m.array() >= box.low_m.array()).all() && (at_m.array() <= box.high_m.array()).all())
            kept_m.push_back(p_m);
    }
    return kept_m;
}

/// Returns the mean of the known heights in a box; NaN if there are none.
double mean_height_m(const RatedMap& map, const GroundBox& box) {
    double sum_m = 0.0;
    int cells = 0;
    for (const Eigen::Vector3f& p_m : inside(cell_points_m(map), box)) {
        sum_m += static_cast<double>(p_m.z());
        ++cells;
    }
    return cells > 0 ? sum_m / cells : std::nan("");
}

}  // namespace

RatedMap rated_map(const grid::GridGeometry& geometry,
                   const grid::Layer& height_m,
                   const traversability::TraversabilityConfig& config) {
    Serial serial;
    traversability::TraversabilityLayers layers;
    traversability::rate(config.widened_to(geometry.resolution_m),
                         height_m.view(),
                         geometry.resolution_m,
                         serial,
                         layers);
    return {geometry, height_m, layers.traversability};
}

std::vector<Eigen::Vector3f> cell_points_m(const RatedMap& map) {
    std::vector<Eigen::Vector3f> points_m;
    for (int iy = 0; iy < map.geometry.ny; ++iy) {
        for (int ix = 0; ix < map.geometry.nx; ++ix) {
            const float z_m = map.height_m.at(ix, iy);
            if (std::isnan(z_m)) continue;
            const Eigen::Vector2f at_m = map.geometry.center_m({ix, iy}).cast<float>();
            points_m.emplace_back(at_m.x(), at_m.y(), z_m);
        }
    }
    return points_m;
}

RatedMap laid_onto(const RatedMap& truth, const RatedMap& live, const Pose& T_truth_live) {
    const grid::GridGeometry& g = truth.geometry;
    const Pose T_live_truth = T_truth_live.inverse();
    RatedMap out{g, grid::Layer(g.nx, g.ny, std::nanf("")), grid::Layer(g.nx, g.ny, std::nanf(""))};
    for (int iy = 0; iy < g.ny; ++iy) {
        for (int ix = 0; ix < g.nx; ++ix) {
            const float truth_z_m = truth.height_m.at(ix, iy);
            const Eigen::Vector2d at_m = g.center_m({ix, iy});
            const Eigen::Vector3d p_live_m =
                T_live_truth *
                Eigen::Vector3d(at_m.x(),
                                at_m.y(),
                                std::isnan(truth_z_m) ? 0.0 : static_cast<double>(truth_z_m));
            const auto cell = live.geometry.cell_at(p_live_m.x(), p_live_m.y());
            if (!cell) continue;
            const float z_m = live.height_m.at(cell->ix, cell->iy);
            if (std::isnan(z_m)) continue;
            const Eigen::Vector3d p_m =
                T_truth_live *
                Eigen::Vector3d(p_live_m.x(), p_live_m.y(), static_cast<double>(z_m));
            out.height_m.at(ix, iy) = static_cast<float>(p_m.z());
            out.traversability.at(ix, iy) = live.traversability.at(cell->ix, cell->iy);
        }
    }
    return out;
}

ComparedMap compare_with_scan(const RatedMap& live,
                              const RatedMap& truth,
                              const eval::M3c2Config& m3c2,
                              const eval::EvalMapsConfig& maps) {
    ComparedMap out;
    const geometry::KdTree scan(cell_points_m(truth));
    std::vector<Eigen::Vector3f> live_m = cell_points_m(live);
    out.T_truth_live = height_and_tilt(truth, live);
    out.figures.set("align_m", out.T_truth_live.translation_m.norm());
    out.figures.set("align_deg", 2.0 * out.T_truth_live.rotation.vec().norm() * kDegPerRad);
    for (Eigen::Vector3f& p_m : live_m) p_m = (out.T_truth_live * p_m.cast<double>()).cast<float>();
    out.live = laid_onto(truth, live, out.T_truth_live);
    eval::M3c2Config cylinders = m3c2;
    cylinders.projection_diameter_m =
        std::max(m3c2.projection_diameter_m, kCellsAcross * truth.geometry.resolution_m);
    add_cloud_figures(live_m, scan, cylinders, out);
    add_floor_figures(truth, maps, out);
    add_rating_figures(truth, maps, out);
    return out;
}

void measure_stairs(std::span<const Eigen::Vector3f> points_m,
                    const GroundBox& box,
                    ThesisFigures& figures) {
    const std::vector<Eigen::Vector3f> chosen_m = inside(points_m, box);
    eval::StairMeasures stairs;
    eval::HeightHistogram heights;
    if (!chosen_m.empty()) {
        const eval::SortedSurfaces surfaces = eval::sort_surfaces(chosen_m);
        heights = eval::height_histogram(surfaces.level_m, kStepLevels);
        stairs = eval::measure_stairs(surfaces, heights.levels);
    }
    const auto set = [&](const std::string& name, const eval::Repeated& values) {
        const bool none = values.values_m.empty();
        figures.set(name + "_m", none ? std::nan("") : values.mean_m);
        figures.set(name + "_se_m", none ? std::nan("") : values.std_error_m);
        figures.set(name + "_spread_m", none ? std::nan("") : values.spread_m);
    };
    set("riser", stairs.riser);
    set("going", stairs.going);
    figures.set("risers", static_cast<double>(stairs.riser.values_m.size()));
    figures.set("first_riser_m",
                stairs.riser.values_m.empty() ? std::nan("") : stairs.riser.values_m.front());
}

std::string box_heights_svg(std::span<const Eigen::Vector3f> points_m,
                            const GroundBox& box,
                            const std::string& title) {
    const std::vector<Eigen::Vector3f> chosen_m = inside(points_m, box);
    if (chosen_m.empty()) return "";
    const eval::SortedSurfaces surfaces = eval::sort_surfaces(chosen_m);
    return heights_svg(eval::height_histogram(surfaces.level_m, kStepLevels),
                       static_cast<std::int64_t>(surfaces.level_m.size()),
                       title);
}

void measure_door(std::span<const Eigen::Vector3f> points_m,
                  const RatedMap& map,
                  const Eigen::Vector2d& door_m,
                  ThesisFigures& figures) {
    // These strips of floor are as wide as a person, and clear of the wall and of the door leaf.
    constexpr double kHalf_m = 0.3;
    constexpr double kFree_m = 0.25;
    constexpr double kLong_m = 1.0;
    const Eigen::Vector2d half(0.0, kHalf_m);
    const auto strip = [&](double from_m, double to_m) {
        return GroundBox{door_m + Eigen::Vector2d(from_m, 0.0) - half,
                         door_m + Eigen::Vector2d(to_m, 0.0) + half};
    };
    const double before_m = mean_height_m(map, strip(-kFree_m - kLong_m, -kFree_m));
    const double behind_m = mean_height_m(map, strip(kFree_m, kFree_m + kLong_m));
    const auto width_m =
        eval::door_width_m(points_m, {door_m, 0.0, std::isnan(before_m) ? 0.0 : before_m});
    figures.set("door_width_m", width_m.value_or(std::nan("")));
    figures.set("floor_step_m", behind_m - before_m);
}

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
// How far do the errors of semi-global matching hang together, and what does it invent behind drop
// edges? Usage: correlated_depth OUT_DIR [FIRST_SEED [SEEDS [NOISE]]]. Writes CSV files into
// OUT_DIR.
//
// A camera 0.95 m over the upper level, 32 deg down, looks over an edge at a given distance. The
// strip behind the edge that neither eye can see (drop * distance / 0.95 long) must stay unknown.
#include <fmt/format.h>
#include <fmt/os.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "apps/surefoot/settings.hpp"
#include "sim/camera_profile.hpp"
#include "sim/renderer.hpp"
#include "sim/rigs.hpp"
#include "sim/truth.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/elevation/elevation_map.hpp"
#include "surefoot/stereo/matcher.hpp"

namespace surefoot {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using elevation::ElevationConfig;

constexpr double kCameraHeight_m = 0.95;
constexpr double kCellSize_m = 0.025;

/// What stands behind the edge.
struct Drop {
    const char* name;
    double rise_m;
    int steps;  ///< 1 = kerb; more = flight down, going 0.31 m
};
constexpr Drop kDrops[] = {{"kerb 75 mm", 0.075, 1},
                           {"kerb 100 mm", 0.100, 1},
                           {"kerb 150 mm", 0.150, 1},
                           {"stairs down 180/310", 0.180, 5}};
constexpr double kDistances_m[] = {0.67, 1.0, 1.5, 2.0};

sim::Material look(sim::Pattern pattern, std::uint64_t seed) {
    sim::Material material;
    material.pattern = pattern;
    material.seed = seed;
    material.contrast *= sim::figures_of(sim::CameraProfile::zed).contrast;
    return material;
}

/// Upper level z = 0 that ends at x = edge_x, everything turned by `yaw_rad` about the edge's
/// middle.
sim::Scene drop_scene(const Drop& drop, double edge_x_m, double yaw_rad, Rng& rng) {
    constexpr double kGoing_m = 0.31;
    constexpr double kReach_m = 4.0;
    sim::Scene scene;
    // A white wall has nothing to match: whether floor is kept cannot be asked there.
    const auto pattern = [&] {
        sim::Pattern drawn = sim::Pattern::white_wall;
        while (drawn == sim::Pattern::white_wall)
            drawn = static_cast<sim::Pattern>(rng.below(sim::kPatterns));
        return drawn;
    };
    const sim::Pattern upper_pattern = pattern();
    const sim::Pattern lower_pattern = pattern();
    const int upper = scene.add_material(look(upper_pattern, rng.next_u64()));
    const int lower = scene.add_material(look(lower_pattern, rng.next_u64()));
    const Vector2d along(std::cos(yaw_rad), std::sin(yaw_rad));
    const double bottom_m = -drop.steps * drop.rise_m;
    const auto slab =
        [&](double from_m, double to_m, double top_m, int material, sim::Label label) {
            const Vector2d center = Vector2d(edge_x_m, 0.0) + 0.5 * (from_m + to_m) * along;
            scene.add(sim::make_box(
                          center, {to_m - from_m, 2.0 * kReach_m}, bottom_m - 0.5, top_m, yaw_rad),
                      material,
                      label);
        };
    slab(-kReach_m, 0.0, 0.0, upper, sim::Label::floor);
    for (int step = 1; step < drop.steps; ++step) {
        slab((step - 1) * kGoing_m, step * kGoing_m, -step * drop.rise_m, upper, sim::Label::step);
    }
    slab((drop.steps - 1) * kGoing_m, kReach_m, bottom_m, lower, sim::Label::drop);
    return scene;
}

/// Renders, matches and knows the truth, for one rig.
class Bench {
  public:
    Bench(double noise, Executor& executor)
        : executor_(executor),
          rig_(*sim::rig_preset("zed_vga")),
          rectifier_(camera::Rectifier::make(rig_).value()),
          matcher_(stereo::make_sgbm_matcher({})) {
        sim::apply_profile(sim::CameraProfile::zed, noise, camera_);
    }

    void see(const sim::Scene& scene, const Pose& T_world_body, int frame, std::uint64_t seed) {
        const auto renderer = sim::Renderer::make(
            scene,
            sim::with_error(rig_, sim::figures_of(sim::CameraProfile::zed).calibration),
            camera_,
            seed);
        renderer->render(T_world_body, frame, executor_, pair_);
        matcher_->match(pair_.left.view(), pair_.right.view(), executor_, depth_);
    }
    [[nodiscard]] const camera::RectifiedRig& rectified() const { return rectifier_.rig(); }
    [[nodiscard]] const camera::StereoRig& rig() const { return rig_; }
    [[nodiscard]] const camera::DepthImage& depth() const { return depth_; }
    [[nodiscard]] const Image<float>& true_depth_m() const { return pair_.depth_m; }
    [[nodiscard]] Pose pose_over(double x_m) const {
        Pose T_world_body;
        T_world_body.translation_m = {
            x_m, 0.0, kCameraHeight_m - rig_.body_from_left().translation_m.z()};
        return T_world_body;
    }
    [[nodiscard]] double camera_x_m() const { return rig_.body_from_left().translation_m.x(); }

  private:
    Executor& executor_;
    camera::StereoRig rig_;
    sim::CameraConfig camera_;
    camera::Rectifier rectifier_;
    std::unique_ptr<stereo::Matcher> matcher_;
    sim::RenderedPair pair_;
    camera::DepthImage depth_;
};

enum class Sight { outside, hidden, partly, seen };

/// How a point of the ground is seen from a pose: by both eyes, by one at most because something
/// stands in the way, or not in both images at all.
Sight sight_of(const sim::Scene& scene,
               const camera::StereoRig& rig,
               const Pose& T_world_body,
               const Vector3d& point_m) {
    constexpr double kMargin_px = 8.0;
    constexpr double kRange_m = 2.8;
    bool blocked = false;
    for (const bool right : {false, true}) {
        const Pose T_world_camera =
            T_world_body * rig.body_from_left() * (right ? rig.T_left_right : Pose{});
        const Vector3d way = point_m - T_world_camera.translation_m;
        const auto pixel = camera::project(rig.left.model, T_world_camera.inverse() * point_m);
        if (way.norm() > kRange_m || !pixel || pixel->x() < kMargin_px || pixel->y() < kMargin_px ||
            pixel->x() > rig.left.width - kMargin_px || pixel->y() > rig.left.height - kMargin_px)
            return Sight::outside;
        blocked = blocked ||
                  scene.blocked(T_world_camera.translation_m, way.normalized(), way.norm() - 1e-6);
    }
    return blocked ? Sight::hidden : Sight::seen;
}

/// A cell is seen when all of 5 x 5 points on its true surface were, from some pose; hidden when
/// none was and each stood behind something.
Sight sight_of_cell(const sim::Scene& scene,
                    const camera::StereoRig& rig,
                    const std::vector<Pose>& T_world_body,
                    const Vector2d& center_m) {
    constexpr int kSide = 5;
    int seen = 0;
    int hidden = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
        const int row = i / kSide;
        const int column = i % kSide;
        const Vector2d offset((column + 0.5) / kSide - 0.5, (row + 0.5) / kSide - 0.5);
        const Vector2d at = center_m + kCellSize_m * offset;
        const auto top = scene.height_at(at.x(), at.y());
        if (!top) continue;
        bool ever_seen = false;
        bool ever_hidden = false;
        for (const Pose& T : T_world_body) {
            const Sight sight = sight_of(scene, rig, T, {at.x(), at.y(), top->z_m});
            ever_seen = ever_seen || sight == Sight::seen;
            ever_hidden = ever_hidden || sight == Sight::hidden;
        }
        seen += ever_seen ? 1 : 0;
        hidden += !ever_seen && ever_hidden ? 1 : 0;
    }
    constexpr int kAll = kSide * kSide;
    return seen == kAll               ? Sight::seen
           : hidden == kAll           ? Sight::hidden
           : seen == 0 && hidden == 0 ? Sight::outside
                                      : Sight::partly;
}

/// A rule for which pixels are fused.
struct Rule {
    std::string name;
    ElevationConfig config;
};

std::vector<Rule> rules() {
    std::vector<Rule> all;
    const auto add = [&](const std::string& name, const auto& change) {
        ElevationConfig config;
        config.reduction.min_points = 2;  // unless the rule says otherwise
        change(config);
        all.push_back({name, config});
    };
    add("every match", [](ElevationConfig& c) {
        c.pixels.surface_check = false;
        c.pixels.max_outlier_probability = 1.0;
    });
    add("likely right", [](ElevationConfig& c) { c.pixels.surface_check = false; });
    add("no jumps", [](ElevationConfig& c) {
        c.pixels.max_incidence_deg = c.pixels.max_incidence_level_deg = 90.0;
    });
    for (const double limit_deg : {85.0, 80.0, 75.0, 70.0, 65.0}) {
        add(fmt::format("no jumps, incidence < {:.0f} deg", limit_deg), [&](ElevationConfig& c) {
            c.pixels.max_incidence_deg = c.pixels.max_incidence_level_deg = limit_deg;
        });
    }
    add("80 deg, level 85 deg, 2 points",
        [](ElevationConfig& c) { c.pixels.max_incidence_deg = 80.0; });
    all.push_back({"default (75 deg, level 85 deg, 3 points)", ElevationConfig{}});
    for (const double level_deg : {80.0, 85.0}) {
        for (const int points : {2, 4}) {
            add(fmt::format("75 deg, level {:.0f} deg, {} points", level_deg, points),
                [&](ElevationConfig& c) {
                    c.pixels.max_incidence_deg = 75.0;
                    c.pixels.max_incidence_level_deg = level_deg;
                    c.reduction.min_points = points;
                });
        }
    }
    for (const int reach_px : {5, 8}) {
        add(fmt::format("75 deg, reach {} px", reach_px), [&](ElevationConfig& c) {
            c.pixels.max_incidence_deg = c.pixels.max_incidence_level_deg = 75.0;
            c.pixels.reach_px = reach_px;
        });
    }
    add("75 deg, outliers < 0.3", [](ElevationConfig& c) {
        c.pixels.max_incidence_deg = c.pixels.max_incidence_level_deg = 75.0;
        c.pixels.max_outlier_probability = 0.3;
    });
    return all;
}

struct Cell {
    Vector2d center_m;
    float truth_m = 0.0F;
    Sight sight = Sight::partly;
};

/// Cells around the edge, at most 0.5 m to either side of the camera.
std::vector<Cell> cells_around(const sim::Scene& scene,
                               const Bench& bench,
                               const std::vector<Pose>& poses,
                               double edge_x_m) {
    std::vector<Cell> cells;
    const double camera_y_m = bench.rig().body_from_left().translation_m.y();
    for (double x = edge_x_m - 1.0; x < edge_x_m + 1.2; x += kCellSize_m) {
        for (double y = camera_y_m - 0.5; y < camera_y_m + 0.5; y += kCellSize_m) {
            const Vector2d center((std::floor(x / kCellSize_m) + 0.5) * kCellSize_m,
                                  (std::floor(y / kCellSize_m) + 0.5) * kCellSize_m);
            const auto top = scene.height_at(center.x(), center.y());
            if (!top) continue;
            cells.push_back({center,
                             static_cast<float>(top->z_m),
                             sight_of_cell(scene, bench.rig(), poses, center)});
        }
    }
    return cells;
}

struct Counts {
    int hidden = 0;
    int invented = 0;
    int invented_wrong = 0;  ///< more than 20 mm from the ground that is really there
    int visible = 0;
    int visible_known = 0;
};

Counts count(const elevation::ElevationMap& map, const std::vector<Cell>& cells) {
    constexpr float kWrong_m = 0.02F;
    Counts counts;
    for (const Cell& cell : cells) {
        const auto index = map.geometry().cell_at(cell.center_m.x(), cell.center_m.y());
        const bool inside = index.has_value();
        const float height_m = inside ? map.layers().height_m.at(index->ix, index->iy) : NAN;
        const bool known = !std::isnan(height_m);
        if (cell.sight == Sight::hidden) {
            ++counts.hidden;
            counts.invented += known ? 1 : 0;
            counts.invented_wrong += known && std::abs(height_m - cell.truth_m) > kWrong_m ? 1 : 0;
        } else if (cell.sight == Sight::seen) {
            ++counts.visible;
            counts.visible_known += known ? 1 : 0;
        }
    }
    return counts;
}

/// Drops seen from one place, and on the way to it (10 frames over 1 m).
void measure_drops(Bench& bench, const std::string& out, int first_seed, int seeds) {
    auto file = fmt::output_file(out + "/invented.csv");
    file.print(
        "motion,drop,distance_m,seed,rule,hidden,invented,invented_wrong,visible,visible_known\n");
    auto profile = fmt::output_file(out + "/profile.csv");
    profile.print("rule,x_m,truth_m,height_m,sight\n");
    const auto all_rules = rules();
    for (const Drop& drop : kDrops) {
        for (const double distance_m : kDistances_m) {
            for (int seed = first_seed; seed < first_seed + seeds; ++seed) {
                for (const int frames : {1, 10}) {
                    Rng rng(mix_seed(static_cast<std::uint64_t>(seed),
                                     static_cast<std::uint64_t>(1000.0 * distance_m)));
                    const double yaw_rad = rng.uniform(-0.35, 0.35);
                    const double edge_x_m = bench.camera_x_m() + distance_m;
                    const sim::Scene scene = drop_scene(drop, edge_x_m, yaw_rad, rng);
                    std::vector<Pose> poses;
                    poses.reserve(static_cast<std::size_t>(frames));
                    for (int i = 0; i < frames; ++i)
                        poses.push_back(bench.pose_over(-0.1 * (frames - 1 - i)));
                    const auto cells = cells_around(scene, bench, poses, edge_x_m);
                    std::vector<elevation::ElevationMap> maps;
                    maps.reserve(all_rules.size());
                    for (const Rule& rule : all_rules) maps.emplace_back(rule.config);
                    for (int i = 0; i < frames; ++i) {
                        bench.see(scene, poses[static_cast<std::size_t>(i)], i, rng.next_u64());
                        for (auto& map : maps) {
                            map.follow(poses[static_cast<std::size_t>(i)],
                                       1e-8 * Matrix6::Identity());
                            map.add(bench.rectified(),
                                    poses[static_cast<std::size_t>(i)],
                                    bench.depth(),
                                    1 + i);
                        }
                    }
                    for (std::size_t r = 0; r < maps.size(); ++r) {
                        const Counts c = count(maps[r], cells);
                        file.print("{},{},{:.2f},{},\"{}\",{},{},{},{},{}\n",
                                   frames == 1 ? "one frame" : "approach",
                                   drop.name,
                                   distance_m,
                                   seed,
                                   all_rules[r].name,
                                   c.hidden,
                                   c.invented,
                                   c.invented_wrong,
                                   c.visible,
                                   c.visible_known);
                    }
                    if (&drop != &kDrops[2] || distance_m != 1.5 || seed != first_seed ||
                        frames != 1) {
                        continue;
                    }
                    const double row_y_m = (std::floor(0.19 / kCellSize_m) + 0.5) * kCellSize_m;
                    for (std::size_t r = 0; r < maps.size(); ++r) {
                        for (const Cell& cell : cells) {
                            if (std::abs(cell.center_m.y() - row_y_m) > 1e-6) continue;
                            const auto index =
                                maps[r].geometry().cell_at(cell.center_m.x(), cell.center_m.y());
                            profile.print("\"{}\",{:.4f},{:.4f},{:.4f},{}\n",
                                          all_rules[r].name,
                                          cell.center_m.x(),
                                          cell.truth_m,
                                          maps[r].layers().height_m.at(index->ix, index->iy),
                                          static_cast<int>(cell.sight));
                        }
                    }
                }
            }
            fmt::print(stderr, "{} at {:.2f} m done\n", drop.name, distance_m);
        }
    }
}

/// Sums for the autocorrelation of disparity errors at one lag.
struct Lag {
    double sum = 0.0;
    std::int64_t count = 0;
};

constexpr float kWrongMatch_px = 1.5F;

/// Errors of the disparity on flat floor, pixel by pixel; NaN where there is none that is likely
/// right, and where it is wrong nevertheless.
Image<float> disparity_errors(const Bench& bench) {
    const auto& depth = bench.depth();
    Image<float> errors(depth.disparity_px.width(), depth.disparity_px.height());
    const double fb = bench.rectified().depth_to_disparity_px_m();
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const double truth_px = fb / static_cast<double>(bench.true_depth_m().data()[i]);
        const bool good = depth.outlier_probability.data()[i] <= 0.5F;
        const float error_px = depth.disparity_px.data()[i] - static_cast<float>(truth_px);
        // Wrong matches are another matter than scatter: a few would decide every sum of squares.
        errors.data()[i] = good && std::abs(error_px) < kWrongMatch_px ? error_px : NAN;
    }
    return errors;
}

/// Pixels by the cell of floor that they show: how much less than a pixel's do cell means scatter?
struct RangeBin {
    double pixel_sq = 0.0;
    std::int64_t pixels = 0;
    double cell_sq = 0.0;
    std::int64_t cells = 0;
};
constexpr int kRangeBins = 5;
constexpr double kBinWidth_m = 0.5;

void add_cells(const Bench& bench,
               const Pose& T_world_body,
               const Image<float>& errors,
               std::vector<RangeBin>& bins) {
    struct Sum {
        double error = 0.0;
        double square = 0.0;
        int count = 0;
        double range_m = 0.0;
    };
    constexpr int kSide = 400;
    std::vector<Sum> cells(static_cast<std::size_t>(kSide) * kSide);
    const auto& rig = bench.rectified();
    const Pose T_world_camera = T_world_body * rig.T_body_camera;
    for (int v = 0; v < errors.height(); ++v) {
        for (int u = 0; u < errors.width(); ++u) {
            const float error = errors.at(u, v);
            const double z = static_cast<double>(bench.true_depth_m().at(u, v));
            if (std::isnan(error) || !(z < 4.0)) continue;
            const Vector3d point =
                T_world_camera *
                Vector3d((u - rig.cx_px) / rig.fx_px * z, (v - rig.cy_px) / rig.fy_px * z, z);
            const int ix = static_cast<int>(std::floor(point.x() / kCellSize_m)) + kSide / 2;
            const int iy = static_cast<int>(std::floor(point.y() / kCellSize_m)) + kSide / 2;
            if (ix < 0 || iy < 0 || ix >= kSide || iy >= kSide) continue;
            Sum& sum = cells[static_cast<std::size_t>(iy) * kSide + static_cast<std::size_t>(ix)];
            sum.error += static_cast<double>(error);
            sum.square += static_cast<double>(error) * static_cast<double>(error);
            ++sum.count;
            sum.range_m = (point - T_world_camera.translation_m).norm();
        }
    }
    for (const Sum& sum : cells) {
        const auto bin = static_cast<int>(sum.range_m / kBinWidth_m) - 2;
        if (sum.count < 4 || bin < 0 || bin >= kRangeBins) continue;
        RangeBin& into = bins[static_cast<std::size_t>(bin)];
        const double mean = sum.error / sum.count;
        into.pixel_sq += sum.square;
        into.pixels += sum.count;
        into.cell_sq += mean * mean;
        ++into.cells;
    }
}

/// Flat floors of every pattern, two frames from the same place with other noise.
void measure_correlation(Bench& bench, const std::string& out, int first_seed, int seeds) {
    constexpr int kLags = 81;
    auto lag_file = fmt::output_file(out + "/correlation.csv");
    lag_file.print("pattern,axis,lag_px,correlation,sigma_px\n");
    auto cell_file = fmt::output_file(out + "/cells.csv");
    cell_file.print("pattern,range_m,pixels_per_cell,independent,pixel_sigma_px,cell_sigma_px\n");
    auto time_file = fmt::output_file(out + "/repeated.csv");
    time_file.print("pattern,correlation_between_frames\n");
    for (int p = 0; p < sim::kPatterns; ++p) {
        std::vector<Lag> along_rows(kLags);
        std::vector<Lag> along_columns(kLags);
        std::vector<RangeBin> bins(kRangeBins);
        double cross = 0.0;
        double square = 0.0;
        for (int seed = first_seed; seed < first_seed + seeds; ++seed) {
            Rng rng(mix_seed(static_cast<std::uint64_t>(seed), static_cast<std::uint64_t>(p)));
            sim::Scene scene;
            const int material =
                scene.add_material(look(static_cast<sim::Pattern>(p), rng.next_u64()));
            scene.add_floor(sim::Floor({{-3.0, -5.0}, {9.0, 5.0}}, 0.0), material, material);
            const Pose T_world_body = bench.pose_over(rng.uniform(-0.5, 0.5));
            const std::uint64_t noise_seed = rng.next_u64();
            bench.see(scene, T_world_body, 0, noise_seed);
            const Image<float> errors = disparity_errors(bench);
            bench.see(scene, T_world_body, 1, noise_seed);
            const Image<float> again = disparity_errors(bench);
            add_cells(bench, T_world_body, errors, bins);
            // The lower two thirds of the image: floor nearer than about 3 m.
            for (int v = errors.height() / 3; v < errors.height(); ++v) {
                for (int u = 0; u < errors.width(); ++u) {
                    const float e = errors.at(u, v);
                    if (std::isnan(e)) continue;
                    const float f = again.at(u, v);
                    if (!std::isnan(f)) {
                        cross += static_cast<double>(e) * static_cast<double>(f);
                        square += 0.5 * (static_cast<double>(e) * static_cast<double>(e) +
                                         static_cast<double>(f) * static_cast<double>(f));
                    }
                    for (int lag = 0; lag < kLags; ++lag) {
                        if (u + lag < errors.width() && !std::isnan(errors.at(u + lag, v))) {
                            along_rows[static_cast<std::size_t>(lag)].sum +=
                                static_cast<double>(e) * static_cast<double>(errors.at(u + lag, v));
                            ++along_rows[static_cast<std::size_t>(lag)].count;
                        }
                        if (v + lag < errors.height() && !std::isnan(errors.at(u, v + lag))) {
                            along_columns[static_cast<std::size_t>(lag)].sum +=
                                static_cast<double>(e) * static_cast<double>(errors.at(u, v + lag));
                            ++along_columns[static_cast<std::size_t>(lag)].count;
                        }
                    }
                }
            }
        }
        const char* name = to_string(static_cast<sim::Pattern>(p));
        for (const auto& [axis, lags] :
             {std::pair{"row", &along_rows}, {"column", &along_columns}}) {
            const double variance =
                (*lags)[0].sum / static_cast<double>(std::max<std::int64_t>((*lags)[0].count, 1));
            for (int lag = 0; lag < kLags; ++lag) {
                const Lag& l = (*lags)[static_cast<std::size_t>(lag)];
                lag_file.print(
                    "{},{},{},{:.4f},{:.4f}\n",
                    name,
                    axis,
                    lag,
                    l.sum / static_cast<double>(std::max<std::int64_t>(l.count, 1)) / variance,
                    std::sqrt(variance));
            }
        }
        for (int bin = 0; bin < kRangeBins; ++bin) {
            const RangeBin& b = bins[static_cast<std::size_t>(bin)];
            if (b.cells < 20) continue;
            const double pixel_var = b.pixel_sq / static_cast<double>(b.pixels);
            const double cell_var = b.cell_sq / static_cast<double>(b.cells);
            cell_file.print("{},{:.2f},{:.1f},{:.3f},{:.4f},{:.4f}\n",
                            name,
                            (bin + 2.5) * kBinWidth_m,
                            static_cast<double>(b.pixels) / static_cast<double>(b.cells),
                            pixel_var / cell_var,
                            std::sqrt(pixel_var),
                            std::sqrt(cell_var));
        }
        time_file.print("{},{:.3f}\n", name, cross / square);
        fmt::print(stderr, "{} done\n", name);
    }
}

}  // namespace
}  // namespace surefoot

// An exception ends an experiment with its message, as it should.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    if (argc < 2) {
        fmt::print(stderr, "usage: correlated_depth OUT_DIR [FIRST_SEED [SEEDS [NOISE]]]\n");
        return 2;
    }
    const std::string out = argv[1];
    const int first_seed = argc > 2 ? std::atoi(argv[2]) : 1;
    const int seeds = argc > 3 ? std::atoi(argv[3]) : 4;
    const auto executor = surefoot::app::make_executor({});
    const double noise = argc > 4 ? std::atof(argv[4]) : 1.0;
    surefoot::Bench bench(noise, *executor);
    surefoot::measure_correlation(bench, out, first_seed, seeds);
    surefoot::measure_drops(bench, out, first_seed, seeds);
    return 0;
}

// SPDX-License-Identifier: Apache-2.0
// Do detected stairs features flicker from frame to frame, and does tracking keep the correct ones?
// Usage: stairs_follow OUT.csv MAPS [KEY=VALUE...]
//   stairs_truth out/up.csv lab/scenes/stairs_up.yaml#up_common 82001 4 images_0.25 1 out/maps
//   stairs_follow out/follow.csv out/maps
//   MAPS: folder in which stairs_truth saved every frame (EVERY = 1). KEY=VALUE: a setting of
//   surefoot.
//
// Writes OUT.csv, one line per run and method: `found` = each frame on its own, `followed` =
// tracked by stairs::FeatureTracker. Lengths in mm; empty or nan = not found:
//   observations           frames of the run
//   edges, drops, kerbs, flights, doors   appearances and disappearances, summed over the frames
//                          after the first: the frame before (or after) has no feature of that
//                          class within 0.1 m across and 20 deg
//   new_ids                features whose id changed at the same place; followed only
//   drops_lost             drops that a frame detected, but that the method does not report, or
//                          reports farther away by more than the sigma of the detected edge
//   found_observations     number of frames that found the true flight
//   steps_changes          changes of its number of steps between consecutive such frames
//   steps_exact            number of such frames with the true number of steps
//   riser_mean, _sd, _step, _last   error of the riser: mean and sd over the frames, rms change
//                          between frames, and value at the last frame
//   going_..., width_...   the same four errors of going and width
//   across_...             the same four errors of the position of the first edge (flight or drop)
//   riser_sure, across_sure   number of frames with an error within 2 stated sigmas
//   call_us, most_us       median and longest time of a call
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "lab/stairs_scenes/stairs_match.hpp"
#include "lab/stairs_scenes/stairs_observation.hpp"
#include "service/console/log.hpp"
#include "surefoot/io/text.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/stairs/feature_finder.hpp"
#include "surefoot/stairs/tracking/feature_tracker.hpp"

namespace surefoot::app {
namespace {

using experiments::Observation;
using experiments::TrueFeature;
using experiments::TrueKind;
using stairs::FeaturePose;
using stairs::TerrainFeatures;

constexpr std::int64_t kFrame_ns = 100'000'000;  ///< period of the simulated trolley, 10 Hz
constexpr double kSameTurn_rad = 20.0 / 180.0 * std::numbers::pi;

FeaturePose pose_of(const stairs::Edge& edge) {
    return stairs::line_feature(edge, true).pose;
}
template <typename Feature>
const FeaturePose& pose_of(const Feature& feature) {
    return feature.pose;
}

bool is_same_place(const FeaturePose& a, const FeaturePose& b) {
    const TrueFeature at{.middle_m = b.p_m.head<2>(), .yaw_rad = b.yaw_rad};
    return (a.p_m - b.p_m).head<2>().norm() < experiments::kBeside_m &&
           std::abs(experiments::across_m(a, at)) < experiments::kNear_m &&
           std::abs(experiments::turned_rad(a, at)) < kSameTurn_rad;
}

/// Returns true if a machine that knows the tracked drop `told` stops in time before the detected
/// drop `found`. The tracked drop must be as wide. Its edge may be at most a sigma farther away
/// than the detected edge, and at most 0.25 m nearer.
bool warns_of(const stairs::LineFeature& told, const stairs::LineFeature& found) {
    constexpr double kRounding_m = 1e-6;
    constexpr double kNearer_m = 0.25;
    const auto unit = [](double yaw_rad) {
        return Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
    };
    const Eigen::Vector2d way = unit(told.pose.yaw_rad);
    const Eigen::Vector2d found_way = unit(found.pose.yaw_rad);
    const Eigen::Vector2d found_along(-found_way.y(), found_way.x());
    for (const double end : {-0.5, 0.5}) {
        const Eigen::Vector2d p_m =
            (found.pose.p_m - told.pose.p_m).head<2>() + end * found.length_m * found_along;
        const double before_m = p_m.dot(way);
        const double beside_m = std::abs(p_m.x() * way.y() - p_m.y() * way.x());
        if (before_m < -found.across_sigma_m - kRounding_m || before_m > kNearer_m ||
            beside_m > 0.5 * told.length_m + experiments::kNear_m)
            return false;
    }
    return way.dot(found_way) > 0.0;
}

/// Counts features that appeared, disappeared, or got another id at the same place between two
/// frames.
struct Changes {
    int came_or_went = 0;
    int new_ids = 0;

    template <typename Feature>
    void add(const std::vector<Feature>& before, const std::vector<Feature>& now) {
        came_or_went += missing(before, now) + missing(now, before);
        const auto has_id_of = [](const std::vector<Feature>& among, const Feature& one) {
            return std::any_of(among.begin(), among.end(), [&](const Feature& other) {
                return other.tracked.id == one.tracked.id;
            });
        };
        for (const Feature& old : before) {
            if (has_id_of(now, old)) continue;
            new_ids += std::any_of(now.begin(), now.end(), [&](const Feature& other) {
                return !has_id_of(before, other) && is_same_place(pose_of(old), pose_of(other));
            });
        }
    }

    template <typename Feature>
    static int missing(const std::vector<Feature>& these, const std::vector<Feature>& among) {
        return static_cast<int>(std::count_if(these.begin(), these.end(), [&](const Feature& one) {
            return std::none_of(among.begin(), among.end(), [&](const Feature& other) {
                return is_same_place(pose_of(one), pose_of(other));
            });
        }));
    }
};

/// Errors over the frames of a run [mm].
class Errors {
  public:
    void add(double error_m, double sigma_m) {
        if (!std::isfinite(error_m)) return;
        errors_mm_.push_back(1e3 * error_m);
        sure_ += std::abs(error_m) <= 2.0 * sigma_m ? 1 : 0;
    }
    [[nodiscard]] int sure() const { return sure_; }
    [[nodiscard]] std::string columns() const {
        if (errors_mm_.empty()) return ",,,,";
        double mean_mm = 0.0, square = 0.0, steps = 0.0;
        const auto n = static_cast<double>(errors_mm_.size());
        for (const double error_mm : errors_mm_) mean_mm += error_mm / n;
        for (const double error_mm : errors_mm_) square += std::pow(error_mm - mean_mm, 2);
        for (std::size_t i = 1; i < errors_mm_.size(); ++i)
            steps += std::pow(errors_mm_[i] - errors_mm_[i - 1], 2);
        const double pairs = std::max(1.0, n - 1.0);
        return fmt::format(",{:.3f},{:.3f},{:.3f},{:.3f}",
                           mean_mm,
                           std::sqrt(square / pairs),
                           std::sqrt(steps / pairs),
                           errors_mm_.back());
    }

  private:
    std::vector<double> errors_mm_;
    int sure_ = 0;
};

/// Statistics of a run for one method.
class Account {
  public:
    void add(const TerrainFeatures& now, const TrueFeature& truth) {
        if (observations_++ > 0) compare(now);
        judge(now, truth);
        before_ = now;
    }
    void add_lost(const TerrainFeatures& found, const TerrainFeatures& told) {
        for (const stairs::LineFeature& drop : found.drops)
            lost_ += std::none_of(told.drops.begin(), told.drops.end(), [&](const auto& other) {
                return warns_of(other, drop);
            });
    }
    [[nodiscard]] std::string columns() const {
        return fmt::format(
            ",{},{},{},{},{},{},{},{},{},{},{}{}{}{}{},{},{}",
            observations_,
            edges_.came_or_went,
            drops_.came_or_went,
            kerbs_.came_or_went,
            flights_.came_or_went,
            doors_.came_or_went,
            edges_.new_ids + drops_.new_ids + kerbs_.new_ids + flights_.new_ids + doors_.new_ids,
            lost_,
            found_observations_,
            steps_changes_,
            steps_exact_,
            riser_.columns(),
            going_.columns(),
            width_.columns(),
            across_.columns(),
            riser_.sure(),
            across_.sure());
    }

  private:
    void compare(const TerrainFeatures& now) {
        edges_.add(before_.edges, now.edges);
        drops_.add(before_.drops, now.drops);
        kerbs_.add(before_.kerbs, now.kerbs);
        flights_.add(before_.flights, now.flights);
        doors_.add(before_.doors, now.doors);
    }
    void judge(const TerrainFeatures& now, const TrueFeature& truth) {
        const auto* const flight =
            experiments::nearest(now.flights, truth, [&](const stairs::Flight& candidate) {
                const bool is_up = candidate.kind == stairs::FlightKind::up;
                return truth.kind == (is_up ? TrueKind::up : TrueKind::down) &&
                       is_line_of(candidate.pose, truth);
            });
        const bool is_drop = truth.kind == TrueKind::down || truth.kind == TrueKind::kerb;
        const auto* const drop =
            experiments::nearest(now.drops, truth, [&](const stairs::LineFeature& candidate) {
                return is_drop && is_line_of(candidate.pose, truth);
            });
        if (drop != nullptr)
            across_.add(experiments::across_m(drop->pose, truth), drop->across_sigma_m);
        if (flight == nullptr) return;
        if (found_observations_++ > 0) steps_changes_ += flight->steps != steps_ ? 1 : 0;
        steps_ = flight->steps;
        steps_exact_ += flight->steps == truth.steps ? 1 : 0;
        riser_.add(flight->riser_m - truth.riser_m, flight->riser_sigma_m);
        going_.add(flight->going_m - truth.going_m, flight->going_sigma_m);
        width_.add(flight->width_m - truth.width_m, 0.0);
        if (!is_drop)
            across_.add(experiments::across_m(flight->pose, truth),
                        flight->edges.front().across_sigma_m);
    }

    TerrainFeatures before_;
    int observations_ = 0;
    Changes edges_, drops_, kerbs_, flights_, doors_;
    int lost_ = 0;
    int found_observations_ = 0;
    int steps_ = 0;
    int steps_changes_ = 0;
    int steps_exact_ = 0;
    Errors riser_, going_, width_, across_;
};

constexpr const char* kHeader =
    "scene,seed,mode,way,kind,observations,edges,drops,kerbs,flights,doors,new_ids,drops_lost,"
    "found_observations,"
    "steps_changes,steps_exact,riser_mean,riser_sd,riser_step,riser_last,going_mean,going_sd,"
    "going_step,going_last,width_mean,width_sd,width_step,width_last,across_mean,across_sd,"
    "across_step,across_last,riser_sure,across_sure,call_us,most_us\n";

Result<std::string> judge_run(const std::vector<std::string>& folders, const Settings& settings) {
    stairs::FeatureFinder finder(settings.pipeline.stairs);
    stairs::FeatureTracker tracker(settings.pipeline.stairs);
    TerrainFeatures found;
    TerrainFeatures tracked;
    Account alone;
    Account over_time;
    std::vector<double> call_us;
    std::string run;
    std::string kind;
    for (const std::string& folder : folders) {
        const auto observation = experiments::read_observation(folder);
        if (!observation) return observation.error();
        const stairs::Terrain terrain = observation->terrain();
        finder.find(terrain, found);
        const std::int64_t start_ns = steady_now_ns();
        tracker.update(found, terrain, {observation->frame * kFrame_ns, {}}, tracked);
        call_us.push_back(1e-3 * static_cast<double>(steady_now_ns() - start_ns));
        alone.add(found, observation->truth);
        over_time.add(tracked, observation->truth);
        over_time.add_lost(found, tracked);
        run = fmt::format("{},{},{},", observation->scene, observation->seed, observation->mode);
        kind = experiments::kTrueKindNames[static_cast<int>(observation->truth.kind)];
    }
    std::sort(call_us.begin(), call_us.end());
    return run + "found," + kind + alone.columns() + ",,\n" + run + "followed," + kind +
           over_time.columns() +
           fmt::format(",{:.1f},{:.1f}\n", call_us[call_us.size() / 2], call_us.back());
}

/// Folders of each run, in the order of its frames.
std::map<std::string, std::vector<std::string>> runs_in(const std::string& maps) {
    std::map<std::string, std::vector<std::string>> runs;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(maps)) {
        if (entry.path().filename() != "truth.txt") continue;
        const std::string folder = entry.path().parent_path().string();
        runs[folder.substr(0, folder.rfind("_f"))].push_back(folder);
    }
    for (auto& [name, folders] : runs) std::sort(folders.begin(), folders.end(), io::natural_less);
    return runs;
}

int measure_all(const std::vector<std::string>& words) {
    if (words.size() < 2) return report(usage_error("stairs_follow OUT.csv MAPS [KEY=VALUE...]"));
    SettingsRequest common;
    common.overrides.assign(words.begin() + 2, words.end());
    const auto settings = surefoot::load_settings(common);
    if (!settings) return report(settings.error());
    auto out = fmt::output_file(words[0]);
    out.print("{}", kHeader);
    for (const auto& [name, folders] : runs_in(words[1])) {
        const auto rows = judge_run(folders, *settings);
        if (!rows) return report(rows.error());
        out.print("{}", *rows);
        out.flush();
    }
    return 0;
}

}  // namespace
}  // namespace surefoot::app

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::app::measure_all({argv + 1, argv + argc});
}

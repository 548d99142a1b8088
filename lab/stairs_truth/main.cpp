// SPDX-License-Identifier: Apache-2.0
// Are stairs, drops, kerbs and doors detected in the map, and how accurate are their parameters?
// Usage: stairs_truth OUT.csv SCENES [FIRST_SEED [SEEDS [MODES [EVERY [MAPS [KEY=VALUE...]]]]]]
//        stairs_truth OUT.csv MAPS [KEY=VALUE...]
//   stairs_truth out/up.csv lab/scenes/stairs_up.yaml#up_common 80001 200 analytic_0.25
//   stairs_truth out/false.csv floor,room 80001 5 images_0.25,images_0.5 5
//   MODES  sensor modes with commas between them, see stairs_scene.hpp; default: analytic_0.25
//   EVERY  judge every n-th frame; 0 = only the last one, with a tracker that gets all frames
//   MAPS   folder that keeps the input of the detector; saved cases are not simulated again.
//          Default '-': keep nothing. If MAPS takes the place of SCENES, all saved cases in it are
//          judged, each on its own.
//   KEY=VALUE   a setting of surefoot; poses are true ones unless sim.known_motion=false
//
// Writes OUT.csv, two lines per judged frame: the detection in this frame alone, and the tracked
// result. Lengths in mm, angles in deg; empty or nan = not found:
//   way                single = this frame alone, tracked = tracked by FeatureTracker
//   noise_px, bias_px, said_px   scatter and mean of disparity errors on level floor, stated sigma
//   kind, steps, riser, going, width, sill, ahead   true values; ahead: from the left camera
//   found              flight whose first edge lies within 0.1 m and 10 deg of the true one
//   ..._steps, _riser, _riser_sigma, _going, _going_sigma, _width, _cut   its parameters
//   across, turn       error of its first edge at the true middle, + = farther; error of its yaw
//   flights, of_2      number of other flights; number of these with two steps or more
//   drop               drop whose edge lies within 0.1 m and 10 deg of the true edge
//   drop_across, drop_height, drop_sigma, bottom_seen   error of its edge at the true middle, its
//                      height downward, sigma of this height, and whether its bottom was seen
//   drops              number of other drops
//   door, door_width, door_width_sigma, door_sill   the opening within 0.3 m and 15 deg of the true
//                                                   one
//   sill_height        height of the sill within 0.3 m
//   find_us            time of a call: the shortest of four, because cases run in parallel
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lab/stairs_scenes/stairs_match.hpp"
#include "lab/stairs_scenes/stairs_observation.hpp"
#include "lab/stairs_scenes/stairs_scene.hpp"
#include "service/console/log.hpp"
#include "surefoot/core/angles.hpp"
#include "surefoot/io/text.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/stairs/feature_finder.hpp"
#include "surefoot/stairs/tracking/feature_tracker.hpp"

namespace surefoot::app {
namespace {

using experiments::across_m;
using experiments::is_line_of;
using experiments::nearest;
using experiments::Observation;
using experiments::StairsCase;
using experiments::TrueFeature;
using experiments::TrueKind;
using experiments::turned_rad;

constexpr int kCalls = 4;
constexpr double kDoorNear_m = 0.3;
constexpr double kDoorTurn_rad = 15.0 / kDegPerRad;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

constexpr double mm(double length_m) {
    return 1e3 * length_m;
}

std::string flight_columns(const std::vector<stairs::Flight>& flights, const TrueFeature& truth) {
    const auto* const found = nearest(flights, truth, [&](const stairs::Flight& flight) {
        const bool is_up = flight.kind == stairs::FlightKind::up;
        return truth.kind == (is_up ? TrueKind::up : TrueKind::down) &&
               is_line_of(flight.pose, truth);
    });
    const std::size_t others = flights.size() - (found != nullptr ? 1 : 0);
    const auto of_2 = std::count_if(flights.begin(), flights.end(), [&](const auto& flight) {
        return &flight != found && flight.steps >= 2;
    });
    if (found == nullptr) return fmt::format(",0{:,>10}{},{}", "", others, of_2);
    return fmt::format(",1,{},{:.2f},{:.2f},{:.2f},{:.2f},{:.1f},{},{:.2f},{:.3f},{},{}",
                       found->steps,
                       mm(found->riser_m),
                       mm(found->riser_sigma_m),
                       mm(found->going_m),
                       mm(found->going_sigma_m),
                       mm(found->width_m),
                       found->cut ? 1 : 0,
                       mm(across_m(found->pose, truth)),
                       kDegPerRad * turned_rad(found->pose, truth),
                       others,
                       of_2);
}

std::string drop_columns(const std::vector<stairs::LineFeature>& drops, const TrueFeature& truth) {
    const bool is_drop = truth.kind == TrueKind::down || truth.kind == TrueKind::kerb;
    const auto* const found = nearest(drops, truth, [&](const stairs::LineFeature& drop) {
        return is_drop && is_line_of(drop.pose, truth);
    });
    const std::size_t others = drops.size() - (found != nullptr ? 1 : 0);
    if (found == nullptr) return fmt::format(",0{:,>5}{}", "", others);
    return fmt::format(",1,{:.2f},{:.2f},{:.2f},{},{}",
                       mm(across_m(found->pose, truth)),
                       mm(-found->height_m),
                       mm(found->sigma_m),
                       found->bottom_seen ? 1 : 0,
                       others);
}

/// A door may be detected from both sides.
bool is_opening_of(const stairs::FeaturePose& found, const TrueFeature& truth) {
    const double turn_rad = std::abs(turned_rad(found, truth));
    return truth.kind == TrueKind::door &&
           (found.p_m.head<2>() - truth.middle_m).norm() < kDoorNear_m &&
           std::min(turn_rad, std::numbers::pi - turn_rad) < kDoorTurn_rad;
}

std::string door_columns(const stairs::TerrainFeatures& features, const TrueFeature& truth) {
    const auto* const door = nearest(features.doors, truth, [&](const stairs::Door& candidate) {
        return is_opening_of(candidate.pose, truth);
    });
    const auto* const sill =
        nearest(features.sills, truth, [&](const stairs::LineFeature& candidate) {
            return is_opening_of(candidate.pose, truth);
        });
    const std::string door_text = door == nullptr ? std::string(",0,,,")
                                                  : fmt::format(",1,{:.2f},{:.2f},{:.2f}",
                                                                mm(door->width_m),
                                                                mm(door->width_sigma_m),
                                                                mm(door->sill_m));
    return fmt::format("{},{:.2f}", door_text, sill == nullptr ? kNone : mm(sill->height_m));
}

constexpr const char* kHeader =
    "scene,seed,mode,way,frame,noise_px,bias_px,said_px,kind,steps,riser,going,width,sill,ahead,"
    "found,found_steps,found_riser,riser_sigma,found_going,going_sigma,found_width,"
    "cut,across,turn,flights,of_2,drop,drop_across,drop_height,drop_sigma,bottom_seen,drops,"
    "door,door_width,door_width_sigma,door_sill,sill_height,find_us\n";

/// Judges the frames of one run in order.
class Judge {
  public:
    explicit Judge(const stairs::StairsConfig& config) : finder_(config), tracker_(config) {}

    void observation(const Observation& observation) { (void)observe_once(observation); }

    /// Returns the two CSV lines of a frame.
    std::string rows(const Observation& observation) {
        const std::int64_t first_ns = observe_once(observation);
        std::int64_t took_ns = first_ns;
        for (int call = 1; call < kCalls; ++call) {  // the first call also allocates
            const std::int64_t start_ns = steady_now_ns();
            finder_.find(observation.terrain(), found_);
            took_ns = std::min(took_ns, steady_now_ns() - start_ns);
        }
        return row(observation, "single", found_, took_ns) +
               row(observation, "tracked", tracked_, took_ns);
    }

  private:
    std::int64_t observe_once(const Observation& observation) {
        constexpr std::int64_t kFrame_ns = 100'000'000;
        const stairs::Terrain terrain = observation.terrain();
        const std::int64_t start_ns = steady_now_ns();
        finder_.find(terrain, found_);
        const std::int64_t took_ns = steady_now_ns() - start_ns;
        tracker_.update(found_, terrain, {observation.frame * kFrame_ns, {}}, tracked_);
        return took_ns;
    }

    static std::string row(const Observation& observation,
                           const char* way,
                           const stairs::TerrainFeatures& features,
                           std::int64_t took_ns) {
        const TrueFeature& truth = observation.truth;
        return fmt::format(
            "{},{},{},{},{},{:.4f},{:.4f},{:.4f},{},{},{:.2f},{:.2f},{:.1f},{:.1f},{:.1f}{}{}{},{}"
            "\n",
            observation.scene,
            observation.seed,
            observation.mode,
            way,
            observation.frame,
            observation.noise_px,
            observation.bias_px,
            observation.said_px,
            experiments::kTrueKindNames[static_cast<int>(truth.kind)],
            truth.steps,
            mm(truth.riser_m),
            mm(truth.going_m),
            mm(truth.width_m),
            mm(truth.sill_m),
            mm(truth.ahead_m),
            flight_columns(features.flights, truth),
            drop_columns(features.drops, truth),
            door_columns(features, truth),
            took_ns / 1000);
    }

    stairs::FeatureFinder finder_;
    stairs::FeatureTracker tracker_;
    stairs::TerrainFeatures found_;
    stairs::TerrainFeatures tracked_;
};

struct Done {
    std::string rows;
    std::optional<Error> error;
};

/// Folder with saved frames. Its list file names one frame per line and is written last.
class Keep {
  public:
    Keep(std::string maps, const StairsCase& now)
        : folder_(std::move(maps) + "/" + now.mode), list_(folder_ + "/" + list_name(now)) {}

    [[nodiscard]] bool has_it() const { return std::filesystem::exists(list_); }
    [[nodiscard]] Result<std::vector<Observation>> read() const {
        std::vector<Observation> observations;
        std::ifstream list(list_);
        for (std::string name; std::getline(list, name);) {
            auto observation = experiments::read_observation(folder_ + "/" + name);
            if (!observation) return observation.error();
            observations.push_back(std::move(*observation));
        }
        return observations;
    }
    [[nodiscard]] Status write(const std::vector<Observation>& observations) const {
        std::string names;
        for (const Observation& observation : observations) {
            names += observation.folder_name() + "\n";
            const std::string folder = folder_ + "/" + observation.folder_name();
            if (Status saved = save_observation(observation, folder); !saved) return saved;
        }
        fmt::output_file(list_).print("{}", names);
        return {};
    }

  private:
    static std::string list_name(const StairsCase& now) {
        return fmt::format(
            "{}_{}_every{}.txt", experiments::short_name(now.scene), now.seed, now.every);
    }

    std::string folder_;
    std::string list_;
};

Result<std::vector<Observation>> observations_of(const StairsCase& now,
                                                 const std::string& maps,
                                                 const Settings& settings) {
    const Keep keep(maps, now);
    if (maps != "-" && keep.has_it()) return keep.read();
    Serial alone;
    auto observations = look_at(now, settings, alone);
    if (!observations || maps == "-") return observations;
    if (Status kept = keep.write(*observations); !kept) return kept.error();
    return observations;
}

Done judge(const StairsCase& now, const std::string& maps, const Settings& settings) {
    const auto observations = observations_of(now, maps, settings);
    if (!observations) return {{}, observations.error()};
    Judge judge(settings.pipeline.stairs);
    Done done;
    for (const Observation& observation : *observations) {
        if (now.every > 0 || &observation == &observations->back())
            done.rows += judge.rows(observation);
        else
            judge.observation(observation);
    }
    return done;
}

Done judge_saved(const std::string& folder, const Settings& settings) {
    const auto observation = experiments::read_observation(folder);
    if (!observation) return {{}, observation.error()};
    return {Judge(settings.pipeline.stairs).rows(*observation), {}};
}

std::vector<StairsCase> cases_of(const std::vector<std::string>& words) {
    const auto number = [&](std::size_t i, std::uint64_t otherwise) {
        return words.size() > i ? std::strtoull(words[i].c_str(), nullptr, 10) : otherwise;
    };
    const std::string modes = words.size() > 4 ? words[4] : "analytic_0.25";
    std::vector<StairsCase> cases;
    for (const std::string_view mode : io::split(modes, ",")) {
        for (const std::string_view scene : io::split(words[1], ",")) {
            for (std::uint64_t k = 0; k < number(3, 1); ++k) {
                cases.push_back({std::string(scene),
                                 number(2, 1) + k,
                                 std::string(mode),
                                 static_cast<int>(number(5, 0))});
            }
        }
    }
    return cases;
}

std::vector<std::string> saved_observations(const std::string& maps) {
    std::vector<std::string> folders;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(maps))
        if (entry.path().filename() == "truth.txt")
            folders.push_back(entry.path().parent_path().string());
    std::sort(folders.begin(), folders.end(), io::natural_less);
    return folders;
}

/// Runs the cases in parallel and writes their lines in order.
int write_all(int count, const std::string& path, const std::function<Done(int)>& make) {
    const auto executor = surefoot::make_executor();
    auto out = fmt::output_file(path);
    out.print("{}", kHeader);
    const int block = 2 * executor->threads();
    for (int first = 0; first < count; first += block) {
        std::vector<Done> done(static_cast<std::size_t>(std::min(block, count - first)));
        executor->parallel_for(static_cast<int>(done.size()),
                               [&](int i) { done[static_cast<std::size_t>(i)] = make(first + i); });
        for (const Done& one : done) {
            if (one.error) return report(*one.error);
            out.print("{}", one.rows);
        }
        out.flush();
    }
    return 0;
}

int measure_all(const std::vector<std::string>& words) {
    if (words.size() < 2) {
        return report(usage_error(
            "stairs_truth OUT.csv SCENES [FIRST_SEED [SEEDS [MODES [EVERY [MAPS [KEY=VALUE...]]]]]]"
            ", or stairs_truth OUT.csv MAPS [KEY=VALUE...]"));
    }
    const bool is_saved = std::filesystem::is_directory(words[1]);
    const std::size_t first_setting = std::min<std::size_t>(is_saved ? 2 : 7, words.size());
    SettingsRequest common;
    common.overrides = {"sim.known_motion=true",
                        "sim.analytic.drift.position_m_sqrt_m=0",
                        "sim.analytic.drift.turn_deg_sqrt_m=0"};
    common.overrides.insert(common.overrides.end(),
                            words.begin() + static_cast<std::ptrdiff_t>(first_setting),
                            words.end());
    const auto settings = surefoot::load_settings(common);
    if (!settings) return report(settings.error());
    if (is_saved) {
        const std::vector<std::string> folders = saved_observations(words[1]);
        return write_all(static_cast<int>(folders.size()), words[0], [&](int i) {
            return judge_saved(folders[static_cast<std::size_t>(i)], *settings);
        });
    }
    const std::string maps = words.size() > 6 ? words[6] : "-";
    const std::vector<StairsCase> cases = cases_of(words);
    return write_all(static_cast<int>(cases.size()), words[0], [&](int i) {
        return judge(cases[static_cast<std::size_t>(i)], maps, *settings);
    });
}

}  // namespace
}  // namespace surefoot::app

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::app::measure_all({argv + 1, argv + argc});
}

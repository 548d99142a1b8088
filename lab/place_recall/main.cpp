// SPDX-License-Identifier: Apache-2.0
// Are places recognised when the machine sees them again, and are there false recognitions?
// Usage: place_recall OUT.csv KINDS SCENES FIRST_SEED SEEDS [PROFILE]
//   place_recall out/places.csv same_run,second_run room,corridor 30001 5 zed_calibrated
//   place_recall out/alike.csv storey,bay lab/scenes/look_alike.yaml 30001 100
//   SCENES to PROFILE: see scene_cases.hpp; default profile: zed_calibrated
//
// KINDS, with commas between them:
//   same_run    forward, turn, back, turn and forward again, beside the first path
//   second_run  the place database is saved; another run starts elsewhere in the scene with its own
//               odom frame
//   storey      the second run is in another corridor of the same house: doors, pillars, type of
//               floor and light are equal, the patterns of floor and walls differ
//   bay         the second run is some bays further down the same corridor
//   house       one database of the corridors of all seeds, at most 500 keyframes; then a second
//               run in every fifth corridor
// Input: rendered images, our matcher, and the true path with the drift of our odometry and an odom
// frame tilted by 0.2 deg. The library's place tracker has its default settings.
//
// Writes OUT.csv, one line per keyframe of the only run (same_run) or of the second run (`revisit`:
// 1 = the keyframe shows a scene part seen before):
//   refusal, inliers, agreeing...  see surefoot/place_recognition/view_comparison.hpp
//   accepted                       the tracker accepted T_map_odom
//   error_m, error_deg             error of base_link in the map, if accepted
//   single_m                       error of the best keyframe's answer, accepted or not
//   query_ms                       CPU time of description and search
#include <fmt/format.h>
#include <fmt/os.h>

#include <cmath>
#include <ctime>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "lab/scenes/scene_cases.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/place_recognition/place_tracker.hpp"
#include "surefoot/sim/scenes/scene_file.hpp"
#include "surefoot/sim/sensors/camera_profile.hpp"
#include "surefoot/sim/sensors/modelled_odometry.hpp"
#include "surefoot/sim/sensors/rigs.hpp"
#include "surefoot/stereo/matcher.hpp"

namespace surefoot::app {
namespace {

constexpr double kLean_deg = 0.2;  ///< tilt of the odom frame
constexpr double kStep_m = 0.26;   ///< distance between two stops; each stop gives one keyframe
constexpr double kTurn_deg = 13.0;
constexpr double kBay_m = 1.5;
constexpr std::uint64_t kWayStream = 0x706c616365;
constexpr int kSecondRun = 10'000;  ///< first frame number of the second run, for different noise

/// Returns the CPU time of this thread. Other threads do not affect it.
double cpu_ms() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// A pose of base_link on the path.
struct Stop {
    double x_m = 0.0;
    double y_m = 0.0;
    double yaw_deg = 0.0;
    bool revisit = false;

    [[nodiscard]] Pose world_from_body() const {
        return {exp_so3({0.0, 0.0, yaw_deg * kRadPerDeg}), {x_m, y_m, sim::kBodyHeight_m}};
    }
};

/// Returns the distance that the machine can go ahead in a scene [m].
double reach_m(const std::string& scene) {
    if (scene == "walk_turn_round") return 2 * kStep_m;
    return 3 * kStep_m;
}

class Way {
  public:
    explicit Way(const Stop& start) : now_(start) { stops_.push_back(now_); }
    void forward(double way_m) {
        for (double at = kStep_m; at < way_m + 1e-6; at += kStep_m) {
            now_.x_m += kStep_m * std::cos(now_.yaw_deg * kRadPerDeg);
            now_.y_m += kStep_m * std::sin(now_.yaw_deg * kRadPerDeg);
            stops_.push_back(now_);
        }
    }
    void turn(double angle_deg) {
        const int steps = static_cast<int>(std::ceil(std::abs(angle_deg) / kTurn_deg));
        for (int i = 0; i < steps; ++i) {
            now_.yaw_deg += angle_deg / steps;
            stops_.push_back(now_);
        }
    }
    void revisits() { now_.revisit = true; }
    [[nodiscard]] const std::vector<Stop>& stops() const { return stops_; }

  private:
    Stop now_;
    std::vector<Stop> stops_;
};

/// Returns the path of the first run: forward, with views to both sides.
std::vector<Stop> first_way(const std::string& scene) {
    Way way({});
    way.forward(reach_m(scene));
    way.turn(26.0);
    way.turn(-52.0);
    return way.stops();
}

std::vector<Stop> second_way(const std::string& scene, double ahead_m, Rng& rng) {
    Way way(
        {ahead_m + rng.uniform(0.0, 0.3), rng.uniform(-0.2, 0.2), rng.uniform(-10.0, 10.0), true});
    way.forward(reach_m(scene) - kStep_m);
    way.turn(rng.uniform() < 0.5 ? 39.0 : -39.0);
    return way.stops();
}

std::vector<Stop> way_and_back(const std::string& scene, Rng& rng) {
    Way way({});
    way.forward(reach_m(scene));
    way.turn(180.0);
    way.forward(reach_m(scene));
    way.turn(180.0 - kTurn_deg + rng.uniform(-8.0, 8.0));
    way.revisits();
    way.turn(kTurn_deg);
    way.forward(reach_m(scene));
    return way.stops();
}

/// Makes the images of one machine in one scene.
class Cameras {
  public:
    static Result<Cameras> open(const std::string& scene,
                                int storey,
                                std::uint64_t seed,
                                const std::string& profile) {
        sim::SceneOptions options;
        if (auto status = experiments::SceneCase{scene, seed, profile}.put_into(options); !status)
            return status.error();
        auto scripted = read(scene, storey, seed);
        if (!scripted) return scripted.error();
        auto rig = sim::rig_preset("zed_vga");
        if (!rig) return rig.error();
        auto rectifier = camera::Rectifier::make(*rig);
        if (!rectifier) return rectifier.error();
        Cameras cameras;
        cameras.rig_ = rectifier->rig();
        cameras.scene_ = std::make_unique<sim::Scene>(std::move(scripted->scene));
        sim::apply_profile(options.profile, 1.0, options.camera);
        auto renderer = sim::Renderer::make(*cameras.scene_, *rig, options.camera, seed);
        if (!renderer) return renderer.error();
        cameras.renderer_.emplace(std::move(renderer).value());
        cameras.matcher_ = stereo::make_matcher({});
        return cameras;
    }

    void look(const Pose& T_world_body, int frame, Executor& executor) {
        renderer_->render(T_world_body, frame, executor, pair_);
        matcher_->match(pair_.left.view(), pair_.right.view(), executor, depth_);
    }
    [[nodiscard]] const camera::RectifiedRig& rig() const { return rig_; }
    [[nodiscard]] const GreyImage& left() const { return pair_.left; }
    [[nodiscard]] const DepthImage& depth() const { return depth_; }

  private:
    static Result<sim::ScriptedScene> read(const std::string& scene,
                                           int storey,
                                           std::uint64_t seed) {
        if (io::extension_of(scene) != ".yaml") return sim::make_scene(scene, seed);
        auto text = io::read_file(scene);
        if (!text) return text.error();
        const std::string ground = "storey: 0";
        const auto at = text->find(ground);
        if (at == std::string::npos) return input_error(scene + ": has no '" + ground + "'");
        text->replace(at, ground.size(), fmt::format("storey: {}", storey));
        return sim::read_scene({scene, *text}, "", seed);
    }

    std::unique_ptr<sim::Scene> scene_;
    camera::RectifiedRig rig_;
    std::optional<sim::Renderer> renderer_;
    std::unique_ptr<stereo::Matcher> matcher_;
    sim::RenderedPair pair_;
    DepthImage depth_;
};

struct Case {
    std::string kind;
    std::string scene;
    std::uint64_t seed = 1;
    std::string profile;
};

/// Moves a tracker along a path and prints the result of each keyframe.
class Run {
  public:
    Run(const Case& now, const Pose& T_world_map, place_recognition::Place saved, fmt::ostream& out)
        : now_(now),
          T_world_map_(T_world_map),
          tracker_({}, std::move(saved)),
          saved_(tracker_.place()),
          out_(out) {}

    void drive(Cameras& cameras,
               const std::vector<Stop>& stops,
               const Pose& T_world_odom,
               int first_frame,
               bool print,
               Executor& executor) {
        sim::ModelledOdometry odometry(
            {},
            cameras.rig().T_body_camera,
            mix_seed(now_.seed, static_cast<std::uint64_t>(first_frame)));
        const Pose T_odom_first = T_world_odom.inverse() * stops.front().world_from_body();
        for (std::size_t i = 0; i < stops.size(); ++i) {
            const Pose T_world_body = stops[i].world_from_body();
            const int frame = static_cast<int>(i);
            MotionEstimate motion =
                odometry.follow(1'000'000'000LL * (frame + 1), frame, T_world_body);
            motion.health = Health::ok;
            motion.T_odom_body = T_odom_first * motion.T_odom_body;
            cameras.look(T_world_body, first_frame + frame, executor);
            const double start_ms = cpu_ms();
            tracker_.follow(motion);
            const auto seen = tracker_.see(cameras.rig(), cameras.left().view(), cameras.depth());
            const double query_ms = cpu_ms() - start_ms;
            if (print && seen) line(*seen, stops[i], frame, motion.T_odom_body, query_ms);
        }
    }
    [[nodiscard]] place_recognition::Place place() const { return tracker_.place(); }

  private:
    void line(const place_recognition::Sighting& seen,
              const Stop& stop,
              int frame,
              const Pose& T_odom_body,
              double query_ms) const {
        const place_recognition::Comparison& c = seen.comparison;
        double error_m = std::nan("");
        double error_deg = std::nan("");
        if (seen.T_map_odom) {
            const Vector6 e =
                difference(stop.world_from_body(), T_world_map_ * *seen.T_map_odom * T_odom_body);
            error_m = e.head<3>().norm();
            error_deg = e.tail<3>().norm() / kRadPerDeg;
        }
        double single_m = std::nan("");
        if (seen.keyframe >= 0 && seen.saved && c.inliers > 0) {
            const Pose& T = saved_.keyframes[static_cast<std::size_t>(seen.keyframe)].T_map_body;
            single_m = difference(stop.world_from_body(), T_world_map_ * T * c.T_candidate_query)
                           .head<3>()
                           .norm();
        }
        out_.print("{},{},{},{},{},{},{},{},{},{},{},{},{:.2f},{},{},{:.4f},{:.3f},{:.4f},{:.2f}\n",
                   now_.kind,
                   now_.scene,
                   now_.seed,
                   now_.profile,
                   frame,
                   stop.revisit ? 1 : 0,
                   to_string(seen.refusal),
                   c.matches,
                   c.inliers,
                   c.asked,
                   c.agreeing,
                   c.parts,
                   c.tilt_deg,
                   c.parts_against,
                   seen.T_map_odom ? 1 : 0,
                   error_m,
                   error_deg,
                   single_m,
                   query_ms);
        out_.flush();
    }

    Case now_;
    Pose T_world_map_;  ///< pose of the odom frame of the first run
    place_recognition::PlaceTracker tracker_;
    place_recognition::Place saved_;
    fmt::ostream& out_;
};

Pose leaning(const Pose& T_world_odom, Rng& rng) {
    const double azimuth = rng.uniform(-std::numbers::pi, std::numbers::pi);
    const double lean = kLean_deg * kRadPerDeg;
    return T_world_odom * Pose{exp_so3({lean * std::cos(azimuth), lean * std::sin(azimuth), 0.0}),
                               {0.0, 0.0, 0.0}};
}

/// Makes a second run with its own odom frame in the saved place `saved`.
Status drive_second(const Case& now,
                    Cameras& cameras,
                    const Pose& T_world_map,
                    place_recognition::Place saved,
                    Rng& rng,
                    Executor& executor,
                    fmt::ostream& out) {
    // Begins a few bays farther, where the first run did not go.
    const double ahead_m = now.kind == "bay" ? kBay_m * static_cast<double>(2 + rng.below(3)) : 0.0;
    const auto again = second_way(now.scene, ahead_m, rng);
    Run second(now, T_world_map, std::move(saved), out);
    const Pose T_start = again.front().world_from_body();
    const Eigen::Vector3d ground_m(T_start.translation_m.x(), T_start.translation_m.y(), 0.0);
    second.drive(
        cameras, again, leaning({T_start.rotation, ground_m}, rng), kSecondRun, true, executor);
    return {};
}

Status measure(const Case& now, Executor& executor, fmt::ostream& out) {
    Rng rng(mix_seed(now.seed, kWayStream));
    auto cameras = Cameras::open(now.scene, 0, now.seed, now.profile);
    if (!cameras) return cameras.error();
    const bool alone = now.kind == "same_run";
    const Pose T_world_map = leaning({}, rng);
    Run first(now, T_world_map, {}, out);
    const auto stops = alone ? way_and_back(now.scene, rng) : first_way(now.scene);
    first.drive(*cameras, stops, T_world_map, 0, alone, executor);
    if (alone) return {};

    if (now.kind == "storey") {
        cameras = Cameras::open(now.scene, 1, now.seed, now.profile);
        if (!cameras) return cameras.error();
    }
    return drive_second(now, *cameras, T_world_map, first.place(), rng, executor, out);
}

/// Puts the corridors of all cases into one place database, 100 m apart in its map.
Status measure_house(const std::vector<Case>& cases, Executor& executor, fmt::ostream& out) {
    place_recognition::Place house;
    std::vector<Pose> T_world_map;
    for (const Case& now : cases) {
        auto cameras = Cameras::open(now.scene, 0, now.seed, now.profile);
        if (!cameras) return cameras.error();
        const Pose T_map_world{Eigen::Quaterniond::Identity(),
                               {100.0 * static_cast<double>(T_world_map.size()), 0.0, 0.0}};
        Run first(now, {}, {}, out);
        first.drive(*cameras, first_way(now.scene), {}, 0, false, executor);
        for (place_recognition::Keyframe& keyframe : first.place().keyframes) {
            if (house.keyframes.size() ==
                static_cast<std::size_t>(place_recognition::kMostKeyframes))
                break;
            keyframe.T_map_body = T_map_world * keyframe.T_map_body;
            house.keyframes.push_back(std::move(keyframe));
        }
        T_world_map.push_back(T_map_world.inverse());
    }
    for (std::size_t i = 0; i < cases.size(); i += 5) {
        Rng rng(mix_seed(cases[i].seed, kWayStream));
        auto cameras = Cameras::open(cases[i].scene, 0, cases[i].seed, cases[i].profile);
        if (!cameras) return cameras.error();
        auto done = drive_second(cases[i], *cameras, T_world_map[i], house, rng, executor, out);
        if (!done) return done;
    }
    return {};
}

int measure_all(const std::vector<std::string>& words) {
    if (words.size() < 5)
        return report(usage_error("place_recall OUT.csv KINDS SCENES FIRST_SEED SEEDS [PROFILE]"));
    const std::string profile = words.size() > 5 ? words[5] : "zed_calibrated";
    const auto executor = surefoot::make_executor();
    auto out = fmt::output_file(words[0]);
    out.print(
        "kind,scene,seed,profile,frame,revisit,refusal,matches,inliers,asked,agreeing,parts,tilt_"
        "deg,"
        "parts_against,accepted,error_m,error_deg,single_m,query_ms\n");
    for (const std::string_view kind : io::split(words[1], ",")) {
        std::vector<Case> cases;
        for (const auto& each : experiments::scene_cases({words[2], words[3], words[4], profile}))
            cases.push_back({std::string(kind), each.scene, each.seed, profile});
        if (kind == "house") {
            if (const auto done = measure_house(cases, *executor, out); !done)
                return report(done.error());
            continue;
        }
        for (const Case& now : cases)
            if (const auto done = measure(now, *executor, out); !done) return report(done.error());
    }
    return kExitOk;
}

}  // namespace
}  // namespace surefoot::app

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::app::measure_all({argv + 1, argv + argc});
}

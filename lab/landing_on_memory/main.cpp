// SPDX-License-Identifier: Apache-2.0
// How wrong is the map of remembered ground on which a foot will land, at the time of the step
// query?
// Usage: landing_on_memory OUT.csv [FIRST_SEED [SEEDS [NOISE [grid | mounts | conditions]]]]
//   FIRST_SEED: default 1. SEEDS: number of seeds, default 1. NOISE: factor on the image noise,
//   default 1.0.
//   grid (default): every camera mount, on carpet, sharp images of a global shutter. mounts: the
//   two recommended mounts. conditions: the usual mount with poor texture, motion blur, a rolling
//   shutter, and all three together.
//
// The machine walks over flat floor. The odometry gets rendered images and the map gets exact
// depth, so that only the estimated motion causes errors. At each step query, the map is read at
// every point under the feet of the requested step:
//   height error      height in the map, relative to the estimated pose and put into the world at
//                     the true pose, minus the true height
//   horizontal error  distance between the place where the foot will really land and the place that
//                     was really measured when the cell was last updated
//
// Writes OUT.csv, one line per point: pitch_deg,height_m,cameras,script,condition,seed,step,lost,
// known,age_s,height_error_m,horizontal_m. `lost` counts the frames so far without a known motion;
// as in the pipeline, the map ignores the depth of these frames.
#include <fmt/format.h>
#include <fmt/os.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "lab/scenes/exact_depth.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/elevation/elevation_map.hpp"
#include "surefoot/odometry/odometry.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/sim/rendering/renderer.hpp"
#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/sensors/camera_profile.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot {
namespace {

constexpr double kRate_hz = 8.0;
constexpr int kDepthEvery = 2;  ///< every second frame has depth
constexpr double kSecondPitch_deg = 65.0;
constexpr double kLongExposure_s = 0.016;  ///< longest exposure of the simulated control

/// Image defects that the odometry gets. The default is a global shutter and the full contrast of
/// the carpet.
struct Condition {
    std::string name = "plain";
    double contrast = 1.0;  ///< factor on the contrast of all textures
    int blur_samples = 0;   ///< number of instants within an exposure of 16 ms; 0 = sharp
    bool rolling = false;
};

struct Setup {
    double pitch_deg = 32.0;
    double height_m = 1.0;  ///< camera height above the soles
    std::string script;
    sim::MotionScript motion;
    std::uint64_t seed = 1;
    double noise = 1.0;
    Condition condition;
};

camera::StereoRig mounted(double pitch_deg, double camera_z_body_m, bool rolling = false) {
    camera::StereoRig rig = *sim::rig_preset(rolling ? "zed_vga_rolling" : "zed_vga");
    rig.T_body_left = sim::looking_down({0.075, 0.25, camera_z_body_m}, pitch_deg * M_PI / 180.0);
    return rig;
}

/// A map and its inputs: exact depth from one or two cameras.
struct Memory {
    int cameras = 1;
    elevation::ElevationMap map{elevation::ElevationConfig{}};
    std::vector<camera::RectifiedRig> rigs;
};

/// State of the run at the time of a step query.
struct Decision {
    int step = 0;
    std::int64_t time_ns = 0;
    int lost_frames = 0;  ///< number of LOST frames from the start to this time
};

struct Poses {
    Pose T_odom_body;   ///< estimated
    Pose T_world_body;  ///< true
};

/// Returns points 25 mm apart under both feet after a step, in the body frame before the step.
std::vector<Eigen::Vector2d> landing_points(const Machine& machine, const sim::StepEvent& step) {
    const Pose T_before_after = step.T_world_before.inverse() * step.T_world_after;
    std::vector<Eigen::Vector2d> points;
    for (const GroundBox* foot : {&machine.left_foot, &machine.right_foot}) {
        constexpr double kStep_m = 0.025;
        const double length_m = 1e-4 * foot->length_tenth_mm;
        const double width_m = 1e-4 * foot->width_tenth_mm;
        for (double x = -0.5 * length_m; x <= 0.5 * length_m; x += kStep_m) {
            for (double y = -0.5 * width_m; y <= 0.5 * width_m; y += kStep_m) {
                const Eigen::Vector3d after(
                    1e-4 * foot->center_x_tenth_mm + x, 1e-4 * foot->center_y_tenth_mm + y, 0.0);
                points.emplace_back((T_before_after * after).head<2>());
            }
        }
    }
    return points;
}

void look_up(const Setup& setup,
             const Memory& memory,
             const std::map<std::int64_t, Poses>& poses,
             const std::vector<Eigen::Vector2d>& points_body_m,
             const Decision& decision,
             fmt::ostream& out) {
    const Poses& now = poses.at(decision.time_ns);
    const auto& layers = memory.map.layers();
    for (const Eigen::Vector2d& point : points_body_m) {
        // The gate reads the map at the estimated pose and assumes that the body is level.
        const Eigen::Vector3d ahead = now.T_odom_body.rotation * Eigen::Vector3d::UnitX();
        const Eigen::Rotation2Dd turn(std::atan2(ahead.y(), ahead.x()));
        const Eigen::Vector2d at = now.T_odom_body.translation_m.head<2>() + turn * point;
        const auto cell = memory.map.geometry().cell_at(at.x(), at.y());
        const float height_m = cell ? layers.height_m.at(cell->ix, cell->iy) : NAN;
        const bool known = !std::isnan(height_m);
        double age_s = std::nan("");
        double height_error_m = std::nan("");
        double horizontal_m = std::nan("");
        if (known) {
            const Eigen::Vector3d stored(at.x(), at.y(), static_cast<double>(height_m));
            const Eigen::Vector3d met = now.T_world_body * (now.T_odom_body.inverse() * stored);
            height_error_m = met.z();  // the true floor is at height 0
            const std::int64_t seen_ns = layers.seen_ns.at(cell->ix, cell->iy);
            const Poses& then = poses.at(seen_ns);
            const Eigen::Vector3d seen = then.T_world_body * (then.T_odom_body.inverse() * stored);
            horizontal_m = (met - seen).head<2>().norm();
            age_s = seconds_from_ns(decision.time_ns - seen_ns);
        }
        out.print("{},{},{},{},{},{},{},{},{},{:.2f},{:.6f},{:.6f}\n",
                  setup.pitch_deg,
                  setup.height_m,
                  memory.cameras,
                  setup.script,
                  setup.condition.name,
                  setup.seed,
                  decision.step,
                  decision.lost_frames,
                  known ? 1 : 0,
                  age_s,
                  height_error_m,
                  horizontal_m);
    }
}

Status walk(const Setup& setup, const Machine& machine, Executor& executor, fmt::ostream& out) {
    const auto place = sim::make_scene("floor", setup.seed);
    if (!place) return place.error();
    sim::Scene scene = place->scene;
    scene.scale_contrast(sim::figures_of(sim::CameraProfile::zed).contrast *
                         setup.condition.contrast);
    const auto script = sim::make_motion(setup.motion, setup.seed);
    if (!script) return script.error();
    const double base_z_m = script->motion->at(0.0).T_world_body.translation_m.z();
    const camera::StereoRig rig =
        mounted(setup.pitch_deg, setup.height_m - base_z_m, setup.condition.rolling);
    const auto rectifier = camera::Rectifier::make(rig);
    const auto second =
        camera::Rectifier::make(mounted(kSecondPitch_deg, setup.height_m - base_z_m));
    sim::CameraConfig camera;
    sim::apply_profile(sim::CameraProfile::zed, setup.noise, camera);
    camera.shutter.blur_samples = setup.condition.blur_samples;
    if (setup.condition.blur_samples > 0) camera.exposure.exposure_s = kLongExposure_s;
    const sim::ProfileFigures zed = sim::figures_of(sim::CameraProfile::zed);
    const auto renderer =
        sim::Renderer::make(scene, sim::with_error(rig, zed.calibration), camera, setup.seed);
    if (!renderer) return renderer.error();

    odometry::Odometry odometry({}, *rectifier);
    odometry.start_at(script->motion->at(0.0).T_world_body);
    std::vector<Memory> memories(2);
    memories[0].rigs = {rectifier->rig()};
    memories[1].rigs = {rectifier->rig(), second->rig()};
    memories[1].cameras = 2;
    std::map<std::int64_t, Poses> poses;
    sim::CleanPair clean;
    sim::RenderedPair images;
    std::size_t next_step = 0;
    int lost_frames = 0;
    const int frames = static_cast<int>(script->motion->duration_s() * kRate_hz) + 1;
    for (int i = 0; i < frames && next_step < script->steps.size(); ++i) {
        const double time_s = i / kRate_hz;
        const std::int64_t time_ns = ns_from_seconds(1.0 + time_s);
        renderer->collect(*script->motion, time_s, camera.exposure.exposure_s, executor, clean);
        renderer->expose(clean, {camera.exposure.exposure_s, 1.0, 1.0}, i, executor, images);
        StereoFrame frame;
        frame.time_ns = time_ns;
        frame.index = i;
        frame.left = images.left;
        frame.right = images.right;
        const MotionEstimate estimate = odometry.update(frame, executor);
        const Pose T_world_body = script->motion->at(time_s).T_world_body;
        poses[time_ns] = {estimate.T_odom_body, T_world_body};
        const bool lost = i > 0 && estimate.health == Health::lost;
        lost_frames += lost ? 1 : 0;
        const bool with_depth = i % kDepthEvery == 0 && !lost;
        std::vector<DepthImage> depths;
        for (const camera::RectifiedRig& both_cameras : memories[1].rigs) {
            if (with_depth)
                depths.push_back(
                    experiments::exact_depth(scene, both_cameras, T_world_body, executor));
        }
        for (Memory& memory : memories) {
            memory.map.follow(estimate.T_odom_body, estimate.relative_covariance);
            for (std::size_t k = 0; k < memory.rigs.size() && with_depth; ++k)
                memory.map.add(memory.rigs[k], estimate.T_odom_body, depths[k], time_ns);
        }
        const sim::StepEvent& step = script->steps[next_step];
        if (time_s + 1.0 / kRate_hz <= step.start_s) continue;
        for (const Memory& memory : memories) {
            look_up(setup,
                    memory,
                    poses,
                    landing_points(machine, step),
                    {static_cast<int>(next_step), time_ns, lost_frames},
                    out);
        }
        ++next_step;
    }
    return {};
}

sim::MotionScript straight_walk() {
    sim::MotionScript straight;
    straight.motion_model = sim::MotionModel::rex;
    straight.waypoints = {{0.0, 0.0, 0.0, 1.0}, {2.4, 0.0, 0.0, 0.5}};
    return straight;
}

std::vector<Setup> grid(std::uint64_t seed, double noise) {
    const sim::MotionScript straight = straight_walk();
    sim::MotionScript turning;
    turning.motion_model = sim::MotionModel::rex;
    turning.waypoints = {{0.0, 0.0, 0.0, 1.0}, {0.8, 0.0, 0.0, 0.5}, {0.8, 0.8, M_PI / 2.0, 0.5}};
    std::vector<Setup> all;
    for (const double pitch_deg : {28.0, 32.0, 36.0, 42.0, 50.0})
        for (const double height_m : {0.95, 1.05})
            all.push_back({pitch_deg, height_m, "straight", straight, seed, noise, {}});
    for (const double pitch_deg : {32.0, 42.0})
        all.push_back({pitch_deg, 1.0, "turning", turning, seed, noise, {}});
    return all;
}

constexpr double kUsualPitch_deg = 32.0;
constexpr double kUsualHeight_m = 1.05;

std::vector<Setup> mounts(std::uint64_t seed, double noise) {
    std::vector<Setup> all;
    for (const double pitch_deg : {kUsualPitch_deg, 42.0}) {
        all.push_back(
            {pitch_deg, kUsualHeight_m, "straight", straight_walk(), seed, noise, Condition{}});
    }
    return all;
}

std::vector<Setup> conditions(std::uint64_t seed, double noise) {
    constexpr double kPoor = 0.3;  // factor on the contrast of a poor texture
    constexpr int kInstants = 3;   // enough: the machine vibrates by about a pixel per exposure
    std::vector<Setup> all;
    const auto add = [&](const Condition& condition) {
        all.push_back(
            {kUsualPitch_deg, kUsualHeight_m, "straight", straight_walk(), seed, noise, condition});
    };
    add({"poor texture", kPoor, 0, false});
    add({"motion blur", 1.0, kInstants, false});
    add({"rolling shutter", 1.0, 0, true});
    add({"all three", kPoor, kInstants, true});
    return all;
}

using Set = std::vector<Setup> (*)(std::uint64_t seed, double noise);

/// Returns the function that makes the setups of this name; nullptr for an unknown name.
Set set_of(const std::string& name) {
    if (name == "grid") return grid;
    if (name == "mounts") return mounts;
    return name == "conditions" ? conditions : nullptr;
}

}  // namespace
}  // namespace surefoot

// An uncaught exception ends the experiment and prints its message. This is intended.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    using namespace surefoot;
    if (argc < 2) {
        fmt::print(stderr,
                   "usage: landing_on_memory OUT.csv "
                   "[FIRST_SEED [SEEDS [NOISE [grid | mounts | conditions]]]]\n");
        return 2;
    }
    const int first_seed = argc > 2 ? std::atoi(argv[2]) : 1;
    const int seeds = argc > 3 ? std::atoi(argv[3]) : 1;
    const double noise = argc > 4 ? std::atof(argv[4]) : 1.0;
    const Set set = set_of(argc > 5 ? argv[5] : "grid");
    if (!set) {
        fmt::print(stderr,
                   "landing_on_memory: unknown set of walks '{}'; use grid, mounts or conditions\n",
                   argv[5]);
        return 2;
    }
    const auto machine = app::load_machine("rex");
    if (!machine) return app::report(machine.error());
    const auto executor = surefoot::make_executor();
    auto out = fmt::output_file(argv[1]);
    out.print(
        "pitch_deg,height_m,cameras,script,condition,seed,step,lost,known,age_s,"
        "height_error_m,horizontal_m\n");
    for (int seed = first_seed; seed < first_seed + seeds; ++seed) {
        for (const Setup& setup : set(static_cast<std::uint64_t>(seed), noise)) {
            const Status walked = walk(setup, machine->value().machine, *executor, out);
            if (!walked) return app::report(walked.error());
            out.flush();
            fmt::print(stderr,
                       "seed {}: {} deg, {} m, {}, {} done\n",
                       seed,
                       setup.pitch_deg,
                       setup.height_m,
                       setup.script,
                       setup.condition.name);
        }
    }
    return 0;
}

// SPDX-License-Identifier: Apache-2.0
#include "lab/stairs_scenes/stairs_scene.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include "lab/scenes/scene_cases.hpp"
#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/geometry/statistics.hpp"
#include "surefoot/io/text.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/sim/rendering/renderer.hpp"
#include "surefoot/sim/scene_source.hpp"
#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot::experiments {
namespace {

constexpr std::uint64_t kRigStream = 101;
constexpr std::uint64_t kOdomStream = 102;
/// Distance from base_link to a door in the path at the judged frame [m].
constexpr double kBeforeDoor_m = 0.9;

/// Noise modes, and the factors on the noise of the `zed` profile. With the factor, our matcher has
/// an error of 0.25 or 0.5 px on level floor.
constexpr std::pair<std::string_view, double> kImageNoise[] = {{"images_0.25", 0.9},
                                                               {"images_0.5", 2.1}};

std::optional<std::string> word(const sim::ScriptedScene& script, std::string_view name) {
    for (const sim::SceneParameter& parameter : script.parameters)
        if (parameter.name == name) return parameter.value;
    return std::nullopt;
}

double number(const sim::ScriptedScene& script, std::string_view name, double otherwise = 0.0) {
    return word(script, name) ? sim::drawn_number(script, name) : otherwise;
}

TrueKind kind_of(const sim::ScriptedScene& script) {
    if (const auto kind = word(script, "kind")) {
        for (int i = 0; i < static_cast<int>(std::size(kTrueKindNames)); ++i)
            if (*kind == kTrueKindNames[i]) return static_cast<TrueKind>(i);
        return TrueKind::none;
    }
    const std::string& name = script.info.name;
    const auto begins = [&](std::string_view with) { return name.starts_with(with); };
    if (begins("stairs_down") || name == "flight_20_down") return TrueKind::down;
    if (begins("stairs_") || name == "flight_20_up" || name == "demo_stairs") return TrueKind::up;
    if (begins("kerb_down")) return TrueKind::kerb;
    if (begins("door_") || begins("sill_")) return TrueKind::door;
    return TrueKind::none;
}

/// Returns the true feature in the world frame. Scenes of lab/scenes turn about (pivot_x_m,
/// pivot_y_m); scenes of the simulator turn about (distance_m, 0).
TrueFeature truth_in_world(const sim::ScriptedScene& script) {
    TrueFeature truth;
    truth.kind = kind_of(script);
    if (truth.kind == TrueKind::none) return truth;
    truth.steps = static_cast<int>(number(script, "steps", truth.kind == TrueKind::kerb ? 1 : 10));
    truth.riser_m = number(script, "rise_m", number(script, "kerb_m"));
    truth.going_m = number(script, "going_m");
    truth.width_m = number(script, "width_m", 1.2);
    truth.sill_m = number(script, "sill_m");
    truth.yaw_rad = kRadPerDeg * number(script, "angle_deg");
    Eigen::Vector2d pivot_m(number(script, "pivot_x_m", number(script, "distance_m")),
                            number(script, "pivot_y_m"));
    Eigen::Vector2d from_pivot_m(number(script, "ahead_m"), number(script, "lateral_m"));
    if (script.info.name == "demo_stairs") {
        truth.steps = 3;
        truth.riser_m = sim::demo_stairs::kRise_m;
        truth.going_m = sim::demo_stairs::kGoing_m;
        pivot_m = {number(script, "stair_x_m"), 0.0};
    } else if (script.info.name.starts_with("sill_")) {
        from_pivot_m = {0.5 * number(script, "thickness_m"), 0.3 * number(script, "lateral_m")};
    }
    truth.middle_m = pivot_m + Eigen::Rotation2Dd(truth.yaw_rad) * from_pivot_m;
    return truth;
}

TrueFeature moved(TrueFeature truth, const Pose& T_odom_world) {
    const Eigen::Vector3d middle_m(truth.middle_m.x(), truth.middle_m.y(), 0.0);
    truth.middle_m = (T_odom_world * middle_m).head<2>();
    truth.yaw_rad += yaw_rad(T_odom_world);
    return truth;
}

camera::StereoRig drawn_rig(camera::StereoRig rig, std::uint64_t seed) {
    Rng rng(mix_seed(seed, kRigStream));
    const double height_m = rng.uniform(0.95, 1.05);
    const double pitch_rad = kRadPerDeg * rng.uniform(28.0, 36.0);
    Eigen::Vector3d at_body_m = rig.body_from_left().translation_m;
    at_body_m.z() = height_m - sim::kBodyHeight_m;
    rig.T_body_left = sim::looking_down(at_body_m, pitch_rad);
    return rig;
}

Pose drawn_odom(std::uint64_t seed) {
    Rng rng(mix_seed(seed, kOdomStream));
    Pose T_odom_world;
    const double yaw = rng.uniform(-std::numbers::pi, std::numbers::pi);
    T_odom_world.rotation = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
    T_odom_world.translation_m = {rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), 0.0};
    return T_odom_world;
}

/// Returns 1 for pixels that show floor at world height 0, within the range of the map.
Image<std::uint8_t> floor_pixels(const Image<float>& disparity_px,
                                 const camera::RectifiedRig& rig,
                                 const Pose& T_world_body,
                                 double max_depth_m) {
    constexpr double kLevel_m = 1e-3;
    const Pose T_world_camera = T_world_body * rig.T_body_camera;
    Image<std::uint8_t> floor(disparity_px.width(), disparity_px.height(), 0);
    for (int v = 0; v < floor.height(); ++v) {
        for (int u = 0; u < floor.width(); ++u) {
            const auto d = static_cast<double>(disparity_px.at(u, v));
            if (!(d > 0.0)) continue;
            const Eigen::Vector3d p_m = rig.point(u, v, d);
            if (p_m.z() < max_depth_m && std::abs((T_world_camera * p_m).z()) < kLevel_m)
                floor.at(u, v) = 1;
        }
    }
    return floor;
}

double median(std::vector<double> values) {
    if (values.empty()) return std::nan("");
    return upper_median_in_place(values);
}

bool all_floor_around(const Image<std::uint8_t>& floor, int u, int v) {
    constexpr int kHalf_px = 8;
    if (u < kHalf_px || v < kHalf_px || u + kHalf_px >= floor.width() ||
        v + kHalf_px >= floor.height()) {
        return false;
    }
    for (int dv = -kHalf_px; dv <= kHalf_px; dv += 4)
        for (int du = -kHalf_px; du <= kHalf_px; du += 4)
            if (floor.at(u + du, v + dv) == 0) return false;
    return true;
}

void measure_noise(const sim::Scene& scene,
                   const pipeline::Pipeline& pipeline,
                   const Pose& T_world_body,
                   Executor& executor,
                   Observation& observation) {
    constexpr double kMaxDepth_m = 2.5;
    const DepthImage& depth = pipeline.depth();
    const Image<float> exact_px =
        sim::rectified_disparity_px(scene, pipeline.rig(), T_world_body, executor);
    const auto floor = floor_pixels(exact_px, pipeline.rig(), T_world_body, kMaxDepth_m);
    const auto most =
        static_cast<float>(pipeline.config().elevation.pixels.max_outlier_probability);
    std::vector<double> errors_px;
    std::vector<double> said_px;
    for (int v = 0; v < floor.height(); ++v) {
        for (int u = 0; u < floor.width(); ++u) {
            if (!all_floor_around(floor, u, v) || !(depth.disparity_px.at(u, v) > 0.0F) ||
                depth.outlier_probability.at(u, v) > most) {
                continue;
            }
            errors_px.push_back(
                static_cast<double>(depth.disparity_px.at(u, v) - exact_px.at(u, v)));
            said_px.push_back(static_cast<double>(depth.sigma_px.at(u, v)));
        }
    }
    observation.bias_px = median(errors_px);
    observation.said_px = median(std::move(said_px));
    for (double& error_px : errors_px) error_px = std::abs(error_px - observation.bias_px);
    observation.noise_px = 1.4826 * median(std::move(errors_px));
}

/// Runs the pipeline on one scene.
class Run {
  public:
    Run(const StairsCase& now, const sim::ScriptedScene& script, Executor& executor)
        : now_(now),
          executor_(executor),
          world_(truth_in_world(script)),
          T_odom_world_(drawn_odom(now.seed)) {}

    Result<std::vector<Observation>> go(const Settings& settings,
                                        const sim::SceneOptions& options) {
        auto source = sim::open_scene(options, &executor_);
        if (!source) return source.error();
        auto pipeline = pipeline::Pipeline::make(settings.pipeline, (*source)->rig(), executor_);
        if (!pipeline) return pipeline.error();
        const sim::SceneTruth& truth = (*source)->truth();
        std::vector<StereoFrame> first;
        int processed = 0;
        const auto process = [&](const StereoFrame& frame) {
            pipeline->process(frame, Work::full);
            const Pose T_world_body = true_pose(truth.trajectory, frame.time_ns);
            ++processed;
            if (is_observation(
                    processed, static_cast<int>(truth.trajectory.size()), T_world_body)) {
                add_observation(processed, *pipeline, T_world_body);
                if (now_.every > 0 || done_)
                    measure_noise(
                        truth.scene, *pipeline, T_world_body, executor_, observations_.back());
            }
        };
        const auto start = [&] {
            pipeline->align(first, T_odom_world_ * truth.trajectory.front().T_world_body);
            std::for_each(first.begin(), first.end(), process);
            first.clear();
        };
        while (!done_) {
            auto frame = (*source)->next();
            if (!frame) return frame.error();
            if (!*frame) break;
            if (processed > 0) {
                process(**frame);
            } else {
                first.push_back(std::move(**frame));
                if (first.size() == pipeline::Pipeline::kAlignmentFrames) start();
            }
        }
        if (processed == 0) start();
        return std::move(observations_);
    }

  private:
    [[nodiscard]] bool is_observation(int processed, int frames, const Pose& T_world_body) {
        if (now_.every > 0) return processed % now_.every == 0;
        const Eigen::Vector2d to_go_m = world_.middle_m - T_world_body.translation_m.head<2>();
        const Eigen::Vector2d ahead(std::cos(world_.yaw_rad), std::sin(world_.yaw_rad));
        if (world_.kind == TrueKind::door && to_go_m.dot(ahead) < kBeforeDoor_m) done_ = true;
        if (processed == frames) done_ = true;
        return true;
    }

    void add_observation(int processed,
                         const pipeline::Pipeline& pipeline,
                         const Pose& T_world_body) {
        Observation observation;
        observation.scene = now_.scene;
        observation.seed = now_.seed;
        observation.mode = now_.mode;
        observation.frame = processed;
        observation.truth = moved(world_, T_odom_world_);
        const Pose T_world_camera = T_world_body * pipeline.rig().T_body_camera;
        const Eigen::Vector2d to_go_m = world_.middle_m - T_world_camera.translation_m.head<2>();
        observation.truth.ahead_m =
            to_go_m.dot(Eigen::Vector2d(std::cos(world_.yaw_rad), std::sin(world_.yaw_rad)));
        const elevation::ElevationLayers& layers = pipeline.map().layers();
        observation.geometry = pipeline.map().geometry();
        observation.height_m = layers.height_m.copy();
        observation.height_var_m2 = layers.height_var_m2.copy();
        observation.free_above_m = layers.free_above_m.copy();
        observation.clearance_m = layers.clearance_m.copy();
        observation.density_ratio = layers.density_ratio.copy();
        observation.observations = layers.count.copy();
        observation.stance_m = pipeline.T_odom_body().translation_m.head<2>();
        observation.view = pipeline.view();
        observation.disparity_px = pipeline.depth().disparity_px;
        observation.disparity_sigma_px = pipeline.depth().sigma_px;
        observations_.push_back(std::move(observation));
    }

    StairsCase now_;
    Executor& executor_;
    TrueFeature world_;
    Pose T_odom_world_;
    bool done_ = false;
    std::vector<Observation> observations_;
};

}  // namespace

Status StairsCase::put_into(sim::SceneOptions& options) const {
    options.scene = scene;
    options.seed = seed;
    constexpr std::string_view kAnalytic = "analytic_";
    constexpr std::string_view kImages = "images_x";
    if (mode.starts_with(kAnalytic)) {
        const auto sigma_px = io::parse_double(std::string_view(mode).substr(kAnalytic.size()));
        if (!sigma_px) return usage_error("there is no mode " + mode);
        options.sensor = sim::Sensor::analytic;
        options.analytic.sigma_px = *sigma_px;
        return {};
    }
    options.profile = sim::CameraProfile::zed;
    for (const auto& [name, factor] : kImageNoise) {
        if (mode != name) continue;
        options.noise = factor;
        return {};
    }
    const auto factor = mode.starts_with(kImages)
                            ? io::parse_double(std::string_view(mode).substr(kImages.size()))
                            : std::nullopt;
    if (!factor) return usage_error("there is no mode " + mode);
    options.noise = *factor;
    return {};
}

Result<std::vector<Observation>> look_at(const StairsCase& now,
                                         Settings settings,
                                         Executor& executor) {
    sim::SceneOptions& options = settings.sim;
    if (Status put = now.put_into(options); !put) return put.error();
    const auto script = sim::make_scene(options.scene, options.seed);
    if (!script) return script.error();
    const auto rig = sim::rig_preset(options.rig_preset);
    if (!rig) return rig.error();
    options.rig = drawn_rig(*rig, options.seed);
    return Run(now, *script, executor).go(settings, options);
}

}  // namespace surefoot::experiments

// SPDX-License-Identifier: Apache-2.0
// How accurate is the odometry, and is its stated covariance correct?
// Usage: odometry_truth OUT.csv SCENES [FIRST_SEED [SEEDS [PROFILES [FRAMES [KEY=VALUE...]]]]]
//   odometry_truth out/odometry.csv floor,walk_floor 20001 30 ideal,zed 100
//   odometry.imu.enabled=false     (same command)
//   SCENES to PROFILES: see scene_cases.hpp. A scene with a slash in its name is a recording with
//   the true poses of its left camera in groundtruth.tum; the seed is appended to its name. FRAMES:
//   0 (default) = to the end of the path. KEY=VALUE: a setting of surefoot.
//
// Only images and odometry run, no map. Consecutive motions of one second are compared with the
// true ones. While the machine stands (less than 5 mm and 0.5 deg in that second) the odometry
// holds its pose and states a covariance near zero; these motions are counted separately.
//
// Writes OUT.csv, one line per scene, seed and profile:
//   path_m, end_mm, end_deg   length of the true path; error at its end relative to the first pose
//   moving, nees              number of motions, and the mean of error^T covariance^-1 error: 6 is
//                             expected for a correct covariance
//   rpe_mm, rpe_deg           rms error of these motions
//   standing, held_mm         number of motions of a standing machine; largest error of these
//   jump_mm                   largest error of the motion from one frame to the next
//   ok, degraded, lost        number of frames
#include <fmt/format.h>
#include <fmt/os.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "lab/scenes/scene_cases.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "surefoot/core/angles.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/io/recordings/trajectory_file.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/pipeline/start.hpp"
#include "surefoot/sim/scene_source.hpp"

namespace surefoot::app {
namespace {

constexpr double kWindow_s = 1.0;
constexpr double kStill_m = 0.005;
constexpr double kStill_rad = 0.5 * std::numbers::pi / 180.0;
constexpr std::int64_t kRounding_ns = 1'000'000;

using experiments::SceneCase;

/// Sums up the results of one run.
class Tally {
  public:
    void add(const MotionEstimate& motion, const Pose& T_world_body) {
        ++health_[static_cast<std::size_t>(motion.health)];
        if (frames_++ == 0) {
            first_true_ = last_true_ = window_true_ = T_world_body;
            first_ = last_ = motion;
            window_start_ns_ = motion.time_ns;
            return;
        }
        const Pose T_step_true = last_true_.inverse() * T_world_body;
        path_m_ += T_step_true.translation_m.norm();
        const Vector6 step = difference(T_step_true, motion.T_previous_body);
        jump_m_ = std::max(jump_m_, step.head<3>().norm());
        window_covariance_ = compose_covariance(
            window_covariance_, motion.T_previous_body, motion.relative_covariance);
        T_window_ = T_window_ * motion.T_previous_body;
        last_true_ = T_world_body;
        last_ = motion;
        if (seconds_from_ns(motion.time_ns - window_start_ns_) >= kWindow_s - 1e-3) close_window();
    }

    void print(fmt::ostream& out) const {
        const Pose T_true = first_true_.inverse() * last_true_;
        const Pose T_found = first_.T_odom_body.inverse() * last_.T_odom_body;
        const Vector6 end = difference(T_true, T_found);
        const auto rms = [&](double sum) { return std::sqrt(sum / std::max(moving_, 1)); };
        out.print("{:.3f},{:.2f},{:.3f},{},{:.2f},{:.2f},{:.4f},{},{:.3f},{:.2f},{},{},{}",
                  path_m_,
                  1e3 * end.head<3>().norm(),
                  kDegPerRad * end.tail<3>().norm(),
                  moving_,
                  nees_ / std::max(moving_, 1),
                  1e3 * rms(error_m2_),
                  kDegPerRad * rms(error_rad2_),
                  standing_,
                  1e3 * held_m_,
                  1e3 * jump_m_,
                  health_[static_cast<std::size_t>(Health::ok)],
                  health_[static_cast<std::size_t>(Health::degraded)],
                  health_[static_cast<std::size_t>(Health::lost)]);
    }

  private:
    void close_window() {
        const Pose T_true = window_true_.inverse() * last_true_;
        const Vector6 error = difference(T_true, T_window_);
        const Vector6 motion = difference(Pose{}, T_true);
        if (motion.head<3>().norm() < kStill_m && motion.tail<3>().norm() < kStill_rad) {
            ++standing_;
            held_m_ = std::max(held_m_, error.head<3>().norm());
        } else {
            ++moving_;
            nees_ += error.dot(window_covariance_.ldlt().solve(error));
            error_m2_ += error.head<3>().squaredNorm();
            error_rad2_ += error.tail<3>().squaredNorm();
        }
        window_true_ = last_true_;
        T_window_ = Pose{};
        window_covariance_.setZero();
        window_start_ns_ = last_.time_ns;
    }

    int frames_ = 0;
    Pose first_true_;
    Pose last_true_;
    Pose window_true_;
    MotionEstimate first_;
    MotionEstimate last_;
    Pose T_window_;
    Matrix6 window_covariance_ = Matrix6::Zero();
    std::int64_t window_start_ns_ = 0;
    double path_m_ = 0.0;
    double jump_m_ = 0.0;
    double held_m_ = 0.0;
    int moving_ = 0;
    int standing_ = 0;
    double nees_ = 0.0;
    double error_m2_ = 0.0;
    double error_rad2_ = 0.0;
    std::array<int, 3> health_{};
};

struct Recording {
    std::unique_ptr<camera::FrameSource> source;
    Trajectory bodies;  ///< true poses of base_link
};

Result<Recording> open_scene(sim::SceneOptions sim, const SceneCase& now, Executor& executor) {
    if (Status seen = now.put_into(sim); !seen) return seen.error();
    auto source = sim::open_scene(sim, &executor);
    if (!source) return source.error();
    const Trajectory bodies = (*source)->truth().trajectory;
    return Recording{std::move(*source), bodies};
}

Result<Recording> open_recording(const std::string& folder, int frames, Executor& executor) {
    auto source = open_source({.source = folder, .rig_file = {}, .max_frames = frames}, executor);
    if (!source) return source.error();
    auto truth = io::read_trajectory(folder + "/groundtruth.tum");
    if (!truth) return truth.error();
    Trajectory bodies = std::move(truth->poses);
    const Pose T_left_body = (*source)->rig().body_from_left().inverse();
    for (StampedPose& pose : bodies) pose.T_world_body = pose.T_world_body * T_left_body;
    return Recording{std::move(*source), std::move(bodies)};
}

Status measure(const SceneCase& now,
               int frames,
               const SettingsRequest& common,
               Executor& executor,
               fmt::ostream& out) {
    auto settings = surefoot::load_settings(common);
    if (!settings) return settings.error();
    settings->sim.frames = frames;
    const bool recorded = now.scene.find('/') != std::string::npos;
    auto recording =
        recorded ? open_recording(fmt::format("{}{}", now.scene, now.seed), frames, executor)
                 : open_scene(settings->sim, now, executor);
    if (!recording) return recording.error();
    auto pipeline =
        pipeline::Pipeline::make(settings->pipeline, recording->source->rig(), executor);
    if (!pipeline) return pipeline.error();

    Tally tally;
    const auto follow = [&](const StereoFrame& frame) {
        const FrameReport report = pipeline->process(frame, Work::odometry);
        // Trajectory files contain rounded stamps.
        tally.add(report.motion,
                  experiments::true_pose(recording->bodies, frame.time_ns - kRounding_ns));
    };
    std::optional<Error> failed;
    const pipeline::NextFrame next = [&]() -> std::optional<StereoFrame> {
        auto frame = recording->source->next();
        if (!frame) failed = frame.error();
        return frame ? std::move(frame).value() : std::nullopt;
    };
    const pipeline::Start start = pipeline::align_when_ready(*pipeline, next);
    for (const StereoFrame& frame : start.frames) follow(frame);
    while (const auto frame = next()) follow(*frame);
    if (failed) return *failed;
    out.print("{},{},{},", now.scene, now.seed, now.profile);
    tally.print(out);
    out.print("\n");
    out.flush();
    return {};
}

int measure_all(const std::vector<std::string>& words) {
    if (words.size() < 2)
        return report(
            usage_error("odometry_truth OUT.csv SCENES [FIRST_SEED [SEEDS [PROFILES [FRAMES "
                        "[KEY=VALUE...]]]]]"));
    const int frames = words.size() > 5 ? std::atoi(words[5].c_str()) : 0;
    SettingsRequest common;
    if (words.size() > 6) common.overrides.assign(words.begin() + 6, words.end());
    const auto executor = surefoot::make_executor();
    auto out = fmt::output_file(words[0]);
    out.print(
        "scene,seed,profile,path_m,end_mm,end_deg,moving,nees,rpe_mm,rpe_deg,standing,held_mm,"
        "jump_mm,ok,degraded,lost\n");
    for (const SceneCase& now : experiments::scene_cases({words.begin() + 1, words.end()})) {
        const auto done = measure(now, frames, common, *executor, out);
        if (!done) return report(done.error());
    }
    return kExitOk;
}

}  // namespace
}  // namespace surefoot::app

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::app::measure_all({argv + 1, argv + argc});
}

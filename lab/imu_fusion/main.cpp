// SPDX-License-Identifier: Apache-2.0
// How much does an IMU improve stereo odometry, and which fusion is better?
// Usage: imu_fusion OUT.csv corners|ROOM
//   SUREFOOT_DATA_DIR=../shared/data imu_fusion out/corners.csv corners
//   imu_fusion out/room.csv out/room
//   corners: corner tracks of both gap-free parts of euroc_april, each part on its own, then the
//   whole recording with the gap; no images. ROOM: a folder written by render_room.py.
//
// Each recording runs through three methods: vision alone; the motion of vision alone, loosely
// fused with the IMU (velocity_fusion.hpp, proposed in the reference thesis, Lange 2016); points
// and IMU in one problem (the method of the library).
//
// Writes OUT.csv, one line per recording and method:
//   frames, path_m            frames with a true pose; path length of the left camera
//   ate_mm                    rms position error after SE3 alignment
//   rpe_mm, rpe_deg           rms error of the motions over one second, starting at every frame
//   nees                      mean of error^T covariance^-1 error of consecutive one-second
//                             motions; 6 is expected for a correct covariance
//   end_mm                    error of the motion from the first to the last frame
//   ok, degraded, lost        number of frames
//   truth_noise_mm            noise of the true positions: scatter about a parabola through five
//                             frames
#include <fmt/format.h>
#include <fmt/os.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "lab/imu_fusion/velocity_fusion.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/eval/trajectory/trajectory.hpp"
#include "surefoot/odometry/odometry.hpp"
#include "surefoot/odometry/recordings_testing.hpp"

namespace surefoot::experiments {
namespace {

/// Standard deviation of a corner coordinate per axis. Source: corners_accuracy_test.cpp.
constexpr double kCornerNoise_px = 0.35;
constexpr double kWindow_s = 1.0;
constexpr std::array kMethods = {"vision alone", "loose fusion", "tight fusion"};
constexpr std::size_t kLoose = 1;
constexpr std::size_t kTight = 2;

/// Estimated motion of a frame, and the true pose of the left camera if known.
struct Step {
    MotionEstimate motion;
    std::optional<Pose> T_world_camera;
};

struct Nees {
    double sum = 0.0;
    int windows = 0;
};

/// Returns the NEES of consecutive one-second windows between frames with a true pose.
Nees nees_of(const std::vector<Step>& steps, const Pose& T_camera_body) {
    Nees nees;
    std::optional<Pose> T_world_begin;
    std::int64_t begin_ns = 0;
    Pose T_window;
    Matrix6 covariance = Matrix6::Zero();
    for (const Step& step : steps) {
        const MotionEstimate& m = step.motion;
        covariance = compose_covariance(covariance, m.T_previous_body, m.relative_covariance);
        T_window = T_window * m.T_previous_body;
        const bool over = seconds_from_ns(m.time_ns - begin_ns) >= kWindow_s - 1e-3;
        if (T_world_begin && (!over || !step.T_world_camera)) continue;
        if (!step.T_world_camera) continue;
        const Pose T_world_body = *step.T_world_camera * T_camera_body;
        if (T_world_begin) {
            const Vector6 error = difference(T_world_begin->inverse() * T_world_body, T_window);
            nees.sum += error.dot(covariance.ldlt().solve(error));
            nees.windows += 1;
        }
        T_world_begin = T_world_body;
        begin_ns = m.time_ns;
        T_window = Pose{};
        covariance.setZero();
    }
    return nees;
}

/// Returns the noise of the true positions: rms over the frames, all axes together. Fits a parabola
/// through five values. White noise leaves 18/35 of its variance around the middle of this parabola
/// (Savitzky and Golay 1964).
double noise_m(const Trajectory& truth) {
    constexpr std::array kWeights = {-3.0 / 35, 12.0 / 35, 17.0 / 35, 12.0 / 35, -3.0 / 35};
    constexpr double kLeft = 18.0 / 35;
    constexpr double kSpan_s = 0.25;  // longest time between the first and the last of five frames
    double sum_m2 = 0.0;
    int count = 0;
    for (std::size_t i = 0; i + kWeights.size() <= truth.size(); ++i) {
        if (seconds_from_ns(truth[i + 4].time_ns - truth[i].time_ns) > kSpan_s) continue;
        Eigen::Vector3d smooth_m = Eigen::Vector3d::Zero();
        for (std::size_t k = 0; k < kWeights.size(); ++k)
            smooth_m += kWeights[k] * truth[i + k].T_world_body.translation_m;
        sum_m2 += (truth[i + 2].T_world_body.translation_m - smooth_m).squaredNorm() / kLeft;
        count += 1;
    }
    return std::sqrt(sum_m2 / std::max(count, 1));
}

Status report(const std::string& recording,
              const char* method,
              const std::vector<Step>& steps,
              const Pose& T_body_camera,
              fmt::ostream& out) {
    Trajectory estimate;
    Trajectory truth;
    std::array<int, 3> health{};
    for (const Step& step : steps) {
        health[static_cast<std::size_t>(step.motion.health)] += 1;
        if (!step.T_world_camera) continue;
        estimate.push_back({step.motion.time_ns, step.motion.T_odom_body * T_body_camera});
        truth.push_back({step.motion.time_ns, *step.T_world_camera});
    }
    eval::EvalTrajectoryConfig config;
    config.rpe_interval_s = kWindow_s;
    const auto errors = eval::evaluate_trajectory(estimate, truth, config);
    if (!errors) return errors.error();
    const Nees nees = nees_of(steps, T_body_camera.inverse());
    out.print("{},{},{},{:.2f},{:.2f},{:.2f},{:.3f},{:.2f},{:.1f},{},{},{},{:.2f}\n",
              recording,
              method,
              errors->matched,
              errors->path_length_m,
              1e3 * errors->ate_rmse_m,
              1e3 * errors->rpe_trans_rmse_m,
              errors->rpe_rot_rmse_deg,
              nees.sum / std::max(nees.windows, 1),
              1e3 * errors->end_error_m,
              health[static_cast<std::size_t>(Health::ok)],
              health[static_cast<std::size_t>(Health::degraded)],
              health[static_cast<std::size_t>(Health::lost)],
              1e3 * noise_m(truth));
    return {};
}

/// Runs the three methods on the same input.
class Contest {
  public:
    Contest(const odometry::OdometryConfig& config,
            const camera::StereoRig& rig,
            const camera::Rectifier& rectifier)
        : T_body_camera_(rig.body_from_left()),
          vision_(config, rectifier),
          loose_(config.imu),
          tight_(config, rectifier, rig.imu) {}

    /// `update` passes the frame to the odometry of one method.
    template <typename Update>
    void follow(const Update& update,
                std::span<const ImuSample> imu,
                const std::optional<Pose>& T_world_camera) {
        const MotionEstimate vision = update(vision_);
        steps_[0].push_back({vision, T_world_camera});
        steps_[kLoose].push_back({loose_.update(vision, imu), T_world_camera});
        steps_[kTight].push_back({update(tight_), T_world_camera});
    }

    [[nodiscard]] Status report(const std::string& recording, fmt::ostream& out) const {
        for (std::size_t i = 0; i < kMethods.size(); ++i)
            if (Status done =
                    experiments::report(recording, kMethods[i], steps_[i], T_body_camera_, out);
                !done)
                return done;
        return {};
    }

  private:
    Pose T_body_camera_;
    odometry::Odometry vision_;
    VelocityFusion loose_;
    odometry::Odometry tight_;
    std::array<std::vector<Step>, kMethods.size()> steps_;
};

Status run_corners(fmt::ostream& out) {
    const auto recording = odometry::testing::euroc_april();
    if (!recording) return input_error("sequences/euroc_april is not in SUREFOOT_DATA_DIR");
    const auto rectifier = camera::Rectifier::make(recording->rig);
    if (!rectifier) return rectifier.error();
    odometry::OdometryConfig config;
    config.sigma_px = kCornerNoise_px;

    // Frames without a true pose (the grid is out of view) separate the parts.
    const auto& truth = recording->T_world_camera;
    const auto gap = std::find(truth.begin(), truth.end(), std::nullopt);
    const auto after = std::find_if(gap, truth.end(), [](const auto& T) { return T.has_value(); });
    const auto at = [&](auto it) { return static_cast<std::size_t>(it - truth.begin()); };
    struct Part {
        const char* name;
        std::size_t first, last;
    };
    for (const Part part : {Part{"corners before the gap", 0, at(gap)},
                            Part{"corners after the gap", at(after), truth.size()},
                            Part{"corners with the gap", 0, truth.size()}}) {
        Contest contest(config, recording->rig, *rectifier);
        for (std::size_t i = part.first; i < part.last; ++i) {
            const odometry::PointFrame& frame = recording->frames[i];
            contest.follow([&](odometry::Odometry& odometry) { return odometry.update(frame); },
                           frame.imu,
                           truth[i]);
        }
        if (Status done = contest.report(part.name, out); !done) return done;
    }
    return {};
}

Status run_room(const std::string& folder, fmt::ostream& out) {
    const auto recording = odometry::testing::rendered_room(folder);
    if (!recording) return input_error(folder + " is no room");
    const auto rectifier = camera::Rectifier::make(recording->rig);
    if (!rectifier) return rectifier.error();
    Contest contest({}, recording->rig, *rectifier);
    for (int i = 0; i < recording->frames; ++i) {
        const StereoFrame frame = recording->frame(i);
        contest.follow(
            [&](odometry::Odometry& odometry) { return odometry.update(frame, serial()); },
            frame.imu,
            recording->T_world_camera[static_cast<std::size_t>(i)]);
    }
    return contest.report("rendered room", out);
}

int run(const std::vector<std::string>& words) {
    if (words.size() != 2) {
        std::fputs("usage: imu_fusion OUT.csv corners|ROOM\n", stderr);
        return 2;
    }
    auto out = fmt::output_file(words[0]);
    out.print(
        "recording,method,frames,path_m,ate_mm,rpe_mm,rpe_deg,nees,end_mm,ok,degraded,lost,truth_"
        "noise_mm\n");
    const Status done = words[1] == "corners" ? run_corners(out) : run_room(words[1], out);
    if (!done) std::fputs((done.error().message + "\n").c_str(), stderr);
    return done ? 0 : 1;
}

}  // namespace
}  // namespace surefoot::experiments

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::experiments::run({argv + 1, argv + argc});
}

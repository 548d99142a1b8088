// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "surefoot/camera/depth_image.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/sim/rendering/renderer.hpp"
#include "surefoot/sim/scenes/scene.hpp"
#include "surefoot/stereo/matcher.hpp"

namespace surefoot {

inline constexpr double kCellSize_m = 0.025;

/// A pattern with the contrast that the fitted ZED sees.
[[nodiscard]] sim::Material zed_look(sim::Pattern pattern, std::uint64_t seed);

/// The fitted ZED, 0.95 m over z = 0 and 32 deg down: renders, matches and knows the truth.
class ZedBench {
  public:
    /// `noise`: factor on the noise of the profile.
    ZedBench(double noise, const stereo::MatcherConfig& matcher, Executor& executor);

    /// `frame` and `seed` choose the noise.
    void see(const sim::Scene& scene, const Pose& T_world_body, int frame, std::uint64_t seed);
    [[nodiscard]] const camera::RectifiedRig& rectified() const { return rectifier_.rig(); }
    [[nodiscard]] const camera::StereoRig& rig() const { return rig_; }
    [[nodiscard]] const camera::DepthImage& depth() const { return depth_; }
    [[nodiscard]] const Image<float>& true_depth_m() const { return pair_.depth_m; }
    /// The camera is camera_x_m() ahead of x_m.
    [[nodiscard]] Pose pose_over(double x_m) const;
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

/// What both programs on this bench take: OUT_DIR [FIRST_SEED [SEEDS [NOISE [KEY=VALUE...]]]] with
/// the matcher's keys (algorithm=sgbm).
struct BenchArguments {
    std::string out_dir;
    int first_seed = 1;
    int seeds = 4;
    double noise = 1.0;
    stereo::MatcherConfig matcher;
};
[[nodiscard]] Result<BenchArguments> bench_arguments(int argc, char** argv);

}  // namespace surefoot

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/depth_image.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/sim/rendering/renderer.hpp"
#include "surefoot/sim/scenes/scene.hpp"
#include "surefoot/stereo/matcher.hpp"

namespace surefoot {

inline constexpr double kCellSize_m = 0.025;  ///< side of a map cell in these experiments [m]

/// Returns a material with this pattern and with the contrast of the fitted ZED profile.
[[nodiscard]] sim::Material zed_look(sim::Pattern pattern, std::uint64_t seed);

/// Renders stereo pairs with the fitted ZED profile, matches them and keeps true and matched depth.
/// At the poses of `pose_over` the camera is 0.95 m above z = 0 and looks 32 deg down.
class ZedBench {
  public:
    /// `noise`: factor on the image noise of the profile. `executor` must outlive the bench.
    ZedBench(double noise, const stereo::MatcherConfig& matcher, Executor& executor);

    /// Renders and matches one pair; `depth` and `true_depth_m` then refer to it. `frame` and
    /// `seed` determine the image noise.
    void see(const sim::Scene& scene, const Pose& T_world_body, int frame, std::uint64_t seed);
    [[nodiscard]] const camera::RectifiedRig& rectified() const { return rectifier_.rig(); }
    [[nodiscard]] const camera::StereoRig& rig() const { return rig_; }
    [[nodiscard]] const DepthImage& depth() const { return depth_; }
    [[nodiscard]] const Image<float>& true_depth_m() const { return pair_.depth_m; }
    /// Returns T_world_body with the body at `x_m` on the x axis and the camera 0.95 m above z = 0.
    /// The camera is `camera_x_m` ahead of the body.
    [[nodiscard]] Pose pose_over(double x_m) const;
    [[nodiscard]] double camera_x_m() const { return rig_.body_from_left().translation_m.x(); }

  private:
    Executor& executor_;
    camera::StereoRig rig_;
    sim::CameraConfig camera_;
    camera::Rectifier rectifier_;
    std::unique_ptr<stereo::Matcher> matcher_;
    sim::RenderedPair pair_;
    DepthImage depth_;
};

/// Arguments of the programs that use this bench: OUT_DIR [FIRST_SEED [SEEDS [NOISE
/// [KEY=VALUE...]]]]. KEY=VALUE sets a key of stereo::MatcherConfig, for example algorithm=sgbm.
struct BenchArguments {
    std::string out_dir;
    int first_seed = 1;
    int seeds = 4;
    double noise = 1.0;  ///< factor on the image noise
    stereo::MatcherConfig matcher;
};
/// Parses the command line. Error: OUT_DIR is missing, or a key or value is not valid.
[[nodiscard]] Result<BenchArguments> bench_arguments(int argc, char** argv);

}  // namespace surefoot

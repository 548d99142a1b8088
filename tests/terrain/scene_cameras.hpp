// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/elevation/elevation_map.hpp"
#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/sensors/analytic_stereo.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot::terrain {

/// The ZED on the armrest with the errors of a matcher: noise, seams, and ramps where one camera
/// sees nothing. The scene must outlive this object. Throws on errors, so that the test fails.
class SceneCameras {
  public:
    explicit SceneCameras(const sim::Scene& scene, const sim::AnalyticStereoConfig& errors = {})
        : stereo_(sim::AnalyticStereo::make(scene, zed_rig(), errors, 1).value()) {}

    [[nodiscard]] const camera::RectifiedRig& rig() const { return stereo_.rig(); }
    /// Depth image from a pose, with new noise in every call. Valid until the next call.
    const DepthImage& look_from(const Pose& T_world_body) {
        stereo_.measure(T_world_body, looks_++, serial(), view_, depth_);
        return depth_;
    }
    [[nodiscard]] int looks() const { return looks_; }

  private:
    static camera::RectifiedRig zed_rig() {
        return camera::Rectifier::make(sim::rig_preset("zed_vga").value()).value().rig();
    }
    sim::AnalyticStereo stereo_;
    sim::AnalyticStereo::View view_;
    DepthImage depth_;
    int looks_ = 0;
};

/// Fuses a depth image into the map at the known pose. odom equals the world frame.
inline void add_look(const SceneCameras& cameras,
                     const DepthImage& depth,
                     const Pose& T_world_body,
                     elevation::ElevationMap& map) {
    constexpr std::int64_t kFrame_ns = 100'000'000;
    map.follow(T_world_body, Matrix6::Zero());
    map.add(cameras.rig(), T_world_body, depth, 1'000'000'000 + cameras.looks() * kFrame_ns);
}

/// Value of a parameter that the seed has drawn for a scene. Throws if it is missing.
inline double drawn(const sim::ScriptedScene& scene, const std::string& name) {
    for (const sim::SceneParameter& parameter : scene.parameters)
        if (parameter.name == name) return std::stod(parameter.value);
    throw std::invalid_argument(scene.info.name + " has no parameter " + name);
}

}  // namespace surefoot::terrain

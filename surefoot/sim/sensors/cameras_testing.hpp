// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/sim/motion/motion.hpp"
#include "surefoot/sim/rendering/renderer.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot::sim::test {

/// The VGA rig with a quarter of the pixels in each direction, for fast tests.
inline camera::StereoRig small_rig() {
    camera::StereoRig rig = rig_preset("zed_vga").value();
    camera::PinholeRadTan lens;
    lens.fx_px = lens.fy_px = 85.0;
    lens.cx_px = 83.5;
    lens.cy_px = 46.5;
    rig.left = {lens, 168, 94};
    rig.right = rig.left;
    rig.readout_s = 0.0;
    return rig;
}

/// A camera without noise and vignetting.
inline CameraConfig noiseless() {
    CameraConfig config;
    config.imaging.read_noise_dn = 0.0;
    config.imaging.shot_noise_dn = 0.0;
    config.imaging.vignetting = 0.0;
    return config;
}

/// Moves from the origin at time 0 with constant velocity and turning rate, also before time 0.
class Steady final : public Motion {
  public:
    Steady(const Pose& start,
           const Eigen::Vector3d& velocity_m_s,
           const Eigen::Vector3d& rate_rad_s)
        : start_(start), velocity_m_s_(velocity_m_s), rate_rad_s_(rate_rad_s) {}
    [[nodiscard]] MotionState at(double time_s) const override {
        MotionState state;
        state.T_world_body = start_;
        state.T_world_body.translation_m += time_s * velocity_m_s_;
        state.T_world_body.rotation = start_.rotation * exp_so3(time_s * rate_rad_s_);
        return state;
    }
    [[nodiscard]] double duration_s() const override { return 10.0; }

  private:
    Pose start_;
    Eigen::Vector3d velocity_m_s_;
    Eigen::Vector3d rate_rad_s_;
};

}  // namespace surefoot::sim::test

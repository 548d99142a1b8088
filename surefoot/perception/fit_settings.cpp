// SPDX-License-Identifier: Apache-2.0
#include "surefoot/perception/fit_settings.hpp"

namespace surefoot {
namespace {

/// Selects the Kinect error model for RGB-D cameras instead of the default model `matcher`. Another
/// model that the user chose stays.
void choose_sensor_model(const camera::StereoRig& rig, Settings& settings) {
    auto& model = settings.pipeline.elevation.sensor.model;
    if (!rig.right && model == elevation::SensorModel::matcher)
        model = elevation::SensorModel::kinect;
}

/// Takes the height of base_link over its ground and the speed limits from the machine file. Values
/// that the user set stay.
void expect_machine(const std::optional<io::MachineFile>& machine, Settings& settings) {
    if (!machine) return;
    const auto unless_set = [](double& value, double known) {
        if (value == 0.0) value = known;
    };
    unless_set(settings.pipeline.ground.expected_height_m,
               1e-4 * machine->machine.sole_depth_tenth_mm);
    unless_set(settings.pipeline.odometry.machine_speed_m_s, machine->speed_m_s);
    unless_set(settings.pipeline.odometry.machine_turn_deg_s, machine->turn_deg_s);
}

}  // namespace

void fit_settings(const camera::StereoRig& rig,
                  const std::optional<io::MachineFile>& machine,
                  Settings& settings) {
    choose_sensor_model(rig, settings);
    expect_machine(machine, settings);
}

camera::StereoRig mounted_rig(const camera::StereoRig& rig,
                              const std::optional<io::MachineFile>& machine) {
    camera::StereoRig mounted = rig;
    if (!mounted.T_body_left && machine) mounted.T_body_left = machine->T_body_left;
    return mounted;
}

}  // namespace surefoot

// SPDX-License-Identifier: Apache-2.0
#include "service/live/machine_joints.hpp"

#include <algorithm>
#include <cstddef>

#include "surefoot/sim/scene_source.hpp"

namespace surefoot::app {

JointsAt joints_of(const camera::FrameSource& source, const io::MachineModel& model) {
    const auto* const scene = dynamic_cast<const sim::SceneSource*>(&source);
    if (scene == nullptr) return {};
    std::vector<std::size_t> places;
    for (const io::ModelJoint* joint : model.moving_joints()) {
        const auto& names = sim::kRexJointNames;
        const auto found = std::find(names.begin(), names.end(), joint->name);
        if (found == names.end()) return {};
        places.push_back(static_cast<std::size_t>(found - names.begin()));
    }
    return [scene, places](std::int64_t time_ns, std::vector<float>& joints_rad) {
        joints_rad.clear();
        const auto joints = scene->rex_joints(time_ns);
        if (!joints) return;
        const auto angles_rad = joints->in_order();
        joints_rad.reserve(places.size());
        for (const std::size_t place : places)
            joints_rad.push_back(static_cast<float>(angles_rad[place]));
    };
}

}  // namespace surefoot::app

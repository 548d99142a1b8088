// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/settings/renamed_keys.hpp"

#include <fmt/format.h>

#include <array>

namespace surefoot::io {
namespace {

struct Renamed {
    std::string_view old_name;  ///< key or group; its outer groups have today's names
    std::string_view new_name;
};

constexpr std::array kRenamed{
    Renamed{"trim", "self_calibration"},
    Renamed{"stairs.follow", "stairs.tracking"},
    Renamed{"stairs.tracking.mean_looks", "stairs.tracking.mean_observations"},
    Renamed{"stairs.tracking.going_looks", "stairs.tracking.going_observations"},
    Renamed{"stairs.tracking.level_looks", "stairs.tracking.level_observations"},
    Renamed{"stairs.tracking.missed_looks", "stairs.tracking.missed_observations"},
    Renamed{"stairs.tracking.first_looks", "stairs.tracking.first_observations"},
    Renamed{"stairs.tracking.steps_looks", "stairs.tracking.steps_observations"},
    Renamed{"mount.wait_for_light_s", "mount.wait_for_exposure_s"},
    Renamed{"sim.carrier", "sim.motion_model"},
    Renamed{"specular.forget_looks", "specular.forget_observations"},
    Renamed{"sim.optics.smudge_eye", "sim.optics.smudge_camera"},
    Renamed{"ancestor", "reference"},
};

bool is_at_or_below(std::string_view key, std::string_view group) {
    return key == group || (key.starts_with(group) && key.substr(group.size()).starts_with('.'));
}

}  // namespace

std::string current_key(std::string_view key) {
    std::string name(key);
    for (const Renamed& renamed : kRenamed) {
        if (is_at_or_below(name, renamed.old_name))
            name.replace(0, renamed.old_name.size(), renamed.new_name);
    }
    return name;
}

std::string renamed_note(std::string_view old_name, std::string_view new_name) {
    return fmt::format("{} is now called {}. Use the new name: version 0.3 refuses the old one",
                       old_name,
                       new_name);
}

}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/eval/clouds/m3c2.hpp"
#include "surefoot/eval/maps/maps.hpp"
#include "surefoot/io/live_camera/live_camera.hpp"
#include "surefoot/io/settings/config_yaml.hpp"
#include "surefoot/pipeline/pipeline_config.hpp"
#include "surefoot/sim/scene_source.hpp"
#include "surefoot/sim/sensors/laser_scanner.hpp"

namespace surefoot {

/// Every setting of the program. `surefoot config` prints all keys with units and defaults.
struct Settings {
    pipeline::PipelineConfig pipeline;
    eval::EvalMapsConfig maps;
    eval::M3c2Config m3c2;
    sim::SceneOptions sim;          ///< rendering of simulated scenes
    sim::LaserScannerConfig laser;  ///< laser scanner in simulated scenes
    io::CameraConfig live;          ///< live cameras

    void describe(ConfigVisitor& visitor);
};

/// Sources of the settings: defaults, preset, file, overrides. Later sources have priority.
struct SettingsRequest {
    std::string preset;                  ///< traversability preset, one of kPresetNames
    std::string config_file;             ///< YAML file, as `surefoot config` writes it
    std::vector<std::string> overrides;  ///< "elevation.resolution_m=0.02"
};

/// Loads and checks the settings. Each problem is a usage error; an error of the file also has the
/// line, key and limit. `notes`, if given, receives a sentence for each key that has a new name.
[[nodiscard]] Result<Settings> load_settings(const SettingsRequest& request = {},
                                             io::Notes* notes = nullptr);
/// Applies the file and the overrides of `request` to a configuration object.
[[nodiscard]] Status apply_overrides(const SettingsRequest& request,
                                     const io::DescribeConfig& describe,
                                     io::Notes* notes = nullptr);
/// Returns the hash of the keys and values of all settings. Map snapshots and verdicts carry it.
[[nodiscard]] std::uint64_t hash_of(const Settings& settings);

/// Returns an executor with this many threads; 0 = one per core of the computer.
[[nodiscard]] std::unique_ptr<Executor> make_executor(int threads = 0);
/// Returns the time of the steady clock, for stage times [ns].
[[nodiscard]] std::int64_t steady_now_ns();

}  // namespace surefoot

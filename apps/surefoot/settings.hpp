// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "apps/surefoot/verbs.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/eval/clouds/m3c2.hpp"
#include "surefoot/eval/maps/maps.hpp"
#include "surefoot/io/live_camera/live_camera.hpp"
#include "surefoot/io/settings/config_yaml.hpp"
#include "surefoot/pipeline/pipeline_config.hpp"
#include "surefoot/sim/scene_source.hpp"
#include "surefoot/sim/sensors/laser_scanner.hpp"

namespace surefoot::app {

/// Every setting of the program.
struct Settings {
    pipeline::PipelineConfig pipeline;
    eval::EvalMapsConfig maps;
    eval::M3c2Config m3c2;
    sim::SceneOptions sim;          ///< how simulated scenes are seen
    sim::LaserScannerConfig laser;  ///< and scanned
    io::CameraConfig live;          ///< how live cameras are used

    void describe(ConfigVisitor& visitor);
};

/// Defaults, then the preset, then the file, then each --set: later ones win.
[[nodiscard]] Result<Settings> load_settings(const CommonOptions& options);

/// The file and each --set of `options` on top of what a config object holds.
[[nodiscard]] Status apply_overrides(const CommonOptions& options,
                                     const io::DescribeConfig& describe);

/// Hash of every setting, as the map snapshot and the verdict carry it.
[[nodiscard]] std::uint64_t hash_of(const Settings& settings);

/// As many threads as asked for, or as the machine has.
[[nodiscard]] std::unique_ptr<Executor> make_executor(const CommonOptions& options);

/// Steady clock for stage times [ns].
[[nodiscard]] std::int64_t steady_now_ns();

}  // namespace surefoot::app

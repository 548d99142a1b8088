// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/cameras.hpp"
#include "cli/rig_view.hpp"
#include "studies/benchmarks/bench_result.hpp"
#include "surefoot/io/settings/config_yaml.hpp"
#include "surefoot/io/settings/model_file.hpp"

// These functions write the JSON objects of the command line. The names of the keys are a contract
// (docs/reference/json.md). NaN is written as null.
namespace surefoot::app {

[[nodiscard]] std::string settings_json(const std::vector<io::ConfigEntry>& entries);
/// `problem` is empty when the settings are valid.
[[nodiscard]] std::string check_json(const std::string& problem);
/// `file`: the URDF file that was written; empty = no file.
[[nodiscard]] std::string urdf_json(const io::MachineModel& model, const std::string& file);
[[nodiscard]] std::string doctor_json(const std::string& version,
                                      int threads,
                                      const std::string& machine,
                                      const RigView& view,
                                      const std::vector<CameraNode>& cameras);
[[nodiscard]] std::string bench_json(const std::vector<BenchResult>& results);

}  // namespace surefoot::app

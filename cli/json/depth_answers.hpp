// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "service/live/measured_pair.hpp"
#include "studies/board_calibration/board_accuracy.hpp"
#include "surefoot/eval/depth/depth_design.hpp"

// These functions write the JSON objects of the command line. The names of the keys are a contract
// (docs/reference/json.md). NaN is written as null.
namespace surefoot::app {

[[nodiscard]] std::string measured_depth_json(const MeasuredPair& measured,
                                              const std::string& folder);
[[nodiscard]] std::string depth_accuracy_json(const std::string& rig,
                                              const std::vector<DistanceAccuracy>& rows,
                                              const std::string& folder);
[[nodiscard]] std::string depth_design_json(const eval::DepthDesign& design,
                                            const std::vector<eval::ResolvableHeight>& rows,
                                            const std::string& folder);

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "service/gate_process/protocol/json_text.hpp"
#include "surefoot/camera/frame_source.hpp"
#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/report.hpp"
#include "surefoot/eval/depth/depth_errors.hpp"
#include "surefoot/eval/maps/map_comparison.hpp"
#include "surefoot/eval/trajectory/trajectory.hpp"

// JSON objects of the command line. Their names are a contract (docs/reference/json.md). NaN is
// written as null.
namespace surefoot::app {

[[nodiscard]] gate_process::Json counts_json(const FusionCounts& f);
[[nodiscard]] gate_process::Json traversability_json(const eval::TraversabilityErrors& t);
[[nodiscard]] gate_process::Json errors_json(const eval::TrajectoryErrors& e);
[[nodiscard]] gate_process::Json figures_json(const eval::ErrorFigures& e, const std::string& unit);
/// Returns the errors [m] per bin. The limits of the bins have the unit of `key_unit`.
[[nodiscard]] gate_process::Json bins_json(const std::vector<eval::ErrorBin>& bins,
                                           const std::string& key_unit);
[[nodiscard]] gate_process::Json sigma_json(const eval::SigmaCoverage& s);
/// Returns the list x y z qx qy qz qw.
[[nodiscard]] gate_process::Json pose_json(const Pose& T);
[[nodiscard]] gate_process::Json camera_json(const camera::RectifiedRig& rig);
[[nodiscard]] gate_process::Json maps_object(const eval::MapComparison& result);
void add_broken(const camera::BrokenFrames& broken, gate_process::Json& object);
[[nodiscard]] gate_process::Json source_json(const camera::SourceInfo& source);
[[nodiscard]] gate_process::Json frame_json(const FrameReport& frame);

}  // namespace surefoot::app

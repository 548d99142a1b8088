// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/cameras.hpp"
#include "studies/simulation/copy_frames.hpp"
#include "surefoot/camera/frame_source.hpp"
#include "surefoot/core/report.hpp"
#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/recordings/recorder.hpp"
#include "surefoot/sim/scenes/scenes.hpp"

// These functions write the JSON objects of the command line. The names of the keys are a contract
// (docs/reference/json.md). NaN is written as null.
namespace surefoot::app {

[[nodiscard]] std::string scenes_json(const std::vector<sim::SceneInfo>& scenes);
[[nodiscard]] std::string recording_json(const io::RecordingInfo& info);
[[nodiscard]] std::string rig_json(const io::RigFile& file,
                                   const std::vector<std::string>& written);
[[nodiscard]] std::string copied_json(const Copied& copied, const std::string& folder);
/// Returns the JSON result of `surefoot calibrate render`.
[[nodiscard]] std::string rendered_boards_json(std::size_t views, const std::string& folder);
[[nodiscard]] std::string replay_json(const std::vector<FrameReport>& frames,
                                      double speed,
                                      std::int64_t late,
                                      const camera::SourceInfo& source);
[[nodiscard]] std::string camera_view_json(const CameraView& view);

}  // namespace surefoot::app

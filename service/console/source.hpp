// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "service/console/options.hpp"
#include "surefoot/camera/frame_source.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/io/live_camera/live_camera.hpp"
#include "surefoot/io/recordings/recording.hpp"
#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/sim/scene_source.hpp"

namespace surefoot::app {

/// The source to open, and the options for opening it.
struct SourceRequest {
    std::string source;  ///< path, sim:SCENE or v4l2:DEVICE
    std::string rig_file;
    double rate_hz = 0.0;  ///< frame rate; 0 = the rate of the source
    int max_frames = 0;    ///< largest number of frames; 0 = all
    std::uint64_t seed = 1;
    sim::SceneOptions sim = {};  ///< further options of a simulated scene
    io::CameraConfig live = {};  ///< options of a live camera
    std::string imu_file = {};   ///< file of IMU samples, see io::with_imu
    int first_frame = 0;         ///< first frame of a recording; earlier frames are skipped
    ReadingOptions reading = {};
};

/// Returns the request for the source that the options name.
[[nodiscard]] SourceRequest request_of(const SourceOptions& options,
                                       const CommonOptions& common,
                                       const Settings& settings);

/// Copies the reading options of the command line to the options of the readers.
void apply(const ReadingOptions& reading, io::OpenOptions& options);

/// Prefix of a source that is a live camera.
inline constexpr std::string_view kLivePrefix = "v4l2:";

/// Opens a recording, video, live camera or simulated scene.
[[nodiscard]] Result<std::unique_ptr<camera::FrameSource>> open_source(const SourceRequest& request,
                                                                       Executor& executor);

/// Opens a simulated scene; the prefix "sim:" is optional. `rig_file` may also be the name of a
/// built-in rig.
[[nodiscard]] Result<std::unique_ptr<sim::SceneSource>> open_simulation(
    const SourceRequest& request, Executor& executor);

/// Reads a calibration file, and logs the notes of the reader as warnings.
[[nodiscard]] Result<camera::StereoRig> read_noted_rig(const std::string& path);
/// Reads a calibration file, or returns the built-in rig of that name.
[[nodiscard]] Result<camera::StereoRig> load_rig(const std::string& path_or_name);

/// Reads a machine file by path or built-in name; returns an empty optional for an empty name.
[[nodiscard]] Result<std::optional<io::MachineFile>> load_machine(const std::string& path_or_name);

}  // namespace surefoot::app

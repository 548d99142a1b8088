// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "apps/surefoot/verbs.hpp"
#include "surefoot/camera/frame_source.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/io/live_camera/live_camera.hpp"
#include "surefoot/io/recordings/recording.hpp"
#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/sim/scene_source.hpp"

namespace surefoot::app {

struct SourceRequest {
    std::string source;  ///< path, sim:SCENE or v4l2:DEVICE
    std::string rig_file;
    double rate_hz = 0.0;  ///< 0 = the source's own
    int max_frames = 0;    ///< 0 = all
    std::uint64_t seed = 1;
    sim::SceneOptions sim = {};  ///< the rest of what a simulated scene wants to know
    io::CameraConfig live = {};  ///< and a live camera
    std::string imu_file = {};   ///< samples of another device, see io::with_imu
    int first_frame = 0;         ///< of a recording; those before it are passed over
    ReadingOptions reading = {};
};

/// Hands the options of the command line on to the readers.
void apply(const ReadingOptions& reading, io::OpenOptions& options);

/// What begins the name of a live camera.
inline constexpr std::string_view kLivePrefix = "v4l2:";

/// Opens a recording, video, live camera or simulated scene.
[[nodiscard]] Result<std::unique_ptr<camera::FrameSource>> open_source(const SourceRequest& request,
                                                                       Executor& executor);

/// Opens a simulated scene, with or without "sim:" before its name; `rig_file` may also be the name
/// of a built-in rig.
[[nodiscard]] Result<std::unique_ptr<sim::SceneSource>> open_simulation(
    const SourceRequest& request, Executor& executor);

/// A calibration from a file; what its reader has to say about it goes to the log.
[[nodiscard]] Result<camera::StereoRig> read_noted_rig(const std::string& path);
/// A calibration by path, or one of the simulator's rigs by its name.
[[nodiscard]] Result<camera::StereoRig> load_rig(const std::string& path_or_name);

/// A machine file by path or by built-in name; nothing for an empty choice.
[[nodiscard]] Result<std::optional<io::MachineFile>> load_machine(const std::string& path_or_name);

/// The source's rig; where it does not know its own body, the machine's mount.
[[nodiscard]] camera::StereoRig mounted_rig(const camera::StereoRig& rig,
                                            const std::optional<io::MachineFile>& machine);

}  // namespace surefoot::app

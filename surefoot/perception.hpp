// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "surefoot/camera/frame_source.hpp"
#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/report.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/grid/map_snapshot.hpp"
#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/pipeline/start.hpp"

namespace surefoot {

/// Opens a recording: a side-by-side video, or a folder of images in a layout that
/// docs/get_started/own_camera.md names (such as EuRoC, KITTI, TUM RGB-D). `rig_file` is a
/// calibration in any format of that page. If it is empty, the calibration of the recording is
/// used. An error names the file and the cause.
[[nodiscard]] Result<std::unique_ptr<camera::FrameSource>> open_recording(
    const std::string& path, const std::string& rig_file = {});

/// Loads a machine file by path, or a built-in machine by name ("rex"). An error names the file or
/// machine; an error of a value also names its line, key and limit.
[[nodiscard]] Result<io::MachineFile> load_machine(const std::string& path_or_name);

/// The whole processing in one object. Input: frames of a stereo or depth camera. Results: a rated
/// map of the ground, its stairs and drops, and the gate's verdict on a movement.
///
///     auto source = surefoot::open_recording("my_recording");
///     auto perception = surefoot::Perception::make((*source)->rig());
///     for (auto frame = (*source)->next(); frame && *frame; frame = (*source)->next())
///         for (const surefoot::FrameReport& report : perception->process(**frame))
///             std::cout << report.motion.T_odom_body.translation_m.transpose() << '\n';
///
/// Start-up: frames are collected until they suffice to place odom, or until a time limit
/// (pipeline::StartUp). Then the kept frames are processed. Results are in odom: z up, origin below
/// the first base_link; see NOTATION.md. Not thread-safe; owns its threads. Takes about 36 ms of
/// one core for a frame of 672 x 376 pixels (docs/evidence/headline_figures.md).
class Perception {
  public:
    /// `rig`: the camera. If it does not state its mounting, the mounting of the machine is used.
    /// `machine`: needed for verdicts. `threads`: 0 = one per core. Returns the first problem of
    /// the rig or of the settings as an error.
    [[nodiscard]] static Result<Perception> make(const camera::StereoRig& rig,
                                                 std::optional<io::MachineFile> machine = {},
                                                 Settings settings = {},
                                                 int threads = 0);

    /// Processes the next frame in time order. Returns the reports of all frames that it processed:
    /// none during start-up, several at its end, then one per call. The reports are valid until the
    /// next call. `Work::odometry` estimates only the motion and is much faster.
    std::span<const FrameReport> process(const StereoFrame& frame, Work work = Work::full);
    /// Call this when the source ends. It processes a recording that is shorter than the start-up.
    std::span<const FrameReport> finish();

    /// True once odom is placed. Before that, the map and the features are empty.
    [[nodiscard]] bool is_started() const noexcept { return !start_.has_value(); }
    /// Returns the map of the ground: robot-centric, in odom.
    [[nodiscard]] const elevation::ElevationMap& map() const noexcept { return pipeline_->map(); }
    /// Returns slope, step height, roughness and traversability of each cell of the map.
    [[nodiscard]] const traversability::TraversabilityLayers& rating() const noexcept {
        return pipeline_->rating();
    }
    /// Returns stairs, drops, kerbs, sills and doors, tracked over time.
    [[nodiscard]] const stairs::TerrainFeatures& features() const noexcept {
        return pipeline_->features();
    }
    /// Returns the data that the gate reads, as of the last frame. An error names the wrong value.
    [[nodiscard]] Result<std::unique_ptr<grid::MapSnapshot>> snapshot() const;
    /// Answers "may the machine make this movement from its present pose?" as of the last frame.
    /// Every missing input inhibits: no machine, no map, an unknown command. Use this for tests and
    /// analysis only. A moving machine asks the gate process (surefoot-gate), which also checks the
    /// age of the map and the health of perception.
    [[nodiscard]] gate::Verdict verdict(std::uint8_t command) const;
    /// Returns the verdict as one sentence, with any obstacle, position, value and limit.
    [[nodiscard]] std::string text_of(const gate::Verdict& verdict) const;

    /// Gives all other results: alignment, camera, depth image of the last frame, footholds.
    [[nodiscard]] const pipeline::Pipeline& pipeline() const noexcept { return *pipeline_; }
    [[nodiscard]] const Settings& settings() const noexcept { return settings_; }

  private:
    Perception(Settings settings,
               std::optional<io::MachineFile> machine,
               std::unique_ptr<Executor> executor,
               pipeline::Pipeline pipeline);
    void process_kept_frames();

    Settings settings_;
    std::uint64_t settings_hash_;
    std::optional<io::MachineFile> machine_;
    std::unique_ptr<Executor> executor_;  // the pipeline keeps its address
    std::unique_ptr<pipeline::Pipeline> pipeline_;
    std::optional<pipeline::StartUp> start_;  ///< exists until odom is placed
    std::vector<FrameReport> reports_;
};

}  // namespace surefoot

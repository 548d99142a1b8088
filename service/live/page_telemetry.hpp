// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "service/live/machine_joints.hpp"
#include "service/page/page_feed.hpp"
#include "surefoot/camera/frame_source.hpp"
#include "surefoot/core/report.hpp"
#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/io/settings/model_file.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/stairs/tracking/drift.hpp"

namespace surefoot::app {

/// Returns the floor in front of a level machine that is too near for the camera: a polygon in
/// base_link [m], counter-clockwise. Empty if the lower image border does not meet the floor in
/// front of the machine.
[[nodiscard]] std::vector<page::PageHello::GroundPoint> blind_zone_of(
    const camera::RectifiedRig& rig, double sole_depth_m);

/// Returns the first message to a page. `gate_port` may change later.
[[nodiscard]] page::PageHello hello_of(const camera::FrameSource& source,
                                       const camera::StereoRig& rig,
                                       const std::optional<io::MachineFile>& machine,
                                       const std::optional<io::MachineModel>& model,
                                       std::uint16_t gate_port,
                                       double rate_hz);

/// Passes the results of perception to the thread of the page. Pose, map and state follow every
/// frame. Images, layers and terrain features follow only if a page wants them, at the rates of the
/// feed.
class PageTelemetry {
  public:
    /// `joints_at` gives the joint angles of the machine; empty = the angles are unknown.
    PageTelemetry(page::PageFeed& feed, std::string source, JointsAt joints_at = {})
        : feed_(feed), source_(std::move(source)), joints_at_(std::move(joints_at)) {}
    /// Call after every frame. `map` is the snapshot of this frame. `map_time_ns` is the stamp of
    /// the last frame that updated the map, on the clock of the source. `now_steady_ns` is the time
    /// on the steady clock.
    void tell(const pipeline::Pipeline& pipeline,
              const FrameReport& report,
              const grid::MapSnapshot& map,
              std::int64_t map_time_ns,
              std::int64_t now_steady_ns);
    /// Tells the pages that the source has ended.
    void tell_the_end(const pipeline::Pipeline& pipeline);
    /// Tells the pages that a new map and a new odom frame begin.
    void tell_new_beginning();

  private:
    void tell_state(page::SourceState state, std::string text, stairs::TerrainFeatures stairs);
    void fill_extras(const pipeline::Pipeline& pipeline,
                     const FrameReport& report,
                     std::uint64_t map_version,
                     std::int64_t now_steady_ns,
                     page::PageFrame& frame);
    void fill_status(const FrameReport& report, page::PageStatus& status);

    page::PageFeed& feed_;
    std::string source_;
    JointsAt joints_at_;
    std::uint64_t serial_ = 0;
    stairs::Drift drift_;
    std::int64_t images_due_ns_ = 0;
    std::int64_t layers_due_ns_ = 0;
    std::int64_t stairs_due_ns_ = 0;
    std::deque<std::int64_t> lately_ns_;  ///< steady-clock times of the last frames
    std::array<std::deque<double>, kStageCount> stages_ms_;
    page::PageStatus status_;
    page::PagePose pose_;
};

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/surefoot/machine_joints.hpp"
#include "service/page/page_feed.hpp"
#include "surefoot/camera/frame_source.hpp"
#include "surefoot/core/report.hpp"
#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/io/settings/model_file.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/stairs/tracking/drift.hpp"

namespace surefoot::app {

/// Where the camera of a machine that stands level sees no floor yet, before it: a polygon in
/// base_link [m], counter-clockwise; empty where the camera looks at no floor.
[[nodiscard]] std::vector<page::PageHello::GroundPoint> blind_zone_of(
    const camera::RectifiedRig& rig, double sole_depth_m);

/// What a page is told first. `gate_port` may change later.
[[nodiscard]] page::PageHello hello_of(const camera::FrameSource& source,
                                       const camera::StereoRig& rig,
                                       const std::optional<io::MachineFile>& machine,
                                       const std::optional<io::MachineModel>& model,
                                       std::uint16_t gate_port,
                                       double rate_hz);

/// Hands what perception did over to the page's thread: pose, map and state after every frame,
/// images, layers and what the ground is as often as pages can want them at most.
class PageTelemetry {
  public:
    /// `joints_at`: who knows the joints of the machine; empty = nobody.
    PageTelemetry(page::PageFeed& feed, std::string source, JointsAt joints_at = {})
        : feed_(feed), source_(std::move(source)), joints_at_(std::move(joints_at)) {}
    /// After a frame. `map`: the snapshot of this frame; `map_time_ns`: of the frame that it took
    /// in last; both of the source's clock.
    void tell(const pipeline::Pipeline& pipeline,
              const FrameReport& report,
              const grid::MapSnapshot& map,
              std::int64_t map_time_ns,
              std::int64_t now_steady_ns);
    /// No frame will come any more, or not before the map has begun anew.
    void tell_the_end(const pipeline::Pipeline& pipeline);
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
    std::deque<std::int64_t> lately_ns_;  ///< steady times of the last frames
    std::array<std::deque<double>, kStageCount> stages_ms_;
    page::PageStatus status_;
    page::PagePose pose_;
};

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "service/console/option_settings.hpp"
#include "service/gate_process/channel/snapshot_channel.hpp"
#include "service/live/camera_order_check.hpp"
#include "surefoot/camera/frame_source.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/grid/map_snapshot.hpp"
#include "surefoot/pipeline/pipeline.hpp"

namespace surefoot::app {

/// Maps the stamps of the last 64 frames to the steady clock, which the gate uses for ages. A live
/// camera stamps its frames with that clock. The stamps of a recording or a simulation come from
/// another clock, so this class uses the arrival time of their frames.
class Arrivals {
  public:
    void note(std::int64_t stamp_ns, std::int64_t steady_ns) noexcept;
    /// Returns the steady time of the frame with this stamp; 0 (older than every frame) if the
    /// stamp is not one of the last 64.
    [[nodiscard]] std::int64_t steady_ns(std::int64_t stamp_ns) const noexcept;

  private:
    struct Arrival {
        std::int64_t stamp_ns = 0;
        std::int64_t steady_ns = 0;
    };
    std::array<Arrival, 64> last_{};
    std::size_t next_ = 0;
};

/// Runs a pipeline over a source and publishes a map snapshot after every frame.
///
/// The session ends when the source ends, `before_frame` returns false, the user interrupts, or the
/// gate requests a restart. Swapped cameras are an error. Pipeline, source and writer must outlive
/// the session. Not thread-safe.
class LiveSession {
  public:
    /// Called before a frame is fetched from the source. The result false ends the session.
    using BeforeFrame = std::function<bool()>;
    /// Called after the snapshot of a frame is published. `map_time_ns`: stamp of the last frame
    /// that updated the map, on the clock of the source.
    using AfterFrame = std::function<void(const FrameReport& report, std::int64_t map_time_ns)>;
    /// Returns the steady time [ns]; tests and experiments pass their own clock.
    using SteadyClock = std::function<std::int64_t()>;

    LiveSession(pipeline::Pipeline& pipeline,
                camera::FrameSource& source,
                gate_process::SnapshotWriter& writer,
                std::uint64_t config_hash,
                SteadyClock clock = steady_now_ns);

    enum class End : std::uint8_t { source_ended, stopped, restart_wanted };
    /// `speed`: upper limit of the playback speed as a multiple of real time; 0 = no limit. Frames
    /// of a live camera are never delayed.
    [[nodiscard]] Result<End> run(double speed,
                                  const BeforeFrame& before_frame,
                                  const AfterFrame& after_frame = {});
    /// Changes the playback speed from the next frame on.
    void pace(double speed) noexcept;
    /// Returns the last published snapshot.
    [[nodiscard]] const grid::MapSnapshot& last() const noexcept { return *snapshot_; }
    [[nodiscard]] std::uint64_t published() const noexcept { return published_; }

  private:
    [[nodiscard]] std::optional<StereoFrame> next();
    void wait_for(std::int64_t stamp_ns);
    [[nodiscard]] std::int64_t exposed_ns(std::int64_t stamp_ns) const;
    [[nodiscard]] Result<std::int64_t> publish();

    pipeline::Pipeline& pipeline_;
    camera::FrameSource& source_;
    gate_process::SnapshotWriter& writer_;
    std::uint64_t config_hash_;
    SteadyClock clock_;
    CameraOrderCheck cameras_;
    std::unique_ptr<grid::MapSnapshot> snapshot_;
    Arrivals arrivals_;
    double speed_ = 0.0;
    std::int64_t first_stamp_ns_ = 0;
    std::int64_t first_steady_ns_ = 0;
    std::uint64_t published_ = 0;
    BeforeFrame before_frame_;
    std::optional<Error> error_;
    std::optional<End> end_;
};

}  // namespace surefoot::app

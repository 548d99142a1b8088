// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "apps/surefoot/eyes_check.hpp"
#include "apps/surefoot/settings.hpp"
#include "service/gate_process/channel/snapshot_channel.hpp"
#include "surefoot/camera/frame_source.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/grid/map_snapshot.hpp"
#include "surefoot/pipeline/pipeline.hpp"

namespace surefoot::app {

/// Steady times of the last frames: what the gate measures ages with. Those of a live camera are
/// its stamps; the stamps of a recording or a simulation are of another clock, there the arrival
/// counts.
class Arrivals {
  public:
    void note(std::int64_t stamp_ns, std::int64_t steady_ns) noexcept;
    /// 0, older than everything, for a stamp that did not come lately.
    [[nodiscard]] std::int64_t steady_ns(std::int64_t stamp_ns) const noexcept;

  private:
    struct Arrival {
        std::int64_t stamp_ns = 0;
        std::int64_t steady_ns = 0;
    };
    std::array<Arrival, 64> last_{};
    std::size_t next_ = 0;
};

/// Drives a pipeline over a source and publishes a snapshot after every frame, until the source
/// ends, the user interrupts, or the gate asks for a beginning anew. Exchanged eyes are an
/// error. Keeps nothing of what was.
class LiveSession {
  public:
    /// Called before each frame of the source is asked for; false ends the session.
    using BeforeFrame = std::function<bool()>;
    /// After each frame, when its snapshot is published. `map_time_ns`: stamp of the frame that the
    /// map took in last.
    using AfterFrame = std::function<void(const FrameReport& report, std::int64_t map_time_ns)>;
    /// Steady time [ns]; tests and experiments bring their own.
    using SteadyClock = std::function<std::int64_t()>;

    LiveSession(pipeline::Pipeline& pipeline,
                camera::FrameSource& source,
                wire::SnapshotWriter& writer,
                std::uint64_t config_hash,
                SteadyClock clock = steady_now_ns);

    enum class End : std::uint8_t { source_ended, stopped, restart_wanted };
    /// `speed`: recordings are not played faster than that times real time; 0 = as fast as they
    /// come. A live camera is never made to wait.
    [[nodiscard]] Result<End> run(double speed,
                                  const BeforeFrame& before_frame,
                                  const AfterFrame& after_frame = {});
    /// From the next frame on frames are due at this speed.
    void pace(double speed) noexcept;
    /// The snapshot that was published last.
    [[nodiscard]] const grid::MapSnapshot& last() const noexcept { return *snapshot_; }
    [[nodiscard]] std::uint64_t published() const noexcept { return published_; }

  private:
    [[nodiscard]] std::optional<StereoFrame> next();
    void wait_for(std::int64_t stamp_ns);
    [[nodiscard]] std::int64_t exposed_ns(std::int64_t stamp_ns) const;
    [[nodiscard]] Result<std::int64_t> publish();

    pipeline::Pipeline& pipeline_;
    camera::FrameSource& source_;
    wire::SnapshotWriter& writer_;
    std::uint64_t config_hash_;
    SteadyClock clock_;
    EyesCheck eyes_;
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

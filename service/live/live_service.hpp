// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "service/live/frame_recorder.hpp"
#include "service/live/gate_child.hpp"
#include "service/live/live_session.hpp"
#include "service/live/map_channel.hpp"
#include "service/live/page_service.hpp"
#include "service/live/serve_options.hpp"
#include "service/live/service_settings.hpp"
#include "service/live/steered_walk.hpp"
#include "surefoot/gate/attestation.hpp"
#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/io/settings/model_file.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/sim/scene_source.hpp"

namespace surefoot::app {

/// Runs perception on its own thread, beside the gate process and an optional steered walk. The
/// thread of run() supervises the gate independently of perception, so that a hanging frame cannot
/// delay the restart of the gate.
class LiveService {
  public:
    LiveService(const ServeOptions& options,
                Settings settings,
                const std::optional<io::MachineFile>& machine,
                const std::optional<io::MachineModel>& model,
                Executor& executor)
        : options_(options),
          settings_(std::move(settings)),
          machine_(machine),
          model_(model),
          executor_(executor) {}

    Status run();
    [[nodiscard]] const std::vector<AskedStep>& steps() const noexcept { return steps_; }

  private:
    Status perceive(std::unique_ptr<camera::FrameSource> source,
                    gate_process::SnapshotWriter& writer);
    Result<LiveSession::End> perceive_anew(camera::FrameSource& source,
                                           gate_process::SnapshotWriter& writer);
    Status perceive_beside(GateChild& gate,
                           std::unique_ptr<camera::FrameSource> source,
                           MapChannel& channel);
    Status introduce(const camera::FrameSource& source,
                     const gate_process::Access& access,
                     std::uint16_t gate_port);
    void offer_settings(bool is_scene);
    void offer_recording(const camera::FrameSource& source);
    Status apply(const ServiceConfig& wanted);
    Result<std::string> change(const page::SettingWish& wish);
    Status steer(camera::FrameSource& source,
                 const std::string& rider_token,
                 std::uint16_t gate_port);
    void follow_walk(sim::SceneSource& scene, const LiveSession& session);
    bool follow_pages(LiveSession& session, const gate_process::SnapshotWriter& writer);
    std::optional<int> next_jump(LiveSession::End end);
    void tell_where(const GateChild& gate);
    void look_after(GateChild& gate, MapChannel& channel);
    void remember_word(const LiveSession& session);
    void draw(const AskedStep& step, const grid::MapSnapshot& map);

    const ServeOptions& options_;
    Settings settings_;  ///< settings, adapted to the rig of the source
    const std::optional<io::MachineFile>& machine_;
    const std::optional<io::MachineModel>& model_;
    Executor& executor_;
    /// Declared before `page_`, so it is destroyed later: pages change these settings.
    std::optional<ServiceSettings> service_settings_;
    std::atomic<int> niceness_{0};
    std::atomic<double> scene_speed_{0.0};
    std::unique_ptr<PageService> page_;
    std::optional<FrameRecorder> recorder_;  ///< destroyed before `page_`, to which it reports
    page::PageHello hello_;
    double speed_ = 1.0;  ///< playback speed relative to real time; 0 = unpaced
    std::unique_ptr<SteeredWalk> walk_;
    std::vector<AskedStep> steps_;
    gate::Attestation word_;
    bool word_given_ = false;
};

}  // namespace surefoot::app

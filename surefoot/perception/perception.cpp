// SPDX-License-Identifier: Apache-2.0
#include "surefoot/perception.hpp"

#include <utility>

#include "surefoot/gate/verdict_text.hpp"
#include "surefoot/io/recordings/recording.hpp"
#include "surefoot/machines/built_in_machines.hpp"
#include "surefoot/perception/fit_settings.hpp"

namespace surefoot {

Result<std::unique_ptr<camera::FrameSource>> open_recording(const std::string& path,
                                                            const std::string& rig_file) {
    io::OpenOptions options;
    if (!rig_file.empty()) options.rig_file = rig_file;
    return io::open_source(path, options);
}

Result<io::MachineFile> load_machine(const std::string& path_or_name) {
    return machines::load_machine(path_or_name);
}

Result<Perception> Perception::make(const camera::StereoRig& rig,
                                    std::optional<io::MachineFile> machine,
                                    Settings settings,
                                    int threads) {
    const camera::StereoRig mounted = mounted_rig(rig, machine);
    fit_settings(mounted, machine, settings);
    auto executor = make_executor(threads);
    auto pipeline = pipeline::Pipeline::make(settings.pipeline, mounted, *executor, steady_now_ns);
    if (!pipeline) return pipeline.error();
    return Perception(
        std::move(settings), std::move(machine), std::move(executor), std::move(pipeline).value());
}

Perception::Perception(Settings settings,
                       std::optional<io::MachineFile> machine,
                       std::unique_ptr<Executor> executor,
                       pipeline::Pipeline pipeline)
    : settings_(std::move(settings)),
      settings_hash_(hash_of(settings_)),
      machine_(std::move(machine)),
      executor_(std::move(executor)),
      pipeline_(std::make_unique<pipeline::Pipeline>(std::move(pipeline))),
      start_(std::in_place, *pipeline_) {}

std::span<const FrameReport> Perception::process(const StereoFrame& frame, Work work) {
    reports_.clear();
    if (is_started()) {
        reports_.push_back(pipeline_->process(frame, work));
    } else if (start_->add(*pipeline_, frame)) {
        process_kept_frames();
    }
    return reports_;
}

std::span<const FrameReport> Perception::finish() {
    reports_.clear();
    if (!is_started()) {
        start_->end(*pipeline_);
        process_kept_frames();
    }
    return reports_;
}

void Perception::process_kept_frames() {
    const pipeline::Start start = start_->take();
    start_.reset();
    for (const StereoFrame& frame : start.frames)
        reports_.push_back(pipeline_->process(frame, Work::full));
}

Result<std::unique_ptr<grid::MapSnapshot>> Perception::snapshot() const {
    auto snapshot = std::make_unique<grid::MapSnapshot>();
    if (Status made = pipeline_->snapshot(settings_hash_, *snapshot); !made) return made.error();
    return snapshot;
}

gate::Verdict Perception::verdict(std::uint8_t command) const {
    gate::Verdict refused;
    refused.command = command;
    if (!machine_ || !is_started()) return refused;
    const auto map = snapshot();
    if (!map) return refused;
    // The verdict holds for the moment right after the last frame. So the map counts as old if no
    // frame has updated it for a long time.
    const gate::GateHealth health{gate::GateState::ready, {}};
    return gate::decide(machine_->machine,
                        gate::query_at_body(command, **map),
                        **map,
                        health,
                        (*map)->pose_time_ns);
}

std::string Perception::text_of(const gate::Verdict& verdict) const {
    if (!machine_) return "no machine file was given: no movement is allowed";
    if (!is_started()) return "perception has not started: no movement is allowed";
    const auto map = snapshot();
    if (!map) return map.error().message;
    return gate::text_of(verdict, gate::query_at_body(verdict.command, **map), machine_->machine);
}

}  // namespace surefoot

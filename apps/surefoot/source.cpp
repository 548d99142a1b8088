// SPDX-License-Identifier: Apache-2.0
#include "apps/surefoot/source.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "apps/surefoot/resources.hpp"
#include "io/recording.hpp"
#include "sim/scene_source.hpp"

namespace surefoot::app {
namespace {

constexpr std::string_view kSimPrefix = "sim:";

/// Ends a source after a number of frames.
class LimitedSource final : public camera::FrameSource {
  public:
    LimitedSource(std::unique_ptr<camera::FrameSource> source, int max_frames)
        : source_(std::move(source)), info_(source_->info()), left_(max_frames) {
        if (!info_.frames || *info_.frames > max_frames) info_.frames = max_frames;
    }
    [[nodiscard]] const camera::StereoRig& rig() const override { return source_->rig(); }
    [[nodiscard]] const camera::SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override {
        if (left_-- <= 0) return std::optional<StereoFrame>{};
        return source_->next();
    }

  private:
    std::unique_ptr<camera::FrameSource> source_;
    camera::SourceInfo info_;
    int left_;
};

Result<std::unique_ptr<camera::FrameSource>> open_simulation(const SourceRequest& request,
                                                             Executor& executor) {
    if (!request.rig_file.empty()) {
        return usage_error(
            fmt::format("--rig {}: simulated scenes bring their own rig", request.rig_file));
    }
    sim::SceneOptions options;
    options.scene = request.source.substr(kSimPrefix.size());
    options.seed = request.seed;
    options.frames = request.max_frames;
    if (request.rate_hz > 0.0) options.rate_hz = request.rate_hz;
    auto scene = sim::open_scene(options, &executor);
    if (!scene) return scene.error();
    return std::unique_ptr<camera::FrameSource>(std::move(scene).value());
}

}  // namespace

Result<std::unique_ptr<camera::FrameSource>> open_source(const SourceRequest& request,
                                                         Executor& executor) {
    if (request.source.starts_with(kSimPrefix)) return open_simulation(request, executor);
    io::OpenOptions options;
    if (!request.rig_file.empty()) options.rig_file = request.rig_file;
    if (request.rate_hz > 0.0) options.rate_hz = request.rate_hz;
    auto source = io::open_source(request.source, options);
    if (!source || request.max_frames <= 0) return source;
    return std::unique_ptr<camera::FrameSource>(
        std::make_unique<LimitedSource>(std::move(source).value(), request.max_frames));
}

Result<std::optional<io::MachineFile>> load_machine(const std::string& path_or_name) {
    if (path_or_name.empty()) return std::optional<io::MachineFile>{};
    const auto as_optional =
        [](Result<io::MachineFile> machine) -> Result<std::optional<io::MachineFile>> {
        if (!machine) return usage_error(machine.error().message);
        return std::optional<io::MachineFile>(std::move(machine).value());
    };
    if (std::filesystem::exists(path_or_name)) return as_optional(io::read_machine(path_or_name));
    const auto text = find_resource("machines", path_or_name);
    if (!text) return text.error();
    return as_optional(io::parse_machine(*text, fmt::format("machine {}", path_or_name)));
}

camera::StereoRig mounted_rig(const camera::StereoRig& rig,
                              const std::optional<io::MachineFile>& machine) {
    camera::StereoRig mounted = rig;
    if (!mounted.T_body_left && machine) mounted.T_body_left = machine->T_body_left;
    return mounted;
}

}  // namespace surefoot::app

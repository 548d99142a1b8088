// SPDX-License-Identifier: Apache-2.0
#include "service/console/source.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "service/console/interrupt.hpp"
#include "service/console/log.hpp"
#include "surefoot/camera/rig_units.hpp"
#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/recordings/imu_stream.hpp"
#include "surefoot/io/recordings/recording.hpp"
#include "surefoot/machines/built_in_machines.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot::app {
namespace {

constexpr std::string_view kSimPrefix = "sim:";

/// Ends a source after a number of frames.
class LimitedSource final : public camera::FrameSource {
  public:
    LimitedSource(std::unique_ptr<camera::FrameSource> source, int max_frames, int first_frame)
        : source_(std::move(source)), info_(source_->info()), left_(max_frames - first_frame) {
        if (!info_.frames || *info_.frames > max_frames) info_.frames = max_frames;
    }
    [[nodiscard]] const camera::StereoRig& rig() const override { return source_->rig(); }
    [[nodiscard]] const camera::SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override {
        if (left_-- <= 0) return std::optional<StereoFrame>{};
        auto frame = source_->next();
        info_.broken = source_->info().broken;
        return frame;
    }

  private:
    std::unique_ptr<camera::FrameSource> source_;
    camera::SourceInfo info_;
    int left_;
};

/// Logs the notes of the calibration reader. A recording returns only its rig, without the notes.
/// So this function reads the small file of --rig a second time, with the image size of the rig.
void log_rig_notes(const SourceRequest& request, const camera::StereoRig& rig) {
    std::vector<std::string> notes;
    if (!request.rig_file.empty()) {
        const auto file =
            io::read_rig_file(request.rig_file, io::ImageSize{rig.left.width, rig.left.height});
        if (file) notes = file->notes;
    } else if (rig.right) {
        if (auto warning = camera::baseline_warning(rig.T_left_right.translation_m.norm()))
            notes.push_back(std::move(*warning));
    }
    for (const std::string& note : notes) {
        log_warning(fmt::format(
            "{}: {}", request.rig_file.empty() ? request.source : request.rig_file, note));
    }
}

Result<std::unique_ptr<camera::FrameSource>> open_live(const SourceRequest& request) {
    const auto address =
        io::parse_live_address(std::string_view(request.source).substr(kLivePrefix.size()));
    if (!address) return address.error();
    if (request.rate_hz > 0.0) {
        return usage_error(
            fmt::format("--rate does not work with a live camera; give the rate in the source "
                        "instead: {}{}@WIDTHxHEIGHT@{:g}",
                        kLivePrefix,
                        address->device,
                        request.rate_hz));
    }
    if (request.rig_file.empty()) {
        return usage_error(
            request.source +
            ": a live camera needs a calibration; give its file, for example --rig rig.yaml");
    }
    const auto rig = read_noted_rig(request.rig_file);
    if (!rig) return rig.error();
    auto camera = io::LiveCamera::open(
        io::kernel_video_device(), *address, *rig, request.live, [] { return interrupted(); });
    if (!camera) return camera.error();
    return std::unique_ptr<camera::FrameSource>(std::move(camera).value());
}

Result<std::unique_ptr<camera::FrameSource>> open_recording(const SourceRequest& request) {
    io::OpenOptions options;
    if (!request.rig_file.empty()) options.rig_file = request.rig_file;
    if (request.rate_hz > 0.0) options.rate_hz = request.rate_hz;
    options.first_frame = request.first_frame;
    apply(request.reading, options);
    auto source = io::open_source(request.source, options);
    if (source) log_rig_notes(request, (*source)->rig());
    return source;
}

}  // namespace

Result<camera::StereoRig> read_noted_rig(const std::string& path) {
    Result<io::RigFile> file = io::read_rig_file(path);
    if (!file) return file.error();
    for (const std::string& note : file->notes) log_warning(fmt::format("{}: {}", path, note));
    return std::move(file->rig);
}

SourceRequest request_of(const SourceOptions& options,
                         const CommonOptions& common,
                         const Settings& settings) {
    return {options.source,
            options.rig_file,
            options.rate_hz,
            options.max_frames,
            common.seed,
            settings.sim,
            settings.live,
            options.imu_file,
            0,
            options.reading};
}

void apply(const ReadingOptions& reading, io::OpenOptions& options) {
    options.pair_tolerance_s = reading.pair_tolerance_s;
    options.depth_codes_per_m = reading.depth_codes_per_m;
    options.image_bits = reading.image_bits;
    options.skip_broken = reading.skip_broken;
}

Result<std::unique_ptr<sim::SceneSource>> open_simulation(const SourceRequest& request,
                                                          Executor& executor) {
    sim::SceneOptions options = request.sim;
    options.scene = request.source.starts_with(kSimPrefix)
                        ? request.source.substr(kSimPrefix.size())
                        : request.source;
    options.seed = request.seed;
    if (request.max_frames > 0) options.frames = request.max_frames;
    if (request.rate_hz > 0.0) options.rate_hz = request.rate_hz;
    if (std::filesystem::exists(request.rig_file)) {
        auto rig = read_noted_rig(request.rig_file);
        if (!rig) return rig.error();
        options.rig = *rig;
    } else if (!request.rig_file.empty()) {
        options.rig_preset = request.rig_file;
    }
    return sim::open_scene(options, &executor);
}

Result<std::unique_ptr<camera::FrameSource>> open_source(const SourceRequest& request,
                                                         Executor& executor) {
    if (request.source.starts_with(kSimPrefix)) {
        if (!request.imu_file.empty())
            return usage_error(
                "--imu does not work with a simulated scene, which has its own IMU; remove --imu "
                "and use the setting sim.imu");
        auto scene = open_simulation(request, executor);
        if (!scene) return scene.error();
        return std::unique_ptr<camera::FrameSource>(std::move(scene).value());
    }
    auto source =
        request.source.starts_with(kLivePrefix) ? open_live(request) : open_recording(request);
    if (!source) return source;
    for (const std::string& note : (*source)->info().notes) log_warning(note);
    if (!request.imu_file.empty())
        source = io::with_imu(std::move(source).value(), request.imu_file);
    if (!source || request.max_frames <= 0) return source;
    return std::unique_ptr<camera::FrameSource>(std::make_unique<LimitedSource>(
        std::move(source).value(), request.max_frames, request.first_frame));
}

Result<camera::StereoRig> load_rig(const std::string& path_or_name) {
    if (std::filesystem::exists(path_or_name)) return read_noted_rig(path_or_name);
    return sim::rig_preset(path_or_name);
}

Result<std::optional<io::MachineFile>> load_machine(const std::string& path_or_name) {
    if (path_or_name.empty()) return std::optional<io::MachineFile>{};
    auto machine = machines::load_machine(path_or_name);
    if (!machine) return machine.error();
    for (const std::string& note : machine->notes) log_warning(note);
    for (const io::Deviation& deviation : machine->deviations)
        log_warning(path_or_name + ": " + io::text_of(deviation));
    return std::optional<io::MachineFile>(std::move(machine).value());
}

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/perception/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <thread>

#include "surefoot/core/fnv1a.hpp"
#include "surefoot/core/nearest_names.hpp"
#include "surefoot/perception/thread_pool.hpp"

namespace surefoot {

void Settings::describe(ConfigVisitor& visitor) {
    pipeline.describe(visitor);
    visitor.begin_group("eval");
    visitor.group("maps", maps);
    visitor.group("m3c2", m3c2);
    visitor.end_group();
    visitor.begin_group("sim");
    sim.describe(visitor);
    visitor.group("laser", laser);
    visitor.end_group();
    visitor.group("live", live);
}

Result<Settings> load_settings(const SettingsRequest& request, io::Notes* notes) {
    Settings settings;
    const auto describe = io::describe_config(settings);
    if (!request.preset.empty()) {
        const auto preset = traversability::preset(request.preset);
        if (!preset) {
            const std::vector<std::string> names(std::begin(traversability::kPresetNames),
                                                 std::end(traversability::kPresetNames));
            const std::string likely = did_you_mean(request.preset, names);
            return usage_error(
                fmt::format("--preset {}: there is no such preset{} Known presets: {}",
                            request.preset,
                            likely.empty() ? "." : likely,
                            fmt::join(names, ", ")));
        }
        settings.pipeline.traversability = *preset;
    }
    if (auto status = apply_overrides(request, describe, notes); !status) return status.error();
    if (const auto problem = settings.pipeline.problem()) return usage_error(*problem);
    if (const auto problem = settings.live.problem()) return usage_error(*problem);
    const bool own_view = settings.pipeline.camera != camera::RectificationConfig{};
    if (settings.sim.sensor == sim::Sensor::analytic && own_view) {
        return usage_error(
            "camera.rectified_focal_px, .rectified_width_px, .rectified_height_px and "
            ".max_view_deg cannot be set with sim.sensor = analytic, because this "
            "sensor computes rectified depth; remove these settings or choose another sim.sensor");
    }
    return settings;
}

Status apply_overrides(const SettingsRequest& request,
                       const io::DescribeConfig& describe,
                       io::Notes* notes) {
    if (!request.config_file.empty()) {
        // An unreadable settings file is a usage error, like a wrong key in the file.
        if (auto status = io::read_config(request.config_file, describe, notes); !status)
            return usage_error(status.error().message);
    }
    for (const std::string& setting : request.overrides) {
        if (auto status = io::override_config(setting, describe, notes); !status) return status;
    }
    return {};
}

std::uint64_t hash_of(const Settings& settings) {
    std::string text;
    for (const io::ConfigEntry& entry : io::list_config_of(settings))
        text += entry.key + "=" + entry.value + "\n";
    return fnv1a(text);
}

std::unique_ptr<Executor> make_executor(int threads) {
    if (threads <= 0) threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    if (threads == 1) return std::make_unique<Serial>();
    return std::make_unique<ThreadPool>(threads);
}

std::int64_t steady_now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace surefoot

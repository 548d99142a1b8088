// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>

#include "io/file.hpp"
#include "io/recorder.hpp"
#include "io/recording.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::io {
namespace {

constexpr double kGapFactor = 1.5;

std::int64_t median(std::vector<std::int64_t> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

void describe_stamps(const std::vector<FrameEntry>& frames, RecordingInfo& info) {
    std::vector<std::int64_t> intervals_ns;
    for (std::size_t i = 1; i < frames.size(); ++i) {
        const std::int64_t interval_ns = frames[i].time_ns - frames[i - 1].time_ns;
        if (interval_ns > 0) {
            intervals_ns.push_back(interval_ns);
        } else {
            ++info.bad_stamps;
        }
    }
    if (intervals_ns.empty()) return;
    info.duration_s = seconds_from_ns(frames.back().time_ns - frames.front().time_ns);
    const std::int64_t typical_ns = median(intervals_ns);
    info.rate_hz = 1e9 / static_cast<double>(typical_ns);
    for (const std::int64_t interval_ns : intervals_ns) {
        if (static_cast<double>(interval_ns) <= kGapFactor * static_cast<double>(typical_ns))
            continue;
        ++info.gaps;
        info.longest_gap_s = std::max(info.longest_gap_s, seconds_from_ns(interval_ns));
    }
}

void describe_files(const std::vector<FrameEntry>& frames, RecordingInfo& info) {
    for (const FrameEntry& frame : frames) {
        for (const std::string& path : {frame.left, frame.right}) {
            if (path.empty()) continue;
            std::error_code error;
            const auto bytes = std::filesystem::file_size(path, error);
            if (!error) {
                info.bytes += static_cast<std::int64_t>(bytes);
            } else if (info.missing_images++ == 0) {
                info.first_missing = path;
            }
        }
    }
}

void describe_imu(const std::vector<ImuSample>& samples, RecordingInfo& info) {
    info.imu_samples = static_cast<int>(samples.size());
    std::vector<std::int64_t> intervals_ns;
    for (std::size_t i = 1; i < samples.size(); ++i) {
        intervals_ns.push_back(samples[i].time_ns - samples[i - 1].time_ns);
    }
    if (!intervals_ns.empty()) info.imu_rate_hz = 1e9 / static_cast<double>(median(intervals_ns));
}

Result<RecordingInfo> inspect_video(const std::string& path, const OpenOptions& options) {
    const auto source = open_video(path, options);
    if (!source) return source.error();
    RecordingInfo info;
    info.kind = (*source)->info().kind;
    info.rig = (*source)->rig();
    info.frames = (*source)->info().frames.value_or(0);
    info.rate_hz = info.rig.rate_hz;
    info.duration_s = info.frames > 1 ? (info.frames - 1) / info.rate_hz : 0.0;
    std::error_code ignored;
    info.bytes = static_cast<std::int64_t>(std::filesystem::file_size(path, ignored));
    return info;
}

}  // namespace

Result<RecordingInfo> inspect(const std::string& path, const OpenOptions& options) {
    if (is_file(path) && is_video_name(path)) return inspect_video(path, options);
    const Result<Recording> recording = index_recording(path, options);
    if (!recording) return recording.error();
    RecordingInfo info;
    info.kind = recording->info.kind;
    info.rig = recording->rig;
    info.frames = static_cast<int>(recording->frames.size());
    info.unpaired = recording->unpaired;
    describe_stamps(recording->frames, info);
    describe_files(recording->frames, info);
    describe_imu(recording->imu, info);
    for (const char* name : {"groundtruth.tum", "groundtruth.txt", "poses.txt"}) {
        info.has_truth = info.has_truth || is_file(join_path(path, name));
    }
    return info;
}

}  // namespace surefoot::io

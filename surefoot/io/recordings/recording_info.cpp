// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>

#include "surefoot/core/time.hpp"
#include "surefoot/geometry/statistics.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/recordings/recorder.hpp"
#include "surefoot/io/recordings/recording.hpp"

namespace surefoot::io {
namespace {

constexpr double kGapFactor = 1.5;

void describe_stamps(const std::vector<std::int64_t>& times_ns, RecordingInfo& info) {
    std::vector<std::int64_t> intervals_ns;
    for (std::size_t i = 1; i < times_ns.size(); ++i) {
        const std::int64_t interval_ns = times_ns[i] - times_ns[i - 1];
        if (interval_ns > 0) {
            intervals_ns.push_back(interval_ns);
        } else {
            ++info.bad_stamps;
        }
    }
    if (intervals_ns.empty()) return;
    info.duration_s = seconds_from_ns(times_ns.back() - times_ns.front());
    const std::int64_t typical_ns = upper_median(intervals_ns);
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
    if (!intervals_ns.empty())
        info.imu_rate_hz = 1e9 / static_cast<double>(upper_median(intervals_ns));
}

/// Decodes a video to its end, because its container may announce missing frames.
Result<RecordingInfo> inspect_video(const std::string& path, const OpenOptions& options) {
    const auto source = open_video(path, options);
    if (!source) return source.error();
    RecordingInfo info;
    std::vector<std::int64_t> times_ns;
    while (true) {
        const auto frame = (*source)->next();
        if (!frame) {
            if (info.incomplete.empty()) info.incomplete = frame.error().message;
            continue;
        }
        if (!frame->has_value()) break;
        times_ns.push_back((*frame)->time_ns);
    }
    if (times_ns.empty() && !info.incomplete.empty()) return input_error(info.incomplete);
    const camera::SourceInfo& about = (*source)->info();
    info.kind = about.kind;
    info.notes = about.notes;
    info.rig = (*source)->rig();
    info.frames = static_cast<int>(times_ns.size());
    info.announced_frames = about.frames;
    info.rate_hz = info.rig.rate_hz;
    describe_stamps(times_ns, info);
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
    info.pair_tolerance_s = recording->pair_tolerance_s;
    info.largest_pair_difference_s = recording->largest_pair_difference_s;
    info.notes = recording->info.notes;
    std::vector<std::int64_t> times_ns;
    for (const FrameEntry& frame : recording->frames) times_ns.push_back(frame.time_ns);
    describe_stamps(times_ns, info);
    describe_files(recording->frames, info);
    describe_imu(recording->imu, info);
    for (const char* name : {"groundtruth.tum", "groundtruth.txt", "poses.txt"}) {
        info.has_truth = info.has_truth || is_file(join_path(path, name));
    }
    return info;
}

}  // namespace surefoot::io

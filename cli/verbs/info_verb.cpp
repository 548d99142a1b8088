// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/cameras.hpp"
#include "cli/json/recording_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "surefoot/io/recordings/recorder.hpp"

namespace surefoot::app {
namespace {

struct InfoOptions {
    CommonOptions common;
    ReadingOptions reading;
    std::string source;
    std::string rig_file;
};

int info_of_camera(const InfoOptions& options) {
    const auto address =
        io::parse_live_address(std::string_view(options.source).substr(kLivePrefix.size()));
    if (!address) return report(address.error());
    const auto view = camera_view(address->device);
    if (!view) return report(view.error());
    if (options.common.json) {
        print_answer(camera_view_json(*view));
        return kExitOk;
    }
    fmt::print("{}: {} (driver {})\n", view->device, view->card, view->driver);
    for (const io::VideoMode& mode : view->modes)
        fmt::print(
            "  {} {}x{} px at {:.4g} Hz\n", mode.fourcc, mode.width, mode.height, mode.rate_hz);
    for (const io::VideoControl& control : view->controls) {
        fmt::print("  {}: {} ({} .. {}, step {}{})\n",
                   control.name,
                   control.value ? fmt::format("{}", *control.value) : "not readable",
                   control.min,
                   control.max,
                   control.step,
                   control.writable ? "" : ", the camera does not allow a change now");
    }
    return kExitOk;
}

/// `surefoot info`: describes a source.
int info(const InfoOptions& options) {
    if (options.source.starts_with(kLivePrefix)) return info_of_camera(options);
    io::OpenOptions open;
    if (!options.rig_file.empty()) open.rig_file = options.rig_file;
    apply(options.reading, open);
    const auto found = io::inspect(options.source, open);
    if (!found) return report(found.error());
    if (options.common.json) {
        print_answer(recording_json(*found));
        return kExitOk;
    }
    const io::RecordingInfo& i = *found;
    fmt::print("{}: {} frames over {:.2f} s at {:.2f} Hz, {:.1f} MB of images\n",
               i.kind,
               i.frames,
               i.duration_s,
               i.rate_hz,
               static_cast<double>(i.bytes) * 1e-6);
    if (i.announced_frames && *i.announced_frames != i.frames) {
        fmt::print("the video file announces {} frames, but {} frames can be decoded\n",
                   *i.announced_frames,
                   i.frames);
    }
    if (!i.incomplete.empty()) fmt::print("incomplete: {}\n", i.incomplete);
    if (i.pair_tolerance_s > 0.0) {
        fmt::print(
            "pairs: the time stamps of left and right image differ by up to {:.3f} ms; the limit "
            "is {:g} ms\n",
            1e3 * i.largest_pair_difference_s,
            1e3 * i.pair_tolerance_s);
    }
    for (const std::string& note : i.notes) fmt::print("note: {}\n", note);
    fmt::print(
        "gaps: {} (longest {:.3f} s), images without a partner in the other camera: {}, missing "
        "images: {}{}\n",
        i.gaps,
        i.longest_gap_s,
        i.unpaired,
        i.missing_images,
        i.first_missing.empty() ? "" : fmt::format(" (first: {})", i.first_missing));
    fmt::print(
        "time stamps that do not increase: {}, IMU: {} samples at {:.1f} Hz, ground truth: {}\n",
        i.bad_stamps,
        i.imu_samples,
        i.imu_rate_hz,
        i.has_truth ? "yes" : "no");
    fmt::print("left camera {}x{} px, baseline {:.1f} mm\n",
               i.rig.left.width,
               i.rig.left.height,
               1e3 * i.rig.T_left_right.translation_m.norm());
    return kExitOk;
}

}  // namespace

void add_info(VerbGroup verbs) {
    auto [verb, o] =
        verbs.add<InfoOptions>("info",
                               "show the contents of a recording (frames, rate, gaps, calibration, "
                               "IMU), or the modes and controls of a live camera (v4l2:DEVICE)",
                               "surefoot info out/floor_recording --json",
                               info,
                               Reads::no_settings);
    add_reading(verb, o.reading);
    verb.option("source",
                o.source,
                "recording or live camera: a folder in EuRoC, KITTI or TUM RGB-D layout, a folder "
                "or video of side-by-side images, or v4l2:DEVICE")
        .required()
        .value("SOURCE");
    verb.option(
            "--rig", o.rig_file, "calibration file; it replaces the calibration of the recording")
        .value("FILE");
}

}  // namespace surefoot::app

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "surefoot/io/file.hpp"
#include "surefoot/io/recordings/mjpeg_source.hpp"
#include "surefoot/io/recordings/recording.hpp"
#include "surefoot/io/recordings/video_frames.hpp"

namespace surefoot::io {
namespace {

constexpr double kDefaultRate_hz = 15.0;

double rate_of(const camera::StereoRig& rig) {
    return rig.rate_hz > 0.0 ? rig.rate_hz : kDefaultRate_hz;
}

/// Reads side-by-side frames of a video file. `rate_hz` replaces the times of the container.
class VideoSource final : public camera::FrameSource {
  public:
    VideoSource(std::string path,
                VideoFrames frames,
                camera::StereoRig rig,
                std::optional<double> rate_hz)
        : frames_(std::move(frames)), rig_(std::move(rig)), rate_hz_(rate_hz) {
        note_rate();
        fit_rig(rig_, one_camera(ImageSize{frames_.width(), frames_.height()}), info_.notes);
        info_.kind = "video";
        info_.path = std::move(path);
        if (frames_.count() > 0) info_.frames = frames_.count();
    }

    [[nodiscard]] const camera::StereoRig& rig() const override { return rig_; }
    [[nodiscard]] const camera::SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override {
        Result<std::optional<VideoFrame>> image = frames_.next();
        if (!image) return image.error();
        if (!image->has_value()) return std::optional<StereoFrame>();
        const std::string what = fmt::format("frame {}: {}", index_, info_.path);
        StereoFrame frame;
        frame.index = index_;
        frame.time_ns =
            rate_hz_ || !(*image)->time_ns ? stamp_at(index_, rig_.rate_hz) : *(*image)->time_ns;
        ++index_;
        if (Status status = split_side_by_side((*image)->image, rig_, what, frame); !status)
            return status.error();
        return std::optional<StereoFrame>(std::move(frame));
    }

  private:
    /// Sets the rate of the rig: from --rate, else the container, else the rig, else 15 Hz. Adds a
    /// note if the rates of rig and container differ by more than 5 %.
    void note_rate() {
        const double of_rig_hz = rig_.rate_hz;
        const double of_video_hz = frames_.rate_hz();
        rig_.rate_hz = rate_hz_.value_or(of_video_hz > 0.0 ? of_video_hz : rate_of(rig_));
        constexpr double kSameShare = 0.05;
        if (rate_hz_ || of_rig_hz <= 0.0 || of_video_hz <= 0.0 ||
            std::abs(of_rig_hz - of_video_hz) <= kSameShare * of_video_hz) {
            return;
        }
        info_.notes.push_back(
            fmt::format("the rig says {:g} Hz, but the video has {:g} frames per second (mean). "
                        "The program uses the times of the video; --rate {:g} replaces them",
                        of_rig_hz,
                        of_video_hz,
                        of_rig_hz));
    }

    VideoFrames frames_;
    camera::StereoRig rig_;
    camera::SourceInfo info_;
    std::optional<double> rate_hz_;
    int index_ = 0;
};

/// Returns the rig of a video; `size` is the image size of one camera, if known.
Result<camera::StereoRig> rig_of(const std::string& path,
                                 const OpenOptions& options,
                                 std::optional<ImageSize> size) {
    Result<std::optional<camera::StereoRig>> rig = read_rig_beside(folder_of(path), options, size);
    if (!rig) return rig.error();
    if (!rig->has_value()) {
        return input_error(fmt::format(
            "{}: this video has no rig; put a rig.yaml beside the video or give a rig with --rig",
            path));
    }
    return **rig;
}

Result<std::unique_ptr<camera::FrameSource>> open_motion_jpeg(const std::string& path,
                                                              const OpenOptions& options) {
    const Result<camera::StereoRig> rig = rig_of(path, options, {});
    if (!rig) return rig.error();
    const Result<double> rate_hz = chosen_rate_hz(options, rate_of(*rig));
    if (!rate_hz) return rate_hz.error();
    return open_mjpeg(path, *rig, *rate_hz);
}

}  // namespace

bool is_video_name(const std::string& path) {
    static const std::vector<std::string> extensions{
        ".avi", ".mp4", ".mkv", ".mov", ".webm", ".mpg", ".m4v", ".mjpeg", ".mjpg"};
    return std::find(extensions.begin(), extensions.end(), extension_of(path)) != extensions.end();
}

Result<std::unique_ptr<camera::FrameSource>> open_video(const std::string& path,
                                                        const OpenOptions& options) {
    if (extension_of(path) == ".mjpeg" || extension_of(path) == ".mjpg")
        return open_motion_jpeg(path, options);
    Result<VideoFrames> frames = VideoFrames::open(path);
    if (!frames) return frames.error();
    const Result<camera::StereoRig> rig =
        rig_of(path, options, one_camera(ImageSize{frames->width(), frames->height()}));
    if (!rig) return rig.error();
    if (options.rate_hz) {
        if (const Result<double> checked = chosen_rate_hz(options, 0.0); !checked)
            return checked.error();
    }
    return std::unique_ptr<camera::FrameSource>(
        std::make_unique<VideoSource>(path, std::move(frames).value(), *rig, options.rate_hz));
}

}  // namespace surefoot::io

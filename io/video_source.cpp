// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "io/file.hpp"
#include "io/image_file.hpp"
#include "io/mjpeg_source.hpp"
#include "io/recording.hpp"

namespace surefoot::io {
namespace {

constexpr double kDefaultRate_hz = 15.0;

GreyImage grey_of(const cv::Mat& image) {
    GreyImage grey(image.cols, image.rows);
    for (int v = 0; v < image.rows; ++v) {
        const std::uint8_t* in = image.ptr<std::uint8_t>(v);
        std::uint8_t* out = grey.row(v);
        if (image.channels() == 1) {
            std::copy(in, in + image.cols, out);
        } else {
            for (int u = 0; u < image.cols; ++u) {
                out[u] = grey_bt601(in[3 * u + 2], in[3 * u + 1], in[3 * u]);
            }
        }
    }
    return grey;
}

/// Side-by-side frames of a video file at a constant rate.
class VideoSource final : public camera::FrameSource {
  public:
    VideoSource(std::string path,
                const cv::VideoCapture& capture,
                camera::StereoRig rig,
                std::optional<ImageSize> size,
                double rate_hz)
        : capture_(capture), rig_(std::move(rig)), rate_hz_(rate_hz) {
        rig_.rate_hz = rate_hz;
        fit_rig(rig_, size, info_.notes);
        info_.kind = "video";
        info_.path = std::move(path);
        // Containers guess this number from duration and rate; some do not know it at all.
        const double frames = capture_.get(cv::CAP_PROP_FRAME_COUNT);
        if (frames > 0.0 && frames < 1e9) info_.frames = static_cast<int>(frames);
    }

    [[nodiscard]] const camera::StereoRig& rig() const override { return rig_; }
    [[nodiscard]] const camera::SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override {
        const std::string what = fmt::format("frame {}: {}", index_, info_.path);
        cv::Mat image;
        try {
            if (!capture_.read(image)) image.release();
        } catch (const cv::Exception&) {
            return input_error(what + ": cannot be decoded");
        }
        if (image.empty()) {
            if (index_ > 0) return std::optional<StereoFrame>();
            return input_error(info_.path + ": a video without a single frame");
        }
        if (image.depth() != CV_8U || (image.channels() != 1 && image.channels() != 3)) {
            return input_error(what + ": pixels must be 8-bit grey or colour");
        }
        StereoFrame frame;
        frame.index = index_;
        frame.time_ns = stamp_at(index_, rate_hz_);
        ++index_;
        if (Status status = split_side_by_side(grey_of(image), rig_, what, frame); !status) {
            return status.error();
        }
        return std::optional<StereoFrame>(std::move(frame));
    }

  private:
    cv::VideoCapture capture_;
    camera::StereoRig rig_;
    camera::SourceInfo info_;
    double rate_hz_;
    int index_ = 0;
};

double rate_of(const camera::StereoRig& rig) {
    return rig.rate_hz > 0.0 ? rig.rate_hz : kDefaultRate_hz;
}

/// The rig of a video of one eye's `size`, if that is known.
Result<camera::StereoRig> rig_of(const std::string& path,
                                 const OpenOptions& options,
                                 std::optional<ImageSize> size) {
    Result<std::optional<camera::StereoRig>> rig = read_rig_beside(folder_of(path), options, size);
    if (!rig) return rig.error();
    if (!rig->has_value()) {
        return input_error(fmt::format(
            "{}: a video but no rig; put a rig.yaml beside it or give one with --rig", path));
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
    cv::VideoCapture capture;
    bool opened = false;
    try {
        // Only backends that read files: asked in general, OpenCV also searches for cameras on USB.
        opened = capture.open(path, cv::CAP_FFMPEG) || capture.open(path, cv::CAP_OPENCV_MJPEG);
    } catch (const cv::Exception&) {  // reported below, in our words
    }
    if (!opened)
        return input_error(path + ": cannot be opened as a video (damaged, or unknown codec)");
    const std::optional<ImageSize> size =
        one_eye(ImageSize{static_cast<int>(capture.get(cv::CAP_PROP_FRAME_WIDTH)),
                          static_cast<int>(capture.get(cv::CAP_PROP_FRAME_HEIGHT))});
    const Result<camera::StereoRig> rig = rig_of(path, options, size);
    if (!rig) return rig.error();
    double own_hz = capture.get(cv::CAP_PROP_FPS);
    if (!(own_hz >= 0.1 && own_hz <= 1000.0)) own_hz = rate_of(*rig);
    const Result<double> rate_hz = chosen_rate_hz(options, own_hz);
    if (!rate_hz) return rate_hz.error();
    return std::unique_ptr<camera::FrameSource>(
        std::make_unique<VideoSource>(path, std::move(capture), *rig, size, *rate_hz));
}

}  // namespace surefoot::io

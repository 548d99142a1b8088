// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/recordings/video_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/videoio.hpp>
#include <vector>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/geometry/statistics.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"

namespace surefoot::io {
namespace {

/// Computes frame times from the positions that the decoder reports [ms]. OpenCV reports 0 for
/// frames that the decoder returns only at the end of the file, and for containers without times.
class FrameTimes {
  public:
    [[nodiscard]] std::optional<std::int64_t> next(double position_ms, double rate_hz) {
        const int index = index_++;
        if (!std::isfinite(position_ms)) position_ms = 0.0;
        if (index == 1 && position_ms <= last_ms_) container_has_times_ = false;
        if (!container_has_times_) {
            if (rate_hz <= 0.0) return std::nullopt;
            last_ms_ = first_ms_ + 1e3 * index / rate_hz;
        } else if (index == 0) {
            last_ms_ = first_ms_ = std::max(position_ms, 0.0);
        } else if (position_ms > last_ms_) {
            intervals_ms_.push_back(position_ms - last_ms_);
            last_ms_ = position_ms;
        } else {
            last_ms_ += typical_ms();
        }
        return saturated_integer<std::int64_t>(std::round(1e6 * last_ms_));
    }
    /// Returns the time from the start of the first frame to the end of the last frame [s].
    [[nodiscard]] double duration_s(double rate_hz) {
        const double last_s = intervals_ms_.empty() ? 1.0 / rate_hz : 1e-3 * typical_ms();
        return 1e-3 * (last_ms_ - first_ms_) + last_s;
    }

  private:
    [[nodiscard]] double typical_ms() { return upper_median_in_place(intervals_ms_); }
    int index_ = 0;
    bool container_has_times_ = true;
    double first_ms_ = 0.0;
    double last_ms_ = 0.0;
    std::vector<double> intervals_ms_;
};

GreyImage grey_of(const cv::Mat& image) {
    GreyImage grey(image.cols, image.rows);
    for (int v = 0; v < image.rows; ++v) {
        const auto* in = image.ptr<std::uint8_t>(v);
        std::uint8_t* out = grey.row(v);
        for (int u = 0; u < image.cols; ++u) {
            const std::uint8_t* pixel = in + u * image.channels();
            out[u] = image.channels() == 1 ? *pixel : grey_bt601(pixel[2], pixel[1], pixel[0]);
        }
    }
    return grey;
}

/// Returns the tolerated missing part of the announced duration [s]. AVI counts its frames; MP4
/// also counts frames outside its edit list; other containers give a duration that includes the
/// sound.
double allowed_shortage_s(const std::string& path, double rate_hz) {
    const std::string extension = extension_of(path);
    if (extension == ".avi") return 0.5 / rate_hz;
    if (extension == ".mp4" || extension == ".m4v" || extension == ".mov") return 2.5 / rate_hz;
    return std::max(1.0, 2.5 / rate_hz);
}

}  // namespace

struct VideoFrames::Impl {
    std::string path;
    cv::VideoCapture capture;
    FrameTimes times;
    int decoded = 0;
    bool ended = false;
    std::optional<VideoFrame> held;  ///< the newest frame, until it is known to be complete

    [[nodiscard]] double get(int property) const { return capture.get(property); }
    [[nodiscard]] double rate_hz() const {
        const double rate_hz = get(cv::CAP_PROP_FPS);
        return rate_hz >= 0.1 && rate_hz <= 1000.0 ? rate_hz : 0.0;
    }
    [[nodiscard]] int count() const {
        const double frames = get(cv::CAP_PROP_FRAME_COUNT);
        // in range, as checked
        return frames > 0.0 && frames < 1e9 ? static_cast<int>(frames) : 0;
    }
    Result<std::optional<VideoFrame>> decode();
    [[nodiscard]] bool breaks_off();
};

/// Decodes the next frame; no value if the decoder returns no more frames.
Result<std::optional<VideoFrame>> VideoFrames::Impl::decode() {
    const std::string what = fmt::format("frame {}: {}", decoded, path);
    cv::Mat image;
    try {
        if (!capture.read(image)) image.release();
    } catch (const cv::Exception&) {
        ended = true;  // a second call could repeat the same failure forever
        return input_error(what + ": cannot be decoded; copy or record the file again");
    }
    if (image.empty()) return std::optional<VideoFrame>();
    if (image.depth() != CV_8U || (image.channels() != 1 && image.channels() != 3))
        return input_error(what + ": pixels must be 8-bit grey or colour");
    ++decoded;
    return std::optional<VideoFrame>(
        VideoFrame{grey_of(image), times.next(get(cv::CAP_PROP_POS_MSEC), rate_hz())});
}

/// Returns true if the frames end before the announced end. OpenCV reports a decode failure like
/// the end of the file, so the announced duration decides.
bool VideoFrames::Impl::breaks_off() {
    if (decoded >= count() || rate_hz() <= 0.0) return false;
    const double announced_s = count() / rate_hz();
    return announced_s - times.duration_s(rate_hz()) > allowed_shortage_s(path, rate_hz());
}

VideoFrames::VideoFrames(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoFrames::~VideoFrames() = default;
VideoFrames::VideoFrames(VideoFrames&&) noexcept = default;
VideoFrames& VideoFrames::operator=(VideoFrames&&) noexcept = default;

Result<VideoFrames> VideoFrames::open(const std::string& path) {
    if (Status status = files::check_input(path, limits::kStreamBytes); !status)
        return status.error();
    auto impl = std::make_unique<Impl>();
    impl->path = path;
    bool opened = false;
    try {
        // Allow only backends for files: with any backend OpenCV would also search for USB cameras.
        opened = impl->capture.open(path, cv::CAP_FFMPEG) ||
                 impl->capture.open(path, cv::CAP_OPENCV_MJPEG);
    } catch (const cv::Exception&) {  // reported below
    }
    if (!opened)
        return input_error(path +
                           ": cannot be opened as a video (damaged, or unknown codec); copy the "
                           "file again, or convert it with ffmpeg");
    return VideoFrames(std::move(impl));
}

int VideoFrames::count() const {
    return impl_->count();
}
double VideoFrames::rate_hz() const {
    return impl_->rate_hz();
}
int VideoFrames::width() const {
    return saturated_integer<int>(impl_->get(cv::CAP_PROP_FRAME_WIDTH));
}
int VideoFrames::height() const {
    return saturated_integer<int>(impl_->get(cv::CAP_PROP_FRAME_HEIGHT));
}

Result<std::optional<VideoFrame>> VideoFrames::next() {
    Impl& video = *impl_;
    while (!video.ended) {
        Result<std::optional<VideoFrame>> frame = video.decode();
        if (!frame) return frame.error();
        if (frame->has_value()) {
            std::swap(video.held, *frame);
            if (frame->has_value()) return frame;
            continue;
        }
        video.ended = true;
        if (video.decoded == 0) return input_error(video.path + ": the video has no frame");
        if (video.breaks_off()) {
            video.held.reset();
            return input_error(
                fmt::format("frame {}: {}: the video breaks off here: {} of the {} frames that its "
                            "container announces can be decoded, and the last decoded frame may be "
                            "incomplete. Copy or record the file again",
                            video.decoded - 1,
                            video.path,
                            video.decoded,
                            video.count()));
        }
    }
    return std::exchange(video.held, std::nullopt);
}

}  // namespace surefoot::io

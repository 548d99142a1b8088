// SPDX-License-Identifier: Apache-2.0
#include "io/video_frames.hpp"

#include <fmt/format.h>

#include <opencv2/videoio.hpp>

#include "io/image_file.hpp"

namespace surefoot::io {

struct VideoFrames::Impl {
    std::string path;
    cv::VideoCapture capture;
    int index = 0;
};

VideoFrames::VideoFrames(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoFrames::~VideoFrames() = default;
VideoFrames::VideoFrames(VideoFrames&&) noexcept = default;
VideoFrames& VideoFrames::operator=(VideoFrames&&) noexcept = default;

Result<VideoFrames> VideoFrames::open(const std::string& path) {
    auto impl = std::make_unique<Impl>();
    impl->path = path;
    bool opened = false;
    try {
        // Only backends that read files: asked in general, OpenCV also searches for cameras on USB.
        opened = impl->capture.open(path, cv::CAP_FFMPEG) ||
                 impl->capture.open(path, cv::CAP_OPENCV_MJPEG);
    } catch (const cv::Exception&) {  // reported below, in our words
    }
    if (!opened)
        return input_error(path + ": cannot be opened as a video (damaged, or unknown codec)");
    return VideoFrames(std::move(impl));
}

int VideoFrames::count() const {
    const double frames = impl_->capture.get(cv::CAP_PROP_FRAME_COUNT);
    return frames > 0.0 && frames < 1e9 ? static_cast<int>(frames) : 0;
}

Result<std::optional<GreyImage>> VideoFrames::next() {
    const std::string what = fmt::format("frame {}: {}", impl_->index, impl_->path);
    cv::Mat image;
    try {
        if (!impl_->capture.read(image)) image.release();
    } catch (const cv::Exception&) {
        return input_error(what + ": cannot be decoded");
    }
    if (image.empty()) return std::optional<GreyImage>();
    if (image.depth() != CV_8U || (image.channels() != 1 && image.channels() != 3))
        return input_error(what + ": pixels must be 8-bit grey or colour");
    ++impl_->index;
    GreyImage grey(image.cols, image.rows);
    for (int v = 0; v < image.rows; ++v) {
        const auto* in = image.ptr<std::uint8_t>(v);
        std::uint8_t* out = grey.row(v);
        for (int u = 0; u < image.cols; ++u) {
            const std::uint8_t* pixel = in + u * image.channels();
            out[u] = image.channels() == 1 ? *pixel : grey_bt601(pixel[2], pixel[1], pixel[0]);
        }
    }
    return std::optional<GreyImage>(std::move(grey));
}

}  // namespace surefoot::io

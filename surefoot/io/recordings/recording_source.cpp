// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <limits>

#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/recordings/imu_stream.hpp"
#include "surefoot/io/recordings/recording.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

template <typename Pixel>
std::string size_text(const Image<Pixel>& image) {
    return fmt::format("{} x {} px", image.width(), image.height());
}

template <typename Pixel, typename Other>
bool same_size(const Image<Pixel>& a, const Image<Other>& b) {
    return a.width() == b.width() && a.height() == b.height();
}

Status check_size(const GreyImage& image, const camera::StereoRig& rig, const std::string& file) {
    if (image.width() == rig.left.width && image.height() == rig.left.height) return {};
    return input_error(
        fmt::format("{}: the image is {}, but the rig is for {} x {} px; give the rig of this "
                    "resolution with --rig",
                    file,
                    size_text(image),
                    rig.left.width,
                    rig.left.height));
}

/// Reads a camera image. From 16-bit images the function uses the upper 8 of `bits` bits.
Result<GreyImage> read_camera_image(const std::string& path, int bits) {
    if (bits == 8) return read_grey_image(path);
    const Result<DepthCodes> codes = read_depth_codes(path);
    if (!codes) return codes.error();
    GreyImage image(codes->width(), codes->height());
    for (std::size_t i = 0; i < codes->size(); ++i) {
        const int value = codes->data()[i] >> (bits - 8);
        if (value > 255) {
            return input_error(
                fmt::format("{}: value {} needs more than {} bits; give the number of bits of the "
                            "camera, for example --image-bits 16",
                            path,
                            codes->data()[i],
                            bits));
        }
        image.data()[i] = static_cast<std::uint8_t>(value);
    }
    return image;
}

Status load_pair(const FrameEntry& entry,
                 const camera::StereoRig& rig,
                 int bits,
                 StereoFrame& frame) {
    Result<GreyImage> left = read_camera_image(entry.left, bits);
    if (!left) return left.error();
    if (!is_file(entry.right)) {
        return input_error(
            fmt::format("{}: the right image of this frame is missing; copy it into the recording, "
                        "or skip such frames with --skip-broken",
                        entry.right));
    }
    Result<GreyImage> right = read_camera_image(entry.right, bits);
    if (!right) return right.error();
    if (!same_size(*left, *right)) {
        return input_error(
            fmt::format("{} is {}, but {} is {}; both images of a frame must have the same size",
                        entry.left,
                        size_text(*left),
                        entry.right,
                        size_text(*right)));
    }
    if (Status status = check_size(*left, rig, entry.left); !status) return status;
    frame.left = std::move(left).value();
    frame.right = std::move(right).value();
    return {};
}

Status load_rgbd(const FrameEntry& entry,
                 const camera::StereoRig& rig,
                 float codes_per_m,
                 StereoFrame& frame) {
    Result<GreyImage> grey = read_grey_image(entry.left);
    if (!grey) return grey.error();
    const Result<DepthCodes> codes = read_depth_codes(entry.right);
    if (!codes) return codes.error();
    if (!same_size(*grey, *codes)) {
        return input_error(fmt::format(
            "{} is {}, but {} is {}; the depth image must have the size of the colour image",
            entry.left,
            size_text(*grey),
            entry.right,
            size_text(*codes)));
    }
    if (Status status = check_size(*grey, rig, entry.left); !status) return status;
    frame.left = std::move(grey).value();
    frame.depth_m.resize(codes->width(), codes->height());
    for (std::size_t i = 0; i < codes->size(); ++i) {
        const std::uint16_t code = codes->data()[i];
        frame.depth_m.data()[i] = code == 0 ? std::numeric_limits<float>::quiet_NaN()
                                            : static_cast<float>(code) / codes_per_m;
    }
    return {};
}

}  // namespace

Status RecordingSource::load_images(const FrameEntry& entry, StereoFrame& frame) const {
    switch (recording_.storage) {
        case Recording::Storage::pair:
            return load_pair(entry, recording_.rig, recording_.image_bits, frame);
        case Recording::Storage::rgbd:
            return load_rgbd(entry, recording_.rig, recording_.depth_codes_per_m, frame);
        case Recording::Storage::side_by_side: break;
    }
    const Result<GreyImage> both = read_camera_image(entry.left, recording_.image_bits);
    if (!both) return both.error();
    return split_side_by_side(*both, recording_.rig, entry.left, frame);
}

Result<std::optional<StereoFrame>> RecordingSource::next() {
    if (next_frame_ >= recording_.frames.size()) return std::optional<StereoFrame>();
    const FrameEntry& entry = recording_.frames[next_frame_];
    StereoFrame frame;
    frame.index = static_cast<int>(next_frame_++);
    frame.time_ns = entry.time_ns;
    if (last_time_ns_ && frame.time_ns <= *last_time_ns_) {
        return input_error(fmt::format(
            "frame {}: {}: time stamp {} s {}: the previous one is {} s; time stamps must increase",
            frame.index,
            entry.where,
            format_seconds(frame.time_ns),
            frame.time_ns == *last_time_ns_ ? "repeats" : "goes back",
            format_seconds(*last_time_ns_)));
    }
    if (Status status = load_images(entry, frame); !status) {
        return input_error(fmt::format("frame {}: {}", frame.index, status.error().message));
    }
    const std::int64_t oldest_ns = last_time_ns_.value_or(frame.time_ns - kFirstImuSpan_ns);
    const std::vector<ImuSample>& imu = recording_.imu;
    for (; next_imu_ < imu.size() && imu[next_imu_].time_ns <= frame.time_ns; ++next_imu_) {
        if (imu[next_imu_].time_ns > oldest_ns) frame.imu.push_back(imu[next_imu_]);
    }
    last_time_ns_ = frame.time_ns;
    return std::optional<StereoFrame>(std::move(frame));
}

namespace {

/// Opens a video at a frame. A video has no index, so earlier frames are read and dropped, damaged
/// frames included.
Result<std::unique_ptr<camera::FrameSource>> open_video_at(const std::string& path,
                                                           const OpenOptions& options) {
    auto source = open_video(path, options);
    if (!source) return source;
    for (int i = 0; i < options.first_frame; ++i) {
        const auto frame = (*source)->next();
        if (frame && !frame->has_value()) break;
    }
    return source;
}

/// Skips unusable frames; see skip_broken_frames.
class SkippingSource final : public camera::FrameSource {
  public:
    explicit SkippingSource(std::unique_ptr<camera::FrameSource> source)
        : source_(std::move(source)), info_(source_->info()) {}
    [[nodiscard]] const camera::StereoRig& rig() const override { return source_->rig(); }
    [[nodiscard]] const camera::SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override {
        for (int passed_over = 0;; ++passed_over) {
            Result<std::optional<StereoFrame>> frame = source_->next();
            if (frame) {
                if (frame->has_value()) (*frame)->frame_status.damaged += passed_over;
                return frame;
            }
            if (info_.broken.count++ == 0) info_.broken.first = frame.error().message;
        }
    }

  private:
    std::unique_ptr<camera::FrameSource> source_;
    camera::SourceInfo info_;
};

Result<std::unique_ptr<camera::FrameSource>> open_any(const std::string& path,
                                                      const OpenOptions& options) {
    if (is_file(path)) {
        if (is_video_name(path)) return open_video_at(path, options);
        return input_error(
            fmt::format("{}: a single file must be a video (.avi .mp4 .mkv .mov .webm .mpg .m4v "
                        ".mjpeg .mjpg); for images give their folder",
                        path));
    }
    if (!is_folder(path)) return input_error(fmt::format("{}: no such file or folder", path));
    Result<Recording> recording = index_recording(path, options);
    if (!recording) return recording.error();
    return std::unique_ptr<camera::FrameSource>(
        std::make_unique<RecordingSource>(std::move(recording).value(), options.first_frame));
}

}  // namespace

std::unique_ptr<camera::FrameSource> skip_broken_frames(
    std::unique_ptr<camera::FrameSource> source) {
    return std::make_unique<SkippingSource>(std::move(source));
}

Result<std::unique_ptr<camera::FrameSource>> open_source(const std::string& path,
                                                         const OpenOptions& options) {
    auto source = open_any(path, options);
    if (!source || !options.skip_broken) return source;
    return skip_broken_frames(std::move(source).value());
}

}  // namespace surefoot::io

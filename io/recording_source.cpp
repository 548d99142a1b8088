// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <limits>

#include "io/file.hpp"
#include "io/image_file.hpp"
#include "io/imu_stream.hpp"
#include "io/recording.hpp"
#include "io/text.hpp"

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
        fmt::format("{}: image is {}, but the rig is for {} x {} px: a rig for another resolution "
                    "(give the right one "
                    "with --rig)",
                    file,
                    size_text(image),
                    rig.left.width,
                    rig.left.height));
}

Status load_pair(const FrameEntry& entry, const camera::StereoRig& rig, StereoFrame& frame) {
    Result<GreyImage> left = read_grey_image(entry.left);
    if (!left) return left.error();
    if (!is_file(entry.right)) {
        return input_error(
            fmt::format("{}: the right image of this frame is missing", entry.right));
    }
    Result<GreyImage> right = read_grey_image(entry.right);
    if (!right) return right.error();
    if (!same_size(*left, *right)) {
        return input_error(
            fmt::format("{} is {}, but {} is {}; both images of a frame must be equal",
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

Status load_rgbd(const FrameEntry& entry, const camera::StereoRig& rig, StereoFrame& frame) {
    Result<GreyImage> grey = read_grey_image(entry.left);
    if (!grey) return grey.error();
    const Result<DepthCodes> codes = read_depth_codes(entry.right);
    if (!codes) return codes.error();
    if (!same_size(*grey, *codes)) {
        return input_error(fmt::format("{} is {}, but {} is {}; depth must be registered to colour",
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
                                            : static_cast<float>(code) / kDepthCodesPerMetre;
    }
    return {};
}

}  // namespace

Status RecordingSource::load_images(const FrameEntry& entry, StereoFrame& frame) const {
    switch (recording_.storage) {
        case Recording::Storage::pair: return load_pair(entry, recording_.rig, frame);
        case Recording::Storage::rgbd: return load_rgbd(entry, recording_.rig, frame);
        case Recording::Storage::side_by_side: break;
    }
    const Result<GreyImage> both = read_grey_image(entry.left);
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
        return input_error(
            fmt::format("frame {}: {}: stamp {} s {}: {} s came before; stamps must grow",
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

/// A video has no index: what comes before is read and dropped, damaged frames too.
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

}  // namespace

Result<std::unique_ptr<camera::FrameSource>> open_source(const std::string& path,
                                                         const OpenOptions& options) {
    if (is_file(path)) {
        if (is_video_name(path)) return open_video_at(path, options);
        return input_error(
            fmt::format("{}: a single file must be a video (.avi .mp4 .mkv .mov .webm .mpg .m4v "
                        ".mjpeg); for images give "
                        "their folder",
                        path));
    }
    if (!is_folder(path)) return input_error(fmt::format("{}: no such file or folder", path));
    Result<Recording> recording = index_recording(path, options);
    if (!recording) return recording.error();
    return std::unique_ptr<camera::FrameSource>(
        std::make_unique<RecordingSource>(std::move(recording).value(), options.first_frame));
}

}  // namespace surefoot::io

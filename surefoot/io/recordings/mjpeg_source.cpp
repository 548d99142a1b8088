// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/recordings/mjpeg_source.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "surefoot/files/input_file.hpp"
#include "surefoot/io/bytes.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/images/jpeg_scan.hpp"

namespace surefoot::io {
namespace {

constexpr std::string_view kStart("\xff\xd8\xff", 3);
/// Limit above the JPEG size of any camera. A file with a larger image is not an MJPEG stream.
constexpr std::size_t kMaxImageBytes = std::size_t{64} << 20;

class MjpegSource final : public camera::FrameSource {
  public:
    MjpegSource(std::string path, files::InputFile file, camera::StereoRig rig, double rate_hz)
        : file_(std::move(file)), rig_(std::move(rig)), rate_hz_(rate_hz) {
        rig_.rate_hz = rate_hz;
        info_.kind = "mjpeg";
        info_.path = std::move(path);
    }
    [[nodiscard]] const camera::StereoRig& rig() const override { return rig_; }
    [[nodiscard]] const camera::SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override {
        const std::string what = fmt::format("frame {}: {}", index_, info_.path);
        const Result<std::optional<JpegSpan>> found = find_next();
        if (!found) return end_with(found.error());
        const std::optional<JpegSpan>& span = *found;
        if (!span) {
            if (rest_.size() > kMaxImageBytes || (index_ == 0 && at_end_))
                return end_with(input_error(info_.path +
                                            ": no JPEG images in the next 64 MiB of this file; "
                                            "check that it is an MJPEG file"));
            if (rest_.find(kStart) != rest_.npos)
                return end_with(input_error(what + ": truncated: the end of the image is missing"));
            return std::optional<StereoFrame>();
        }
        StereoFrame frame;
        frame.index = index_;
        frame.time_ns = stamp_at(index_, rate_hz_);
        ++index_;
        const Result<GreyImage> image = parse_grey_image(
            std::string_view(rest_).substr(span->begin, span->end - span->begin), what);
        rest_.erase(0, span->end);
        if (!image) return image.error();
        if (Status status = split_side_by_side(*image, rig_, what, frame); !status)
            return status.error();
        return std::optional<StereoFrame>(std::move(frame));
    }

  private:
    /// Reports the error once; afterwards the source has ended.
    Error end_with(Error error) {
        rest_.clear();
        at_end_ = true;
        index_ = std::max(index_, 1);
        return error;
    }
    Result<std::optional<JpegSpan>> find_next() {
        while (true) {
            if (const auto span = first_jpeg(rest_)) return span;
            if (at_end_ || rest_.size() > kMaxImageBytes) return std::optional<JpegSpan>();
            std::string chunk(std::size_t{1} << 18, '\0');
            const Result<files::InputFile::Piece> piece = file_.read(chunk);
            if (!piece) return piece.error();
            at_end_ = piece->bytes == 0;
            rest_.append(chunk, 0, piece->bytes);
        }
    }

    files::InputFile file_;
    bool at_end_ = false;
    camera::StereoRig rig_;
    camera::SourceInfo info_;
    double rate_hz_;
    std::string rest_;  ///< bytes that are read, but not decoded yet
    int index_ = 0;
};

}  // namespace

std::optional<JpegSpan> first_jpeg(std::string_view bytes) {
    const std::size_t begin = bytes.find(kStart);
    if (begin == bytes.npos) return std::nullopt;
    std::size_t at = begin + 2;
    while (at + 1 < bytes.size()) {
        const auto marker = static_cast<std::uint8_t>(bytes[at + 1]);
        if (bytes[at] != '\xff' || marker == 0xd8) {  // damaged image, or start of the next image
            const std::size_t next = bytes.find(kStart, begin + kStart.size());
            if (next == bytes.npos) return std::nullopt;
            return JpegSpan{begin, next};
        }
        if (marker == 0xd9) return JpegSpan{begin, at + 2};
        if (marker == 0xff) {  // fill byte
            ++at;
            continue;
        }
        if (bytes.size() - at < 4) return std::nullopt;
        at += 2U + load<std::uint16_t>(bytes.data() + at + 2, std::endian::big);
        if (marker == 0xda) at = end_of_scan(bytes, at);
    }
    return std::nullopt;
}

Result<std::unique_ptr<camera::FrameSource>> open_mjpeg(const std::string& path,
                                                        const camera::StereoRig& rig,
                                                        double rate_hz) {
    Result<files::InputFile> file = files::InputFile::open(path, files::limits::kStreamBytes);
    if (!file) return file.error();
    return std::unique_ptr<camera::FrameSource>(
        std::make_unique<MjpegSource>(path, std::move(file).value(), rig, rate_hz));
}

}  // namespace surefoot::io

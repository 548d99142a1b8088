// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/recordings/recorder.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "surefoot/io/file.hpp"
#include "surefoot/io/recordings/recording_writer.hpp"
#include "surefoot/io/recordings/trajectory_file.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {

std::int64_t written_bytes(const std::string& path) noexcept {
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(path, error);
    return error ? 0 : static_cast<std::int64_t>(bytes);
}

struct Recorder::Impl {
    std::string folder;
    camera::StereoRig rig;
    std::unique_ptr<RecordingWriter> writer;
    std::optional<AppendFile> truth;
    std::optional<std::int64_t> last_frame_ns, last_truth_ns;
    int frames = 0;

    [[nodiscard]] bool fits(const StereoFrame& frame) const {
        const auto of_rig = [&](int width, int height) {
            return width == rig.left.width && height == rig.left.height;
        };
        return of_rig(frame.left.width(), frame.left.height()) &&
               (rig.right ? of_rig(frame.right.width(), frame.right.height())
                          : of_rig(frame.depth_m.width(), frame.depth_m.height()));
    }

    [[nodiscard]] Status check(const StereoFrame& frame) const {
        if (!fits(frame)) {
            const int second_width = rig.right ? frame.right.width() : frame.depth_m.width();
            const int second_height = rig.right ? frame.right.height() : frame.depth_m.height();
            return input_error(
                fmt::format("{}: frame {}: the left image has {} x {} px and the second image {} x "
                            "{} px, but the rig is for {} x {} px; give the rig of this image size",
                            folder,
                            frame.index,
                            frame.left.width(),
                            frame.left.height(),
                            second_width,
                            second_height,
                            rig.left.width,
                            rig.left.height));
        }
        if (last_frame_ns && frame.time_ns <= *last_frame_ns) {
            return input_error(fmt::format(
                "{}: frame {}: time stamp {} s does not increase: the previous one is {} s",
                folder,
                frame.index,
                format_seconds(frame.time_ns),
                format_seconds(*last_frame_ns)));
        }
        return {};
    }

    [[nodiscard]] Status add(const StereoFrame& frame) {
        if (Status s = check(frame); !s) return s;
        if (Status s = writer->add(frame); !s) return s;
        last_frame_ns = frame.time_ns;
        ++frames;
        return {};
    }
};

Recorder::Recorder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Recorder::~Recorder() = default;
Recorder::Recorder(Recorder&&) noexcept = default;
Recorder& Recorder::operator=(Recorder&&) noexcept = default;

Result<Recorder> Recorder::create(const std::string& folder,
                                  const camera::StereoRig& rig,
                                  Existing existing) {
    if (const auto problem = rig.problem()) {
        return input_error(fmt::format("{}: this rig cannot be recorded: {}", folder, *problem));
    }
    const bool is_there =
        is_file(join_path(folder, "mav0/cam0/data.csv")) || is_file(join_path(folder, "rgb.txt"));
    if (is_there && existing == Existing::refuse) {
        return output_error(folder + ": holds a recording already; choose another folder");
    }
    auto impl = std::make_unique<Impl>();
    impl->folder = folder;
    impl->rig = rig;
    impl->writer = rig.right ? make_euroc_writer(folder, rig) : make_tum_writer(folder, rig);
    if (Status status = impl->writer->start(); !status) return status.error();
    return Recorder(std::move(impl));
}

Status Recorder::add(const StereoFrame& frame) {
    return impl_->add(frame);
}

bool Recorder::read_back(StereoFrame& frame) const {
    StereoFrame images;
    images.time_ns = frame.time_ns;
    if (!impl_->writer->read_back(images) || !impl_->fits(images)) return false;
    frame.left = std::move(images.left);
    frame.right = std::move(images.right);
    frame.depth_m = std::move(images.depth_m);
    return true;
}

Status Recorder::add_truth(std::int64_t time_ns, const Pose& T_world_body) {
    if (impl_->last_truth_ns && time_ns <= *impl_->last_truth_ns) {
        return input_error(
            fmt::format("{}: the time stamp {} s of the ground truth does not increase; write "
                        "poses in order of time",
                        impl_->folder,
                        format_seconds(time_ns)));
    }
    std::string text = format_tum_trajectory({{time_ns, T_world_body}});
    if (!impl_->truth) {
        Result<AppendFile> file = AppendFile::create(join_path(impl_->folder, "groundtruth.tum"));
        if (!file) return file.error();
        impl_->truth = std::move(file).value();
    } else {
        text.erase(0, text.find('\n') + 1);  // the file already has its header line
    }
    impl_->last_truth_ns = time_ns;
    return impl_->truth->append(text);
}

Status Recorder::finish() {
    Status closed = impl_->writer->close();
    if (!impl_->truth) return closed;
    Status truth = impl_->truth->close();
    return closed.ok() ? truth : closed;
}

int Recorder::frames() const noexcept {
    return impl_->frames;
}

std::int64_t Recorder::bytes() const noexcept {
    return impl_->writer->bytes();
}

}  // namespace surefoot::io

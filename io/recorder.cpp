// SPDX-License-Identifier: Apache-2.0
#include "io/recorder.hpp"

#include <fmt/format.h>

#include <tuple>

#include "io/file.hpp"
#include "io/image_file.hpp"
#include "io/rig_file.hpp"
#include "io/text.hpp"
#include "io/trajectory_file.hpp"

namespace surefoot::io {
namespace {

constexpr const char* kFrameHead = "#timestamp [ns],filename\n";
constexpr const char* kImuHead =
    "#timestamp [ns],w_x [rad s^-1],w_y [rad s^-1],w_z [rad s^-1],a_x [m s^-2],a_y [m s^-2],a_z [m "
    "s^-2]\n";

std::string imu_line(const ImuSample& sample) {
    const Eigen::Vector3d& w = sample.angular_velocity_rad_s;
    const Eigen::Vector3d& a = sample.specific_force_m_s2;
    return fmt::format(
        "{},{},{},{},{},{},{}\n", sample.time_ns, w.x(), w.y(), w.z(), a.x(), a.y(), a.z());
}

/// A list file with its head line, and the sensor.yaml beside it.
Result<AppendFile> start_sensor(const std::string& folder,
                                const std::string& yaml,
                                const char* head) {
    if (Status status = make_folder(folder); !status) return status.error();
    if (Status status = write_file(join_path(folder, "sensor.yaml"), yaml); !status) {
        return status.error();
    }
    Result<AppendFile> list = AppendFile::create(join_path(folder, "data.csv"));
    if (!list) return list;
    if (Status status = list->append(head); !status) return status.error();
    return list;
}

}  // namespace

struct Recorder::Impl {
    std::string folder;
    camera::StereoRig rig;
    std::optional<AppendFile> left_list, right_list, imu_list, truth;
    std::optional<std::int64_t> last_frame_ns, last_imu_ns, last_truth_ns;
    int frames = 0;

    [[nodiscard]] Status start() {
        const Pose T_body_left = rig.body_from_left();
        const EurocCamera left{rig.left, T_body_left, rig.rate_hz, rig.readout_s};
        const EurocCamera right{
            *rig.right, T_body_left * rig.T_left_right, rig.rate_hz, rig.readout_s};
        for (const auto& [name, camera, list] : {std::tuple{"mav0/cam0", &left, &left_list},
                                                 std::tuple{"mav0/cam1", &right, &right_list}}) {
            const std::string path = join_path(folder, name);
            if (Status s = make_folder(join_path(path, "data")); !s) return s;
            Result<AppendFile> file = start_sensor(path, format_euroc_camera(*camera), kFrameHead);
            if (!file) return file.error();
            *list = std::move(file).value();
        }
        if (!rig.imu) return {};
        Result<AppendFile> file =
            start_sensor(join_path(folder, "mav0/imu0"), format_euroc_imu(*rig.imu), kImuHead);
        if (!file) return file.error();
        imu_list = std::move(file).value();
        return {};
    }

    [[nodiscard]] Status check(const StereoFrame& frame) const {
        const auto fits = [&](const GreyImage& image) {
            return image.width() == rig.left.width && image.height() == rig.left.height;
        };
        if (!fits(frame.left) || !fits(frame.right)) {
            return input_error(
                fmt::format("{}: frame {} is {} x {} and {} x {} px, the rig is for {} x {} px",
                            folder,
                            frame.index,
                            frame.left.width(),
                            frame.left.height(),
                            frame.right.width(),
                            frame.right.height(),
                            rig.left.width,
                            rig.left.height));
        }
        if (last_frame_ns && frame.time_ns <= *last_frame_ns) {
            return input_error(
                fmt::format("{}: frame {}: stamp {} s does not grow: {} s came before",
                            folder,
                            frame.index,
                            format_seconds(frame.time_ns),
                            format_seconds(*last_frame_ns)));
        }
        return {};
    }

    [[nodiscard]] Status add_imu(const std::vector<ImuSample>& samples) {
        if (!imu_list) return {};
        std::string lines;
        for (const ImuSample& sample : samples) {
            if (last_imu_ns && sample.time_ns <= *last_imu_ns) continue;  // seen with another frame
            lines += imu_line(sample);
            last_imu_ns = sample.time_ns;
        }
        return imu_list->append(lines);
    }

    [[nodiscard]] Status add(const StereoFrame& frame) {
        if (Status s = check(frame); !s) return s;
        const std::string name = fmt::format("{}.png", frame.time_ns);
        if (Status s = write_png(join_path(folder, "mav0/cam0/data/" + name), frame.left); !s)
            return s;
        if (Status s = write_png(join_path(folder, "mav0/cam1/data/" + name), frame.right); !s)
            return s;
        if (Status s = add_imu(frame.imu); !s) return s;
        const std::string line = fmt::format("{},{}\n", frame.time_ns, name);
        // The left list decides what a reader looks for, so it comes last.
        if (Status s = right_list->append(line); !s) return s;
        if (Status s = left_list->append(line); !s) return s;
        last_frame_ns = frame.time_ns;
        ++frames;
        return {};
    }
};

Recorder::Recorder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Recorder::~Recorder() = default;
Recorder::Recorder(Recorder&&) noexcept = default;
Recorder& Recorder::operator=(Recorder&&) noexcept = default;

Result<Recorder> Recorder::create(const std::string& folder, const camera::StereoRig& rig) {
    if (!rig.right) {
        return usage_error(folder + ": an RGB-D source cannot be recorded in the EuRoC layout");
    }
    if (const auto problem = rig.problem()) {
        return input_error(fmt::format("{}: this rig cannot be recorded: {}", folder, *problem));
    }
    if (is_file(join_path(folder, "mav0/cam0/data.csv"))) {
        return output_error(folder + ": holds a recording already; choose another folder");
    }
    auto impl = std::make_unique<Impl>();
    impl->folder = folder;
    impl->rig = rig;
    if (Status status = impl->start(); !status) return status.error();
    return Recorder(std::move(impl));
}

Status Recorder::add(const StereoFrame& frame) {
    return impl_->add(frame);
}

Status Recorder::add_truth(std::int64_t time_ns, const Pose& T_world_body) {
    if (impl_->last_truth_ns && time_ns <= *impl_->last_truth_ns) {
        return input_error(fmt::format(
            "{}: truth stamp {} s does not grow", impl_->folder, format_seconds(time_ns)));
    }
    std::string text = format_tum_trajectory({{time_ns, T_world_body}});
    if (!impl_->truth) {
        Result<AppendFile> file = AppendFile::create(join_path(impl_->folder, "groundtruth.tum"));
        if (!file) return file.error();
        impl_->truth = std::move(file).value();
    } else {
        text.erase(0, text.find('\n') + 1);  // the head is there already
    }
    impl_->last_truth_ns = time_ns;
    return impl_->truth->append(text);
}

Status Recorder::finish() {
    Status first;
    for (auto* file : {&impl_->left_list, &impl_->right_list, &impl_->imu_list, &impl_->truth}) {
        if (!file->has_value()) continue;
        Status status = (*file)->close();
        if (first.ok() && !status.ok()) first = status;
    }
    return first;
}

int Recorder::frames() const noexcept {
    return impl_->frames;
}

}  // namespace surefoot::io

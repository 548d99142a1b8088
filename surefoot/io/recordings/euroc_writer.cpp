// SPDX-License-Identifier: Apache-2.0
// Writes the EuRoC ASL layout, after Burri et al. 2016.
#include <fmt/format.h>

#include <optional>
#include <tuple>

#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/recordings/recording_writer.hpp"

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

/// Creates a list file with a header line, and the sensor.yaml beside the list.
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

class EurocWriter final : public RecordingWriter {
  public:
    EurocWriter(std::string folder, camera::StereoRig rig)
        : folder_(std::move(folder)), rig_(std::move(rig)) {}

    [[nodiscard]] Status start() override {
        const Pose T_body_left = rig_.body_from_left();
        const EurocCamera left{rig_.left, T_body_left, rig_.rate_hz, rig_.readout_s};
        const EurocCamera right{
            *rig_.right, T_body_left * rig_.T_left_right, rig_.rate_hz, rig_.readout_s};
        for (const auto& [name, camera, list] : {std::tuple{"mav0/cam0", &left, &left_list_},
                                                 std::tuple{"mav0/cam1", &right, &right_list_}}) {
            const std::string path = join_path(folder_, name);
            if (Status s = make_folder(join_path(path, "data")); !s) return s;
            Result<AppendFile> file = start_sensor(path, format_euroc_camera(*camera), kFrameHead);
            if (!file) return file.error();
            *list = std::move(file).value();
        }
        if (!rig_.imu) return {};
        Result<AppendFile> file =
            start_sensor(join_path(folder_, "mav0/imu0"), format_euroc_imu(*rig_.imu), kImuHead);
        if (!file) return file.error();
        imu_list_ = std::move(file).value();
        return {};
    }

    [[nodiscard]] Status add(const StereoFrame& frame) override {
        const std::string name = fmt::format("{}.png", frame.time_ns);
        const std::string left = join_path(folder_, "mav0/cam0/data/" + name);
        const std::string right = join_path(folder_, "mav0/cam1/data/" + name);
        if (Status s = write_png(left, frame.left); !s) return s;
        if (Status s = write_png(right, frame.right); !s) return s;
        bytes_ += written_bytes(left) + written_bytes(right);
        if (Status s = add_imu(frame.imu); !s) return s;
        const std::string line = fmt::format("{},{}\n", frame.time_ns, name);
        // Readers start with the left list, so it is written last.
        if (Status s = right_list_->append(line); !s) return s;
        return left_list_->append(line);
    }

    [[nodiscard]] bool read_back(StereoFrame& frame) const override {
        const std::string name = fmt::format("data/{}.png", frame.time_ns);
        auto left = read_grey_image(join_path(folder_, "mav0/cam0/" + name));
        auto right = read_grey_image(join_path(folder_, "mav0/cam1/" + name));
        if (!left || !right) return false;
        frame.left = std::move(left).value();
        frame.right = std::move(right).value();
        return true;
    }

    [[nodiscard]] std::int64_t bytes() const noexcept override { return bytes_; }

    [[nodiscard]] Status close() override {
        Status first;
        for (auto* file : {&left_list_, &right_list_, &imu_list_}) {
            if (!file->has_value()) continue;
            Status status = (*file)->close();
            if (first.ok() && !status.ok()) first = status;
        }
        return first;
    }

  private:
    [[nodiscard]] Status add_imu(const std::vector<ImuSample>& samples) {
        if (!imu_list_) return {};
        std::string lines;
        for (const ImuSample& sample : samples) {
            if (last_imu_ns_ && sample.time_ns <= *last_imu_ns_)
                continue;  // already written with another frame
            lines += imu_line(sample);
            last_imu_ns_ = sample.time_ns;
        }
        return imu_list_->append(lines);
    }

    std::string folder_;
    camera::StereoRig rig_;
    std::optional<AppendFile> left_list_, right_list_, imu_list_;
    std::optional<std::int64_t> last_imu_ns_;
    std::int64_t bytes_ = 0;
};

}  // namespace

std::unique_ptr<RecordingWriter> make_euroc_writer(const std::string& folder,
                                                   const camera::StereoRig& rig) {
    return std::make_unique<EurocWriter>(folder, rig);
}

}  // namespace surefoot::io

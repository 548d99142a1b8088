// SPDX-License-Identifier: Apache-2.0
// Writes the layout of the TUM RGB-D benchmark, after Sturm et al. 2012. Adds a rig.yaml of
// Surefoot for the lens and its pose.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/recordings/recording.hpp"
#include "surefoot/io/recordings/recording_writer.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

/// Returns the nearest code of each depth; 0 for a depth that is unknown or has no code.
DepthCodes codes_of(const Image<float>& depth_m) {
    constexpr auto kLast = static_cast<float>(std::numeric_limits<std::uint16_t>::max());
    DepthCodes codes(depth_m.width(), depth_m.height());
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const float code = std::round(depth_m.data()[i] * kDepthCodesPerMetre);
        codes.data()[i] =
            // in range: 1 to 65535, as checked
            code > 0.0F && code <= kLast ? static_cast<std::uint16_t>(code) : std::uint16_t{0};
    }
    return codes;
}

/// Returns the depth of each code [m]; code 0 (unknown) gives 0 m.
Image<float> depths_of(const DepthCodes& codes) {
    Image<float> depth_m(codes.width(), codes.height());
    for (std::size_t i = 0; i < codes.size(); ++i)
        depth_m.data()[i] = static_cast<float>(codes.data()[i]) / kDepthCodesPerMetre;
    return depth_m;
}

class TumWriter final : public RecordingWriter {
  public:
    TumWriter(std::string folder, camera::StereoRig rig)
        : folder_(std::move(folder)), rig_(std::move(rig)) {
        rig_.imu.reset();  // TUM RGB-D cannot store IMU samples
    }

    [[nodiscard]] Status start() override {
        for (const auto& [name, list] :
             {std::pair{"rgb", &colour_list_}, std::pair{"depth", &depth_list_}}) {
            const std::string path = join_path(folder_, name);
            if (Status s = make_folder(path); !s) return s;
            Result<AppendFile> file = AppendFile::create(path + ".txt");
            if (!file) return file.error();
            if (Status s = file->append("# timestamp [s] filename\n"); !s) return s;
            *list = std::move(file).value();
        }
        return write_rig_yaml(join_path(folder_, "rig.yaml"), rig_);
    }

    [[nodiscard]] Status add(const StereoFrame& frame) override {
        const std::string stamp = format_seconds(frame.time_ns);
        const std::string colour = fmt::format("rgb/{}.png", stamp);
        const std::string depth = fmt::format("depth/{}.png", stamp);
        if (Status s = write_png(join_path(folder_, colour), frame.left); !s) return s;
        if (Status s = write_png(join_path(folder_, depth), codes_of(frame.depth_m)); !s) return s;
        bytes_ +=
            written_bytes(join_path(folder_, colour)) + written_bytes(join_path(folder_, depth));
        if (Status s = depth_list_->append(fmt::format("{} {}\n", stamp, depth)); !s) return s;
        return colour_list_->append(fmt::format("{} {}\n", stamp, colour));
    }

    [[nodiscard]] bool read_back(StereoFrame& frame) const override {
        const std::string name = format_seconds(frame.time_ns) + ".png";
        auto grey = read_grey_image(join_path(folder_, "rgb/" + name));
        const auto codes = read_depth_codes(join_path(folder_, "depth/" + name));
        if (!grey || !codes) return false;
        frame.left = std::move(grey).value();
        frame.depth_m = depths_of(*codes);
        return true;
    }

    [[nodiscard]] std::int64_t bytes() const noexcept override { return bytes_; }

    [[nodiscard]] Status close() override {
        Status first;
        for (auto* file : {&colour_list_, &depth_list_}) {
            if (!file->has_value()) continue;
            Status status = (*file)->close();
            if (first.ok() && !status.ok()) first = status;
        }
        return first;
    }

  private:
    std::string folder_;
    camera::StereoRig rig_;
    std::optional<AppendFile> colour_list_, depth_list_;
    std::int64_t bytes_ = 0;
};

}  // namespace

std::unique_ptr<RecordingWriter> make_tum_writer(const std::string& folder,
                                                 const camera::StereoRig& rig) {
    return std::make_unique<TumWriter>(folder, rig);
}

}  // namespace surefoot::io

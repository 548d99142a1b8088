// SPDX-License-Identifier: Apache-2.0
// Reads calib_cam_to_cam.txt of KITTI's raw recordings, after Geiger et al. 2013, "Vision meets
// robotics". For each camera i the file describes the raw image (keys S, K, D), the pose (x_i = R_i
// x_0 + T_i [m]) and the rectified image (S_rect, P_rect). The common "synced+rectified" recordings
// contain rectified images.
#include <fmt/format.h>

#include <cmath>
#include <map>

#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_lens.hpp"
#include "surefoot/io/calibration/rig_values.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

struct Values {
    std::vector<double> numbers;
    int line = 0;
};

/// Finds "NAME: numbers" lines by name. Skips lines whose values are not numbers (calib_time).
class RawLines {
  public:
    RawLines(std::string_view text, std::string file) : file_(std::move(file)) {
        LineReader lines(text);
        while (const auto line = lines.next()) {
            const std::size_t colon = line->find(':');
            if (colon == line->npos) continue;
            Values values{{}, lines.number()};
            bool sound = true;
            for (const std::string_view word : split(line->substr(colon + 1))) {
                const auto value = parse_double(word);
                sound = sound && value && std::isfinite(*value);
                if (sound) values.numbers.push_back(*value);
            }
            if (sound) values_.emplace(trimmed(line->substr(0, colon)), std::move(values));
        }
    }

    [[nodiscard]] bool has(const std::string& name) const { return values_.contains(name); }
    /// Reads exactly `count` numbers; keeps the first failure.
    std::vector<double> numbers(const std::string& name, std::size_t count) {
        const auto found = values_.find(name);
        if (found == values_.end()) {
            fail(fmt::format("{}: the line '{}:' is missing or holds no numbers", file_, name));
        } else if (found->second.numbers.size() != count) {
            fail(fmt::format("{}:{}: {}: found {} numbers; exactly {} are needed",
                             file_,
                             found->second.line,
                             name,
                             found->second.numbers.size(),
                             count));
        } else {
            return found->second.numbers;
        }
        return std::vector<double>(count, 0.0);
    }
    void fail(const std::string& what) {
        if (!error_) error_ = input_error(what);
    }
    [[nodiscard]] const std::optional<Error>& error() const { return error_; }
    [[nodiscard]] const std::string& file() const { return file_; }

  private:
    std::string file_;
    std::map<std::string, Values> values_;
    std::optional<Error> error_;
};

ImageSize read_sides(RawLines& raw, const std::string& name) {
    const std::vector<double> sides = raw.numbers(name, 2);
    for (const double side_px : sides) {
        if (side_px >= 1.0 && side_px <= kMaxRigSide_px && side_px == std::floor(side_px)) continue;
        raw.fail(fmt::format("{}: {}: {} is not an image side of 1 .. {} px",
                             raw.file(),
                             name,
                             side_px,
                             kMaxRigSide_px));
        return {};
    }
    return {static_cast<int>(sides[0]), static_cast<int>(sides[1])};
}

camera::Camera read_raw_camera(RawLines& raw, const std::string& number) {
    const std::vector<double> K = raw.numbers("K_" + number, 9);
    const ImageSize size = read_sides(raw, "S_" + number);
    const auto lens = pinhole_lens({K[0], K[4], K[2], K[5]}, raw.numbers("D_" + number, 5));
    if (!lens) raw.fail(fmt::format("{}: D_{}: {}", raw.file(), number, lens.error().message));
    return {lens ? *lens : camera::CameraModel{}, size.width, size.height};
}

/// Reads the pose T_i_0 of camera i.
Pose read_raw_pose(RawLines& raw, const std::string& number) {
    const std::vector<double> R = raw.numbers("R_" + number, 9);
    const std::vector<double> T = raw.numbers("T_" + number, 3);
    if (raw.error()) return {};
    const YamlNode no_document;
    YamlReader reader(raw.file(), no_document);
    Pose pose = pose_from_parts(reader, no_document, "R_" + number, R, T);
    if (reader.error())
        raw.fail(fmt::format("{}: R_{} is not a rotation matrix", raw.file(), number));
    return pose;
}

Result<RigFile> raw_rig(RawLines& raw, const std::string& left, const std::string& right) {
    RigFile out;
    out.rig.left = read_raw_camera(raw, left);
    out.rig.right = read_raw_camera(raw, right);
    out.rig.T_left_right = read_raw_pose(raw, left) * read_raw_pose(raw, right).inverse();
    if (raw.error()) return *raw.error();
    out.notes.emplace_back("the calibration of the raw images is used (keys S, K, D, R, T)");
    return out;
}

Result<RigFile> rectified_rig(RawLines& raw,
                              const std::string& left,
                              const std::string& right,
                              std::optional<ImageSize> size) {
    KittiCalibration calibration;
    for (const auto& [index, number] : {std::pair<std::size_t, std::string>{0, left}, {1, right}}) {
        std::array<double, 12> P{};
        const std::vector<double> values = raw.numbers("P_rect_" + number, 12);
        std::copy(values.begin(), values.end(), P.begin());
        if (!(P[0] > 0.0) || !(P[5] > 0.0))
            raw.fail(fmt::format("{}: P_rect_{}: focal lengths {} and {} must be above 0 px",
                                 raw.file(),
                                 number,
                                 P[0],
                                 P[5]));
        calibration.P[index] = P;
    }
    const std::string side = "S_rect_" + left;
    const ImageSize image = raw.has(side) || !size ? read_sides(raw, side) : *size;
    if (raw.error()) return *raw.error();
    const auto rig = kitti_rig(calibration, 0, 1, image, raw.file());
    if (!rig) return rig.error();
    RigFile out;
    out.rig = *rig;
    out.notes.emplace_back(
        "the calibration of the rectified images is used (keys S_rect, P_rect). It fits recordings "
        "named 'synced+rectified'");
    return out;
}

}  // namespace

Result<RigFile> parse_kitti_raw_rig(std::string_view text,
                                    const std::string& file,
                                    std::optional<ImageSize> size) {
    RawLines raw(text, file);
    const bool grey = raw.has("P_rect_00") || raw.has("P_rect_01") || !raw.has("P_rect_02");
    const std::string left = grey ? "00" : "02";
    const std::string right = grey ? "01" : "03";
    const auto is_raw_size = [&] {
        if (!size || !raw.has("S_" + left) || !raw.has("S_rect_" + left)) return false;
        return read_sides(raw, "S_" + left) == *size && read_sides(raw, "S_rect_" + left) != *size;
    };
    Result<RigFile> out =
        is_raw_size() ? raw_rig(raw, left, right) : rectified_rig(raw, left, right, size);
    if (!out) return out;
    out->format = RigFormat::kitti_raw;
    out->rig.name = "kitti";
    out->notes.push_back(grey ? "cameras 0 and 1 (grey) are used"
                              : "cameras 2 and 3 (colour) are used");
    return checked_file(std::move(out).value(), file);
}

}  // namespace surefoot::io

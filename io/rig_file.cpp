// SPDX-License-Identifier: Apache-2.0
#include "io/rig_file.hpp"

#include <fmt/format.h>

#include "io/file.hpp"
#include "io/rig_formats.hpp"
#include "io/rig_values.hpp"
#include "io/text.hpp"
#include "io/yaml_tree.hpp"

namespace surefoot::io {
namespace {

bool has_any(const YamlNode& root, std::initializer_list<const char*> keys) {
    for (const char* key : keys) {
        if (root.find(key) != nullptr) return true;
    }
    return false;
}

bool is_opencv(const YamlNode& root) {
    return has_any(root,
                   {"M1", "K1", "D1", "cameraMatrix1", "camera_matrix_1", "camera_matrix_left"});
}

/// OpenCV's sample writes intrinsics.yml and extrinsics.yml; together they are one calibration.
Result<camera::StereoRig> read_opencv(YamlNode root,
                                      const std::string& path,
                                      std::optional<ImageSize> size) {
    const std::string beside = join_path(folder_of(path), "extrinsics.yml");
    if (has_any(root, {"R", "T"}) || !is_file(beside)) return opencv_rig(root, path, size);
    const Result<std::string> text = read_file(beside, limits::kSettingsBytes);
    if (!text) return text.error();
    const Result<YamlNode> more = parse_yaml(*text, beside);
    if (!more) return more.error();
    for (const YamlNode& item : more->items) {
        if (root.find(item.key) == nullptr) root.items.push_back(item);
    }
    return opencv_rig(root, path + " + extrinsics.yml", size);
}

Result<camera::StereoRig> read_kitti(const std::string& text,
                                     const std::string& path,
                                     std::optional<ImageSize> size) {
    if (!size) {
        return input_error(fmt::format(
            "{}: a KITTI calibration does not hold the image size; use it with its images", path));
    }
    const Result<KittiCalibration> calibration = parse_kitti_calibration(text, path);
    if (!calibration) return calibration.error();
    return kitti_rig(*calibration, 0, 1, *size, path);
}

/// A Kalibr chain names its cameras cam0, cam1.
bool is_kalibr(const YamlNode& root) {
    const YamlNode* camera = root.find("cam0");
    return camera != nullptr && camera->is_mapping();
}

bool is_ros(const YamlNode& root) {
    return has_any(root, {"camera_matrix"}) &&
           has_any(root, {"projection_matrix", "rectification_matrix", "camera_name"});
}

bool is_zed(const std::string& path, std::string_view text) {
    if (extension_of(path) == ".conf") return true;
    return lowercase(text.substr(0, text.find(']'))).find("[left_cam_") != std::string::npos;
}

Result<RigFile> read_ros(const std::string& left_file) {
    const std::optional<std::string> right_file = ros_partner(left_file);
    if (!right_file) {
        return input_error(
            fmt::format("{}: a ROS calibration has one file for each camera; give the left one, "
                        "with 'left' in its name, and put the same name with 'right' beside it",
                        left_file));
    }
    Result<std::string> left = read_file(left_file, limits::kSettingsBytes);
    if (!left) return left.error();
    Result<std::string> right = read_file(*right_file, limits::kSettingsBytes);
    if (!right) return right.error();
    return parse_ros_rig({std::move(left).value(), left_file},
                         {std::move(right).value(), *right_file});
}

/// Into a folder as left.yaml and right.yaml, or beside each other.
Result<std::vector<std::string>> write_ros(const std::string& path, const RosTexts& texts) {
    std::string left = path;
    if (extension_of(path) != ".yaml" && extension_of(path) != ".yml") {
        if (Status status = make_folder(path); !status) return status.error();
        left = join_path(path, "left.yaml");
    }
    const std::optional<std::string> right = ros_partner(left);
    if (!right) {
        return usage_error(fmt::format(
            "{}: ROS needs a file for each camera; give a folder, or the name of the left one with "
            "'left' in it",
            path));
    }
    if (Status status = write_file(left, texts.left); !status) return status.error();
    if (Status status = write_file(*right, texts.right); !status) return status.error();
    return std::vector<std::string>{left, *right};
}

Result<RigFile> with_format(Result<camera::StereoRig> rig, RigFormat format) {
    if (!rig) return rig.error();
    return RigFile{std::move(rig).value(), format, {}};
}

Result<RigFile> read_yaml_rig(const std::string& text,
                              const std::string& path,
                              std::optional<ImageSize> size) {
    const Result<YamlNode> root = parse_yaml(text, path);
    if (!root) return root.error();
    if (is_kalibr(*root)) return parse_kalibr_rig(text, path);
    if (is_ros(*root)) return read_ros(path);
    if (is_opencv(*root)) return with_format(read_opencv(*root, path, size), RigFormat::opencv);
    if (has_any(*root, {"T_BS"})) {
        return input_error(fmt::format(
            "{}: this is one sensor of an EuRoC recording; give its folder (with cam0 and cam1)",
            path));
    }
    return with_format(parse_rig_yaml(text, path), RigFormat::surefoot);
}

}  // namespace

Result<RigFile> read_rig_file(const std::string& path, std::optional<ImageSize> size) {
    if (is_folder(path)) {
        const std::string left = join_path(path, "left.yaml");
        if (is_file(left)) return read_ros(left);
        const std::string inner = join_path(path, "mav0");
        return with_format(read_euroc_rig(is_folder(inner) ? inner : path), RigFormat::euroc);
    }
    const Result<std::string> text = read_file(path, limits::kSettingsBytes);
    if (!text) return text.error();
    if (is_zed(path, *text)) return parse_zed_rig(*text, path, size);
    if (text->starts_with("P0:")) {
        return with_format(read_kitti(*text, path, size), RigFormat::kitti);
    }
    return read_yaml_rig(*text, path, size);
}

Result<camera::StereoRig> read_rig(const std::string& path, std::optional<ImageSize> size) {
    Result<RigFile> file = read_rig_file(path, size);
    if (!file) return file.error();
    return std::move(file->rig);
}

const char* name_of(RigFormat format) noexcept {
    switch (format) {
        case RigFormat::surefoot: return "surefoot";
        case RigFormat::opencv: return "opencv";
        case RigFormat::kalibr: return "kalibr";
        case RigFormat::ros: return "ros";
        case RigFormat::zed: return "zed";
        case RigFormat::euroc: return "euroc";
        case RigFormat::kitti: return "kitti";
    }
    return "?";
}

std::vector<std::string> lost_in(RigFormat format, const camera::StereoRig& rig) {
    std::vector<std::string> lost;
    if (format == RigFormat::surefoot) return lost;
    const bool has_body = format == RigFormat::euroc;
    const bool has_imu = has_body || format == RigFormat::kalibr;
    if (rig.T_body_left && !has_body) lost.emplace_back("T_body_left");
    if (rig.imu && !has_imu) lost.emplace_back("imu");
    if (rig.rate_hz > 0.0 && !has_body) lost.push_back(fmt::format("rate_hz {}", rig.rate_hz));
    if (rig.readout_s > 0.0 && !has_body) {
        lost.push_back(fmt::format("readout_s {}", rig.readout_s));
    }
    return lost;
}

Result<std::vector<std::string>> write_rig(const std::string& path,
                                           const camera::StereoRig& rig,
                                           RigFormat format) {
    using Files = std::vector<std::string>;
    if (const auto problem = rig.problem()) {
        return output_error(fmt::format("{}: this rig cannot be written: {}", path, *problem));
    }
    if (format == RigFormat::ros) {
        const Result<RosTexts> texts = format_ros_rig(rig);
        if (!texts) return output_error(fmt::format("{}: {}", path, texts.error().message));
        return write_ros(path, *texts);
    }
    Result<std::string> text =
        format == RigFormat::surefoot ? Result<std::string>(format_rig_yaml(rig))
        : format == RigFormat::opencv ? format_opencv_rig(rig)
        : format == RigFormat::kalibr ? format_kalibr_rig(rig)
        : format == RigFormat::zed
            ? format_zed_rig(rig)
            : Result<std::string>(output_error("euroc and kitti are written with recordings"));
    if (!text) return output_error(fmt::format("{}: {}", path, text.error().message));
    if (Status status = write_file(path, *text); !status) return status.error();
    return Files{path};
}

}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/calibration/rig_file.hpp"

#include <fmt/format.h>

#include "surefoot/io/calibration/calibration_kind.hpp"
#include "surefoot/io/calibration/opencv_names.hpp"
#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_values.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/settings/yaml_tree.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

/// Reads OpenCV calibrations. OpenCV's sample program writes one calibration as intrinsics.yml and
/// extrinsics.yml.
Result<RigFile> read_opencv(YamlNode root, const std::string& path, std::optional<ImageSize> size) {
    const std::string beside = join_path(folder_of(path), "extrinsics.yml");
    const OpenCvNames names = find_opencv_names(root);
    if (names.R.node != nullptr || names.T.node != nullptr || !is_file(beside))
        return opencv_rig(root, path, size);
    const Result<std::string> text = read_file(beside, limits::kSettingsBytes);
    if (!text) return text.error();
    const Result<YamlNode> more = parse_yaml(*text, beside);
    if (!more) return more.error();
    for (const YamlNode& item : more->items) {
        if (root.find(item.key) == nullptr) root.items.push_back(item);
    }
    return opencv_rig(root, path + " + extrinsics.yml", size);
}

Result<RigFile> with_format(Result<camera::StereoRig> rig,
                            RigFormat format,
                            const std::string& file) {
    if (!rig) return rig.error();
    return checked_file(RigFile{std::move(rig).value(), format, {}}, file);
}

Result<RigFile> parse_kitti(const std::string& text,
                            const std::string& path,
                            std::optional<ImageSize> size) {
    if (!size) {
        return input_error(
            fmt::format("{}: a KITTI calibration has no image size. Use the file with its images, "
                        "or convert the file to a rig.yaml with 'surefoot rig FILE --resolution "
                        "WIDTHxHEIGHT --out rig.yaml'",
                        path));
    }
    const Result<KittiCalibration> calibration = parse_kitti_calibration(text, path);
    if (!calibration) return calibration.error();
    const bool colour = !calibration->P[0] && !calibration->P[1] && calibration->P[2];
    return with_format(kitti_rig(*calibration, colour ? 2 : 0, colour ? 3 : 1, *size, path),
                       RigFormat::kitti,
                       path);
}

Result<std::string> read_ros_text(const std::string& file) {
    Result<std::string> text = read_file(file, limits::kSettingsBytes);
    if (!text) return text;
    const Result<YamlNode> root = parse_yaml(*text, file);
    if (!root) return root.error();
    const CalibrationKind kind = kind_of_document(*root);
    // An unknown document may be a damaged ROS file; the ROS reader names the bad key.
    if (kind == CalibrationKind::ros || kind == CalibrationKind::unknown ||
        kind == CalibrationKind::opencv_camera)
        return text;
    return input_error(
        fmt::format("{}: this looks like {}, not like one camera of a ROS pair; give the "
                    "camera_info file of this camera",
                    file,
                    title_of(kind)));
}

Result<RigFile> read_ros(const std::string& left_file) {
    const std::optional<std::string> right_file = ros_partner(left_file);
    if (!right_file) {
        return input_error(
            fmt::format("{}: a ROS calibration has one file for each camera. Give the file of the "
                        "left camera, with 'left' in its name. Put the file of the right camera, "
                        "with 'right' in its name, into the same folder",
                        left_file));
    }
    Result<std::string> left = read_ros_text(left_file);
    if (!left) return left.error();
    Result<std::string> right = read_ros_text(*right_file);
    if (!right) return right.error();
    return parse_ros_rig({std::move(left).value(), left_file},
                         {std::move(right).value(), *right_file});
}

/// Reads a folder: a ROS pair, a calibration under its usual name, or an EuRoC recording.
Result<RigFile> read_folder(const std::string& path, std::optional<ImageSize> size) {
    const std::string left = join_path(path, "left.yaml");
    if (is_file(left)) return read_ros(left);
    for (const std::string& mav : {join_path(path, "mav0"), path}) {
        if (is_folder(join_path(mav, "cam0")))
            return with_format(read_euroc_rig(mav), RigFormat::euroc, mav);
    }
    for (const char* name : {"rig.yaml", "calib.txt", "calib_cam_to_cam.txt", "camchain.yaml"}) {
        const std::string file = join_path(path, name);
        if (is_file(file)) return read_rig_file(file, size);
    }
    return input_error(
        fmt::format("{}: this folder has no calibration: no cam0/sensor.yaml and cam1/sensor.yaml "
                    "(EuRoC), no left.yaml and right.yaml (ROS), no rig.yaml, calib.txt, "
                    "calib_cam_to_cam.txt or camchain.yaml. Give the calibration file itself",
                    path));
}

/// Parses a YAML or JSON document of a recognised kind, except formats with two files.
Result<RigFile> parse_document(const YamlNode& root,
                               CalibrationKind kind,
                               const std::string& text,
                               const std::string& file,
                               std::optional<ImageSize> size) {
    switch (kind) {
        case CalibrationKind::kalibr: return parse_kalibr_rig(text, file);
        case CalibrationKind::orbslam: return parse_orbslam_rig(text, file);
        case CalibrationKind::opencv: return opencv_rig(root, file, size);
        case CalibrationKind::surefoot:
            return with_format(parse_rig_yaml(text, file), RigFormat::surefoot, file);
        case CalibrationKind::ros:
            return input_error(file +
                               ": a ROS calibration has one file for each camera; give the folder "
                               "with both files");
        default: return input_error(fmt::format("{}: {}", file, why_no_rig(kind, &root)));
    }
}

/// Parses a text format other than YAML. Returns no value if the text may be YAML.
std::optional<Result<RigFile>> parse_other(const std::string& text,
                                           const std::string& file,
                                           std::optional<ImageSize> size) {
    const CalibrationKind kind =
        extension_of(file) == ".conf" ? CalibrationKind::zed : kind_of_text(text);
    switch (kind) {
        case CalibrationKind::zed: return parse_zed_rig(text, file, size);
        case CalibrationKind::kitti: return parse_kitti(text, file, size);
        case CalibrationKind::kitti_raw: return parse_kitti_raw_rig(text, file, size);
        case CalibrationKind::middlebury: return parse_middlebury_rig(text, file, size);
        case CalibrationKind::unknown: return std::nullopt;
        default:
            return Result<RigFile>(
                input_error(fmt::format("{}: {}", file, why_no_rig(kind, nullptr))));
    }
}

Result<YamlNode> parse_mapping(const std::string& text, const std::string& file) {
    Result<YamlNode> root = parse_yaml(text, file);
    if (!root || root->is_mapping()) return root;
    return input_error(fmt::format("{}: {}", file, why_no_rig(CalibrationKind::unknown, &*root)));
}

/// Writes left.yaml and right.yaml into a folder. A `path` that ends in .yaml or .yml is the left
/// file, and the right file is written beside it.
Result<std::vector<std::string>> write_ros(const std::string& path, const RosTexts& texts) {
    std::string left = path;
    if (extension_of(path) != ".yaml" && extension_of(path) != ".yml") {
        if (Status status = make_folder(path); !status) return status.error();
        left = join_path(path, "left.yaml");
    }
    const std::optional<std::string> right = ros_partner(left);
    if (!right) {
        return usage_error(
            fmt::format("{}: a ROS calibration needs one file for each camera. Give a folder, or "
                        "give a name with 'left' in it for the file of the left camera",
                        path));
    }
    if (Status status = write_file(left, texts.left); !status) return status.error();
    if (Status status = write_file(*right, texts.right); !status) return status.error();
    return std::vector<std::string>{left, *right};
}

}  // namespace

Result<RigFile> parse_rig_file(const std::string& text,
                               const std::string& file,
                               std::optional<ImageSize> size) {
    if (auto other = parse_other(text, file, size)) return std::move(*other);
    const Result<YamlNode> root = parse_mapping(text, file);
    if (!root) return root.error();
    return parse_document(*root, kind_of_document(*root), text, file, size);
}

Result<RigFile> read_rig_file(const std::string& path, std::optional<ImageSize> size) {
    if (is_folder(path)) return read_folder(path, size);
    const Result<std::string> text = read_file(path, limits::kSettingsBytes);
    if (!text) return text.error();
    if (auto other = parse_other(*text, path, size)) return std::move(*other);
    const Result<YamlNode> root = parse_mapping(*text, path);
    if (!root) return root.error();
    const CalibrationKind kind = kind_of_document(*root);
    if (kind == CalibrationKind::ros) return read_ros(path);
    if (kind == CalibrationKind::opencv) return read_opencv(*root, path, size);
    return parse_document(*root, kind, *text, path, size);
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
        case RigFormat::kitti_raw: return "kitti_raw";
        case RigFormat::middlebury: return "middlebury";
        case RigFormat::orbslam: return "orbslam";
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
        : format == RigFormat::zed    ? format_zed_rig(rig)
                                      : Result<std::string>(output_error(
                                         fmt::format("{} files can be read but not written; choose "
                                                        "surefoot, opencv, kalibr, ros or zed",
                                                     name_of(format))));
    if (!text) return output_error(fmt::format("{}: {}", path, text.error().message));
    if (Status status = write_file(path, *text); !status) return status.error();
    return Files{path};
}

}  // namespace surefoot::io

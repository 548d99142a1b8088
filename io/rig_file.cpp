// SPDX-License-Identifier: Apache-2.0
#include "io/rig_file.hpp"

#include <fmt/format.h>

#include "io/file.hpp"
#include "io/rig_values.hpp"
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
    const Result<std::string> text = read_file(beside);
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

}  // namespace

Result<camera::StereoRig> read_rig(const std::string& path, std::optional<ImageSize> size) {
    if (is_folder(path)) {
        const std::string inner = join_path(path, "mav0");
        return read_euroc_rig(is_folder(inner) ? inner : path);
    }
    const Result<std::string> text = read_file(path);
    if (!text) return text.error();
    if (text->starts_with("P0:")) return read_kitti(*text, path, size);
    const Result<YamlNode> root = parse_yaml(*text, path);
    if (!root) return root.error();
    if (is_opencv(*root)) return read_opencv(*root, path, size);
    if (has_any(*root, {"T_BS"})) {
        return input_error(fmt::format(
            "{}: this is one sensor of an EuRoC recording; give its folder (with cam0 and cam1)",
            path));
    }
    return parse_rig_yaml(*text, path);
}

}  // namespace surefoot::io

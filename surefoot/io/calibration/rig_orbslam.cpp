// SPDX-License-Identifier: Apache-2.0
// Reads stereo settings of ORB-SLAM2 and ORB-SLAM3, after their examples and ORB-SLAM3's
// "Calibration tutorial". ORB-SLAM2: Camera.* is the rectified camera, and Camera.bf = fx *
// baseline [px m]. LEFT.* and RIGHT.* (K D R P) are the raw cameras. ORB-SLAM3: Camera1.* and
// Camera2.* are the cameras. Stereo.T_c1_c2 maps camera 2 into camera 1; IMU.T_b_c1 maps camera 1
// into the IMU.
#include <fmt/format.h>

#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_lens.hpp"
#include "surefoot/io/calibration/rig_values.hpp"
#include "surefoot/io/settings/yaml_tree.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

constexpr double kLargest = 1e9;

double number(YamlReader& yaml, const std::string& key) {
    const YamlNode* node = yaml.required(yaml.root(), key);
    return node == nullptr ? 0.0 : yaml.number(*node, key, -kLargest, kLargest);
}

double number_or_zero(YamlReader& yaml, const std::string& key) {
    const YamlNode* node = yaml.root().find(key);
    return node == nullptr ? 0.0 : yaml.number(*node, key, -kLargest, kLargest);
}

ImageSize read_image_size(YamlReader& yaml) {
    const YamlNode& root = yaml.root();
    for (const std::string prefix : {"Camera", "LEFT"}) {
        const YamlNode* width = root.find(prefix + ".width");
        const YamlNode* height = root.find(prefix + ".height");
        if (width == nullptr || height == nullptr) continue;
        return {yaml.integer(*width, prefix + ".width", 1, kMaxRigSide_px),
                yaml.integer(*height, prefix + ".height", 1, kMaxRigSide_px)};
    }
    yaml.required(root, "Camera.width");
    return {};
}

/// Reads Camera.type; a missing type means pinhole, as in ORB-SLAM2.
std::string read_type(YamlReader& yaml) {
    const YamlNode* node = yaml.root().find("Camera.type");
    if (node == nullptr) return "PinHole";
    std::string type = yaml.text(*node, "Camera.type");
    if (type != "PinHole" && type != "KannalaBrandt8" && type != "Rectified") {
        yaml.fail(*node,
                  "Camera.type",
                  quoted(type) + " is not one of PinHole | KannalaBrandt8 | Rectified");
    }
    return type;
}

/// Reads the camera whose keys begin with `prefix`, for example "Camera1.fx".
camera::CameraModel read_lens(YamlReader& yaml,
                              const std::string& prefix,
                              const std::string& type) {
    const std::vector<double> k{number(yaml, prefix + ".fx"),
                                number(yaml, prefix + ".fy"),
                                number(yaml, prefix + ".cx"),
                                number(yaml, prefix + ".cy")};
    if (yaml.error()) return {};
    check_focal(yaml, yaml.root(), prefix + ".fx, fy", {k[0], 0, k[2], 0, k[1]});
    if (type == "Rectified") return make_pinhole(k, {});
    std::vector<double> D;
    const bool fisheye = type == "KannalaBrandt8";
    const std::vector<const char*> keys =
        fisheye ? std::vector<const char*>{"k1", "k2", "k3", "k4"}
                : std::vector<const char*>{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
    for (const char* key : keys) {
        const std::string name = prefix + "." + key;
        D.push_back(fisheye ? number(yaml, name) : number_or_zero(yaml, name));
    }
    return lens_or_fail(yaml,
                        yaml.root(),
                        prefix + ".k1 ..",
                        fisheye ? fisheye_lens(k, std::move(D)) : pinhole_lens(k, std::move(D)));
}

/// Reads a pose from a matrix of 16 numbers, or of 12 numbers without the last row.
Pose read_matrix_pose(YamlReader& yaml, const YamlNode& node, const char* key) {
    std::vector<double> rows = read_matrix(yaml, node, key, 12, 16);
    if (rows.size() == 12) rows.insert(rows.end(), {0.0, 0.0, 0.0, 1.0});
    if (rows.size() != 16)
        yaml.fail(node, key, fmt::format("found {} numbers; a pose has 12 or 16", rows.size()));
    return yaml.error() ? Pose{} : pose_from_rows(yaml, node, key, rows);
}

/// ORB-SLAM3 before file version 1.0 calls the left camera "Camera", as ORB-SLAM2 does.
std::string left_prefix(const YamlNode& root) {
    return root.find("Camera1.fx") != nullptr ? "Camera1" : "Camera";
}

/// Reads ORB-SLAM3 settings with two separate cameras.
void read_two_cameras(YamlReader& yaml, RigFile& out, ImageSize size) {
    const YamlNode& root = yaml.root();
    const std::string type = read_type(yaml);
    const std::string left = left_prefix(root);
    out.rig.left = {read_lens(yaml, left, type), size.width, size.height};
    // Rectified settings without Camera2 have one lens for both cameras.
    const bool one_lens = type == "Rectified" && root.find("Camera2.fx") == nullptr;
    out.rig.right =
        camera::Camera{read_lens(yaml, one_lens ? left : "Camera2", type), size.width, size.height};
    for (const char* key : {"Stereo.T_c1_c2", "Tlr"}) {
        if (const YamlNode* pose = root.find(key); pose != nullptr) {
            out.rig.T_left_right = read_matrix_pose(yaml, *pose, key);
            return;
        }
    }
    if (root.find("Stereo.b") != nullptr && type == "Rectified") {
        out.rig.T_left_right.translation_m.x() = number(yaml, "Stereo.b");
        return;
    }
    yaml.fail(root,
              "Stereo.T_c1_c2",
              "this key is missing, but two cameras need the pose of camera 2 in camera 1. Add the "
              "key; for rectified cameras add Stereo.b instead");
}

/// Raw camera from LEFT.* or RIGHT.* of ORB-SLAM2. The keys K, D, R and P mean the same as in ROS.
struct RawCamera {
    camera::Camera camera;
    Pose T_rectified_raw;
    double x_m = 0.0;
};
RawCamera read_raw_camera(YamlReader& yaml, const std::string& side, ImageSize size) {
    const auto matrix = [&](const char* name, std::size_t min, std::size_t max) {
        const std::string key = side + "." + name;
        const YamlNode* node = yaml.required(yaml.root(), key);
        return node == nullptr ? std::vector<double>(min, 0.0)
                               : read_matrix(yaml, *node, key, min, max);
    };
    const std::vector<double> K = matrix("K", 9, 9);
    const std::vector<double> D = matrix("D", 4, 14);
    const std::vector<double> R = matrix("R", 9, 9);
    const std::vector<double> P = matrix("P", 12, 12);
    if (yaml.error()) return {};
    check_focal(yaml, *yaml.root().find(side + ".K"), side + ".K", K);
    check_focal(yaml, *yaml.root().find(side + ".P"), side + ".P", {P[0], 0, 0, 0, P[5]});
    const YamlNode& distortion = *yaml.root().find(side + ".D");
    RawCamera out;
    out.camera = {
        lens_or_fail(yaml, distortion, side + ".D", pinhole_lens({K[0], K[4], K[2], K[5]}, D)),
        size.width,
        size.height};
    const YamlNode& R_node = *yaml.root().find(side + ".R");
    out.T_rectified_raw = pose_from_parts(yaml, R_node, side + ".R", R, {0.0, 0.0, 0.0});
    out.x_m = yaml.error() ? 0.0 : -P[3] / P[0];
    return out;
}

void read_raw_pair(YamlReader& yaml, RigFile& out, ImageSize size) {
    const RawCamera left = read_raw_camera(yaml, "LEFT", size);
    const RawCamera right = read_raw_camera(yaml, "RIGHT", size);
    out.rig.left = left.camera;
    out.rig.right = right.camera;
    const Pose T_rectified_right{right.T_rectified_raw.rotation, {right.x_m - left.x_m, 0.0, 0.0}};
    out.rig.T_left_right = left.T_rectified_raw.inverse() * T_rectified_right;
}

void read_rgbd_camera(YamlReader& yaml, RigFile& out, ImageSize size) {
    out.rig.left = {
        read_lens(yaml, left_prefix(yaml.root()), read_type(yaml)), size.width, size.height};
    out.notes.emplace_back(
        "the file has a depth factor, so it is read as a rig of one camera with depth");
    out.rig.rectified = true;  // assumed; the next line checks this
    out.rig.rectified = !out.rig.problem().has_value();
}

/// Reads files with Camera.bf but without LEFT.* and RIGHT.*: the images are already rectified.
void read_rectified_pair(YamlReader& yaml, RigFile& out, ImageSize size) {
    const std::string prefix = left_prefix(yaml.root());
    out.rig.left = {read_lens(yaml, prefix, read_type(yaml)), size.width, size.height};
    const double bf_px_m = number(yaml, "Camera.bf");
    const double fx_px = number(yaml, prefix + ".fx");
    if (yaml.error()) return;
    out.rig.right = out.rig.left;
    out.rig.T_left_right.translation_m.x() = bf_px_m / fx_px;
    mark_if_rectified(out.rig);
    if (!out.rig.rectified && !out.rig.problem()) {
        yaml.fail(yaml.root(),
                  "Camera.bf",
                  "this key is for rectified images, but Camera.k1 .. are not 0; give LEFT.K, D, "
                  "R, P and RIGHT.K, D, R, P of the raw images too");
    }
    out.notes.emplace_back(
        "the file has Camera.bf but no keys LEFT.* and RIGHT.*: the program assumes rectified "
        "images");
}

void read_cameras(YamlReader& yaml, RigFile& out, ImageSize size) {
    const auto has = [&yaml](const char* key) { return yaml.root().find(key) != nullptr; };
    if (has("LEFT.K") != has("RIGHT.K")) {
        return yaml.fail(
            yaml.root(),
            has("LEFT.K") ? "RIGHT.K" : "LEFT.K",
            "this key is missing: these ORB-SLAM settings describe the raw images of one camera "
            "only. Give K, D, R and P of both LEFT and RIGHT. For rectified images remove all keys "
            "LEFT.* and RIGHT.*; then Camera.fx .. and Camera.bf are used");
    }
    if (has("LEFT.K")) return read_raw_pair(yaml, out, size);
    if (has("DepthMapFactor") || has("RGBD.DepthMapFactor"))
        return read_rgbd_camera(yaml, out, size);
    if (has("Camera2.fx") || has("Stereo.T_c1_c2") || has("Stereo.b") || has("Tlr"))
        return read_two_cameras(yaml, out, size);
    if (has("Camera.bf")) return read_rectified_pair(yaml, out, size);
    yaml.fail(yaml.root(),
              "Stereo.T_c1_c2",
              "this key is missing, and Stereo.b and Camera.bf are missing too: these ORB-SLAM "
              "settings are for one camera. Give the settings of a stereo camera");
}

void read_imu(YamlReader& yaml, RigFile& out) {
    for (const char* key : {"IMU.T_b_c1", "Tbc"}) {
        const YamlNode* pose = yaml.root().find(key);
        if (pose == nullptr) continue;
        const Pose T_imu_left = read_matrix_pose(yaml, *pose, key);
        const double rate_hz = number_or_zero(yaml, "IMU.Frequency");
        if (!yaml.error()) mount_imu(T_imu_left.inverse(), rate_hz, out);
        return;
    }
}

}  // namespace

Result<RigFile> parse_orbslam_rig(std::string_view text, const std::string& file) {
    const Result<YamlNode> document = parse_yaml(text, file);
    if (!document) return document.error();
    if (!document->is_mapping())
        return input_error(file + ": expected the keys of ORB-SLAM settings");
    YamlReader yaml(file, *document);
    RigFile out;
    out.format = RigFormat::orbslam;
    out.rig.name = "orbslam";
    const ImageSize size = read_image_size(yaml);
    out.rig.rate_hz = number_or_zero(yaml, "Camera.fps");
    read_cameras(yaml, out, size);
    read_imu(yaml, out);
    if (yaml.error()) return *yaml.error();
    return checked_file(std::move(out), file);
}

}  // namespace surefoot::io

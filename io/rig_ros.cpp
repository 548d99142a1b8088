// SPDX-License-Identifier: Apache-2.0
// ROS camera_info files, after the comments of sensor_msgs/CameraInfo and REP 104: K and D belong
// to the raw image, R turns it into the rectified one, P projects from there; P(0, 3) = -fx' * Tx.
#include <fmt/format.h>

#include "io/rig_formats.hpp"
#include "io/rig_values.hpp"
#include "io/text.hpp"
#include "io/yaml_tree.hpp"

namespace surefoot::io {
namespace {

/// One camera of the pair.
struct RosCamera {
    camera::Camera camera;
    Pose T_rectified_raw;
    double x_m = 0.0;  ///< its centre on the x axis of the rectified frame
};

const YamlNode& required_matrix(YamlReader& yaml, const char* key) {
    const YamlNode* node = yaml.required(yaml.root(), key);
    return node == nullptr ? yaml.root() : *node;
}

camera::CameraModel read_lens(YamlReader& yaml) {
    const YamlNode& matrix = required_matrix(yaml, "camera_matrix");
    const YamlNode& list = required_matrix(yaml, "distortion_coefficients");
    if (yaml.error()) return {};
    const std::vector<double> K = read_matrix(yaml, matrix, "camera_matrix", 9, 9);
    std::vector<double> D = read_matrix(yaml, list, "distortion_coefficients", 0, 14);
    if (yaml.error()) return {};
    check_focal(yaml, matrix, "camera_matrix", K);
    const std::vector<double> k{K[0], K[4], K[2], K[5]};
    std::string model = "plumb_bob";  // what files without the key mean
    const YamlNode* node = yaml.root().find("distortion_model");
    if (node != nullptr) model = yaml.text(*node, "distortion_model");
    const auto expect = [&](std::size_t min, std::size_t max) {
        if (D.size() >= min && D.size() <= max) return;
        yaml.fail(list,
                  "distortion_coefficients",
                  fmt::format("{} numbers; {} has {}", D.size(), model, max));
    };
    if (model == "equidistant") {
        expect(4, 4);
        return make_kannala_brandt(k, std::move(D));
    }
    if (model == "rational_polynomial") {
        expect(8, 8);
        return make_pinhole(k, std::move(D));
    }
    if (model != "plumb_bob") {
        yaml.fail(node == nullptr ? yaml.root() : *node,
                  "distortion_model",
                  quoted(model) + " is none of plumb_bob | rational_polynomial | equidistant");
        return {};
    }
    if (!D.empty()) expect(4, 5);
    return make_pinhole(k, std::move(D));
}

void read_rectification(YamlReader& yaml, RosCamera& out) {
    const YamlNode& rotation = required_matrix(yaml, "rectification_matrix");
    const YamlNode& projection = required_matrix(yaml, "projection_matrix");
    if (yaml.error()) return;
    const std::vector<double> R = read_matrix(yaml, rotation, "rectification_matrix", 9, 9);
    const std::vector<double> P = read_matrix(yaml, projection, "projection_matrix", 12, 12);
    if (yaml.error()) return;
    out.T_rectified_raw =
        pose_from_parts(yaml, rotation, "rectification_matrix", R, {0.0, 0.0, 0.0});
    if (!(P[0] > 0.0) || !(P[5] > 0.0)) {
        yaml.fail(projection,
                  "projection_matrix",
                  fmt::format("focal lengths {} and {} must be above 0 px", P[0], P[5]));
        return;
    }
    if (P[7] != 0.0) {
        yaml.fail(
            projection,
            "projection_matrix",
            fmt::format("element (1, 3) is {}; cameras on top of each other are not supported",
                        P[7]));
    }
    out.x_m = -P[3] / P[0];
}

Result<RosCamera> parse_camera(const NamedText& in) {
    const Result<YamlNode> root = parse_yaml(in.text, in.file);
    if (!root) return root.error();
    if (!root->is_mapping()) {
        return input_error(in.file + ": expected 'key: value' lines of a ROS camera_info file");
    }
    YamlReader yaml(in.file, *root);
    RosCamera out;
    const YamlNode* width = yaml.required(*root, "image_width");
    const YamlNode* height = yaml.required(*root, "image_height");
    if (width != nullptr && height != nullptr) {
        out.camera.width = yaml.integer(*width, "image_width", 1, kMaxRigSide_px);
        out.camera.height = yaml.integer(*height, "image_height", 1, kMaxRigSide_px);
    }
    out.camera.model = read_lens(yaml);
    read_rectification(yaml, out);
    if (yaml.error()) return *yaml.error();
    if (const auto problem = out.camera.problem()) {
        return input_error(fmt::format("{}: {}", in.file, *problem));
    }
    return out;
}

std::string format_camera(const char* name,
                          const camera::Camera& camera,
                          const std::vector<double>& R,
                          const std::vector<double>& P) {
    const std::vector<double> k = intrinsics_of(camera.model);
    const std::vector<double> D = coefficients_of(camera.model);
    const char* model = is_kannala_brandt(camera.model) ? "equidistant"
                        : is_rational(camera.model)     ? "rational_polynomial"
                                                        : "plumb_bob";
    return fmt::format(
        "image_width: {}\nimage_height: {}\ncamera_name: {}\n"
        "camera_matrix:\n  rows: 3\n  cols: 3\n  data: {}\n"
        "distortion_model: {}\n"
        "distortion_coefficients:\n  rows: 1\n  cols: {}\n  data: {}\n"
        "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: {}\n"
        "projection_matrix:\n  rows: 3\n  cols: 4\n  data: {}\n",
        camera.width,
        camera.height,
        name,
        format_list({k[0], 0.0, k[2], 0.0, k[1], k[3], 0.0, 0.0, 1.0}),
        model,
        D.size(),
        format_list(D),
        format_list(R),
        format_list(P));
}

}  // namespace

Result<RigFile> parse_ros_rig(const NamedText& left, const NamedText& right) {
    const Result<RosCamera> l = parse_camera(left);
    if (!l) return l.error();
    const Result<RosCamera> r = parse_camera(right);
    if (!r) return r.error();
    const double baseline_m = r->x_m - l->x_m;
    if (!(baseline_m > 0.0)) {
        return input_error(fmt::format(
            "{}: projection_matrix: element (0, 3) says that this camera lies {} m to the right of "
            "the left one; it must be -fx * baseline, below 0, in the right camera's file (0 is a "
            "calibration of single cameras; above 0 they are exchanged)",
            right.file,
            baseline_m));
    }
    RigFile out;
    out.format = RigFormat::ros;
    out.rig.name = "ros";
    out.rig.left = l->camera;
    out.rig.right = r->camera;
    const Pose T_rectified_right{r->T_rectified_raw.rotation, {baseline_m, 0.0, 0.0}};
    out.rig.T_left_right = l->T_rectified_raw.inverse() * T_rectified_right;
    mark_if_rectified(out.rig);
    Result<camera::StereoRig> rig = checked_rig(std::move(out.rig), left.file);
    if (!rig) return rig.error();
    out.rig = std::move(rig).value();
    return out;
}

Result<RosTexts> format_ros_rig(const camera::StereoRig& rig) {
    if (Status status = check_pair(rig, "ROS"); !status) return status.error();
    const RectifiedMatrices m = rectified_matrices(rig);
    return RosTexts{format_camera("left", rig.left, m.R_left, m.P_left),
                    format_camera("right", *rig.right, m.R_right, m.P_right)};
}

std::optional<std::string> ros_partner(const std::string& left_path) {
    const std::size_t name = left_path.rfind('/') + 1;  // npos + 1 is 0
    const std::size_t at = left_path.rfind("left");
    if (at == std::string::npos || at < name) return std::nullopt;
    return left_path.substr(0, at) + "right" + left_path.substr(at + 4);
}

}  // namespace surefoot::io

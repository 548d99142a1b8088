// SPDX-License-Identifier: Apache-2.0
// Kalibr's camera chain, after its wiki "Yaml formats" (Furgale, Rehder and Siegwart 2013).
#include <fmt/format.h>

#include "io/rig_formats.hpp"
#include "io/rig_values.hpp"
#include "io/text.hpp"
#include "io/yaml_tree.hpp"

namespace surefoot::io {
namespace {

/// Kalibr does not write the rate of the IMU; a common one, only used to judge gaps.
constexpr double kAssumedImuRate_hz = 200.0;

camera::CameraModel read_lens(YamlReader& yaml, const YamlNode& node, const std::string& name) {
    const YamlNode* model = yaml.required(node, "camera_model");
    const YamlNode* intrinsics = yaml.required(node, "intrinsics");
    const YamlNode* distortion = yaml.required(node, "distortion_model");
    const YamlNode* list = yaml.required(node, "distortion_coeffs");
    if (model == nullptr || intrinsics == nullptr || distortion == nullptr || list == nullptr) {
        return {};
    }
    const std::string model_name = yaml.text(*model, name + ".camera_model");
    if (model_name != "pinhole") {
        yaml.fail(*model,
                  name + ".camera_model",
                  quoted(model_name) +
                      " is not supported; calibrate with pinhole-radtan, or "
                      "pinhole-equi for wide lenses");
        return {};
    }
    const std::vector<double> k = yaml.numbers(*intrinsics, name + ".intrinsics", 4);
    check_focal(yaml, *intrinsics, name + ".intrinsics", {k[0], 0, 0, 0, k[1]});
    const std::string kind = yaml.text(*distortion, name + ".distortion_model");
    if (kind == "none") return make_pinhole(k, {});
    if (kind != "radtan" && kind != "equidistant") {
        yaml.fail(*distortion,
                  name + ".distortion_model",
                  quoted(kind) + " is none of radtan | equidistant | none");
        return {};
    }
    std::vector<double> D = yaml.numbers(*list, name + ".distortion_coeffs", 4);
    return kind == "radtan" ? make_pinhole(k, std::move(D)) : make_kannala_brandt(k, std::move(D));
}

camera::Camera read_camera(YamlReader& yaml, const std::string& name) {
    const YamlNode* node = yaml.required(yaml.root(), name);
    if (node == nullptr) return {};
    if (!node->is_mapping()) {
        yaml.fail(*node, name, "expected camera_model, intrinsics and so on");
        return {};
    }
    camera::Camera camera;
    if (const YamlNode* resolution = yaml.required(*node, "resolution"); resolution != nullptr) {
        const ImageSize size = read_size(yaml, *resolution, name + ".resolution");
        camera.width = size.width;
        camera.height = size.height;
    }
    camera.model = read_lens(yaml, *node, name);
    return camera;
}

/// Pose of the IMU, where the chain has one.
void read_imu(YamlReader& yaml, RigFile& out) {
    const YamlNode* node = yaml.root().find("cam0");
    const YamlNode* pose = node->find("T_cam_imu");
    if (pose == nullptr) return;
    out.rig.T_body_left = T_body_optical();
    const Pose T_left_imu = read_pose(yaml, *pose, "cam0.T_cam_imu");
    out.rig.imu = camera::ImuMount{*out.rig.T_body_left * T_left_imu, kAssumedImuRate_hz};
    out.notes.push_back(
        fmt::format("the file does not hold the rate of the IMU; {} Hz assumed, and base_link is "
                    "the left camera turned to body axes",
                    kAssumedImuRate_hz));
    const YamlNode* shift = node->find("timeshift_cam_imu");
    if (shift == nullptr) return;
    const double shift_s = yaml.number(*shift, "cam0.timeshift_cam_imu", -10.0, 10.0);
    if (shift_s == 0.0) return;
    out.notes.push_back(fmt::format(
        "cam0.timeshift_cam_imu {} s is left out: a rig takes camera and IMU stamps as they are",
        shift_s));
}

std::string format_camera(const char* name,
                          const char* other,
                          const camera::Camera& camera,
                          const std::optional<Pose>& T_cam_previous,
                          const std::optional<Pose>& T_cam_imu) {
    std::vector<double> D = coefficients_of(camera.model);
    D.resize(4);
    const auto format_pose = [](const char* key, const Pose& pose) {
        const Eigen::Matrix4d T = pose.matrix();
        std::string out = fmt::format("  {}:\n", key);
        for (Eigen::Index i = 0; i < 4; ++i) {
            out += fmt::format("  - {}\n", format_list({T(i, 0), T(i, 1), T(i, 2), T(i, 3)}));
        }
        return out;
    };
    std::string out = fmt::format("{}:\n", name);
    if (T_cam_imu) out += format_pose("T_cam_imu", *T_cam_imu);
    if (T_cam_previous) out += format_pose("T_cn_cnm1", *T_cam_previous);
    out += fmt::format(
        "  cam_overlaps: [{}]\n  camera_model: pinhole\n  distortion_coeffs: {}\n"
        "  distortion_model: {}\n  intrinsics: {}\n  resolution: [{}, {}]\n"
        "  rostopic: /{}/image_raw\n",
        other,
        format_list(D),
        is_kannala_brandt(camera.model) ? "equidistant" : "radtan",
        format_list(intrinsics_of(camera.model)),
        camera.width,
        camera.height,
        name);
    return out;
}

/// Kalibr's radtan has four coefficients.
Status check_lens(const camera::CameraModel& model, const char* name) {
    if (is_rational(model)) {
        return output_error(fmt::format(
            "Kalibr has no rational model; the {} camera has one: calibrate with radtan or "
            "equidistant",
            name));
    }
    const std::vector<double> D = coefficients_of(model);
    if (D.size() == 5 && D[4] != 0.0) {
        return output_error(
            fmt::format("Kalibr's radtan ends with k2; the {} camera has k3 = {}", name, D[4]));
    }
    return {};
}

}  // namespace

Result<RigFile> parse_kalibr_rig(std::string_view text, const std::string& file) {
    const Result<YamlNode> root = parse_yaml(text, file);
    if (!root) return root.error();
    if (!root->is_mapping()) {
        return input_error(file + ": expected the cameras cam0 and cam1 of a Kalibr chain");
    }
    YamlReader yaml(file, *root);
    RigFile out;
    out.format = RigFormat::kalibr;
    out.rig.name = "kalibr";
    out.rig.left = read_camera(yaml, "cam0");
    out.rig.right = read_camera(yaml, "cam1");
    if (yaml.error()) return *yaml.error();
    const YamlNode& cam1 = *root->find("cam1");
    if (const YamlNode* pose = yaml.required(cam1, "T_cn_cnm1"); pose != nullptr) {
        out.rig.T_left_right = read_pose(yaml, *pose, "cam1.T_cn_cnm1").inverse();
    }
    read_imu(yaml, out);
    if (root->find("cam2") != nullptr) {
        out.notes.emplace_back("more than two cameras; cam0 and cam1 are taken");
    }
    if (yaml.error()) return *yaml.error();
    mark_if_rectified(out.rig);
    Result<camera::StereoRig> rig = checked_rig(std::move(out.rig), file);
    if (!rig) return rig.error();
    out.rig = std::move(rig).value();
    return out;
}

Result<std::string> format_kalibr_rig(const camera::StereoRig& rig) {
    if (Status status = check_pair(rig, "Kalibr"); !status) return status.error();
    if (Status status = check_lens(rig.left.model, "left"); !status) return status.error();
    if (Status status = check_lens(rig.right->model, "right"); !status) return status.error();
    const Pose T_right_left = rig.T_left_right.inverse();
    std::optional<Pose> T_left_imu;
    std::optional<Pose> T_right_imu;
    if (rig.imu) {
        T_left_imu = rig.body_from_left().inverse() * rig.imu->T_body_imu;
        T_right_imu = T_right_left * *T_left_imu;
    }
    return format_camera("cam0", "1", rig.left, std::nullopt, T_left_imu) +
           format_camera("cam1", "0", *rig.right, T_right_left, T_right_imu);
}

}  // namespace surefoot::io

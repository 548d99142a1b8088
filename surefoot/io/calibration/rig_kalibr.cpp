// SPDX-License-Identifier: Apache-2.0
// Reads and writes Kalibr's camera chain, after the wiki page "Yaml formats" (Furgale, Rehder and
// Siegwart 2013).
#include <fmt/format.h>

#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_lens.hpp"
#include "surefoot/io/calibration/rig_values.hpp"
#include "surefoot/io/settings/yaml_tree.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

camera::CameraModel read_lens(YamlReader& yaml, const YamlNode& node, const std::string& name) {
    const YamlNode* model = yaml.required(node, "camera_model");
    const YamlNode* intrinsics = yaml.required(node, "intrinsics");
    const YamlNode* distortion = yaml.required(node, "distortion_model");
    if (model == nullptr || intrinsics == nullptr || distortion == nullptr) return {};
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
    const YamlNode* list = yaml.required(node, "distortion_coeffs");
    if (list == nullptr) return {};
    if (kind != "radtan" && kind != "equidistant") {
        yaml.fail(*distortion,
                  name + ".distortion_model",
                  quoted(kind) + " is not one of radtan | equidistant | none");
        return {};
    }
    const std::string key = name + ".distortion_coeffs";
    std::vector<double> D = yaml.any_numbers(*list, key, 14);
    drop_zero_tail(D, 4);
    if (D.size() != 4)
        yaml.fail(*list, key, fmt::format("found {} numbers; exactly 4 are needed", D.size()));
    if (yaml.error()) return {};
    return lens_or_fail(
        yaml,
        *list,
        key,
        kind == "radtan" ? pinhole_lens(k, std::move(D)) : fisheye_lens(k, std::move(D)));
}

camera::Camera read_camera(YamlReader& yaml, const std::string& name) {
    const YamlNode* node = yaml.required(yaml.root(), name);
    if (node == nullptr) return {};
    if (!node->is_mapping()) {
        yaml.fail(
            *node, name, "expected a group with camera_model, intrinsics and distortion_model");
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

/// Reads the pose of the IMU in a camera: T_cam_imu of Kalibr, or the inverse, T_imu_cam, of
/// OpenVINS.
std::optional<Pose> read_imu_pose(YamlReader& yaml, const std::string& name) {
    const YamlNode& node = *yaml.root().find(name);
    if (const YamlNode* pose = node.find("T_cam_imu"); pose != nullptr)
        return read_pose(yaml, *pose, name + ".T_cam_imu");
    if (const YamlNode* pose = node.find("T_imu_cam"); pose != nullptr)
        return read_pose(yaml, *pose, name + ".T_imu_cam").inverse();
    return std::nullopt;
}

/// Reads T_left_right from T_cn_cnm1, or computes it from the poses of the IMU in both cameras.
Pose read_extrinsics(YamlReader& yaml,
                     const std::optional<Pose>& T_left_imu,
                     const std::optional<Pose>& T_right_imu,
                     RigFile& out) {
    const YamlNode& cam1 = *yaml.root().find("cam1");
    if (const YamlNode* pose = cam1.find("T_cn_cnm1"); pose != nullptr)
        return read_pose(yaml, *pose, "cam1.T_cn_cnm1").inverse();
    if (T_left_imu && T_right_imu) {
        out.notes.emplace_back(
            "cam1 has no T_cn_cnm1: the pose of the right camera follows from the poses of the IMU "
            "in both cameras");
        return *T_left_imu * T_right_imu->inverse();
    }
    yaml.fail(cam1,
              "cam1",
              "key 'T_cn_cnm1' is missing, and only one camera or no camera has T_cam_imu. Run "
              "kalibr_calibrate_cameras with both topics in one call: its camchain contains the "
              "pose between the cameras");
    return {};
}

void read_imu(YamlReader& yaml, const std::optional<Pose>& T_left_imu, RigFile& out) {
    if (!T_left_imu) return;
    mount_imu(*T_left_imu, 0.0, out);
    const YamlNode* shift = yaml.root().find("cam0")->find("timeshift_cam_imu");
    if (shift == nullptr) return;
    const double shift_s = yaml.number(*shift, "cam0.timeshift_cam_imu", -10.0, 10.0);
    if (shift_s == 0.0) return;
    out.notes.push_back(
        fmt::format("cam0.timeshift_cam_imu {} s is left out: a rig uses the time stamps of camera "
                    "and IMU without correction",
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

/// Refuses lenses that Kalibr cannot store. Kalibr's radtan has four coefficients.
Status check_lens(const camera::CameraModel& model, const char* name) {
    if (is_rational(model)) {
        return output_error(
            fmt::format("the {} camera has a rational lens model, which Kalibr does not support: "
                        "calibrate with radtan or equidistant",
                        name));
    }
    const std::vector<double> D = coefficients_of(model);
    if (D.size() == 5 && D[4] != 0.0) {
        return output_error(fmt::format(
            "Kalibr's radtan model has no k3, but the {} camera has k3 = {}; choose another format",
            name,
            D[4]));
    }
    return {};
}

}  // namespace

Result<RigFile> parse_kalibr_rig(std::string_view text, const std::string& file) {
    const Result<YamlNode> root = parse_yaml(text, file);
    if (!root) return root.error();
    if (!root->is_mapping()) {
        return input_error(file + ": expected the cameras cam0 and cam1 of a Kalibr camera chain");
    }
    YamlReader yaml(file, *root);
    RigFile out;
    out.format = RigFormat::kalibr;
    out.rig.name = "kalibr";
    out.rig.left = read_camera(yaml, "cam0");
    out.rig.right = read_camera(yaml, "cam1");
    if (yaml.error()) return *yaml.error();
    const std::optional<Pose> T_left_imu = read_imu_pose(yaml, "cam0");
    const std::optional<Pose> T_right_imu = read_imu_pose(yaml, "cam1");
    out.rig.T_left_right = read_extrinsics(yaml, T_left_imu, T_right_imu, out);
    read_imu(yaml, T_left_imu, out);
    if (root->find("cam2") != nullptr) {
        out.notes.emplace_back("the file has more than two cameras; cam0 and cam1 are used");
    }
    if (yaml.error()) return *yaml.error();
    return checked_file(std::move(out), file);
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

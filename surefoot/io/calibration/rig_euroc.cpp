// SPDX-License-Identifier: Apache-2.0
// EuRoC ASL format after Burri et al. 2016, "The EuRoC micro aerial vehicle datasets". T_BS maps
// sensor coordinates into body coordinates. The reader ignores keys that a rig does not need
// (comment, noise densities).
#include <fmt/format.h>

#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/calibration/rig_lens.hpp"
#include "surefoot/io/calibration/rig_values.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

/// Reads T_BS: {cols: 4, rows: 4, data: [16 numbers]}.
Pose read_sensor_pose(YamlReader& yaml) {
    const YamlNode* pose = yaml.required(yaml.root(), "T_BS");
    if (pose == nullptr) return {};
    if (!pose->is_mapping()) {
        yaml.fail(*pose, "T_BS", "expected a group with rows, cols and data");
        return {};
    }
    const YamlNode* data = yaml.required(*pose, "data");
    return data == nullptr ? Pose{} : read_pose(yaml, *data, "T_BS");
}

camera::CameraModel read_model(YamlReader& yaml) {
    const YamlNode& root = yaml.root();
    const YamlNode* intrinsics = yaml.required(root, "intrinsics");
    if (intrinsics == nullptr) return {};
    const std::vector<double> k = yaml.numbers(*intrinsics, "intrinsics", 4);
    if (!(k[0] > 0.0) || !(k[1] > 0.0)) {
        yaml.fail(*intrinsics,
                  "intrinsics",
                  fmt::format("focal lengths {} and {} must be above 0 px", k[0], k[1]));
    }
    if (const YamlNode* model = root.find("camera_model"); model != nullptr) {
        if (yaml.text(*model, "camera_model") != "pinhole") {
            yaml.fail(
                *model,
                "camera_model",
                quoted(model->scalar) + " is not supported; the camera model must be 'pinhole'");
        }
    }
    std::string distortion = "none";
    const YamlNode* distortion_node = root.find("distortion_model");
    if (distortion_node != nullptr) distortion = yaml.text(*distortion_node, "distortion_model");
    std::vector<double> coefficients;
    const YamlNode* list = root.find("distortion_coefficients");
    if (list != nullptr) coefficients = yaml.any_numbers(*list, "distortion_coefficients", 14);
    drop_zero_tail(coefficients, distortion == "rational_polynomial" ? 8 : 4);
    const std::size_t count = coefficients.size();
    if (distortion == "equidistant") {
        if (count != 4 && distortion_node != nullptr) {
            yaml.fail(list != nullptr ? *list : *distortion_node,
                      "distortion_coefficients",
                      fmt::format("found {} numbers; the equidistant model has 4", count));
        }
        return make_kannala_brandt(k, coefficients);
    }
    if (distortion == "radial-tangential" || distortion == "radtan") {
        if (count != 4 && count != 5) {
            yaml.fail(
                list != nullptr ? *list : *distortion_node,
                "distortion_coefficients",
                fmt::format("found {} numbers; the radial-tangential model has 4, or 5 with k3",
                            count));
        }
        return make_pinhole(k, coefficients);
    }
    if (distortion == "rational_polynomial") {  // extension of EuRoC; the name comes from ROS
        if (count < 8) {
            yaml.fail(list != nullptr ? *list : *distortion_node,
                      "distortion_coefficients",
                      fmt::format("found {} numbers; the rational_polynomial model has 8", count));
        }
        if (yaml.error()) return {};
        return lens_or_fail(
            yaml, *list, "distortion_coefficients", pinhole_lens(k, std::move(coefficients)));
    }
    if (distortion != "none" && distortion_node != nullptr) {
        yaml.fail(
            *distortion_node,
            "distortion_model",
            quoted(distortion) +
                " is not one of radial-tangential | rational_polynomial | equidistant | none");
    }
    return make_pinhole(k, {});
}

double read_rate(YamlReader& yaml) {
    const YamlNode* rate = yaml.root().find("rate_hz");
    return rate == nullptr ? 0.0 : yaml.number(*rate, "rate_hz", 0.0, 1e5);
}

Result<EurocCamera> read_euroc_camera(const std::string& path) {
    const Result<std::string> text = read_file(path, limits::kSettingsBytes);
    if (!text) return text.error();
    return parse_euroc_camera(*text, path);
}

Result<YamlNode> parse_mapping(std::string_view text, const std::string& file) {
    Result<YamlNode> root = parse_yaml(text, file);
    if (root && !root->is_mapping()) {
        return input_error(file + ": expected 'key: value' lines of an EuRoC sensor.yaml");
    }
    return root;
}

std::string format_sensor_pose(const Pose& T_body_sensor) {
    return fmt::format("T_BS:\n  cols: 4\n  rows: 4\n  data: {}\n",
                       format_pose_rows(T_body_sensor));
}

}  // namespace

Result<EurocCamera> parse_euroc_camera(std::string_view text, const std::string& file) {
    const Result<YamlNode> root = parse_mapping(text, file);
    if (!root) return root.error();
    YamlReader yaml(file, *root);
    EurocCamera camera;
    camera.T_body_camera = read_sensor_pose(yaml);
    camera.rate_hz = read_rate(yaml);
    if (const YamlNode* readout = root->find("readout_s"); readout != nullptr) {
        camera.readout_s = yaml.number(*readout, "readout_s", 0.0, 1.0);
    }
    if (const YamlNode* resolution = yaml.required(*root, "resolution"); resolution != nullptr) {
        const ImageSize size = read_size(yaml, *resolution, "resolution");
        camera.camera.width = size.width;
        camera.camera.height = size.height;
    }
    camera.camera.model = read_model(yaml);
    if (yaml.error()) return *yaml.error();
    if (const auto problem = camera.camera.problem()) {
        return input_error(fmt::format("{}: {}", file, *problem));
    }
    return camera;
}

std::string format_euroc_camera(const EurocCamera& camera) {
    const bool fisheye = is_kannala_brandt(camera.camera.model);
    const bool rational = is_rational(camera.camera.model);
    std::vector<double> coefficients = coefficients_of(camera.camera.model);
    // Other readers accept four coefficients, so the fifth is written only if it is not 0.
    if (!fisheye && !rational && coefficients.back() == 0.0) coefficients.pop_back();
    std::string out = "sensor_type: camera\n" + format_sensor_pose(camera.T_body_camera);
    out += fmt::format(
        "rate_hz: {}\nresolution: [{}, {}]\ncamera_model: pinhole\nintrinsics: {}   # fu, fv, cu, "
        "cv\n"
        "distortion_model: {}\ndistortion_coefficients: {}\n",
        camera.rate_hz,
        camera.camera.width,
        camera.camera.height,
        format_list(intrinsics_of(camera.camera.model)),
        fisheye    ? "equidistant"
        : rational ? "rational_polynomial"
                   : "radial-tangential",
        format_list(coefficients));
    if (camera.readout_s > 0.0) out += fmt::format("readout_s: {}\n", camera.readout_s);
    return out;
}

Result<camera::ImuMount> parse_euroc_imu(std::string_view text, const std::string& file) {
    const Result<YamlNode> root = parse_mapping(text, file);
    if (!root) return root.error();
    YamlReader yaml(file, *root);
    camera::ImuMount imu;
    imu.T_body_imu = read_sensor_pose(yaml);
    if (const YamlNode* rate = root->find("rate_hz"); rate != nullptr) {
        imu.rate_hz = yaml.number(*rate, "rate_hz", 1.0, 1e5);
    }
    if (yaml.error()) return *yaml.error();
    return imu;
}

std::string format_euroc_imu(const camera::ImuMount& imu) {
    return "sensor_type: imu\n" + format_sensor_pose(imu.T_body_imu) +
           fmt::format("rate_hz: {}\n", imu.rate_hz);
}

Result<camera::StereoRig> read_euroc_rig(const std::string& mav_folder) {
    const Result<EurocCamera> left = read_euroc_camera(join_path(mav_folder, "cam0/sensor.yaml"));
    if (!left) return left.error();
    const Result<EurocCamera> right = read_euroc_camera(join_path(mav_folder, "cam1/sensor.yaml"));
    if (!right) return right.error();
    camera::StereoRig rig;
    rig.name = "euroc";
    rig.left = left->camera;
    rig.right = right->camera;
    rig.T_left_right = left->T_body_camera.inverse() * right->T_body_camera;
    rig.T_body_left = left->T_body_camera;
    rig.rate_hz = left->rate_hz;
    rig.readout_s = left->readout_s;
    const std::string imu_folder = join_path(mav_folder, "imu0");
    const std::string imu_file = join_path(imu_folder, "sensor.yaml");
    if (is_file(imu_file)) {
        const Result<std::string> text = read_file(imu_file, limits::kSettingsBytes);
        if (!text) return text.error();
        const Result<camera::ImuMount> imu = parse_euroc_imu(*text, imu_file);
        if (!imu) return imu.error();
        rig.imu = *imu;
    } else if (is_file(join_path(imu_folder, "data.csv"))) {
        rig.imu = camera::ImuMount{};  // in EuRoC the IMU frame is the body frame
    }
    mark_if_rectified(rig);
    return checked_rig(std::move(rig), mav_folder);
}

}  // namespace surefoot::io

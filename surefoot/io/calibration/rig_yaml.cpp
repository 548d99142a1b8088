// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "surefoot/camera/rig_units.hpp"
#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/calibration/rig_lens.hpp"
#include "surefoot/io/calibration/rig_values.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

/// Hint for a missing key of the second camera, because the file may describe an RGB-D camera.
constexpr const char* kRgbdHint =
    "; a camera that measures depth itself (RGB-D) needs 'layout: rgbd' and no second camera";

/// Reads a required key of the second camera.
const YamlNode* required_of_pair(YamlReader& yaml, const char* key) {
    const YamlNode* node = yaml.root().find(key);
    if (node == nullptr)
        yaml.fail(yaml.root(), key, fmt::format("this key is missing{}", kRgbdHint));
    return node;
}

const std::vector<std::string>& common_keys() {
    static const std::vector<std::string> keys{"name",
                                               "layout",
                                               "resolution",
                                               "rate_hz",
                                               "readout_s",
                                               "rectified",
                                               "left",
                                               "right",
                                               "T_left_right",
                                               "T_body_left",
                                               "imu",
                                               "baseline_m",
                                               "focal_px",
                                               "principal_px",
                                               "distortion"};
    return keys;
}

/// Reads one camera block of the full form.
camera::Camera read_camera(YamlReader& yaml,
                           const YamlNode& node,
                           const std::string& name,
                           ImageSize size) {
    camera::Camera camera;
    camera.width = size.width;
    camera.height = size.height;
    if (!node.is_mapping()) {
        yaml.fail(
            node, name, "expected a group with model, focal_px, principal_px and coefficients");
        return camera;
    }
    yaml.only_keys(node, name + ".", {"model", "focal_px", "principal_px", "coefficients"});
    const YamlNode* model = yaml.required(node, "model");
    const YamlNode* focal = yaml.required(node, "focal_px");
    const YamlNode* principal = yaml.required(node, "principal_px");
    if (model == nullptr || focal == nullptr || principal == nullptr) return camera;
    std::vector<double> intrinsics = read_focal(yaml, *focal, name + ".focal_px");
    const std::vector<double> centre = yaml.numbers(*principal, name + ".principal_px", 2);
    intrinsics.insert(intrinsics.end(), centre.begin(), centre.end());
    const std::string model_name = yaml.text(*model, name + ".model");
    const bool fisheye = model_name == "kannala_brandt";
    const bool rational = model_name == "pinhole_rational";
    if (!fisheye && !rational && model_name != "pinhole") {
        yaml.fail(
            *model,
            name + ".model",
            quoted(model_name) + " is not one of pinhole | pinhole_rational | kannala_brandt");
    }
    std::vector<double> coefficients;
    if (const YamlNode* list = node.find("coefficients"); list != nullptr) {
        const std::size_t count = fisheye ? 4 : rational ? 8 : 5;
        coefficients = yaml.any_numbers(*list, name + ".coefficients", 14);
        drop_zero_tail(coefficients, count);
        const bool four = count == 5 && coefficients.size() == 4;  // without k3
        if (!coefficients.empty() && coefficients.size() != count && !four) {
            yaml.fail(
                *list,
                name + ".coefficients",
                fmt::format("found {} numbers; {} has {}", coefficients.size(), model_name, count));
        }
    }
    camera.model = fisheye    ? make_kannala_brandt(intrinsics, coefficients)
                   : rational ? make_rational(intrinsics, coefficients)
                              : make_pinhole(intrinsics, coefficients);
    return camera;
}

/// Reads the short form (baseline_m, focal_px, principal_px): two equal cameras without distortion,
/// or one RGB-D camera.
void read_short_form(YamlReader& yaml, ImageSize size, bool rgbd, camera::StereoRig& rig) {
    const YamlNode& root = yaml.root();
    for (const char* key : {"left", "right", "T_left_right"}) {
        const YamlNode* node = root.find(key);
        if (node != nullptr) yaml.fail(*node, key, "cannot be used together with 'focal_px'");
    }
    const YamlNode* focal = yaml.required(root, "focal_px");
    const YamlNode* principal = yaml.required(root, "principal_px");
    if (focal == nullptr || principal == nullptr) return;
    std::vector<double> intrinsics = read_focal(yaml, *focal, "focal_px");
    const std::vector<double> centre = yaml.numbers(*principal, "principal_px", 2);
    intrinsics.insert(intrinsics.end(), centre.begin(), centre.end());
    const YamlNode* distortion = root.find("distortion");
    if (distortion != nullptr && yaml.text(*distortion, "distortion") != "none") {
        yaml.fail(*distortion,
                  "distortion",
                  "must be 'none' here; lenses with distortion need a 'left' and a 'right' block");
    }
    rig.left = {make_pinhole(intrinsics, {}), size.width, size.height};
    rig.rectified = true;
    if (rgbd) return;
    rig.right = rig.left;
    const YamlNode* baseline = required_of_pair(yaml, "baseline_m");
    if (baseline == nullptr) return;
    constexpr double kLargest = 1e12;  // accepts any unit; baseline_problem checks the limit
    const double baseline_m = yaml.number(*baseline, "baseline_m", -kLargest, kLargest);
    if (const auto problem = camera::baseline_problem(baseline_m))
        yaml.fail(*baseline, "baseline_m", *problem);
    rig.T_left_right.translation_m.x() = baseline_m;
}

void read_full_form(YamlReader& yaml, ImageSize size, bool rgbd, camera::StereoRig& rig) {
    const YamlNode& root = yaml.root();
    for (const char* key : {"baseline_m", "focal_px", "principal_px", "distortion"}) {
        const YamlNode* node = root.find(key);
        if (node != nullptr) yaml.fail(*node, key, "cannot be used together with a 'left' block");
    }
    if (const YamlNode* left = yaml.required(root, "left"); left != nullptr) {
        rig.left = read_camera(yaml, *left, "left", size);
    }
    if (const YamlNode* rectified = root.find("rectified"); rectified != nullptr) {
        rig.rectified = yaml.boolean(*rectified, "rectified");
    }
    if (rgbd) return;
    const YamlNode* right = required_of_pair(yaml, "right");
    const YamlNode* T_left_right = yaml.required(root, "T_left_right");
    if (right == nullptr || T_left_right == nullptr) return;
    rig.right = read_camera(yaml, *right, "right", size);
    rig.T_left_right = read_pose(yaml, *T_left_right, "T_left_right");
}

void read_imu(YamlReader& yaml, const YamlNode& node, camera::StereoRig& rig) {
    if (!node.is_mapping())
        return yaml.fail(node, "imu", "expected a group with T_body_imu and rate_hz");
    yaml.only_keys(node, "imu.", {"T_body_imu", "rate_hz"});
    camera::ImuMount imu;
    if (const YamlNode* pose = yaml.required(node, "T_body_imu"); pose != nullptr) {
        imu.T_body_imu = read_pose(yaml, *pose, "imu.T_body_imu");
    }
    if (const YamlNode* rate = yaml.required(node, "rate_hz"); rate != nullptr) {
        imu.rate_hz = yaml.number(*rate, "imu.rate_hz", 1.0, 1e5);
    }
    rig.imu = imu;
}

/// Reads the keys that both forms share.
void read_common(YamlReader& yaml, camera::StereoRig& rig) {
    const YamlNode& root = yaml.root();
    if (const YamlNode* name = root.find("name"); name != nullptr)
        rig.name = yaml.text(*name, "name");
    if (const YamlNode* rate = root.find("rate_hz"); rate != nullptr) {
        rig.rate_hz = yaml.number(*rate, "rate_hz", 0.0, 1e4);
    }
    if (const YamlNode* readout = root.find("readout_s"); readout != nullptr) {
        rig.readout_s = yaml.number(*readout, "readout_s", 0.0, 1.0);
    }
    if (const YamlNode* pose = root.find("T_body_left"); pose != nullptr) {
        rig.T_body_left = read_pose(yaml, *pose, "T_body_left");
    }
    if (const YamlNode* imu = root.find("imu"); imu != nullptr) read_imu(yaml, *imu, rig);
}

std::string format_camera(const char* name, const camera::Camera& camera) {
    const std::vector<double> k = intrinsics_of(camera.model);
    return fmt::format("{}:\n  model: {}\n  focal_px: {}\n  principal_px: {}\n  coefficients: {}\n",
                       name,
                       is_kannala_brandt(camera.model) ? "kannala_brandt"
                       : is_rational(camera.model)     ? "pinhole_rational"
                                                       : "pinhole",
                       format_list({k[0], k[1]}),
                       format_list({k[2], k[3]}),
                       format_list(coefficients_of(camera.model)));
}

/// Formats a name as a YAML scalar in double quotes.
std::string quoted_scalar(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return out + "\"";
}

}  // namespace

Result<camera::StereoRig> parse_rig_yaml(std::string_view text, const std::string& file) {
    const Result<YamlNode> root = parse_yaml(text, file);
    if (!root) return root.error();
    if (!root->is_mapping()) {
        return input_error(
            fmt::format("{}: a rig file must have 'key: value' lines, but this one has {}",
                        file,
                        root->kind_name()));
    }
    YamlReader yaml(file, *root);
    yaml.only_keys(*root, "", common_keys());
    camera::StereoRig rig;
    std::string layout = "separate";
    if (const YamlNode* node = root->find("layout"); node != nullptr) {
        layout = yaml.text(*node, "layout");
        if (layout != "side_by_side" && layout != "separate" && layout != "rgbd") {
            yaml.fail(
                *node, "layout", quoted(layout) + " is not one of side_by_side | separate | rgbd");
        }
    }
    ImageSize size;
    if (const YamlNode* node = yaml.required(*root, "resolution"); node != nullptr) {
        size = read_size(yaml, *node, "resolution");
    }
    const bool rgbd = layout == "rgbd";
    const bool full = root->find("left") != nullptr && root->find("focal_px") == nullptr;
    full ? read_full_form(yaml, size, rgbd, rig) : read_short_form(yaml, size, rgbd, rig);
    read_common(yaml, rig);
    return checked_rig(std::move(rig), yaml);
}

std::string format_rig_yaml(const camera::StereoRig& rig) {
    std::string out;
    if (!rig.name.empty()) out += fmt::format("name: {}\n", quoted_scalar(rig.name));
    out += fmt::format(
        "layout: {}\nresolution: [{}, {}]   # px, one camera\nrate_hz: {}\nreadout_s: {}   # "
        "rolling "
        "shutter, 0 = global\nrectified: {}\n",
        rig.right ? "separate" : "rgbd",
        rig.left.width,
        rig.left.height,
        rig.rate_hz,
        rig.readout_s,
        rig.rectified);
    out += format_camera("left", rig.left);
    if (rig.right) {
        out += format_camera("right", *rig.right);
        out += fmt::format("T_left_right: {}   # 4x4 row by row, m\n",
                           format_pose_rows(rig.T_left_right));
    }
    if (rig.T_body_left) {
        out += fmt::format("T_body_left: {}\n", format_pose_rows(*rig.T_body_left));
    }
    if (rig.imu) {
        out += fmt::format("imu:\n  T_body_imu: {}\n  rate_hz: {}\n",
                           format_pose_rows(rig.imu->T_body_imu),
                           rig.imu->rate_hz);
    }
    return out;
}

Status write_rig_yaml(const std::string& path, const camera::StereoRig& rig) {
    if (const auto problem = rig.problem()) {
        return output_error(fmt::format("{}: this rig cannot be written: {}", path, *problem));
    }
    return write_file(path, format_rig_yaml(rig));
}

}  // namespace surefoot::io

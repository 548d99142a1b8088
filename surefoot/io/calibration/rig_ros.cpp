// SPDX-License-Identifier: Apache-2.0
// Reads and writes ROS camera_info files, after the comments of sensor_msgs/CameraInfo and REP 104.
// K and D belong to the raw image. R rotates the raw camera frame into the rectified frame, and P
// projects from the rectified frame; P(0, 3) = -fx' * Tx.
#include <fmt/format.h>

#include <algorithm>

#include "surefoot/camera/rig_units.hpp"
#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_lens.hpp"
#include "surefoot/io/calibration/rig_values.hpp"
#include "surefoot/io/settings/yaml_tree.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

/// Keys of two forms: files of camera_calibration_parsers, and a sensor_msgs/CameraInfo that `ros2
/// topic echo` or `rostopic echo` printed.
struct RosKeys {
    const char *width, *height, *K, *D, *R, *P;
};
constexpr RosKeys kFileKeys{"image_width",
                            "image_height",
                            "camera_matrix",
                            "distortion_coefficients",
                            "rectification_matrix",
                            "projection_matrix"};
constexpr RosKeys kRos1Keys{"width", "height", "K", "D", "R", "P"};
constexpr RosKeys kRos2Keys{"width", "height", "k", "d", "r", "p"};

const RosKeys& keys_of(const YamlNode& root) {
    if (root.find(kRos2Keys.K) != nullptr) return kRos2Keys;
    return root.find(kRos1Keys.K) != nullptr ? kRos1Keys : kFileKeys;
}

/// One camera of the pair.
struct RosCamera {
    camera::Camera camera;
    Pose T_rectified_raw;
    double x_m = 0.0;          ///< x of the camera centre in the rectified frame [m]
    bool has_rotation = true;  ///< false if R is all zero ("not rectified")
    std::vector<std::string> notes;
};

bool all_zero(const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double value) { return value == 0.0; });
}

const YamlNode& required_matrix(YamlReader& yaml, const char* key) {
    const YamlNode* node = yaml.required(yaml.root(), key);
    return node == nullptr ? yaml.root() : *node;
}

std::string read_model(YamlReader& yaml, const YamlNode& list, const char* key, bool zero) {
    const YamlNode* node = yaml.root().find("distortion_model");
    if (node == nullptr) return "plumb_bob";  // the default if the key is missing
    std::string model = yaml.text(*node, "distortion_model");
    if (!model.empty() && model != "none") return model;
    if (zero) return "none";
    yaml.fail(list,
              key,
              fmt::format("the coefficients are not 0, but distortion_model is {}; set it to "
                          "plumb_bob, rational_polynomial or equidistant",
                          quoted(model)));
    return "none";
}

camera::CameraModel read_lens(YamlReader& yaml, const RosKeys& keys, RosCamera& out) {
    const YamlNode& matrix = required_matrix(yaml, keys.K);
    const YamlNode& list = required_matrix(yaml, keys.D);
    if (yaml.error()) return {};
    const std::vector<double> K = read_matrix(yaml, matrix, keys.K, 9, 9);
    std::vector<double> D = read_matrix(yaml, list, keys.D, 0, 14);
    if (yaml.error()) return {};
    check_focal(yaml, matrix, keys.K, K);
    const std::vector<double> k{K[0], K[4], K[2], K[5]};
    const std::string model = read_model(yaml, list, keys.D, all_zero(D));
    const auto expect = [&](std::size_t min, std::size_t max) {
        drop_zero_tail(D, max);
        if (D.size() >= min && D.size() <= max) return;
        yaml.fail(list,
                  keys.D,
                  min == max ? fmt::format("found {} numbers; {} has {}", D.size(), model, max)
                             : fmt::format(
                                   "found {} numbers; {} has {} or {}", D.size(), model, min, max));
    };
    if (model == "none") return make_pinhole(k, {});
    if (model == "equidistant" || model == "fisheye") {
        expect(4, 4);
        if (yaml.error()) return {};
        return lens_or_fail(yaml, list, keys.D, fisheye_lens(k, std::move(D)));
    }
    if (model == "rational_polynomial") {
        if (D.size() < 8) expect(8, 8);
        return lens_or_fail(yaml, list, keys.D, pinhole_lens(k, std::move(D)));
    }
    if (model != "plumb_bob") {
        yaml.fail(*yaml.root().find("distortion_model"),  // exists: a missing key means plumb_bob
                  "distortion_model",
                  quoted(model) + " is not one of plumb_bob | rational_polynomial | equidistant");
        return {};
    }
    const std::size_t given = D.size();
    drop_zero_tail(D, 5);
    if (given < 8 && !D.empty()) expect(4, 5);
    if (D.size() > 5 && !yaml.error()) {
        out.notes.push_back(
            fmt::format("distortion_model is plumb_bob, but coefficients after k3 in {} are not 0: "
                        "the program reads all coefficients as rational_polynomial",
                        keys.D));
    }
    return lens_or_fail(yaml, list, keys.D, pinhole_lens(k, std::move(D)));
}

void read_rectification(YamlReader& yaml, const RosKeys& keys, RosCamera& out) {
    const YamlNode& rotation = required_matrix(yaml, keys.R);
    const YamlNode& projection = required_matrix(yaml, keys.P);
    if (yaml.error()) return;
    const std::vector<double> R = read_matrix(yaml, rotation, keys.R, 9, 9);
    const std::vector<double> P = read_matrix(yaml, projection, keys.P, 12, 12);
    if (yaml.error()) return;
    out.has_rotation = !all_zero(R);
    if (out.has_rotation) {
        out.T_rectified_raw = pose_from_parts(yaml, rotation, keys.R, R, {0.0, 0.0, 0.0});
    }
    if (all_zero(P)) {
        yaml.fail(projection,
                  keys.P,
                  "all zero: this camera is not calibrated as one of a pair. Calibrate both at "
                  "once (ROS cameracalibrator, or 'surefoot calibrate stereo')");
        return;
    }
    if (!(P[0] > 0.0) || !(P[5] > 0.0)) {
        yaml.fail(projection,
                  keys.P,
                  fmt::format("focal lengths {} and {} must be above 0 px", P[0], P[5]));
        return;
    }
    if (P[7] != 0.0) {
        yaml.fail(projection,
                  keys.P,
                  fmt::format("element (1, 3) is {}, but must be 0; cameras on top of each other "
                              "are not supported",
                              P[7]));
    }
    out.x_m = -P[3] / P[0];
}

/// Reads an optional number of a message; 0 if it is missing.
int count_or_zero(YamlReader& yaml,
                  const YamlNode& group,
                  const char* key,
                  const std::string& name) {
    const YamlNode* node = group.find(key);
    return node == nullptr ? 0 : yaml.integer(*node, name, 0, kMaxRigSide_px);
}

void shift_and_shrink(camera::Camera& camera, int x_px, int y_px, double bin_x, double bin_y) {
    std::visit(
        [&](auto& m) {  // pixel centres have whole coordinates
            m.fx_px /= bin_x;
            m.fy_px /= bin_y;
            m.cx_px = (m.cx_px - x_px + 0.5) / bin_x - 0.5;
            m.cy_px = (m.cy_px - y_px + 0.5) / bin_y - 0.5;
        },
        camera.model);
}

/// Applies roi and binning to the image that K belongs to. First roi selects a part of this image
/// [px] (all 0 = the whole image). Then binning_x and binning_y shrink this part.
void apply_window(YamlReader& yaml, RosCamera& out) {
    const YamlNode& root = yaml.root();
    camera::Camera& camera = out.camera;
    const int bin_x = std::max(1, count_or_zero(yaml, root, "binning_x", "binning_x"));
    const int bin_y = std::max(1, count_or_zero(yaml, root, "binning_y", "binning_y"));
    const YamlNode* roi = root.find("roi");
    int x = 0, y = 0, width = 0, height = 0;
    if (roi != nullptr) {
        x = count_or_zero(yaml, *roi, "x_offset", "roi.x_offset");
        y = count_or_zero(yaml, *roi, "y_offset", "roi.y_offset");
        width = count_or_zero(yaml, *roi, "width", "roi.width");
        height = count_or_zero(yaml, *roi, "height", "roi.height");
    }
    if (yaml.error()) return;
    if (width == 0 && height == 0 && x == 0 && y == 0) {
        width = camera.width;
        height = camera.height;
    }
    if (width < 1 || height < 1 || x + width > camera.width || y + height > camera.height) {
        return yaml.fail(*roi,
                         "roi",
                         fmt::format("{} x {} px at ({}, {}) is not inside the image of {} x {} px",
                                     width,
                                     height,
                                     x,
                                     y,
                                     camera.width,
                                     camera.height));
    }
    if (width % bin_x != 0 || height % bin_y != 0) {
        return yaml.fail(
            root,
            "binning_x, binning_y",
            fmt::format("{} x {} px cannot be binned by {} x {}: a side is not a multiple of its "
                        "binning factor. Calibrate at the image size that the camera delivers",
                        width,
                        height,
                        bin_x,
                        bin_y));
    }
    const bool whole = width == camera.width && height == camera.height;
    if (whole && bin_x == 1 && bin_y == 1) return;
    out.notes.push_back(
        fmt::format("roi and binning are applied: the rig is for images of {} x {} px. They show "
                    "the part of {} x {} px at ({}, {}) of the full image of {} x {} px",
                    width / bin_x,
                    height / bin_y,
                    width,
                    height,
                    x,
                    y,
                    camera.width,
                    camera.height));
    shift_and_shrink(camera, x, y, bin_x, bin_y);
    camera.width = width / bin_x;
    camera.height = height / bin_y;
}

Result<RosCamera> parse_camera(const NamedText& in) {
    const Result<YamlNode> root = parse_yaml(in.text, in.file);
    if (!root) return root.error();
    if (!root->is_mapping()) {
        return input_error(in.file + ": expected 'key: value' lines of a ROS camera_info file");
    }
    YamlReader yaml(in.file, *root);
    const RosKeys& keys = keys_of(*root);
    RosCamera out;
    const YamlNode* width = yaml.required(*root, keys.width);
    const YamlNode* height = yaml.required(*root, keys.height);
    if (width != nullptr && height != nullptr) {
        out.camera.width = yaml.integer(*width, keys.width, 1, kMaxRigSide_px);
        out.camera.height = yaml.integer(*height, keys.height, 1, kMaxRigSide_px);
    }
    out.camera.model = read_lens(yaml, keys, out);
    read_rectification(yaml, keys, out);
    apply_window(yaml, out);
    if (yaml.error()) return *yaml.error();
    if (const auto problem = out.camera.problem()) {
        return input_error(fmt::format("{}: {}", in.file, *problem));
    }
    return out;
}

/// Checks the rotations. A driver that does not rectify writes an R of zeros. The cameras then
/// count as parallel.
Status check_rotations(const RosCamera& l, const RosCamera& r, RigFile& out) {
    if (l.has_rotation != r.has_rotation) {
        return input_error(
            "the rectification matrix of one camera is all zero (not rectified), but that of the "
            "other camera is not. Both files must come from one stereo calibration");
    }
    if (l.has_rotation) return {};
    out.notes.emplace_back(
        "the rectification matrices are all zero (not rectified): the program assumes parallel "
        "cameras. A stereo calibration gives their true directions");
    return {};
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
        return input_error(
            fmt::format("{}: projection_matrix: element (0, 3) gives a baseline of {} m, but a "
                        "baseline must be above 0 m. In the file of the right camera this element "
                        "must be -fx * baseline. If the element is 0, the cameras were calibrated "
                        "one by one; if it is above 0, the cameras are swapped",
                        right.file,
                        baseline_m));
    }
    if (const auto problem = camera::baseline_problem(baseline_m)) {
        return input_error(fmt::format(
            "{}: projection matrix: {} (element (0, 3) is -fx * baseline)", right.file, *problem));
    }
    RigFile out;
    out.format = RigFormat::ros;
    if (Status status = check_rotations(*l, *r, out); !status)
        return input_error(fmt::format("{}: {}", right.file, status.error().message));
    for (const RosCamera* camera : {&*l, &*r}) {
        for (const std::string& note : camera->notes) {
            if (std::find(out.notes.begin(), out.notes.end(), note) == out.notes.end())
                out.notes.push_back(note);
        }
    }
    out.rig.name = "ros";
    out.rig.left = l->camera;
    out.rig.right = r->camera;
    const Pose T_rectified_right{r->T_rectified_raw.rotation, {baseline_m, 0.0, 0.0}};
    out.rig.T_left_right = l->T_rectified_raw.inverse() * T_rectified_right;
    return checked_file(std::move(out), left.file);
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

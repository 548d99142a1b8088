// SPDX-License-Identifier: Apache-2.0
// OpenCV FileStorage YAML as its stereo calibration sample and most users write it. A matrix is
// {rows, cols, dt, data}; x_right = R x_left + T (stereoCalibrate).
#include <fmt/format.h>

#include <cmath>

#include "io/rig_file.hpp"
#include "io/rig_formats.hpp"
#include "io/rig_values.hpp"
#include "io/text.hpp"

namespace surefoot::io {
namespace {

/// A translation larger than this was certainly not given in metres.
constexpr double kMaxBaseline_m = 5.0;

struct Named {
    const YamlNode* node = nullptr;
    std::string key;
};

/// First of several spellings of a key.
Named find_any(const YamlNode& root, std::initializer_list<const char*> keys) {
    for (const char* key : keys) {
        if (const YamlNode* node = root.find(key); node != nullptr) return {node, key};
    }
    return {};
}

Named require_any(YamlReader& yaml, std::initializer_list<const char*> keys) {
    Named found = find_any(yaml.root(), keys);
    if (found.node == nullptr)
        yaml.required(yaml.root(), *keys.begin());  // reports the first spelling
    return found;
}

bool is_fisheye(const YamlNode& root) {
    const Named flag = find_any(root, {"fisheye", "model", "distortion_model", "camera_model"});
    if (flag.node == nullptr) return false;
    const std::string value = lowercase(flag.node->scalar);
    return value == "1" || value == "true" || value == "fisheye" || value == "equidistant" ||
           value == "kannala_brandt";
}

camera::CameraModel read_lens(YamlReader& yaml, const Named& matrix, const Named& distortion) {
    const std::vector<double> K = read_matrix(yaml, *matrix.node, matrix.key, 9, 9);
    std::vector<double> D = read_matrix(yaml, *distortion.node, distortion.key, 4, 14);
    if (yaml.error()) return {};
    check_focal(yaml, *matrix.node, matrix.key, K);
    if (is_fisheye(yaml.root())) {
        if (D.size() != 4)
            yaml.fail(*distortion.node, distortion.key, "a fisheye has 4 coefficients");
        return make_kannala_brandt({K[0], K[4], K[2], K[5]}, D);
    }
    for (std::size_t i = 8; i < D.size(); ++i) {
        if (D[i] == 0.0) continue;
        yaml.fail(*distortion.node,
                  distortion.key,
                  fmt::format("coefficient {} is {}; only k1 k2 p1 p2 k3 k4 k5 k6 are supported, "
                              "calibrate without the thin-prism and tilt terms",
                              i + 1,
                              D[i]));
    }
    return make_pinhole({K[0], K[4], K[2], K[5]}, D);
}

/// R and T turned into T_left_right = (R, T)^-1.
Pose read_extrinsics(YamlReader& yaml) {
    const Named R_node = require_any(yaml, {"R", "rotation", "R_stereo"});
    const Named T_node = require_any(yaml, {"T", "translation", "T_stereo"});
    if (yaml.error()) return {};
    const std::vector<double> R = read_matrix(yaml, *R_node.node, R_node.key, 9, 9);
    const std::vector<double> T = read_matrix(yaml, *T_node.node, T_node.key, 3, 3);
    if (yaml.error()) return {};
    const double length_m = std::sqrt(T[0] * T[0] + T[1] * T[1] + T[2] * T[2]);
    if (length_m > kMaxBaseline_m) {
        yaml.fail(
            *T_node.node,
            T_node.key,
            fmt::format("a baseline of {:.3f} m exceeds {} m; T must be in metres (calibrate with "
                        "the square size in metres)",
                        length_m,
                        kMaxBaseline_m));
    }
    const Pose T_right_left = pose_from_parts(yaml, *R_node.node, R_node.key, R, T);
    return T_right_left.inverse();
}

ImageSize find_size(YamlReader& yaml, std::optional<ImageSize> fallback) {
    const YamlNode& root = yaml.root();
    const Named width = find_any(root, {"image_width", "width"});
    const Named height = find_any(root, {"image_height", "height"});
    if (width.node != nullptr && height.node != nullptr) {
        return {yaml.integer(*width.node, width.key, 1, kMaxRigSide_px),
                yaml.integer(*height.node, height.key, 1, kMaxRigSide_px)};
    }
    const Named size = find_any(root, {"image_size", "imageSize", "size", "resolution"});
    if (size.node != nullptr) {
        const std::vector<double> sides = read_matrix(yaml, *size.node, size.key, 2, 2);
        for (const double side : sides) {
            if (side >= 1.0 && side <= kMaxRigSide_px) continue;
            yaml.fail(*size.node, size.key, fmt::format("{} is no image side", side));
            return {};
        }
        return {static_cast<int>(sides[0]), static_cast<int>(sides[1])};
    }
    if (!fallback) {
        yaml.fail(root,
                  "image_width",
                  "the file does not hold the image size; add image_width and image_height");
    }
    return fallback.value_or(ImageSize{});
}

/// A matrix as cv::FileStorage writes it, doubles row by row.
std::string format_matrix(std::string_view key,
                          std::size_t rows,
                          std::size_t cols,
                          const std::vector<double>& data) {
    return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: {}\n",
                       key,
                       rows,
                       cols,
                       format_list(data));
}

std::vector<double> row_major(const Eigen::Matrix3d& M) {
    return {M(0, 0), M(0, 1), M(0, 2), M(1, 0), M(1, 1), M(1, 2), M(2, 0), M(2, 1), M(2, 2)};
}

std::string format_lens(char number, const camera::CameraModel& model) {
    const std::vector<double> k = intrinsics_of(model);
    const std::vector<double> D = coefficients_of(model);
    return format_matrix(fmt::format("M{}", number),
                         3,
                         3,
                         {k[0], 0.0, k[2], 0.0, k[1], k[3], 0.0, 0.0, 1.0}) +
           format_matrix(fmt::format("D{}", number), 1, D.size(), D);
}

}  // namespace

Result<std::string> format_opencv_rig(const camera::StereoRig& rig) {
    if (Status status = check_pair(rig, "OpenCV"); !status) return status.error();
    const bool fisheye = is_kannala_brandt(rig.left.model);
    if (fisheye != is_kannala_brandt(rig.right->model)) {
        return output_error("an OpenCV file holds two fisheye lenses or none; this rig mixes them");
    }
    const Pose T_right_left = rig.T_left_right.inverse();
    const Eigen::Vector3d& t = T_right_left.translation_m;
    const RectifiedMatrices m = rectified_matrices(rig);
    return fmt::format("%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\nfisheye: {}\n",
                       rig.left.width,
                       rig.left.height,
                       fisheye ? 1 : 0) +
           format_lens('1', rig.left.model) + format_lens('2', rig.right->model) +
           format_matrix("R", 3, 3, row_major(T_right_left.R())) +
           format_matrix("T", 3, 1, {t.x(), t.y(), t.z()}) + format_matrix("R1", 3, 3, m.R_left) +
           format_matrix("R2", 3, 3, m.R_right) + format_matrix("P1", 3, 4, m.P_left) +
           format_matrix("P2", 3, 4, m.P_right) + format_matrix("Q", 4, 4, m.Q);
}

Result<camera::StereoRig> parse_opencv_rig(std::string_view text,
                                           const std::string& file,
                                           std::optional<ImageSize> size) {
    const Result<YamlNode> root = parse_yaml(text, file);
    if (!root) return root.error();
    return opencv_rig(*root, file, size);
}

Result<camera::StereoRig> opencv_rig(const YamlNode& root,
                                     const std::string& file,
                                     std::optional<ImageSize> size) {
    if (!root.is_mapping()) return input_error(file + ": not an OpenCV calibration file");
    YamlReader yaml(file, root);
    camera::StereoRig rig;
    rig.name = "opencv";
    const ImageSize image = find_size(yaml, size);
    const Named left_matrix =
        require_any(yaml, {"M1", "K1", "cameraMatrix1", "camera_matrix_1", "camera_matrix_left"});
    const Named right_matrix =
        require_any(yaml, {"M2", "K2", "cameraMatrix2", "camera_matrix_2", "camera_matrix_right"});
    const Named left_distortion =
        require_any(yaml, {"D1", "distCoeffs1", "dist_coeffs_1", "dist_coeffs_left"});
    const Named right_distortion =
        require_any(yaml, {"D2", "distCoeffs2", "dist_coeffs_2", "dist_coeffs_right"});
    if (yaml.error()) return *yaml.error();
    rig.left = {read_lens(yaml, left_matrix, left_distortion), image.width, image.height};
    rig.right =
        camera::Camera{read_lens(yaml, right_matrix, right_distortion), image.width, image.height};
    rig.T_left_right = read_extrinsics(yaml);
    if (yaml.error()) return *yaml.error();
    mark_if_rectified(rig);
    return checked_rig(std::move(rig), file);
}

}  // namespace surefoot::io

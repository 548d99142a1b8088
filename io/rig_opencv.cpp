// SPDX-License-Identifier: Apache-2.0
// OpenCV FileStorage YAML as its stereo calibration sample and most users write it. A matrix is
// {rows, cols, dt, data}; x_right = R x_left + T (stereoCalibrate).
#include <fmt/format.h>

#include <cmath>

#include "io/rig_file.hpp"
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

/// Numbers of a matrix {rows, cols, data} or of a plain list.
std::vector<double> read_matrix(YamlReader& yaml,
                                const Named& named,
                                std::size_t min,
                                std::size_t max) {
    if (named.node == nullptr) return std::vector<double>(min, 0.0);
    const YamlNode* data = named.node;
    if (data->is_mapping()) data = yaml.required(*named.node, "data");
    std::vector<double> values;
    if (data != nullptr) values = yaml.any_numbers(*data, named.key, max);
    if (values.size() < min) {
        yaml.fail(*named.node,
                  named.key,
                  fmt::format("{} numbers; at least {} belong here", values.size(), min));
        values.resize(min, 0.0);
    }
    return values;
}

bool is_fisheye(const YamlNode& root) {
    const Named flag = find_any(root, {"fisheye", "model", "distortion_model", "camera_model"});
    if (flag.node == nullptr) return false;
    const std::string value = lowercase(flag.node->scalar);
    return value == "1" || value == "true" || value == "fisheye" || value == "equidistant" ||
           value == "kannala_brandt";
}

camera::CameraModel read_lens(YamlReader& yaml, const Named& matrix, const Named& distortion) {
    const std::vector<double> K = read_matrix(yaml, matrix, 9, 9);
    std::vector<double> D = read_matrix(yaml, distortion, 4, 14);
    if (yaml.error()) return {};
    if (!(K[0] > 0.0) || !(K[4] > 0.0)) {
        yaml.fail(*matrix.node,
                  matrix.key,
                  fmt::format("focal lengths {} and {} must be above 0 px", K[0], K[4]));
    }
    if (is_fisheye(yaml.root())) {
        if (D.size() != 4)
            yaml.fail(*distortion.node, distortion.key, "a fisheye has 4 coefficients");
        return make_kannala_brandt({K[0], K[4], K[2], K[5]}, D);
    }
    for (std::size_t i = 5; i < D.size(); ++i) {
        if (D[i] == 0.0) continue;
        yaml.fail(*distortion.node,
                  distortion.key,
                  fmt::format("coefficient {} is {}; only k1 k2 p1 p2 k3 are supported, calibrate "
                              "without the rational and thin-prism terms",
                              i + 1,
                              D[i]));
    }
    return make_pinhole({K[0], K[4], K[2], K[5]}, D);
}

/// R and T turned into T_left_right = (R, T)^-1.
Pose read_extrinsics(YamlReader& yaml) {
    const Named R_node = require_any(yaml, {"R", "rotation", "R_stereo"});
    const Named T_node = require_any(yaml, {"T", "translation", "T_stereo"});
    const std::vector<double> R = read_matrix(yaml, R_node, 9, 9);
    const std::vector<double> T = read_matrix(yaml, T_node, 3, 3);
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
    const Pose T_right_left = pose_from_rows(yaml,
                                             *R_node.node,
                                             R_node.key,
                                             {R[0],
                                              R[1],
                                              R[2],
                                              T[0],
                                              R[3],
                                              R[4],
                                              R[5],
                                              T[1],
                                              R[6],
                                              R[7],
                                              R[8],
                                              T[2],
                                              0.0,
                                              0.0,
                                              0.0,
                                              1.0});
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
        const std::vector<double> sides = read_matrix(yaml, size, 2, 2);
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

}  // namespace

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

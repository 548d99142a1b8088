// SPDX-License-Identifier: Apache-2.0
// Reads and writes FileStorage YAML in the form of OpenCV's stereo calibration sample. A matrix is
// {rows, cols, dt, data}; x_right = R x_left + T (stereoCalibrate).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "surefoot/camera/rig_units.hpp"
#include "surefoot/io/calibration/opencv_names.hpp"
#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_lens.hpp"
#include "surefoot/io/calibration/rig_values.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

std::vector<double> row_major(const Eigen::Matrix3d& M) {
    return {M(0, 0), M(0, 1), M(0, 2), M(1, 0), M(1, 1), M(1, 2), M(2, 0), M(2, 1), M(2, 2)};
}

bool is_fisheye(const YamlNode& root) {
    for (const char* key : {"fisheye", "model", "distortion_model", "camera_model"}) {
        const YamlNode* flag = root.find(key);
        if (flag == nullptr) continue;
        const std::string value = lowercase(flag->scalar);
        return value == "1" || value == "true" || value == "fisheye" || value == "equidistant" ||
               value == "kannala_brandt";
    }
    return false;
}

/// Requires a matrix. `other` is the same matrix of the other camera; the error message names its
/// key.
bool require(YamlReader& yaml, const NamedNode& found, const char* what, const NamedNode& other) {
    if (found.node != nullptr) return true;
    yaml.fail(
        yaml.root(),
        what,
        other.node != nullptr
            ? fmt::format("not found; the key of the other camera is '{}'. Use the same name for "
                          "both keys, except for 1 and 2, left and right, or l and r",
                          other.key)
            : "not found under any of its usual names; use OpenCV's names M1, D1, M2, D2, R and T");
    return false;
}

camera::CameraModel read_lens(YamlReader& yaml,
                              const NamedNode& matrix,
                              const NamedNode& distortion) {
    const std::vector<double> K = read_matrix(yaml, *matrix.node, matrix.key, 9, 9);
    const std::vector<double> D = read_matrix(yaml, *distortion.node, distortion.key, 4, 14);
    if (yaml.error()) return {};
    check_focal(yaml, *matrix.node, matrix.key, K);
    const std::vector<double> k{K[0], K[4], K[2], K[5]};
    return lens_or_fail(yaml,
                        *distortion.node,
                        distortion.key,
                        is_fisheye(yaml.root()) ? fisheye_lens(k, D) : pinhole_lens(k, D));
}

/// Adds a note about an ambiguous lens. Both cv::fisheye and cv::calibrateCamera without k3 write
/// four coefficients, and cv::fisheye does not write the name of its lens model.
void note_unmarked_lens(YamlReader& yaml, const NamedNode& distortion, RigFile& out) {
    const YamlNode& root = yaml.root();
    for (const char* key : {"fisheye", "model", "distortion_model", "camera_model"}) {
        if (root.find(key) != nullptr) return;
    }
    const std::vector<double> D = read_matrix(yaml, *distortion.node, distortion.key, 4, 14);
    const auto is_zero = [](double value) { return value == 0.0; };
    if (D.size() != 4 || std::all_of(D.begin(), D.end(), is_zero)) return;
    out.notes.push_back(
        fmt::format("{}: four coefficients without the name of a lens model are read as k1 k2 p1 "
                    "p2 of a pinhole; if cv::fisheye made them, add 'fisheye: 1' to the file",
                    distortion.key));
}

/// Reads a rotation matrix or a rotation vector (cv::Rodrigues) and returns 9 numbers.
std::vector<double> read_rotation(YamlReader& yaml, const NamedNode& named, RigFile& out) {
    std::vector<double> R = read_matrix(yaml, *named.node, named.key, 3, 9);
    if (R.size() == 3) {
        out.notes.push_back(
            fmt::format("{}: the three numbers are read as a rotation vector", named.key));
        return row_major(exp_so3({R[0], R[1], R[2]}).toRotationMatrix());
    }
    if (R.size() != 9) {
        yaml.fail(*named.node,
                  named.key,
                  fmt::format("found {} numbers; a rotation matrix has 9, a rotation vector 3",
                              R.size()));
        R.resize(9, 0.0);
    }
    return R;
}

/// Reads R and T and returns T_left_right = (R, T)^-1.
Pose read_extrinsics(YamlReader& yaml, const OpenCvNames& names, RigFile& out) {
    if (names.R.node == nullptr) yaml.required(yaml.root(), "R");
    if (names.T.node == nullptr) yaml.required(yaml.root(), "T");
    if (yaml.error()) return {};
    const std::vector<double> R = read_rotation(yaml, names.R, out);
    const std::vector<double> T = read_matrix(yaml, *names.T.node, names.T.key, 3, 3);
    if (yaml.error()) return {};
    const double length_m = std::sqrt(T[0] * T[0] + T[1] * T[1] + T[2] * T[2]);
    if (const auto problem = camera::baseline_problem(length_m)) {
        yaml.fail(*names.T.node,
                  names.T.key,
                  *problem + " (stereoCalibrate returns T in the unit of the board's squares)");
    }
    return pose_from_parts(yaml, *names.R.node, names.R.key, R, T).inverse();
}

ImageSize find_size(YamlReader& yaml, const OpenCvNames& names, std::optional<ImageSize> fallback) {
    if (names.width.node != nullptr && names.height.node != nullptr) {
        return {yaml.integer(*names.width.node, names.width.key, 1, kMaxRigSide_px),
                yaml.integer(*names.height.node, names.height.key, 1, kMaxRigSide_px)};
    }
    if (names.size.node != nullptr) {
        const YamlNode* data =
            names.size.node->is_mapping() ? names.size.node->find("data") : nullptr;
        return read_size(yaml, data != nullptr ? *data : *names.size.node, names.size.key);
    }
    if (!fallback) {
        yaml.fail(yaml.root(),
                  "image size",
                  "the file has no image size. Convert it to a rig.yaml with 'surefoot rig FILE "
                  "--resolution WIDTHxHEIGHT --out rig.yaml', or add image_width and image_height");
    }
    return fallback.value_or(ImageSize{});
}

/// Formats a matrix of doubles, row by row, as cv::FileStorage does.
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
        return output_error(
            "an OpenCV file stores either two fisheye lenses or two pinhole lenses, but this rig "
            "has one fisheye lens and one pinhole lens; choose another format");
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
    Result<RigFile> out = opencv_rig(*root, file, size);
    if (!out) return out.error();
    return std::move(out->rig);
}

Result<RigFile> opencv_rig(const YamlNode& root,
                           const std::string& file,
                           std::optional<ImageSize> size) {
    if (!root.is_mapping()) return input_error(file + ": not an OpenCV calibration file");
    YamlReader yaml(file, root);
    const OpenCvNames names = find_opencv_names(root);
    require(yaml, names.left_matrix, "camera matrix of the left camera", names.right_matrix);
    require(yaml, names.right_matrix, "camera matrix of the right camera", names.left_matrix);
    require(yaml, names.left_distortion, "distortion of the left camera", names.right_distortion);
    require(yaml, names.right_distortion, "distortion of the right camera", names.left_distortion);
    if (yaml.error()) return *yaml.error();
    RigFile out;
    out.format = RigFormat::opencv;
    out.rig.name = "opencv";
    const ImageSize image = find_size(yaml, names, size);
    if (yaml.error()) return *yaml.error();
    out.rig.left = {
        read_lens(yaml, names.left_matrix, names.left_distortion), image.width, image.height};
    out.rig.right = camera::Camera{
        read_lens(yaml, names.right_matrix, names.right_distortion), image.width, image.height};
    out.rig.T_left_right = read_extrinsics(yaml, names, out);
    if (yaml.error()) return *yaml.error();
    note_unmarked_lens(yaml, names.left_distortion, out);
    return checked_file(std::move(out), file);
}

}  // namespace surefoot::io

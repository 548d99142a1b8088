// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/io/settings/yaml_tree.hpp"

/// Finds the matrices of a stereo calibration in an OpenCV file; private to the rig readers.
/// cv::FileStorage lets the writer choose the names, so every tutorial uses its own.
namespace surefoot::io {

/// A value and its key ("left.K" for a key inside a group).
struct NamedNode {
    const YamlNode* node = nullptr;
    std::string key;
};

/// Nodes point into the document; nullptr if a matrix was not found.
struct OpenCvNames {
    NamedNode left_matrix, right_matrix;  ///< K1, M1, cameraMatrixL, left_camera_matrix, mtxL ..
    NamedNode left_distortion, right_distortion;  ///< D1, distL, left_distortion ..
    NamedNode R, T;  ///< x_right = R x_left + T; R may be a rotation vector
    NamedNode width, height, size;
};

/// Ignores case, '_', '-' and '.' in keys. Keys may be in one group for each camera.
[[nodiscard]] OpenCvNames find_opencv_names(const YamlNode& root);

}  // namespace surefoot::io

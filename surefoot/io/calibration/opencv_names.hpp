// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/io/settings/yaml_tree.hpp"

/// Where the matrices of a stereo calibration stand in an OpenCV file; private to the rig readers.
/// cv::FileStorage leaves the names to the writer, so every tutorial has its own.
namespace surefoot::io {

/// A value and the key under which it was found ("left.K" for a key inside a group).
struct NamedNode {
    const YamlNode* node = nullptr;
    std::string key;
};

/// Nodes point into the document; nullptr where nothing was found.
struct OpenCvNames {
    NamedNode left_matrix, right_matrix;  ///< K1, M1, cameraMatrixL, left_camera_matrix, mtxL ..
    NamedNode left_distortion, right_distortion;  ///< D1, distL, left_distortion ..
    NamedNode R, T;  ///< x_right = R x_left + T; R may be a rotation vector
    NamedNode width, height, size;
};

/// Case, '_', '-' and '.' of the keys do not matter; keys may stand in one group for each camera.
[[nodiscard]] OpenCvNames find_opencv_names(const YamlNode& root);

}  // namespace surefoot::io

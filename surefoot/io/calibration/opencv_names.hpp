// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/io/settings/yaml_tree.hpp"

/// Finds the matrices of a stereo calibration in an OpenCV file; private to the rig readers.
/// cv::FileStorage lets the writer choose the names, so tutorials use different names.
namespace surefoot::io {

/// Value of a key, and the key itself ("left.K" for a key inside a group).
struct NamedNode {
    const YamlNode* node = nullptr;
    std::string key;
};

/// Nodes point into the document; nullptr if a matrix was not found.
struct OpenCvNames {
    NamedNode left_matrix, right_matrix;          ///< for example K1, M1, cameraMatrixL or mtxL
    NamedNode left_distortion, right_distortion;  ///< for example D1, distL or left_distortion
    NamedNode R, T;  ///< x_right = R x_left + T [m]; R may be a rotation vector
    NamedNode width, height, size;
};

/// Finds the matrices. Ignores case and punctuation of keys. A group may hold the keys of a camera.
[[nodiscard]] OpenCvNames find_opencv_names(const YamlNode& root);

}  // namespace surefoot::io

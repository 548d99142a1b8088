// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "surefoot/io/settings/yaml_tree.hpp"

/// Detects the format of a calibration file by its content. The readers of rigs and of
/// machine files use this header, so that no reader checks a file against the keys of another
/// format.
namespace surefoot::io {

enum class CalibrationKind : std::uint8_t {
    // These formats are read as rigs.
    surefoot,
    opencv,
    kalibr,
    ros,
    zed,
    kitti,
    kitti_raw,
    middlebury,
    orbslam,
    // These formats are recognised, but not read as rigs.
    euroc_sensor,   ///< sensor.yaml of one EuRoC sensor
    opencv_camera,  ///< OpenCV calibration of a single camera
    opencv_xml,
    kitti_sensors,  ///< KITTI calib_imu_to_velo.txt or calib_velo_to_cam.txt
    vins,
    okvis,
    basalt,
    machine,   ///< a Surefoot machine file
    settings,  ///< Surefoot settings (--config)
    binary,
    unknown
};

/// Detects formats other than YAML by their text; returns `unknown` for YAML and other texts.
[[nodiscard]] CalibrationKind kind_of_text(std::string_view text);
/// Detects the format by the keys of a YAML (or JSON) document.
[[nodiscard]] CalibrationKind kind_of_document(const YamlNode& root);

/// Returns the name of the format for messages, for example "an ORB-SLAM settings file".
[[nodiscard]] const char* title_of(CalibrationKind kind) noexcept;
/// Explains why a file of this kind cannot be read as a rig, and what to do. The text continues a
/// sentence that begins with the file name. For an unknown file the text names the first keys of
/// `root`; `root` may be nullptr.
[[nodiscard]] std::string why_no_rig(CalibrationKind kind, const YamlNode* root);

}  // namespace surefoot::io

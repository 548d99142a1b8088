// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "surefoot/io/settings/yaml_tree.hpp"

/// What a file that was given as a calibration is. The only place that tells formats apart: every
/// command that reads a rig or a machine file asks here, so that no file is judged by the keys of a
/// format that it does not have.
namespace surefoot::io {

enum class CalibrationKind : std::uint8_t {
    // read as rigs
    surefoot,
    opencv,
    kalibr,
    ros,
    zed,
    kitti,
    kitti_raw,
    middlebury,
    orbslam,
    // recognised, not read as rigs
    euroc_sensor,   ///< one camera of an EuRoC folder
    opencv_camera,  ///< one camera, without a second one
    opencv_xml,
    kitti_sensors,  ///< calib_imu_to_velo.txt, calib_velo_to_cam.txt
    vins,
    okvis,
    basalt,
    machine,   ///< a machine file of ours
    settings,  ///< settings of ours (--config)
    binary,
    unknown
};

/// By the text alone, for formats that are not YAML; `unknown` for all others.
[[nodiscard]] CalibrationKind kind_of_text(std::string_view text);
/// By the keys of a YAML (or JSON) document.
[[nodiscard]] CalibrationKind kind_of_document(const YamlNode& root);

/// "an ORB-SLAM settings file".
[[nodiscard]] const char* title_of(CalibrationKind kind) noexcept;
/// Why a file of a kind that is not read as a rig cannot be one, and what to do: a sentence after
/// the name of the file. `root` is the document where there is one, for the keys of an unknown
/// file.
[[nodiscard]] std::string why_no_rig(CalibrationKind kind, const YamlNode* root);

}  // namespace surefoot::io

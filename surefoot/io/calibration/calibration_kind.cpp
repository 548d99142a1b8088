// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/calibration/calibration_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <vector>

#include "surefoot/io/calibration/opencv_names.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

constexpr const char* kReadFormats =
    "Surefoot's rig.yaml, OpenCV stereo (YAML, JSON), Kalibr camchain, ROS camera_info (two "
    "files), "
    "ORB-SLAM2/3 stereo settings, ZED SN*.conf, KITTI calib.txt and calib_cam_to_cam.txt, "
    "Middlebury calib.txt, and EuRoC folders";

/// kind_of_text checks only this many lines at the start of a text one by one, because files can be
/// long.
constexpr int kHeadLines = 200;

bool has_any(const YamlNode& root, std::initializer_list<const char*> keys) {
    return std::any_of(
        keys.begin(), keys.end(), [&](const char* key) { return root.find(key) != nullptr; });
}

int count_of(const YamlNode& root, std::initializer_list<const char*> keys) {
    return static_cast<int>(std::count_if(
        keys.begin(), keys.end(), [&](const char* key) { return root.find(key) != nullptr; }));
}

bool has_group_with(const YamlNode& root,
                    const char* group,
                    std::initializer_list<const char*> keys) {
    const YamlNode* node = root.find(group);
    return node != nullptr && has_any(*node, keys);
}

bool any_key_starts_with(const YamlNode& root, std::initializer_list<const char*> starts) {
    return std::any_of(root.items.begin(), root.items.end(), [&](const YamlNode& item) {
        return std::any_of(starts.begin(), starts.end(), [&](const char* start) {
            return item.key.starts_with(start);
        });
    });
}

/// Returns true for a line like "P0: 7.2e+02 0 ...", where a number follows the colon. Returns
/// false for "P1: !!opencv-matrix" of an OpenCV file.
bool is_kitti_line(std::string_view line) {
    if (line.size() < 3 || line[0] != 'P' || line[1] < '0' || line[1] > '3' || line[2] != ':')
        return false;
    const std::vector<std::string_view> words = split(line.substr(3));
    return !words.empty() && parse_double(words[0]).has_value();
}

/// Returns true for a file of camera_calibration_parsers or a printed sensor_msgs/CameraInfo (ROS 1
/// writes K, ROS 2 writes k).
bool is_ros(const YamlNode& root) {
    if (has_any(root, {"camera_matrix"}) &&
        has_any(root, {"projection_matrix", "rectification_matrix", "camera_name"}))
        return true;
    return has_any(root, {"K", "k"}) && has_any(root, {"P", "p"}) &&
           has_any(root, {"distortion_model", "D", "d", "header"});
}

bool is_surefoot(const YamlNode& root) {
    if (has_any(root, {"focal_px", "principal_px", "baseline_m", "T_left_right", "T_body_left"}))
        return true;
    return has_group_with(root, "left", {"focal_px", "principal_px", "coefficients"});
}

/// Returns true if the document may be a rig.yaml whose important keys are missing or misspelled.
bool may_be_surefoot(const YamlNode& root) {
    return count_of(
               root,
               {"layout", "resolution", "rate_hz", "readout_s", "rectified", "left", "right"}) >= 2;
}

bool is_orbslam(const YamlNode& root) {
    return any_key_starts_with(
        root, {"Camera.", "Camera1.", "Stereo.", "ORBextractor.", "LEFT.K", "RIGHT.K"});
}

bool has_opencv_pair(const YamlNode& root) {
    const OpenCvNames names = find_opencv_names(root);
    return names.left_matrix.node != nullptr || names.right_matrix.node != nullptr;
}

}  // namespace

CalibrationKind kind_of_text(std::string_view text) {
    if (text.find('\0') != text.npos) return CalibrationKind::binary;
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    LineReader lines(text);
    while (const auto line = lines.next()) {
        if (lines.number() > kHeadLines) break;
        const std::string_view content = trimmed(*line);
        if (content.starts_with("<?xml") || content.starts_with("<opencv_storage"))
            return CalibrationKind::opencv_xml;
        if (content.starts_with('[')) {
            const std::string section = lowercase(content);
            if (section.find("left_cam_") != section.npos ||
                section.find("right_cam_") != section.npos)
                return CalibrationKind::zed;
        }
        if (content.starts_with("P_rect_0") || content.starts_with("S_rect_0"))
            return CalibrationKind::kitti_raw;
        if (is_kitti_line(content)) return CalibrationKind::kitti;
        if (content.starts_with("cam0=") || content.starts_with("cam0 ="))
            return CalibrationKind::middlebury;
        if (content.starts_with("delta_f:")) return CalibrationKind::kitti_sensors;
    }
    // calib_imu_to_velo.txt has the keys calib_time, R and T, but no key that only KITTI uses.
    if (text.starts_with("calib_time:") && text.find("\nR: ") != text.npos)
        return CalibrationKind::kitti_sensors;
    return CalibrationKind::unknown;
}

CalibrationKind kind_of_document(const YamlNode& root) {
    if (!root.is_mapping()) return CalibrationKind::unknown;
    if (has_any(root, {"sole_depth_m", "movements"})) return CalibrationKind::machine;
    const YamlNode* cam0 = root.find("cam0");
    const YamlNode* cam1 = root.find("cam1");
    const YamlNode* chain = cam0 != nullptr ? cam0 : cam1;
    if (chain != nullptr && chain->is_mapping() &&
        has_any(*chain,
                {"camera_model", "intrinsics", "distortion_model", "T_cn_cnm1", "T_cam_imu"}))
        return CalibrationKind::kalibr;
    if (is_orbslam(root)) return CalibrationKind::orbslam;
    if (is_ros(root)) return CalibrationKind::ros;
    if (has_any(root, {"T_BS"})) return CalibrationKind::euroc_sensor;
    if (has_any(root, {"model_type", "projection_parameters", "body_T_cam0"}))
        return CalibrationKind::vins;
    if (has_any(root, {"value0"})) return CalibrationKind::basalt;
    if (is_surefoot(root)) return CalibrationKind::surefoot;
    if (has_opencv_pair(root)) return CalibrationKind::opencv;
    if (may_be_surefoot(root)) return CalibrationKind::surefoot;
    if (has_any(root, {"cameras"})) return CalibrationKind::okvis;
    if (has_any(root, {"camera_matrix", "cameraMatrix", "Camera_Matrix", "K", "mtx"}))
        return CalibrationKind::opencv_camera;
    if (count_of(root, {"odometry", "elevation", "ground", "stereo", "traversability", "mount"}) >=
        2)
        return CalibrationKind::settings;
    return CalibrationKind::unknown;
}

const char* title_of(CalibrationKind kind) noexcept {
    switch (kind) {
        case CalibrationKind::surefoot: return "a rig.yaml of Surefoot";
        case CalibrationKind::opencv: return "an OpenCV stereo calibration";
        case CalibrationKind::kalibr: return "a Kalibr camera chain";
        case CalibrationKind::ros: return "a ROS camera_info file";
        case CalibrationKind::zed: return "a ZED calibration (SN*.conf)";
        case CalibrationKind::kitti: return "a KITTI calib.txt";
        case CalibrationKind::kitti_raw: return "a KITTI raw calib_cam_to_cam.txt";
        case CalibrationKind::middlebury: return "a Middlebury calib.txt";
        case CalibrationKind::orbslam: return "an ORB-SLAM settings file";
        case CalibrationKind::euroc_sensor: return "the sensor.yaml of one EuRoC sensor";
        case CalibrationKind::opencv_camera: return "an OpenCV calibration of one camera";
        case CalibrationKind::opencv_xml: return "an XML file of OpenCV";
        case CalibrationKind::kitti_sensors:
            return "a KITTI calibration of the laser scanner or the IMU";
        case CalibrationKind::vins: return "a VINS or camodocal calibration";
        case CalibrationKind::okvis: return "an OKVIS configuration";
        case CalibrationKind::basalt: return "a Basalt calibration";
        case CalibrationKind::machine: return "a machine file of Surefoot";
        case CalibrationKind::settings: return "a settings file of Surefoot";
        case CalibrationKind::binary: return "a binary file";
        case CalibrationKind::unknown: break;
    }
    return "a file of an unknown kind";
}

std::string why_no_rig(CalibrationKind kind, const YamlNode* root) {
    const auto looks_like = [kind](const char* what_to_do) {
        return fmt::format("this looks like {}; {}", title_of(kind), what_to_do);
    };
    switch (kind) {
        case CalibrationKind::euroc_sensor:
            return looks_like("give the folder that contains cam0 and cam1");
        case CalibrationKind::opencv_camera:
            return looks_like(
                "a rig needs the matrices of both cameras, and R and T from stereoCalibrate. "
                "Calibrate both cameras at once ('surefoot calibrate stereo')");
        case CalibrationKind::opencv_xml:
            return looks_like(
                "only YAML and JSON files of OpenCV are read. Write the matrices again, to a file "
                "whose name ends in .yml (cv::FileStorage, cv2.FileStorage)");
        case CalibrationKind::kitti_sensors:
            return looks_like("give calib_cam_to_cam.txt of the same folder");
        case CalibrationKind::vins:
            return looks_like(
                "this format is not supported. Copy fx fy cx cy, k1 k2 p1 p2 and the pose of the "
                "right camera into a rig.yaml (docs/get_started/own_camera.md shows one)");
        case CalibrationKind::okvis:
            return looks_like(
                "this format is not supported. Copy focal length, principal point, distortion and "
                "the poses T_SC into a rig.yaml (docs/get_started/own_camera.md shows one)");
        case CalibrationKind::basalt:
            return looks_like(
                "this format is not supported. Give the Kalibr camchain or the EuRoC folder from "
                "which the file was made, or calibrate with Kalibr's pinhole-equi");
        case CalibrationKind::machine: return looks_like("give it with --machine");
        case CalibrationKind::settings: return looks_like("give it with --config");
        case CalibrationKind::binary:
            return looks_like("write the matrices into a YAML file with cv2.FileStorage");
        default: break;
    }
    std::vector<std::string> keys;
    constexpr std::size_t kMostKeys = 4;
    if (root != nullptr) {
        for (const YamlNode& item : root->items) {
            if (!item.key.empty() && keys.size() < kMostKeys) keys.push_back(quoted(item.key));
        }
    }
    std::string listed;
    for (const std::string& key : keys) listed += (listed.empty() ? "" : ", ") + key;
    return fmt::format("not a known calibration format{}. Known formats: {}",
                       listed.empty() ? "" : fmt::format(" (first keys of the file: {})", listed),
                       kReadFormats);
}

}  // namespace surefoot::io

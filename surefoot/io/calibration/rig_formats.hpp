// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/io/calibration/rig_file.hpp"

/// Reads and writes calibration files of other programs. Reads return valid rigs. Writers refuse
/// cameras that the format cannot store; lost_in() names the other parts that they leave out.
namespace surefoot::io {

enum class RigFormat {
    surefoot,
    opencv,
    kalibr,
    ros,
    zed,
    euroc,
    kitti,
    kitti_raw,
    middlebury,
    orbslam
};
[[nodiscard]] const char* name_of(RigFormat format) noexcept;

/// A rig and its format, with notes about assumptions, unused contents and unusual values.
struct RigFile {
    camera::StereoRig rig;
    RigFormat format = RigFormat::surefoot;
    std::vector<std::string> notes;
};

/// Reads any calibration file of read_rig or of the formats below. The content decides the format
/// (surefoot/io/calibration/calibration_kind.hpp), except that every .conf file is a ZED file. The
/// error for an unknown file lists the known formats.
[[nodiscard]] Result<RigFile> read_rig_file(const std::string& path,
                                            std::optional<ImageSize> size = {});
/// Parses the text of a file. ROS calibrations consist of two files and are an error here.
[[nodiscard]] Result<RigFile> parse_rig_file(const std::string& text,
                                             const std::string& file,
                                             std::optional<ImageSize> size = {});
/// Writes the rig as surefoot, opencv, kalibr, ros or zed and returns the file names. ROS uses one
/// file per camera: `path` is a folder (for left.yaml and right.yaml), or the left file with "left"
/// in its name.
[[nodiscard]] Result<std::vector<std::string>> write_rig(const std::string& path,
                                                         const camera::StereoRig& rig,
                                                         RigFormat format);
/// Names the parts of this rig that the format cannot store.
[[nodiscard]] std::vector<std::string> lost_in(RigFormat format, const camera::StereoRig& rig);

/// Formats M1 D1 M2 D2 R T, and R1 R2 P1 P2 Q of Surefoot's rectification, for cv::FileStorage.
[[nodiscard]] Result<std::string> format_opencv_rig(const camera::StereoRig& rig);

/// Reads Kalibr's camchain.yaml: cam0 is the left camera, cam1 the right camera; camera_model
/// pinhole with radtan (k1 k2 p1 p2), equidistant or none. T_cn_cnm1 maps cam0 into cam1, T_cam_imu
/// maps the IMU into the camera (OpenVINS stores the inverse, T_imu_cam). The poses of the IMU in
/// both cameras replace a missing T_cn_cnm1. With an IMU, base_link lies at the left camera (axes:
/// T_body_optical). The file has no IMU rate; 200 Hz are assumed.
[[nodiscard]] Result<RigFile> parse_kalibr_rig(std::string_view text, const std::string& file);
[[nodiscard]] Result<std::string> format_kalibr_rig(const camera::StereoRig& rig);

/// Text and name of a file of ROS camera_calibration_parsers ("camera_info"), or a
/// sensor_msgs/CameraInfo as printed by `ros2 topic echo` or `rostopic echo`.
struct NamedText {
    std::string text;
    std::string file;
};
/// Reads both cameras: K and D of plumb_bob, rational_polynomial or equidistant. Their relative
/// pose follows from the rectification, x_rectified = R x_raw. P of the right camera holds -fx *
/// baseline. roi and binning are applied, so that the rig fits the images that the driver delivers.
[[nodiscard]] Result<RigFile> parse_ros_rig(const NamedText& left, const NamedText& right);
struct RosTexts {
    std::string left;
    std::string right;
};
[[nodiscard]] Result<RosTexts> format_ros_rig(const camera::StereoRig& rig);
/// Returns "right.yaml" for "left.yaml" (replaces the last "left"); no value without "left".
[[nodiscard]] std::optional<std::string> ros_partner(const std::string& left_path);

/// Reads Stereolabs' SN<serial>.conf: the section STEREO, and LEFT_CAM_x and RIGHT_CAM_x for each
/// resolution x. Their calibration tool writes Baseline = -T.x, TY = T.y, TZ = T.z [mm] and the
/// rotation vector (RX, CV or RY, RZ). With x_right = R x_left + T, T.x is negative and Baseline is
/// positive. A complete LEFT_DISTO or RIGHT_DISTO replaces the lens of every section of this
/// camera: eight coefficients (rational), or k1 .. k4 alone (fisheye). Thin-prism terms s1 .. s4
/// other than 0 are refused. `size` selects the section; a file of one resolution needs no `size`.
[[nodiscard]] Result<RigFile> parse_zed_rig(std::string_view text,
                                            const std::string& file,
                                            std::optional<ImageSize> size = {});
[[nodiscard]] Result<std::string> format_zed_rig(const camera::StereoRig& rig);

/// Reads stereo settings of ORB-SLAM2 (LEFT.* and RIGHT.*, or Camera.bf of rectified images) and of
/// ORB-SLAM3 (Camera1.*, Camera2.*, Stereo.T_c1_c2). With a depth factor, the rig has one camera.
[[nodiscard]] Result<RigFile> parse_orbslam_rig(std::string_view text, const std::string& file);

/// Reads calib.txt of Middlebury's stereo sets. The images are rectified, but their principal
/// points differ by doffs. `size` is used if the file has no image size.
[[nodiscard]] Result<RigFile> parse_middlebury_rig(std::string_view text,
                                                   const std::string& file,
                                                   std::optional<ImageSize> size = {});

/// Reads the grey cameras of KITTI raw calib_cam_to_cam.txt, or the colour cameras if the file has
/// only these. The rig is for the rectified images, or for the raw images if `size` is their size.
[[nodiscard]] Result<RigFile> parse_kitti_raw_rig(std::string_view text,
                                                  const std::string& file,
                                                  std::optional<ImageSize> size = {});

}  // namespace surefoot::io

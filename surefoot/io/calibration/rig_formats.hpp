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

/// Calibration files of other programs, and what to write them with. Readers return rigs without
/// problem(); writers refuse what a format cannot hold with a sentence that names it.
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

/// A rig, and in words what its file says beyond what a rig holds.
struct RigFile {
    camera::StereoRig rig;
    RigFormat format = RigFormat::surefoot;
    std::vector<std::string> notes;
};

/// Any calibration file, told apart by its content (surefoot/io/calibration/calibration_kind.hpp):
/// see read_rig, and the formats below. A file that is none of them is an error that says what it
/// looks like.
[[nodiscard]] Result<RigFile> read_rig_file(const std::string& path,
                                            std::optional<ImageSize> size = {});
/// The same for a text. ROS files come in twos, and are an error here.
[[nodiscard]] Result<RigFile> parse_rig_file(const std::string& text,
                                             const std::string& file,
                                             std::optional<ImageSize> size = {});
/// Writes the rig as surefoot, opencv, kalibr, ros or zed and returns the files. ROS has one file
/// for each camera: `path` is a folder (left.yaml, right.yaml), or the left one with "left" in its
/// name.
[[nodiscard]] Result<std::vector<std::string>> write_rig(const std::string& path,
                                                         const camera::StereoRig& rig,
                                                         RigFormat format);
/// What of this rig the format has no place for, in words.
[[nodiscard]] std::vector<std::string> lost_in(RigFormat format, const camera::StereoRig& rig);

/// OpenCV: M1 D1 M2 D2 R T, and R1 R2 P1 P2 Q of our own rectification; cv::FileStorage reads it.
[[nodiscard]] Result<std::string> format_opencv_rig(const camera::StereoRig& rig);

/// Kalibr's camchain.yaml: cam0 is the left camera, cam1 the right one; camera_model pinhole with
/// radtan (k1 k2 p1 p2), equidistant or none. T_cn_cnm1 maps cam0 into cam1, T_cam_imu the IMU into
/// the camera (T_imu_cam of OpenVINS the camera into the IMU); where T_cn_cnm1 is missing it
/// follows from the poses of the IMU in both cameras. base_link of a chain with an IMU is the left
/// camera turned to body axes; the IMU's rate is not in the file and becomes 200 Hz.
[[nodiscard]] Result<RigFile> parse_kalibr_rig(std::string_view text, const std::string& file);
[[nodiscard]] Result<std::string> format_kalibr_rig(const camera::StereoRig& rig);

/// One text of ROS camera_calibration_parsers ("camera_info"), or a sensor_msgs/CameraInfo as `ros2
/// topic echo` and `rostopic echo` print it, with the name of its file.
struct NamedText {
    std::string text;
    std::string file;
};
/// Both cameras: K and D of plumb_bob, rational_polynomial or equidistant; the pose between them is
/// that of the rectification: x_rectified = R x_raw, and P of the right camera holds -fx *
/// baseline. roi and binning are applied: the rig is for the images that the driver delivers.
[[nodiscard]] Result<RigFile> parse_ros_rig(const NamedText& left, const NamedText& right);
struct RosTexts {
    std::string left;
    std::string right;
};
[[nodiscard]] Result<RosTexts> format_ros_rig(const camera::StereoRig& rig);
/// "stereo/right.yaml" for "stereo/left.yaml": the last "left" of the name replaced.
[[nodiscard]] std::optional<std::string> ros_partner(const std::string& left_path);

/// Stereolabs' SN<serial>.conf: sections LEFT_CAM_x, RIGHT_CAM_x for each resolution x and STEREO.
/// Stereolabs' calibration tool writes Baseline = -T.x, TY = T.y, TZ = T.z [mm] and the rotation
/// vector (RX, CV or RY, RZ) of x_right = R x_left + T: the baseline is positive in the file and
/// T.x is not. LEFT_DISTO, where it is complete, replaces the lens of every section: eight
/// coefficients (rational), or k1 .. k4 alone (fisheye). Thin-prism terms s1 .. s4 that are not 0
/// are refused, as everywhere. `size` picks the section; a file of one resolution needs none.
[[nodiscard]] Result<RigFile> parse_zed_rig(std::string_view text,
                                            const std::string& file,
                                            std::optional<ImageSize> size = {});
[[nodiscard]] Result<std::string> format_zed_rig(const camera::StereoRig& rig);

/// Stereo settings of ORB-SLAM2 (LEFT.* and RIGHT.*, or Camera.bf of rectified images) and
/// ORB-SLAM3 (Camera1.*, Camera2.*, Stereo.T_c1_c2); with a depth factor, a rig of one camera.
[[nodiscard]] Result<RigFile> parse_orbslam_rig(std::string_view text, const std::string& file);

/// calib.txt of Middlebury's stereo sets: rectified but for the principal points, which differ by
/// doffs. `size` counts where the file does not hold it.
[[nodiscard]] Result<RigFile> parse_middlebury_rig(std::string_view text,
                                                   const std::string& file,
                                                   std::optional<ImageSize> size = {});

/// KITTI raw, calib_cam_to_cam.txt: the grey cameras (the colour ones where the file has these
/// alone), rectified; of the raw images where `size` is theirs.
[[nodiscard]] Result<RigFile> parse_kitti_raw_rig(std::string_view text,
                                                  const std::string& file,
                                                  std::optional<ImageSize> size = {});

}  // namespace surefoot::io

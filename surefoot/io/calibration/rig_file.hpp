// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/result.hpp"

/// Reads rigs from rig.yaml, EuRoC sensor.yaml, KITTI calib.txt, OpenCV calibration files and the
/// formats of rig_formats.hpp. Every returned rig has passed StereoRig::problem(). Every error of a
/// reader names the file; an error in a key names the key and, for most formats, the line.
namespace surefoot::io {

struct ImageSize {
    int width = 0;
    int height = 0;
    friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

/// Reads a rig.yaml of Surefoot. Short form for rectified cameras:
///   layout: side_by_side     (side_by_side | separate | rgbd; default separate)
///   resolution: [672, 376]   (one camera)
///   baseline_m: 0.12, focal_px: 350 or [fx, fy], principal_px: [336, 188], distortion: none
/// Full form, one block per camera:
///   left:  {model: pinhole, focal_px: [fx, fy], principal_px: [cx, cy], coefficients: [...]}
///          (pinhole: k1 k2 p1 p2 k3; pinhole_rational: k1 k2 p1 p2 k3 k4 k5 k6)
///   right: {model: kannala_brandt, ..., coefficients: [k1, k2, k3, k4]}
///   T_left_right: 4x4, row by row; rectified: true if the images are rectified
/// Both forms: layout, resolution, name, rate_hz, readout_s, T_body_left, imu {T_body_imu, rate_hz}
[[nodiscard]] Result<camera::StereoRig> parse_rig_yaml(std::string_view text,
                                                       const std::string& file);
/// Formats a rig in the full form. parse_rig_yaml reads the same rig back (poses to 1e-15).
[[nodiscard]] std::string format_rig_yaml(const camera::StereoRig& rig);
[[nodiscard]] Status write_rig_yaml(const std::string& path, const camera::StereoRig& rig);

/// One camera of an EuRoC folder.
struct EurocCamera {
    camera::Camera camera;
    Pose T_body_camera;
    double rate_hz = 0.0;
    double readout_s = 0.0;  ///< readout time of a rolling shutter; extension of EuRoC, default 0
};
/// Reads sensor.yaml of a camera: T_BS, resolution, pinhole intrinsics and the distortion
/// (radial-tangential, equidistant, rational_polynomial as an extension of EuRoC, or none).
[[nodiscard]] Result<EurocCamera> parse_euroc_camera(std::string_view text,
                                                     const std::string& file);
[[nodiscard]] std::string format_euroc_camera(const EurocCamera& camera);
/// Reads sensor.yaml of an IMU: T_BS and rate_hz.
[[nodiscard]] Result<camera::ImuMount> parse_euroc_imu(std::string_view text,
                                                       const std::string& file);
[[nodiscard]] std::string format_euroc_imu(const camera::ImuMount& imu);
/// Reads the rig of a "mav0" folder with cam0, cam1 and an optional imu0. An IMU with data.csv but
/// without sensor.yaml has the body frame.
[[nodiscard]] Result<camera::StereoRig> read_euroc_rig(const std::string& mav_folder);

/// Projection matrices of KITTI's calib.txt, 3x4 row by row.
struct KittiCalibration {
    std::array<std::optional<std::array<double, 12>>, 4> P;
};
[[nodiscard]] Result<KittiCalibration> parse_kitti_calibration(std::string_view text,
                                                               const std::string& file);
/// Builds the rectified rig of two cameras (0 and 1: grey, 2 and 3: colour); baseline = (P_left[3]
/// - P_right[3]) / fx. The image size is an argument, because the file has none.
[[nodiscard]] Result<camera::StereoRig> kitti_rig(const KittiCalibration& calibration,
                                                  int left,
                                                  int right,
                                                  ImageSize size,
                                                  const std::string& file);

/// Reads OpenCV FileStorage YAML or JSON: camera matrices and distortion under any usual name (see
/// surefoot/io/calibration/opencv_names.hpp). R (or a rotation vector) and T [m] mean x_right = R
/// x_left + T. `size` is used if the file has no image size. "fisheye: 1" or "model: fisheye" in
/// the file marks fisheye lenses with four coefficients.
[[nodiscard]] Result<camera::StereoRig> parse_opencv_rig(std::string_view text,
                                                         const std::string& file,
                                                         std::optional<ImageSize> size = {});

/// Reads any format above or in rig_formats.hpp: an EuRoC folder (mav0 or its parent), a folder
/// with ROS's left.yaml and right.yaml or a calibration under its usual name, or a file. `size`
/// helps formats without an image size, and selects the section of a ZED file and the raw images of
/// KITTI raw; other formats ignore `size`. If an OpenCV file has no R and no T, the keys of
/// extrinsics.yml in the same folder are added. read_rig_file also returns the notes.
[[nodiscard]] Result<camera::StereoRig> read_rig(const std::string& path,
                                                 std::optional<ImageSize> size = {});

/// Marks a camera pair as rectified if StereoRig::problem() accepts it as a rectified pair.
void mark_if_rectified(camera::StereoRig& rig);

}  // namespace surefoot::io

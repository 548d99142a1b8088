// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/result.hpp"

/// Rigs from our rig.yaml, EuRoC sensor.yaml, KITTI calib.txt, OpenCV's calibration files and the
/// formats of rig_formats.hpp. Every rig that comes out has passed StereoRig::problem(); every
/// error names file, line and key.
namespace surefoot::io {

struct ImageSize {
    int width = 0;
    int height = 0;
    friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

/// Our rig.yaml. Short form for rectified cameras:
///   layout: side_by_side     (side_by_side | separate | rgbd; default separate)
///   resolution: [672, 376]   (one eye)
///   baseline_m: 0.12, focal_px: 350 or [fx, fy], principal_px: [336, 188], distortion: none
/// Full form, one block per camera:
///   left:  {model: pinhole, focal_px: [fx, fy], principal_px: [cx, cy], coefficients: [k1, k2, p1,
///   p2, k3]} (pinhole_rational: [k1, k2, p1, p2, k3, k4, k5, k6])
///   right: {model: kannala_brandt, ..., coefficients: [k1, k2, k3, k4]} T_left_right:
///   4x4, row by row; rectified: true where the images are rectified
/// In both: name, rate_hz, readout_s, T_body_left, imu: {T_body_imu, rate_hz}.
[[nodiscard]] Result<camera::StereoRig> parse_rig_yaml(std::string_view text,
                                                       const std::string& file);
/// The full form; reads back to the same rig (poses to 1e-15).
[[nodiscard]] std::string format_rig_yaml(const camera::StereoRig& rig);
[[nodiscard]] Status write_rig_yaml(const std::string& path, const camera::StereoRig& rig);

/// One camera of an EuRoC folder.
struct EurocCamera {
    camera::Camera camera;
    Pose T_body_camera;
    double rate_hz = 0.0;
    double readout_s = 0.0;  ///< our extension, 0 where the file says nothing
};
/// sensor.yaml of a camera: T_BS, resolution, pinhole intrinsics; radial-tangential, equidistant or
/// no distortion, and rational_polynomial, which is our extension.
[[nodiscard]] Result<EurocCamera> parse_euroc_camera(std::string_view text,
                                                     const std::string& file);
[[nodiscard]] std::string format_euroc_camera(const EurocCamera& camera);
/// sensor.yaml of an IMU: T_BS and rate_hz.
[[nodiscard]] Result<camera::ImuMount> parse_euroc_imu(std::string_view text,
                                                       const std::string& file);
[[nodiscard]] std::string format_euroc_imu(const camera::ImuMount& imu);
/// The rig of a "mav0" folder with cam0, cam1 and perhaps imu0 (without sensor.yaml: in the body
/// frame).
[[nodiscard]] Result<camera::StereoRig> read_euroc_rig(const std::string& mav_folder);

/// Projection matrices of KITTI's calib.txt, 3x4 row by row.
struct KittiCalibration {
    std::array<std::optional<std::array<double, 12>>, 4> P;
};
[[nodiscard]] Result<KittiCalibration> parse_kitti_calibration(std::string_view text,
                                                               const std::string& file);
/// Rectified rig of the cameras `left` and `right` (0 and 1: grey, 2 and 3: colour);
/// baseline = (P_left[3] - P_right[3]) / fx. The file does not hold the image size.
[[nodiscard]] Result<camera::StereoRig> kitti_rig(const KittiCalibration& calibration,
                                                  int left,
                                                  int right,
                                                  ImageSize size,
                                                  const std::string& file);

/// OpenCV FileStorage YAML or JSON: camera matrices and distortion under any of their usual names
/// (surefoot/io/calibration/opencv_names.hpp), R (or a rotation vector) and T with x_right = R
/// x_left + T [m], image size if the file has it. Four coefficients are a fisheye where the file
/// says "fisheye: 1" or "model: fisheye".
[[nodiscard]] Result<camera::StereoRig> parse_opencv_rig(std::string_view text,
                                                         const std::string& file,
                                                         std::optional<ImageSize> size = {});

/// Any of the above and of rig_formats.hpp: an EuRoC folder (with mav0 or inside it), a folder with
/// ROS's left.yaml and right.yaml or with a rig.yaml, or a file that is told apart by its content.
/// `size` helps formats that do not know their image size, and picks the section of a ZED file; the
/// rig of another file may still be for another size. An OpenCV intrinsics.yml without R and T
/// takes them from extrinsics.yml beside it. read_rig_file gives the notes too.
[[nodiscard]] Result<camera::StereoRig> read_rig(const std::string& path,
                                                 std::optional<ImageSize> size = {});

/// Marks a rig as rectified when its images are: no distortion, equal intrinsics, baseline along x.
void mark_if_rectified(camera::StereoRig& rig);

}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

/// Calibration files as users have them, after public reports of users of similar programs.
namespace surefoot::io::testing {

inline constexpr const char* kD = "[0.05, 0.17, -0.001, 0.001, -0.7]";

/// A file of camera_calibration_parsers: f 721.13 px, baseline 43.84 / 721.13 = 60.79 mm.
inline std::string ros_file(const std::string& offset, const std::string& more = "") {
    return "image_width: 752\nimage_height: 480\ncamera_name: cam\n"
           "camera_matrix:\n  rows: 3\n  cols: 3\n"
           "  data: [719.87, 0, 386.1, 0, 719.73, 217.1, 0, 0, 1]\n"
           "distortion_model: plumb_bob\n"
           "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: " +
           std::string(kD) +
           "\nrectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
           "projection_matrix:\n  rows: 3\n  cols: 4\n"
           "  data: [721.13, 0, 387.7, " +
           offset + ", 0, 721.13, 222.4, 0, 0, 0, 1, 0]\n" + more;
}

struct Names {
    const char *K1, *D1, *K2, *D2, *R, *T;
};
inline constexpr Names kUsualNames{"M1", "D1", "M2", "D2", "R", "T"};
inline constexpr const char* kR =
    "[ 0.9999756307053949, 0, 0.006981260297961553, 0, 1, 0, -0.006981260297961553, 0, "
    "0.9999756307053949 ]";

inline std::string opencv_file(const Names& names,
                               const std::string& T = "[ -0.12, 0.0004, 0.0002 ]") {
    const auto matrix = [](const std::string& key, const char* size, const std::string& data) {
        return key + ": !!opencv-matrix\n   " + size + "\n   dt: d\n   data: " + data + "\n";
    };
    return "%YAML:1.0\n---\nimage_width: 1280\nimage_height: 720\n" +
           matrix(names.K1, "rows: 3\n   cols: 3", "[ 700, 0, 640, 0, 700, 360, 0, 0, 1 ]") +
           matrix(names.D1, "rows: 1\n   cols: 5", "[ -0.17, 0.03, 0.001, -0.0005, 0 ]") +
           matrix(names.K2, "rows: 3\n   cols: 3", "[ 702, 0, 642, 0, 702, 358, 0, 0, 1 ]") +
           matrix(names.D2, "rows: 1\n   cols: 5", "[ -0.17, 0.03, 0.001, -0.0005, 0 ]") +
           matrix(names.R, "rows: 3\n   cols: 3", kR) + matrix(names.T, "rows: 3\n   cols: 1", T);
}

inline const std::string kOrbSlam3 =
    "%YAML:1.0\n\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\n"
    "Camera1.fx: 458.654\nCamera1.fy: 457.296\nCamera1.cx: 367.215\nCamera1.cy: 248.375\n"
    "Camera1.k1: -0.28340811\nCamera1.k2: 0.07395907\nCamera1.p1: 0.00019359\n"
    "Camera1.p2: 1.76187114e-05\n"
    "Camera2.fx: 457.587\nCamera2.fy: 456.134\nCamera2.cx: 379.999\nCamera2.cy: 255.238\n"
    "Camera2.k1: -0.28368365\nCamera2.k2: 0.07451284\nCamera2.p1: -0.00010473\n"
    "Camera2.p2: -3.55590700e-05\n"
    "Camera.width: 752\nCamera.height: 480\nCamera.fps: 20\nCamera.RGB: 1\nStereo.ThDepth: 60.0\n"
    "Stereo.T_c1_c2: !!opencv-matrix\n  rows: 4\n  cols: 4\n  dt: f\n"
    "  data: [0.999997256477797,-0.002317135723275,-0.000343393120620,0.110074137800478,"
    "0.002312067192432,0.999898048507103,-0.014090668452683,-0.000156612054392,"
    "0.000376008102320,0.014089835846691,0.999900662638081,0.000889382785432,0,0,0,1.0]\n";

inline const std::string kOrbSlam2 =
    "%YAML:1.0\n\nCamera.fx: 435.2\nCamera.fy: 435.2\nCamera.cx: 367.5\nCamera.cy: 252.2\n"
    "Camera.k1: 0.0\nCamera.k2: 0.0\nCamera.p1: 0.0\nCamera.p2: 0.0\n"
    "Camera.width: 752\nCamera.height: 480\nCamera.fps: 20.0\nCamera.bf: 47.906\n";

inline std::string orbslam2_side(const std::string& side, const char* offset) {
    // Without a blank behind "data:", as ORB-SLAM2's own examples have it.
    return side +
           ".D: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
           "   data:[-0.28, 0.07, 0.0002, 1.8e-05, 0.0]\n" +
           side +
           ".K: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
           "   data: [458.654, 0.0, 367.215, 0.0, 457.296, 248.375, 0.0, 0.0, 1.0]\n" +
           side +
           ".R: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
           "   data: [0.8, 0.0, 0.6, 0.0, 1.0, 0.0, -0.6, 0.0, 0.8]\n" +
           side +
           ".P: !!opencv-matrix\n   rows: 3\n   cols: 4\n   dt: d\n"
           "   data: [435.2, 0.0, 367.5, " +
           offset + ", 0.0, 435.2, 252.2, 0.0, 0.0, 0.0, 1.0, 0.0]\n";
}

inline const std::string kKittiRaw =
    "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.950000e-02\n"
    "S_00: 1.392000e+03 5.120000e+02\n"
    "K_00: 9.842439e+02 0 6.900000e+02 0 9.808141e+02 2.331966e+02 0 0 1\n"
    "D_00: -3.728755e-01 2.037299e-01 2.219027e-03 1.383707e-03 -7.233722e-02\n"
    "R_00: 1 0 0 0 1 0 0 0 1\nT_00: 2.573699e-16 -1.059758e-16 1.614870e-16\n"
    "S_rect_00: 1.242000e+03 3.750000e+02\n"
    "R_rect_00: 9.999239e-01 9.837760e-03 -7.445048e-03 -9.869795e-03 9.999421e-01 -4.278459e-03 "
    "7.402527e-03 4.351614e-03 9.999631e-01\n"
    "P_rect_00: 7.215377e+02 0 6.095593e+02 0 0 7.215377e+02 1.728540e+02 0 0 0 1 0\n"
    "S_01: 1.392000e+03 5.120000e+02\n"
    "K_01: 9.895267e+02 0 7.020000e+02 0 9.878386e+02 2.455590e+02 0 0 1\n"
    "D_01: -3.644661e-01 1.790019e-01 1.148107e-03 -6.298563e-04 -5.314062e-02\n"
    "R_01: 9.993513e-01 1.860866e-02 -3.083487e-02 -1.887662e-02 9.997863e-01 -8.421873e-03 "
    "3.067156e-02 8.998467e-03 9.994890e-01\n"
    "T_01: -5.370000e-01 4.822061e-03 -1.252488e-02\n"
    "P_rect_01: 7.215377e+02 0 6.095593e+02 -3.875744e+02 0 7.215377e+02 1.728540e+02 0 0 0 1 0\n";

inline const std::string kMiddlebury =
    "cam0=[4161.221 0 1445.577; 0 4161.221 984.686; 0 0 1]\n"
    "cam1=[4161.221 0 1654.636; 0 4161.221 984.686; 0 0 1]\n"
    "doffs=209.059\nbaseline=176.252\nwidth=2880\nheight=1988\nndisp=280\nisint=0\nvmin=25\n"
    "vmax=248\ndyavg=0\ndymax=0\n";

inline std::string zed_lens(const char* prism) {
    return std::string(
               "k1=1.21\nk2=0.30\np1=0.0001\np2=-0.0002\nk3=0.01\nk4=1.55\nk5=0.55\nk6=0.06\n") +
           prism;
}

inline std::string zed_file(const char* prism) {
    return "[LEFT_CAM_HD]\nfx=738.1\nfy=738.0\ncx=641.2\ncy=361.7\n"
           "[RIGHT_CAM_HD]\nfx=737.9\nfy=737.8\ncx=640.9\ncy=360.8\n"
           "[LEFT_DISTO]\n" +
           zed_lens(prism) + "[RIGHT_DISTO]\n" + zed_lens(prism) +
           "[STEREO]\nBaseline=119.87\nTY=0.02\nTZ=-0.31\nRX_HD=0.0004\nCV_HD=0.001\nRZ_HD=-0."
           "0002\n";
}

}  // namespace surefoot::io::testing

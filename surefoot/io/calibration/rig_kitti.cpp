// SPDX-License-Identifier: Apache-2.0
// Reads calib.txt of KITTI odometry, after Geiger et al. 2012. The lines "P0:" to "P3:" hold the
// 3x4 projection matrices of the rectified cameras 0 to 3, row by row. P[3] = -fx * (position of
// the camera along x) [px m].
#include <fmt/format.h>

#include <cmath>

#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/calibration/rig_values.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

/// Parses one "Pn: 12 numbers" line.
Result<std::array<double, 12>> parse_matrix(const std::vector<std::string_view>& words,
                                            const std::string& where) {
    if (words.size() != 13) {
        return input_error(fmt::format(
            "{}: {} found {} numbers; exactly 12 are needed", where, words[0], words.size() - 1));
    }
    std::array<double, 12> P{};
    for (std::size_t i = 0; i < 12; ++i) {
        const auto value = parse_double(words[i + 1]);
        if (!value || !std::isfinite(*value)) {
            return input_error(fmt::format(
                "{}: {} {} is not a finite number", where, words[0], quoted(words[i + 1])));
        }
        P[i] = *value;
    }
    if (!(P[0] > 0.0) || !(P[5] > 0.0)) {
        return input_error(fmt::format(
            "{}: {} focal lengths {} and {} must be above 0 px", where, words[0], P[0], P[5]));
    }
    return P;
}

}  // namespace

Result<KittiCalibration> parse_kitti_calibration(std::string_view text, const std::string& file) {
    KittiCalibration calibration;
    LineReader lines(text);
    while (const auto line = lines.next()) {
        const std::vector<std::string_view> words = split(*line);
        if (words.empty() || words[0].size() != 3 || words[0][0] != 'P' || words[0][2] != ':')
            continue;
        const int camera = words[0][1] - '0';
        if (camera < 0 || camera > 3) continue;
        const auto P = parse_matrix(words, fmt::format("{}:{}", file, lines.number()));
        if (!P) return P.error();
        calibration.P[static_cast<std::size_t>(camera)] = *P;
    }
    return calibration;
}

Result<camera::StereoRig> kitti_rig(const KittiCalibration& calibration,
                                    int left,
                                    int right,
                                    ImageSize size,
                                    const std::string& file) {
    for (const int camera : {left, right}) {
        if (camera < 0 || camera > 3 || !calibration.P[static_cast<std::size_t>(camera)]) {
            return input_error(fmt::format("{}: the line 'P{}:' is missing", file, camera));
        }
    }
    const auto& P_left = *calibration.P[static_cast<std::size_t>(left)];
    const auto& P_right = *calibration.P[static_cast<std::size_t>(right)];
    camera::StereoRig rig;
    rig.name = "kitti";
    rig.left = {
        make_pinhole({P_left[0], P_left[5], P_left[2], P_left[6]}, {}), size.width, size.height};
    rig.right = camera::Camera{make_pinhole({P_right[0], P_right[5], P_right[2], P_right[6]}, {}),
                               size.width,
                               size.height};
    rig.T_left_right.translation_m.x() = (P_left[3] - P_right[3]) / P_left[0];
    rig.rectified = true;
    return checked_rig(std::move(rig), file);
}

}  // namespace surefoot::io

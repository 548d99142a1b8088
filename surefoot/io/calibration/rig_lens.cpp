// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/calibration/rig_lens.hpp"

#include <fmt/format.h>

#include <array>

#include "surefoot/io/calibration/rig_values.hpp"

namespace surefoot::io {
namespace {

/// Number of OpenCV's coefficients that PinholeRational supports.
constexpr std::size_t kRationalCount = 8;
constexpr std::array<const char*, 6> kUnsupported{"s1", "s2", "s3", "s4", "taux", "tauy"};

}  // namespace

void drop_zero_tail(std::vector<double>& coefficients, std::size_t count) {
    while (coefficients.size() > count && coefficients.back() == 0.0) coefficients.pop_back();
}

Result<camera::CameraModel> pinhole_lens(const std::vector<double>& intrinsics,
                                         std::vector<double> coefficients) {
    drop_zero_tail(coefficients, 0);
    if (coefficients.size() > kRationalCount + kUnsupported.size()) {
        return input_error(fmt::format("found {} coefficients; at most {} are allowed",
                                       coefficients.size(),
                                       kRationalCount + kUnsupported.size()));
    }
    for (std::size_t i = kRationalCount; i < coefficients.size(); ++i) {
        if (coefficients[i] == 0.0) continue;
        return input_error(
            fmt::format("coefficient {} is {} ({}); thin-prism and tilt terms are not supported. "
                        "Without these terms the rows of the two images would not match. Calibrate "
                        "with k1 k2 p1 p2 k3 k4 k5 k6 alone ('surefoot calibrate stereo')",
                        i + 1,
                        coefficients[i],
                        kUnsupported[i - kRationalCount]));
    }
    return make_pinhole(intrinsics, std::move(coefficients));
}

Result<camera::CameraModel> fisheye_lens(const std::vector<double>& intrinsics,
                                         std::vector<double> coefficients) {
    drop_zero_tail(coefficients, 4);
    if (coefficients.size() != 4) {
        return input_error(fmt::format("found {} coefficients; a fisheye lens has 4 (k1 k2 k3 k4)",
                                       coefficients.size()));
    }
    return make_kannala_brandt(intrinsics, std::move(coefficients));
}

}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#include "io/rig_values.hpp"

#include <fmt/format.h>

#include <cmath>

#include "io/text.hpp"

namespace surefoot::io {
namespace {

/// Rotations printed with four digits are off by less than this.
constexpr double kRotationTolerance = 1e-3;

}  // namespace

ImageSize read_size(YamlReader& yaml, const YamlNode& node, std::string_view key) {
    const std::vector<double> values = yaml.numbers(node, key, 2);
    for (const double side_px : values) {
        if (side_px >= 1.0 && side_px <= kMaxRigSide_px && side_px == std::floor(side_px)) continue;
        yaml.fail(
            node, key, fmt::format("{} is no image side of 1 .. {} px", side_px, kMaxRigSide_px));
        return {1, 1};
    }
    return {static_cast<int>(values[0]), static_cast<int>(values[1])};
}

Pose pose_from_rows(YamlReader& yaml,
                    const YamlNode& node,
                    std::string_view key,
                    const std::vector<double>& rows) {
    Eigen::Matrix4d T;
    for (Eigen::Index i = 0; i < 16; ++i) T(i / 4, i % 4) = rows[static_cast<std::size_t>(i)];
    const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
    const double error = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    const bool last_row = T.row(3) == Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0);
    if (!(error < kRotationTolerance) || !(R.determinant() > 0.0) || !last_row) {
        yaml.fail(node,
                  key,
                  fmt::format("not a rigid motion (R^T R differs from 1 by {:.3g}, limit {}; "
                              "last row 0 0 0 1)",
                              error,
                              kRotationTolerance));
        return {};
    }
    return Pose::from_matrix(T);
}

Pose read_pose(YamlReader& yaml, const YamlNode& node, std::string_view key) {
    std::vector<double> rows = yaml.numbers(node, key, 16);
    if (yaml.error()) return {};
    return pose_from_rows(yaml, node, key, rows);
}

std::string format_list(const std::vector<double>& values) {
    std::string text = "[";
    for (const double value : values) text += (text.size() > 1 ? ", " : "") + format_double(value);
    return text + "]";
}

std::string format_pose_rows(const Pose& pose) {
    const Eigen::Matrix4d T = pose.matrix();
    std::vector<double> rows;
    for (Eigen::Index i = 0; i < 16; ++i) rows.push_back(T(i / 4, i % 4));
    return format_list(rows);
}

std::vector<double> read_focal(YamlReader& yaml, const YamlNode& node, std::string_view key) {
    constexpr double kMaxFocal_px = 1e6;
    if (node.is_scalar()) {
        const double focal_px = yaml.number(node, key, 0.0, kMaxFocal_px);
        if (!(focal_px > 0.0)) yaml.fail(node, key, fmt::format("{} must be above 0", focal_px));
        return {focal_px, focal_px};
    }
    std::vector<double> focal_px = yaml.numbers(node, key, 2);
    for (const double f : focal_px) {
        if (!(f > 0.0 && f <= kMaxFocal_px)) {
            yaml.fail(node, key, fmt::format("focal length {} must be above 0 px", f));
        }
    }
    return focal_px;
}

camera::CameraModel make_pinhole(const std::vector<double>& intrinsics,
                                 std::vector<double> coefficients) {
    coefficients.resize(5, 0.0);
    const auto& c = coefficients;
    return camera::PinholeRadTan{
        intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3], c[0], c[1], c[2], c[3], c[4]};
}

camera::CameraModel make_kannala_brandt(const std::vector<double>& intrinsics,
                                        std::vector<double> coefficients) {
    coefficients.resize(4, 0.0);
    const auto& c = coefficients;
    return camera::KannalaBrandt{
        intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3], c[0], c[1], c[2], c[3]};
}

std::vector<double> intrinsics_of(const camera::CameraModel& model) {
    return std::visit(
        [](const auto& m) {
            return std::vector<double>{m.fx_px, m.fy_px, m.cx_px, m.cy_px};
        },
        model);
}

std::vector<double> coefficients_of(const camera::CameraModel& model) {
    if (const auto* fisheye = std::get_if<camera::KannalaBrandt>(&model)) {
        return {fisheye->k1, fisheye->k2, fisheye->k3, fisheye->k4};
    }
    const auto& pinhole = std::get<camera::PinholeRadTan>(model);
    return {pinhole.k1, pinhole.k2, pinhole.p1, pinhole.p2, pinhole.k3};
}

bool is_kannala_brandt(const camera::CameraModel& model) noexcept {
    return std::holds_alternative<camera::KannalaBrandt>(model);
}

Result<camera::StereoRig> checked_rig(camera::StereoRig rig, const std::string& file) {
    if (const auto problem = rig.problem()) {
        return input_error(fmt::format("{}: {}", file, *problem));
    }
    return rig;
}

Result<camera::StereoRig> checked_rig(camera::StereoRig rig, const YamlReader& yaml) {
    if (yaml.error()) return *yaml.error();
    return checked_rig(std::move(rig), yaml.file());
}

void mark_if_rectified(camera::StereoRig& rig) {
    if (!rig.right) return;
    rig.rectified = true;  // its own check says whether that is true
    rig.rectified = !rig.problem().has_value();
}

}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/calibration/rig_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "surefoot/camera/rectification.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/camera/rig_units.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

/// Limit of the elements of R^T R - I. A rotation printed with four digits stays below this limit.
constexpr double kRotationTolerance = 1e-3;

}  // namespace

ImageSize read_size(YamlReader& yaml, const YamlNode& node, std::string_view key) {
    const std::vector<double> values = yaml.numbers(node, key, 2);
    for (const double side_px : values) {
        if (side_px >= 1.0 && side_px <= kMaxRigSide_px && side_px == std::floor(side_px)) continue;
        yaml.fail(node,
                  key,
                  fmt::format("{} is not an image side of 1 .. {} px", side_px, kMaxRigSide_px));
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
                  fmt::format("not a rigid motion: R^T R must equal 1 (error {:.3g}, limit {}), R "
                              "must not be a reflection, and the last row must be 0 0 0 1",
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
        if (!(focal_px > 0.0))
            yaml.fail(node, key, fmt::format("focal length {} must be above 0 px", focal_px));
        return {focal_px, focal_px};
    }
    std::vector<double> focal_px = yaml.numbers(node, key, 2);
    for (const double f : focal_px) {
        if (!(f > 0.0 && f <= kMaxFocal_px)) {
            yaml.fail(node,
                      key,
                      fmt::format("focal length {} must be above 0 and at most 1000000 px", f));
        }
    }
    return focal_px;
}

camera::CameraModel make_pinhole(const std::vector<double>& intrinsics,
                                 std::vector<double> coefficients) {
    coefficients.resize(8, 0.0);
    const auto& c = coefficients;
    if (c[5] != 0.0 || c[6] != 0.0 || c[7] != 0.0) return make_rational(intrinsics, coefficients);
    return camera::PinholeRadTan{
        intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3], c[0], c[1], c[2], c[3], c[4]};
}

camera::CameraModel make_rational(const std::vector<double>& intrinsics,
                                  std::vector<double> coefficients) {
    coefficients.resize(8, 0.0);
    const auto& c = coefficients;
    return camera::PinholeRational{intrinsics[0],
                                   intrinsics[1],
                                   intrinsics[2],
                                   intrinsics[3],
                                   c[0],
                                   c[1],
                                   c[2],
                                   c[3],
                                   c[4],
                                   c[5],
                                   c[6],
                                   c[7]};
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
    if (const auto* rational = std::get_if<camera::PinholeRational>(&model)) {
        const auto& m = *rational;
        return {m.k1, m.k2, m.p1, m.p2, m.k3, m.k4, m.k5, m.k6};
    }
    const auto& pinhole = std::get<camera::PinholeRadTan>(model);
    return {pinhole.k1, pinhole.k2, pinhole.p1, pinhole.p2, pinhole.k3};
}

bool is_kannala_brandt(const camera::CameraModel& model) noexcept {
    return std::holds_alternative<camera::KannalaBrandt>(model);
}

RectifiedMatrices rectified_matrices(const camera::StereoRig& rig) {
    const camera::Rectification plan = camera::plan_rectification(
        rig, camera::RectificationConfig{}, camera::Rectifier::kVirtualBaseline_m);
    const camera::RectifiedRig& r = plan.rig;
    const auto rows = [](const Eigen::Matrix3d& M) {
        std::vector<double> out;
        for (Eigen::Index i = 0; i < 9; ++i) out.push_back(M(i / 3, i % 3));
        return out;
    };
    const auto projection = [&r](double baseline_m) {
        const double shift = baseline_m == 0.0 ? 0.0 : -r.fx_px * baseline_m;  // prints 0, not -0
        return std::vector<double>{
            r.fx_px, 0.0, r.cx_px, shift, 0.0, r.fy_px, r.cy_px, 0.0, 0.0, 0.0, 1.0, 0.0};
    };
    const double y_scale =
        r.fx_px / r.fy_px;  // differs from 1 only for rectified images with non-square pixels
    return {rows(plan.left.R_rectified_raw),
            rows(plan.right->R_rectified_raw),
            projection(0.0),
            projection(r.baseline_m),
            {1.0,
             0.0,
             0.0,
             -r.cx_px,
             0.0,
             y_scale,
             0.0,
             -r.cy_px * y_scale,
             0.0,
             0.0,
             0.0,
             r.fx_px,
             0.0,
             0.0,
             1.0 / r.baseline_m,
             0.0}};
}

bool is_rational(const camera::CameraModel& model) noexcept {
    return std::holds_alternative<camera::PinholeRational>(model);
}

Status check_pair(const camera::StereoRig& rig, std::string_view format) {
    if (const auto problem = rig.problem()) return output_error(*problem);
    if (rig.right) return {};
    return output_error(fmt::format(
        "{} files store stereo rigs, but this rig has one camera; write a rig.yaml", format));
}

Pose pose_from_parts(YamlReader& yaml,
                     const YamlNode& node,
                     std::string_view key,
                     const std::vector<double>& R,
                     const std::vector<double>& t_m) {
    std::vector<double> rows;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) rows.push_back(R[3 * i + j]);
        rows.push_back(t_m[i]);
    }
    rows.insert(rows.end(), {0.0, 0.0, 0.0, 1.0});
    return pose_from_rows(yaml, node, key, rows);
}

std::vector<double> read_matrix(YamlReader& yaml,
                                const YamlNode& node,
                                std::string_view key,
                                std::size_t min,
                                std::size_t max) {
    const YamlNode* data = node.is_mapping() ? yaml.required(node, "data") : &node;
    std::vector<double> values;
    if (data != nullptr) values = yaml.any_numbers(*data, key, max);
    if (values.size() < min) {
        yaml.fail(
            node, key, fmt::format("found {} numbers; at least {} are needed", values.size(), min));
        values.resize(min, 0.0);
    }
    return values;
}

camera::CameraModel lens_or_fail(YamlReader& yaml,
                                 const YamlNode& node,
                                 std::string_view key,
                                 const Result<camera::CameraModel>& lens) {
    if (lens) return *lens;
    yaml.fail(node, key, lens.error().message);
    return {};
}

void check_focal(YamlReader& yaml,
                 const YamlNode& node,
                 std::string_view key,
                 const std::vector<double>& K) {
    if (K[0] > 0.0 && K[4] > 0.0) return;
    if (std::all_of(K.begin(), K.end(), [](double value) { return value == 0.0; })) {
        return yaml.fail(node, key, "all zero: this camera is not calibrated");
    }
    yaml.fail(node, key, fmt::format("focal lengths {} and {} must be above 0 px", K[0], K[4]));
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

Result<RigFile> checked_file(RigFile out, const std::string& file) {
    if (!out.rig.rectified) mark_if_rectified(out.rig);
    Result<camera::StereoRig> rig = checked_rig(std::move(out.rig), file);
    if (!rig) return rig.error();
    out.rig = std::move(rig).value();
    if (!is_kannala_brandt(out.rig.left.model)) {
        const double focal_px = intrinsics_of(out.rig.left.model)[0];
        if (auto warning = camera::focal_warning(focal_px, out.rig.left.width))
            out.notes.push_back(std::move(*warning));
    }
    if (!out.rig.right) return out;
    if (auto warning = camera::baseline_warning(out.rig.T_left_right.translation_m.norm()))
        out.notes.push_back(std::move(*warning));
    return out;
}

void mount_imu(const Pose& T_left_imu, double rate_hz, RigFile& out) {
    // A common IMU rate. Odometry does not use this rate: it uses the time stamps of the samples.
    constexpr double kAssumedImuRate_hz = 200.0;
    out.rig.T_body_left = T_body_optical();
    const bool known = rate_hz > 0.0;
    out.rig.imu =
        camera::ImuMount{*out.rig.T_body_left * T_left_imu, known ? rate_hz : kAssumedImuRate_hz};
    out.notes.push_back(
        fmt::format("{}base_link lies at the left camera: x points along its optical axis, y to "
                    "the left, z up in the image",
                    known ? ""
                          : fmt::format("the file has no rate of the IMU: {} Hz is assumed; ",
                                        kAssumedImuRate_hz)));
}

void mark_if_rectified(camera::StereoRig& rig) {
    if (!rig.right) return;
    rig.rectified = true;  // assumed; the next line checks this
    rig.rectified = !rig.problem().has_value();
}

}  // namespace surefoot::io

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/specular/floor_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace surefoot::specular {
namespace {

constexpr double kWindow_m = 5.12;
constexpr double kAhead_m = 1.0;     ///< distance from the body to the middle of the window
constexpr double kSlack_m = 0.25;    ///< the window moves if its centre is off by more than this
constexpr double kNearest_m = 0.25;  ///< smallest depth along the optical axis
constexpr unsigned kRowPhases = 4;
/// A measured point belongs to the plane up to this distance above or below the plane.
constexpr double kHeightTolerance_m = 0.06;
/// Largest weight of a cell's mean. A sample at a depth of one metre adds a weight of 1. So the
/// mean follows a change of the floor within about this many samples.
constexpr float kMostWeight = 8.0F;
constexpr float kUnseen = std::numeric_limits<float>::quiet_NaN();

/// Sample position in a cell. The position changes after every kRowPhases frames, when all rows
/// have had a turn. So the mean of four samples is the mean over the cell.
struct InCell {
    double x;
    double y;
};
constexpr std::array<InCell, 4> kInCell = {
    {{0.25, 0.25}, {0.75, 0.75}, {0.25, 0.75}, {0.75, 0.25}}};

}  // namespace

/// Data of one frame for filling the rows of the picture.
struct FloorPicture::View {
    const camera::RectifiedRig& rig;
    ImageView<const std::uint8_t> left;
    ImageView<const float> disparity_px;
    Eigen::Matrix3d R_camera_odom;
    Eigen::Vector3d camera_m;  ///< position in odom
    InCell in_cell;
    double floor_z_m = 0.0;
    double range_m = 0.0;
    int first_ix = 0;
    int last_ix = 0;
};

FloorPicture::FloorPicture(const SpecularConfig& config)
    : range_m_(config.range_m),
      window_(kWindow_m, config.cell_m),
      grey_(window_.geometry().nx, window_.geometry().ny, kUnseen),
      weight_(window_.geometry().nx, window_.geometry().ny, 0.0F) {}

void FloorPicture::clear() {
    grey_.fill(kUnseen);
    weight_.fill(0.0F);
}

void FloorPicture::follow(const Pose& T_odom_body) {
    if (!T_odom_body.all_finite()) return;
    const double yaw = yaw_rad(T_odom_body);
    const Eigen::Vector2d wanted_m = T_odom_body.translation_m.head<2>() +
                                     kAhead_m * Eigen::Vector2d(std::cos(yaw), std::sin(yaw));
    const grid::GridGeometry& g = geometry();
    const Eigen::Vector2d middle_m =
        g.origin_m + 0.5 * g.resolution_m * Eigen::Vector2d(g.nx, g.ny);
    if ((wanted_m - middle_m).cwiseAbs().maxCoeff() <= kSlack_m) return;
    const grid::Shift shift = window_.center_on(wanted_m.x(), wanted_m.y());
    grey_.shift(shift, kUnseen);
    weight_.shift(shift, 0.0F);
}

void FloorPicture::add(const camera::RectifiedRig& rig,
                       const Pose& T_odom_body,
                       ImageView<const std::uint8_t> left,
                       ImageView<const float> disparity_px,
                       double floor_z_m) {
    const Pose T_odom_camera = T_odom_body * rig.T_body_camera;
    const Eigen::Vector3d& camera_m = T_odom_camera.translation_m;
    if (!T_odom_camera.all_finite() || camera_m.z() <= floor_z_m + kNearest_m) return;
    if (left.width != rig.width || left.height != rig.height || disparity_px.width != rig.width ||
        disparity_px.height != rig.height)
        return;
    const grid::GridGeometry& g = geometry();
    const unsigned phase = frame_ % kRowPhases;
    const InCell in_cell = kInCell[frame_ / kRowPhases % kInCell.size()];
    ++frame_;
    const Eigen::Array2d low =
        (camera_m.head<2>().array() - range_m_ - g.origin_m.array()) / g.resolution_m;
    const Eigen::Array2d high =
        (camera_m.head<2>().array() + range_m_ - g.origin_m.array()) / g.resolution_m;
    const auto cell = [](double at, int count) {
        const double inside = std::clamp(std::floor(at), 0.0, static_cast<double>(count - 1));
        return static_cast<int>(inside);  // in range: clamped, the pose is finite
    };
    const View view{rig,
                    left,
                    disparity_px,
                    T_odom_camera.R().transpose(),
                    camera_m,
                    in_cell,
                    floor_z_m,
                    range_m_,
                    cell(low.x(), g.nx),
                    cell(high.x(), g.nx)};
    for (int iy = cell(low.y(), g.ny); iy <= cell(high.y(), g.ny); ++iy) {
        // Rows take turns by their number in odom. This number does not change when the window
        // moves.
        const auto row = static_cast<std::uint64_t>(window_.first_iy() + iy);
        if (row % kRowPhases != phase) continue;
        add_row(view, iy, g.origin_m.y() + g.resolution_m * (iy + in_cell.y));
    }
}

void FloorPicture::add_row(const View& view, int iy, double y_m) {
    const grid::GridGeometry& g = geometry();
    const camera::RectifiedRig& rig = view.rig;
    const double first_x_m = g.origin_m.x() + g.resolution_m * (view.first_ix + view.in_cell.x);
    Eigen::Vector3d ray =
        view.R_camera_odom * (Eigen::Vector3d(first_x_m, y_m, view.floor_z_m) - view.camera_m);
    const Eigen::Vector3d step = g.resolution_m * view.R_camera_odom.col(0);
    const double height_m = view.camera_m.z() - view.floor_z_m;
    const double fb_px_m = rig.depth_to_disparity_px_m();
    const double last_u = rig.width - 2;
    const double last_v = rig.height - 2;
    float* grey = grey_.row(iy);
    float* weight = weight_.row(iy);
    for (int ix = view.first_ix; ix <= view.last_ix; ++ix, ray += step) {
        const double z_m = ray.z();
        if (!(z_m > kNearest_m && z_m < view.range_m)) continue;
        const double u = rig.fx_px * ray.x() / z_m + rig.cx_px;
        const double v = rig.fy_px * ray.y() / z_m + rig.cy_px;
        if (!(u >= 0.0 && v >= 0.0 && u < last_u && v < last_v)) continue;
        const int left = static_cast<int>(u);  // in range: inside the image
        const int top = static_cast<int>(v);   // in range: inside the image
        const double disparity_px = static_cast<double>(
            view.disparity_px.row(top + (v - top > 0.5))[left + (u - left > 0.5)]);
        // A ray that ends above the plane ends earlier, with a larger disparity. NaN fails the
        // comparison.
        const double above_m = height_m * (1.0 - fb_px_m / (disparity_px * z_m));
        if (!(std::abs(above_m) < kHeightTolerance_m)) continue;
        const std::uint8_t* upper = view.left.row(top) + left;
        const std::uint8_t* lower = view.left.row(top + 1) + left;
        const auto a = static_cast<float>(u - left);
        const auto b = static_cast<float>(v - top);
        const float over = static_cast<float>(upper[0]) +
                           a * (static_cast<float>(upper[1]) - static_cast<float>(upper[0]));
        const float under = static_cast<float>(lower[0]) +
                            a * (static_cast<float>(lower[1]) - static_cast<float>(lower[0]));
        const float seen = over + b * (under - over);
        const auto share = static_cast<float>(1.0 / (z_m * z_m));
        const float known = std::min(weight[ix], kMostWeight);
        weight[ix] = known + share;
        grey[ix] = known > 0.0F ? grey[ix] + (seen - grey[ix]) * share / (known + share) : seen;
    }
}

}  // namespace surefoot::specular

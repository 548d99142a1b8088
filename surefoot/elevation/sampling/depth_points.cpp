// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/sampling/depth_points.hpp"

#include <cmath>

#include "surefoot/core/unknown.hpp"

namespace surefoot::elevation {
namespace {

/// Converts one frame into points. Holds the constants of the frame.
class DepthWalk {
  public:
    DepthWalk(const ElevationConfig& config,
              const camera::RectifiedRig& rig,
              const Pose& T_odom_body,
              const DepthImage& depth,
              const Eigen::Vector2d& grid_origin_m)
        : config_(config),
          rig_(rig),
          depth_(depth),
          check_(config.pixels,
                 rig.fx_px,
                 rig.fy_px,
                 (T_odom_body * rig.T_body_camera).R().row(2).transpose()),
          R_odom_camera_((T_odom_body * rig.T_body_camera).R()),
          camera_in_grid_m_((T_odom_body * rig.T_body_camera).translation_m),
          body_z_m_(T_odom_body.translation_m.z()),
          tilt_var_(config.camera_tilt_sigma_rad * config.camera_tilt_sigma_rad),
          per_fx_(1.0 / rig.fx_px),
          depth_to_disparity_px_m_(rig.depth_to_disparity_px_m()),
          max_outlier_probability_(static_cast<float>(config.pixels.max_outlier_probability)) {
        camera_in_grid_m_.head<2>() -= grid_origin_m;
    }

    void row(int v, std::vector<GridPoint>& points, FusionCounts& counts) const {
        const float* disparity_px = depth_.disparity_px.row(v);
        const float* sigma_px = depth_.sigma_px.row(v);
        const RowRays rays(*this, v);
        for (int u = 0; u < depth_.disparity_px.width(); ++u) {
            if (!(disparity_px[u] > 0.0F) || std::isinf(disparity_px[u])) continue;
            ++counts.points;
            const double x = (u - rig_.cx_px) * per_fx_;
            if (!is_trusted(u, v, static_cast<float>(x), static_cast<float>(rays.y))) {
                ++counts.gated_confidence;
                continue;
            }
            const double z_m = depth_to_disparity_px_m_ / static_cast<double>(disparity_px[u]);
            SensorReading reading{z_m,
                                  0.0,
                                  static_cast<double>(sigma_px[u]),
                                  static_cast<double>(u),
                                  static_cast<double>(v),
                                  rig_.cy_px,
                                  rig_.fx_px,
                                  depth_to_disparity_px_m_};
            add_pixel(rays, x, reading, points, counts);
        }
    }

  private:
    /// Data shared by the rays of one row: the ray (x, y, 1) in odom is x * along + start.
    struct RowRays {
        RowRays(const DepthWalk& walk, int v)
            : y((v - walk.rig_.cy_px) / walk.rig_.fy_px),
              start(walk.R_odom_camera_.col(1) * y + walk.R_odom_camera_.col(2)),
              along(walk.R_odom_camera_.col(0)) {}
        double y;
        Eigen::Vector3d start;
        Eigen::Vector3d along;
    };

    [[nodiscard]] bool is_trusted(int u, int v, float ray_x, float ray_y) const {
        if (!(depth_.outlier_probability.row(v)[u] <= max_outlier_probability_)) return false;
        const float sigma_px = depth_.sigma_px.row(v)[u];
        if (!(sigma_px > 0.0F) || std::isinf(sigma_px)) return false;
        if (!config_.pixels.surface_check) return true;
        return check_.accepts(
            neighbours(u, v), depth_.disparity_px.row(v)[u], sigma_px, ray_x, ray_y);
    }

    [[nodiscard]] Neighbours neighbours(int u, int v) const {
        const int reach = config_.pixels.reach_px;
        const Image<float>& d = depth_.disparity_px;
        return {u >= reach ? d.row(v)[u - reach] : kNanF,
                u + reach < d.width() ? d.row(v)[u + reach] : kNanF,
                v >= reach ? d.row(v - reach)[u] : kNanF,
                v + reach < d.height() ? d.row(v + reach)[u] : kNanF};
    }

    /// Adds the point of a pixel. `reading` must be complete except for the range.
    void add_pixel(const RowRays& rays,
                   double x,
                   SensorReading& reading,
                   std::vector<GridPoint>& points,
                   FusionCounts& counts) const {
        const double z_m = reading.depth_m;
        const double ray_sq = x * x + rays.y * rays.y + 1.0;
        reading.range_m = z_m * std::sqrt(ray_sq);
        if (!is_in_range(config_.prefilter, reading.range_m)) {
            ++counts.gated_range;
            return;
        }
        const double ray_up = rays.start.z() + x * rays.along.z();
        const double height_m = camera_in_grid_m_.z() + z_m * ray_up;
        if (!is_in_height(config_.prefilter, height_m - body_z_m_)) {
            ++counts.gated_height;
            return;
        }
        const RayVariance ray = ray_variance(config_.sensor, reading);
        // Gives the same result as height_variance_m2() if the pose has only equal errors of roll
        // and pitch.
        const double n_sq = ray_up * ray_up / ray_sq;
        const double beside_camera_sq_m2 = z_m * z_m * (ray_sq - ray_up * ray_up);
        const double var_m2 =
            ray.along_m2 * n_sq + ray.lateral_m2 * (1.0 - n_sq) + tilt_var_ * beside_camera_sq_m2;
        points.push_back({static_cast<float>(camera_in_grid_m_.x() +
                                             z_m * (rays.start.x() + x * rays.along.x())),
                          static_cast<float>(camera_in_grid_m_.y() +
                                             z_m * (rays.start.y() + x * rays.along.y())),
                          static_cast<float>(height_m),
                          static_cast<float>(var_m2)});
    }

    const ElevationConfig& config_;
    const camera::RectifiedRig& rig_;
    const DepthImage& depth_;
    SurfaceCheck check_;
    Eigen::Matrix3d R_odom_camera_;
    Eigen::Vector3d camera_in_grid_m_;
    double body_z_m_;
    double tilt_var_;
    double per_fx_;
    double depth_to_disparity_px_m_;
    float max_outlier_probability_;
};

}  // namespace

void points_from_depth(const ElevationConfig& config,
                       const camera::RectifiedRig& rig,
                       const Pose& T_odom_body,
                       const DepthImage& depth,
                       const Eigen::Vector2d& grid_origin_m,
                       std::vector<GridPoint>& points,
                       FusionCounts& counts) {
    const Image<float>& disparity = depth.disparity_px;
    SUREFOOT_ASSERT(depth.sigma_px.width() == disparity.width() &&
                    depth.sigma_px.height() == disparity.height() &&
                    depth.outlier_probability.width() == disparity.width() &&
                    depth.outlier_probability.height() == disparity.height());
    points.clear();
    points.reserve(disparity.size());
    const DepthWalk walk(config, rig, T_odom_body, depth, grid_origin_m);
    for (int v = 0; v < disparity.height(); ++v) walk.row(v, points, counts);
}

}  // namespace surefoot::elevation

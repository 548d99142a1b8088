// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "surefoot/sim/scenes/ground_field.hpp"

namespace surefoot::sim {

/// A ground sample under a foot; `p_foot_m` is relative to the foot's centre, along its axes.
struct SolePoint {
    int i = 0;
    int j = 0;
    Eigen::Vector2d p_field_m;
    Eigen::Vector2d p_foot_m;
    double z_m = 0.0;
};

/// The ground under one foot.
struct FootGround {
    std::vector<SolePoint> points;             ///< sole points that have ground
    std::optional<Eigen::Vector2d> void_at_m;  ///< one point without ground, in the field's frame
    double mean_z_m = 0.0;
    LevelPlane plane;  ///< least-squares plane over `p_foot_m`

    [[nodiscard]] double tilt_rad() const;
    /// Patch of the sole with the largest absolute mean residual to the plane, and its position.
    /// The sole is cut into equal patches with sides of at most `side_m`.
    struct Patch {
        double residual_m = 0.0;
        Eigen::Vector2d center_field_m = Eigen::Vector2d::Zero();
    };
    [[nodiscard]] Patch worst_patch(const Eigen::Vector2d& size_m, double side_m) const;
};

/// Samples the ground under `foot`, a rectangle in base_link.
[[nodiscard]] FootGround ground_under(const GroundField& field,
                                      const Rect& foot,
                                      const PlanarPose& T_field_body);

/// Calls f(i, j, p_field, p_body) for the samples under a rectangle in base_link, border included.
template <typename F>
void for_samples_under(const GroundField& field,
                       const Rect& box,
                       const PlanarPose& T_field_body,
                       F&& f) {
    constexpr double kRim_m = 1e-9;
    const Eigen::Vector2d middle_m = T_field_body * Eigen::Vector2d(0.5 * (box.min_m + box.max_m));
    const Eigen::Vector2d half = 0.5 * (box.max_m - box.min_m);
    const double c = std::abs(T_field_body.cos_yaw);
    const double s = std::abs(T_field_body.sin_yaw);
    const Eigen::Vector2d reach(c * half.x() + s * half.y(), s * half.x() + c * half.y());
    const auto range = field.range_of({middle_m - reach, middle_m + reach});
    for (int j = range.min_j; j <= range.max_j; ++j) {
        for (int i = range.min_i; i <= range.max_i; ++i) {
            const Eigen::Vector2d p_field = GroundField::point_m(i, j);
            const Eigen::Vector2d p_body = T_field_body.inverse_times(p_field);
            const bool inside =
                p_body.x() >= box.min_m.x() - kRim_m && p_body.x() <= box.max_m.x() + kRim_m &&
                p_body.y() >= box.min_m.y() - kRim_m && p_body.y() <= box.max_m.y() + kRim_m;
            if (inside) f(i, j, p_field, p_body);
        }
    }
}

}  // namespace surefoot::sim

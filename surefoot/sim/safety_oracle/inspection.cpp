// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/safety_oracle/inspection.hpp"

#include <limits>

#include "surefoot/core/angles.hpp"

namespace surefoot::sim::rules {

using Eigen::Vector2d;

Inspection inspection_at(const GroundField& field,
                         const std::vector<char>& reached,
                         const Figures& figures,
                         const PlanarPose& T_field_body) {
    return {field,
            reached,
            figures,
            T_field_body,
            T_field_body * figures.T_start_target,
            stand(field, figures, T_field_body),
            Collector(field.T_world_field())};
}

bool Inspection::check_stance(double most_apart_m) {
    const Collector::Place here{T_field_body.position_m, stance.plane.height_m};
    if (!stance.known || stance.void_at_m) {
        const Collector::Place at{stance.void_at_m.value_or(here.p_field_m), here.z_m};
        found.add(Danger::no_stance, std::numeric_limits<double>::infinity(), 0.0, 0.0, at);
    }
    if (!stance.known) return false;
    const double difference_m = stance.height_difference_m;
    if (!(difference_m <= most_apart_m + kRounding))
        found.add(Danger::no_stance, difference_m, difference_m, most_apart_m, here);
    if (!(stance.tilt_rad <= figures.tilt_rad + kRounding)) {
        found.add(Danger::not_level_here,
                  stance.tilt_rad,
                  stance.tilt_rad * kDegPerRad,
                  figures.tilt_rad * kDegPerRad,
                  here);
    }
    return true;
}

void Inspection::check_sole(const FootGround& under, const Rect& foot) {
    const Vector2d middle_m = T_field_target * Vector2d(0.5 * (foot.min_m + foot.max_m));
    const double tilt_rad = under.tilt_rad();
    if (!(tilt_rad <= figures.tilt_rad + kRounding)) {
        found.add(Danger::tilt,
                  tilt_rad,
                  tilt_rad * kDegPerRad,
                  figures.tilt_rad * kDegPerRad,
                  {middle_m, under.mean_z_m});
    }
    const auto patch = under.worst_patch(foot.max_m - foot.min_m, figures.patch_side_m);
    if (!(patch.residual_m <= figures.residual_m + kRounding)) {
        found.add(Danger::roughness,
                  patch.residual_m,
                  patch.residual_m,
                  figures.residual_m,
                  {patch.center_field_m, under.mean_z_m});
    }
}

void Inspection::check_way(const Rect& foot, double clearance_m, double lower_edge_m) {
    const SweptBox way(grown(foot, figures.foot_margin_m), T_field_body, figures.T_start_target);
    const auto matters = [&](const GroundField::Tile& tile, double low_m, double high_m) {
        return tile.highest_ground_m - low_m > clearance_m ||
               tile.lowest_underside_m - high_m < lower_edge_m;
    };
    for_samples_in(way.bounds(), matters, [&](const Vector2d& p_field, const auto& sample) {
        const double above_m = above_plane(p_field, sample.ground_m);
        const double hangs_m = above_plane(p_field, sample.underside_m);
        const bool too_high = above_m > clearance_m + kRounding;
        if (!too_high && !(hangs_m < lower_edge_m - kRounding)) return;
        const double value_m = too_high ? above_m : hangs_m;
        const double limit_m = too_high ? clearance_m : lower_edge_m;
        if (!found.is_worse(Danger::obstacle_in_way, value_m) || !way.covers(p_field)) return;
        found.add(Danger::obstacle_in_way,
                  value_m,
                  value_m,
                  limit_m,
                  {p_field, stance.plane.at(p_field) + value_m});
    });
}

void Inspection::check_space(const SweptBox& area, double low_m, double high_m) {
    const auto matters = [&](const GroundField::Tile& tile, double lowest_m, double highest_m) {
        return tile.highest_ground_m - lowest_m > low_m ||
               (tile.highest_top_m - lowest_m > low_m &&
                tile.lowest_underside_m - highest_m < high_m);
    };
    for_samples_in(area.bounds(), matters, [&](const Vector2d& p_field, const auto& sample) {
        const bool in_ground = above_plane(p_field, sample.ground_m) > low_m + kRounding;
        if (!in_ground && !(above_plane(p_field, sample.top_m) > low_m + kRounding)) return;
        const double hangs_m = above_plane(p_field, sample.underside_m);
        const double begins_m = in_ground ? low_m : std::max(hangs_m, low_m);
        if (!(begins_m < high_m - kRounding)) return;
        const Danger danger =
            begins_m > figures.hips_m ? Danger::overhang_too_low : Danger::body_hits;
        if (!found.is_worse(danger, -begins_m) || !area.covers(p_field)) return;
        found.add(
            danger, -begins_m, begins_m, high_m, {p_field, stance.plane.at(p_field) + begins_m});
    });
}

}  // namespace surefoot::sim::rules

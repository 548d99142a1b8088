// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/safety_oracle/safety_rules.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "surefoot/geometry/statistics.hpp"
#include "surefoot/sim/safety_oracle/foot_ground.hpp"
#include "surefoot/sim/safety_oracle/inspection.hpp"
#include "surefoot/sim/safety_oracle/tread_rules.hpp"

namespace surefoot::sim::rules {
namespace {

using Eigen::Vector2d;

double median(std::vector<double>& values) {
    if (values.empty()) return 0.0;
    return upper_median_in_place(values);
}

/// Collects slopes over 20 mm along both axes of the field, inside one foot, at every second
/// sample.
void collect_slopes(const GroundField& field,
                    const FootGround& foot,
                    const Vector2d& half_m,
                    std::array<std::vector<double>, 2>& slopes) {
    constexpr int kStride = 4;
    constexpr double kRun_m = kStride * GroundField::kSpacing_m;
    for (const SolePoint& p : foot.points) {
        if (p.i % 2 != 0 || p.j % 2 != 0) continue;
        const std::array<std::pair<int, int>, 2> ahead{std::pair{p.i + kStride, p.j},
                                                       {p.i, p.j + kStride}};
        for (int axis = 0; axis < 2; ++axis) {
            if (p.p_foot_m[axis] + kRun_m > half_m[axis]) continue;
            const auto& [i, j] = ahead[static_cast<std::size_t>(axis)];
            if (i > field.range().max_i || j > field.range().max_j) continue;
            const double slope = (field.at(i, j).ground_m - p.z_m) / kRun_m;
            if (!std::isnan(slope)) slopes[static_cast<std::size_t>(axis)].push_back(slope);
        }
    }
}

double mean_above(const FootGround& foot, const Vector2d& slope) {
    double sum_m = 0.0;
    for (const SolePoint& p : foot.points) sum_m += p.z_m - slope.dot(p.p_field_m);
    return sum_m / static_cast<double>(foot.points.size());
}

void check_height(Inspection& at, const SolePoint& p, double above_m) {
    const Collector::Place place{p.p_field_m, p.z_m};
    const Figures& figures = at.figures;
    // A step down that the movement class allows is not a drop.
    const double drop_m = std::max(figures.drop_m, figures.down_m);
    if (above_m > figures.up_m + kRounding) {
        at.found.add(Danger::step_up, above_m, above_m, figures.up_m, place);
    } else if (above_m < -drop_m - kRounding) {
        at.found.add(Danger::drop_off, -above_m, -above_m, drop_m, place);
    } else if (above_m < -figures.down_m - kRounding) {
        at.found.add(Danger::step_down, -above_m, -above_m, figures.down_m, place);
    } else if (!at.is_reached(p)) {
        at.found.add(Danger::disconnected, 0.0, 0.0, 0.0, place);
    }
}

/// Checks the drop band, which is round at the corners of the foot. Heights are relative to the
/// landed foot.
void check_band(Inspection& at, const Rect& foot, double landed_m) {
    const Figures& figures = at.figures;
    const double lowest_m = landed_m - figures.drop_m - kRounding;  // above the stance plane
    const auto matters = [&](const GroundField::Tile& tile, double, double high_m) {
        return tile.lowest_ground_m - high_m < lowest_m;
    };
    const Rect band =
        SweptBox(grown(foot, figures.band_m), at.T_field_target, PlanarPose()).bounds();
    at.for_samples_in(band, matters, [&](const Vector2d& p_field, const GroundSample& sample) {
        if (at.above_plane(p_field, sample.ground_m) >= lowest_m) return;
        const Vector2d p_body = at.T_field_target.inverse_times(p_field);
        const Vector2d nearest = p_body.cwiseMax(foot.min_m).cwiseMin(foot.max_m);
        const double distance_m = (p_body - nearest).norm();
        if (distance_m <= kRounding || distance_m > figures.band_m + kRounding) return;
        const double plane_z_m = at.stance.plane.at(p_field);
        at.found.add(Danger::edge_too_near,
                     -distance_m,
                     distance_m,
                     figures.band_m,
                     {p_field, std::isnan(sample.ground_m) ? plane_z_m : sample.ground_m});
    });
}

void check_landing(Inspection& at, const Rect& foot) {
    const Figures& figures = at.figures;
    const FootGround under = ground_under(at.field, foot, at.T_field_target);
    if (under.void_at_m)
        at.found.add(Danger::no_ground, 0.0, 0.0, 0.0, {*under.void_at_m, under.mean_z_m});
    if (under.points.empty()) return;
    double mean_m = 0.0;
    for (const SolePoint& p : under.points) {
        const double above_m = at.above_plane(p.p_field_m, p.z_m);
        mean_m += above_m / static_cast<double>(under.points.size());
        check_height(at, p, above_m);
    }
    at.check_sole(under, foot);
    check_band(at, foot, std::clamp(mean_m, -figures.down_m, figures.up_m));
}

/// Finds the stance on flat ground or a ramp. The slope is a median, so that a sill under the toes
/// does not tilt the ground plane ahead.
Stance stand_on_ground(const GroundField& field,
                       const Figures& figures,
                       const PlanarPose& T_field_body) {
    Stance stance;
    std::array<FootGround, 2> under;
    std::array<std::vector<double>, 2> slopes;
    for (std::size_t k = 0; k < under.size(); ++k) {
        const Rect& foot = figures.feet[k];
        under[k] = ground_under(field, foot, T_field_body);
        if (under[k].void_at_m) stance.void_at_m = under[k].void_at_m;
        if (under[k].points.empty()) return stance;
        collect_slopes(field, under[k], 0.5 * (foot.max_m - foot.min_m), slopes);
        stance.tilt_rad = std::max(stance.tilt_rad, under[k].tilt_rad());
    }
    const Vector2d slope(median(slopes[0]), median(slopes[1]));
    const std::array<double, 2> height_m{mean_above(under[0], slope), mean_above(under[1], slope)};
    stance.plane = {0.5 * (height_m[0] + height_m[1]), slope};
    stance.height_difference_m = std::abs(height_m[0] - height_m[1]);
    stance.tilt_rad = std::max(stance.tilt_rad, std::atan(slope.norm()));
    stance.known = true;
    return stance;
}

}  // namespace

Stance stand(const GroundField& field, const Figures& figures, const PlanarPose& T_field_body) {
    return figures.treads ? stand_on_treads(field, figures, T_field_body)
                          : stand_on_ground(field, figures, T_field_body);
}

std::vector<Finding> dangers_at(const GroundField& field,
                                const std::vector<char>& reached,
                                const Figures& figures,
                                const PlanarPose& T_field_body) {
    Inspection at = inspection_at(field, reached, figures, T_field_body);
    if (!at.check_stance(figures.treads ? figures.residual_m
                                        : std::max(figures.up_m, figures.down_m)))
        return at.found.findings();
    if (figures.treads) {
        check_tread_step(at);
        return at.found.findings();
    }
    for (const Rect& foot : figures.feet) {
        check_landing(at, foot);
        at.check_way(foot, figures.clearance_m, figures.lower_edge_m);
    }
    for (const Figures::Part& part : figures.body) {
        at.check_space(
            SweptBox(grown(part.box, figures.sway_m), T_field_body, figures.T_start_target),
            part.low_m,
            part.high_m);
    }
    return at.found.findings();
}

}  // namespace surefoot::sim::rules

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/safety_oracle/tread_rules.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/geometry/statistics.hpp"

namespace surefoot::sim::rules {
namespace {

using Eigen::Vector2d;

/// A nosing that is not square to the foot passes the band beside the foot up to this distance
/// before or behind the end of the carried part: 5 deg over 0.2 m.
constexpr double kSlant_m = 0.02;

/// Returns the height of a sample; minus infinity without ground.
double depth(double z_m) {
    if (std::isnan(z_m)) return -std::numeric_limits<double>::infinity();
    return z_m;
}

bool is_enough(const FootOnTread& foot, const Rect& box, const Figures& figures) {
    const double length_m = box.max_m.x() - box.min_m.x();
    return foot.carried_m() >= figures.treads->share * length_m - kRounding;
}

/// Tests that the tread carries enough of a landed foot.
void check_support(Inspection& at, const FootOnTread& foot, const Rect& box) {
    const Figures& figures = at.figures;
    const Collector::Place middle{at.T_field_target * Vector2d(0.5 * (box.min_m + box.max_m)),
                                  foot.level_m};
    if (!is_enough(foot, box, figures)) {
        const double wanted_m = figures.treads->share * (box.max_m.x() - box.min_m.x());
        at.found.add(Danger::tread_support, -foot.carried_m(), foot.carried_m(), wanted_m, middle);
    }
    const double over_m = foot.over_m();
    if (over_m > figures.treads->overhang_m + kRounding)
        at.found.add(Danger::tread_overhang, over_m, over_m, figures.treads->overhang_m, middle);
    if (foot.highest_m > figures.residual_m + kRounding) {
        at.found.add(Danger::roughness,
                     foot.highest_m,
                     foot.highest_m,
                     figures.residual_m,
                     {foot.highest_field_m, foot.level_m + foot.highest_m});
    }
    if (foot.carried.points.empty()) return;
    at.check_sole(foot.carried, foot.carried_box);
    for (const SolePoint& p : foot.carried.points) {
        if (!at.is_reached(p))
            at.found.add(Danger::disconnected, 0.0, 0.0, 0.0, {p.p_field_m, p.z_m});
    }
}

/// Tests the height of a tread above the stance.
void check_rise(Inspection& at, double rise_m, const Collector::Place& place) {
    const Figures& figures = at.figures;
    if (rise_m > figures.up_m + kRounding)
        at.found.add(Danger::step_up, rise_m, rise_m, figures.up_m, place);
    if (-rise_m > figures.down_m + kRounding)
        at.found.add(Danger::step_down, -rise_m, -rise_m, figures.down_m, place);
}

/// Tests the ground around a landed foot, which is round at the corners of the foot. Before and
/// behind the carried part, the next tread may lie lower by one step down. Within the margin of the
/// foot nothing may be higher than the swing clearance, because the foot is put down vertically.
void check_around(Inspection& at, const FootOnTread& foot, const Rect& box) {
    const Figures& figures = at.figures;
    const double reach_m = std::max(figures.band_m, figures.foot_margin_m);
    const double drop_z_m = foot.level_m - figures.drop_m - kRounding;
    const double next_z_m = foot.level_m - figures.down_m - figures.residual_m - kRounding;
    const double high_z_m = foot.level_m + figures.swing_m + kRounding;
    const auto everywhere = [](const GroundField::Tile&, double, double) { return true; };
    const Rect area = SweptBox(grown(box, reach_m), at.T_field_target, PlanarPose()).bounds();
    at.for_samples_in(area, everywhere, [&](const Vector2d& p_field, const auto& sample) {
        const double z_m = depth(sample.ground_m);
        if (z_m >= drop_z_m && z_m <= high_z_m) return;
        const Vector2d p_body = at.T_field_target.inverse_times(p_field);
        const double from_foot_m = (p_body - p_body.cwiseMax(box.min_m).cwiseMin(box.max_m)).norm();
        if (z_m > high_z_m) {
            if (from_foot_m > figures.foot_margin_m + kRounding) return;
            at.found.add(Danger::obstacle_in_way,
                         -from_foot_m,
                         z_m - at.stance.plane.height_m,
                         high_z_m - at.stance.plane.height_m,
                         {p_field, z_m});
            return;
        }
        const bool beside = p_body.x() > foot.carried_box.min_m.x() + kSlant_m &&
                            p_body.x() < foot.carried_box.max_m.x() - kSlant_m;
        if (from_foot_m > figures.band_m + kRounding || (!beside && z_m >= next_z_m)) return;
        at.found.add(Danger::edge_too_near,
                     -from_foot_m,
                     from_foot_m,
                     figures.band_m,
                     {p_field, std::max(z_m, next_z_m)});
    });
}

/// Tests the space of the body. It rises before it moves, and sinks after it has moved.
void check_body(Inspection& at, double rise_m) {
    const Figures& figures = at.figures;
    const double up_m = std::max(0.0, rise_m);
    for (const Figures::Part& part : figures.body) {
        const Rect box = grown(part.box, figures.sway_m);
        at.check_space(
            SweptBox(box, at.T_field_body, PlanarPose()), part.low_m, part.high_m + up_m);
        at.check_space(SweptBox(box, at.T_field_body, figures.T_start_target),
                       part.low_m + up_m,
                       part.high_m + up_m);
        at.check_space(SweptBox(box, at.T_field_target, PlanarPose()),
                       part.low_m + rise_m,
                       part.high_m + up_m);
    }
}

}  // namespace

double FootOnTread::carried_m() const {
    return std::max(0.0, carried_box.max_m.x() - carried_box.min_m.x());
}

double FootOnTread::over_m() const {
    return std::max(heel_over_m, toe_over_m);
}

FootOnTread foot_on_tread(const GroundField& field,
                          const Rect& foot,
                          const Figures& figures,
                          const PlanarPose& T_field_body) {
    FootOnTread on;
    on.carried_box = {foot.min_m, foot.min_m};
    const double heel_m = foot.min_m.x();
    const double length_m = foot.max_m.x() - heel_m;
    const double ankle_m = heel_m + figures.treads->ankle_from_heel_m;
    const double reach_m = 0.5 * figures.patch_side_m;
    const int rows = std::max(1, saturated_integer<int>(length_m / GroundField::kSpacing_m));
    const auto row_of = [&](double along_m) {
        return clamped_integer<int>((along_m - heel_m) / length_m * rows, 0, rows - 1);
    };
    std::vector<double> ankle_z_m;
    for_samples_under(
        field, foot, T_field_body, [&](int i, int j, const Vector2d&, const Vector2d& p) {
            if (std::abs(p.x() - ankle_m) <= reach_m)
                ankle_z_m.push_back(depth(field.at(i, j).ground_m));
        });
    if (ankle_z_m.empty()) return on;
    on.level_m = upper_median_in_place(ankle_z_m);
    if (std::isinf(on.level_m)) return on;
    on.known = true;

    std::vector<double> lowest_m(static_cast<std::size_t>(rows),
                                 std::numeric_limits<double>::infinity());
    for_samples_under(
        field, foot, T_field_body, [&](int i, int j, const Vector2d& p_field, const Vector2d& p) {
            const double z_m = depth(field.at(i, j).ground_m);
            const int row = row_of(p.x());
            double& lowest = lowest_m[static_cast<std::size_t>(row)];
            lowest = std::min(lowest, z_m);
            if (z_m - on.level_m > on.highest_m) {
                on.highest_m = z_m - on.level_m;
                on.highest_field_m = p_field;
            }
        });
    const auto carries = [&](int row) {
        return lowest_m[static_cast<std::size_t>(row)] >= on.level_m - figures.drop_m - kRounding;
    };
    int first = row_of(ankle_m - reach_m);
    int last = row_of(ankle_m + reach_m);
    bool on_tread = true;
    for (int row = first; row <= last; ++row) on_tread = on_tread && carries(row);
    if (!on_tread) {
        on.heel_over_m = on.toe_over_m = length_m;
        return on;
    }
    while (first > 0 && carries(first - 1)) --first;
    while (last + 1 < rows && carries(last + 1)) ++last;
    const double row_m = length_m / rows;
    on.heel_over_m = row_m * first;
    on.toe_over_m = row_m * (rows - 1 - last);
    on.carried_box = {{heel_m + on.heel_over_m, foot.min_m.y()},
                      {foot.max_m.x() - on.toe_over_m, foot.max_m.y()}};
    on.carried = ground_under(field, on.carried_box, T_field_body);
    return on;
}

Stance stand_on_treads(const GroundField& field,
                       const Figures& figures,
                       const PlanarPose& T_field_body) {
    Stance stance;
    std::array<double, 2> level_m{};
    for (std::size_t k = 0; k < level_m.size(); ++k) {
        const Rect& box = figures.feet[k];
        const FootOnTread foot = foot_on_tread(field, box, figures, T_field_body);
        if (!foot.known || foot.carried.points.empty()) return stance;
        if (!is_enough(foot, box, figures) ||
            foot.over_m() > figures.treads->overhang_m + kRounding)
            stance.void_at_m = T_field_body * Vector2d(0.5 * (box.min_m + box.max_m));
        level_m[k] = foot.level_m;
        stance.tilt_rad = std::max(stance.tilt_rad, foot.carried.tilt_rad());
    }
    stance.plane = {0.5 * (level_m[0] + level_m[1]), Vector2d::Zero()};
    stance.height_difference_m = std::abs(level_m[0] - level_m[1]);
    stance.known = true;
    return stance;
}

void check_tread_step(Inspection& at) {
    const Figures& figures = at.figures;
    std::array<FootOnTread, 2> feet;
    std::array<double, 2> rise_m{};
    for (std::size_t k = 0; k < feet.size(); ++k) {
        const Rect& box = figures.feet[k];
        feet[k] = foot_on_tread(at.field, box, figures, at.T_field_target);
        const Vector2d middle_m = at.T_field_target * Vector2d(0.5 * (box.min_m + box.max_m));
        if (!feet[k].known) {
            at.found.add(Danger::no_ground, 0.0, 0.0, 0.0, {middle_m, at.stance.plane.height_m});
            return;
        }
        rise_m[k] = feet[k].level_m - at.stance.plane.height_m;
        check_rise(at, rise_m[k], {middle_m, feet[k].level_m});
        check_support(at, feet[k], box);
        check_around(at, feet[k], box);
    }
    const double apart_m = std::abs(rise_m[0] - rise_m[1]);
    if (apart_m > figures.residual_m + kRounding) {
        at.found.add(Danger::roughness,
                     apart_m,
                     apart_m,
                     figures.residual_m,
                     {at.T_field_target.position_m, feet[0].level_m});
    }
    const double highest_m = std::max({0.0, rise_m[0], rise_m[1]});
    for (const Rect& box : figures.feet)
        at.check_way(box, highest_m + figures.swing_m, highest_m + figures.lower_edge_m);
    check_body(at, std::abs(rise_m[0]) > std::abs(rise_m[1]) ? rise_m[0] : rise_m[1]);
}

}  // namespace surefoot::sim::rules

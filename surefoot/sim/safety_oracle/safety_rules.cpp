// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/safety_oracle/safety_rules.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "surefoot/core/angles.hpp"
#include "surefoot/geometry/statistics.hpp"
#include "surefoot/sim/safety_oracle/foot_ground.hpp"
#include "surefoot/sim/safety_oracle/swept_box.hpp"

namespace surefoot::sim::rules {
namespace {

using Eigen::Vector2d;

/// Tolerance for rounding errors [m, rad]: a value that equals its limit does not exceed it.
constexpr double kRounding = 1e-7;

/// Keeps the worst finding of each danger.
class Collector {
  public:
    explicit Collector(const PlanarPose& T_world_field) : T_world_field_(T_world_field) {}

    struct Place {
        Vector2d p_field_m = Vector2d::Zero();
        double z_m = 0.0;
    };
    /// A larger `badness` is worse.
    void add(Danger danger, double badness, double value, double limit, const Place& place) {
        Slot& slot = slots_[static_cast<std::size_t>(danger)];
        if (slot.used && badness <= slot.badness) return;
        const Vector2d p_world = T_world_field_ * place.p_field_m;
        slot = {true, badness, {danger, value, limit, {p_world.x(), p_world.y(), place.z_m}}};
    }
    [[nodiscard]] bool is_worse(Danger danger, double badness) const {
        const Slot& slot = slots_[static_cast<std::size_t>(danger)];
        return !slot.used || badness > slot.badness;
    }
    [[nodiscard]] std::vector<Finding> findings() const {
        std::vector<Finding> all;
        for (const Slot& slot : slots_) {
            if (slot.used) all.push_back(slot.finding);
        }
        return all;
    }

  private:
    struct Slot {
        bool used = false;
        double badness = 0.0;
        Finding finding;
    };
    PlanarPose T_world_field_;
    std::array<Slot, kDangerCount> slots_;
};

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

/// Checks one pose and one movement. The findings are in the order of `Danger`.
class Inspector {
  public:
    Inspector(const GroundField& field,
              const std::vector<char>& reached,
              const Figures& figures,
              const PlanarPose& T_field_body)
        : field_(field),
          reached_(reached),
          figures_(figures),
          T_field_body_(T_field_body),
          stance_(stand(field, figures, T_field_body)),
          found_(field.T_world_field()) {}

    std::vector<Finding> inspect() {
        check_stance();
        if (!stance_.known) return found_.findings();
        const PlanarPose T_field_target = T_field_body_ * figures_.T_start_target;
        for (const Rect& foot : figures_.feet) {
            check_landing(foot, T_field_target);
            check_way(foot);
        }
        for (const Figures::Part& part : figures_.body) check_body(part);
        return found_.findings();
    }

  private:
    [[nodiscard]] double above_plane(const Vector2d& p_field, double z_m) const {
        return z_m - stance_.plane.at(p_field);
    }

    void check_stance() {
        const Collector::Place here{T_field_body_.position_m, stance_.plane.height_m};
        if (!stance_.known || stance_.void_at_m) {
            const Collector::Place at{stance_.void_at_m.value_or(here.p_field_m), here.z_m};
            found_.add(Danger::no_stance, std::numeric_limits<double>::infinity(), 0.0, 0.0, at);
        }
        if (!stance_.known) return;
        const double most_m = std::max(figures_.up_m, figures_.down_m);
        const double difference_m = stance_.height_difference_m;
        if (!(difference_m <= most_m + kRounding))
            found_.add(Danger::no_stance, difference_m, difference_m, most_m, here);
        if (!(stance_.tilt_rad <= figures_.tilt_rad + kRounding)) {
            found_.add(Danger::not_level_here,
                       stance_.tilt_rad,
                       stance_.tilt_rad * kDegPerRad,
                       figures_.tilt_rad * kDegPerRad,
                       here);
        }
    }

    void check_landing(const Rect& foot, const PlanarPose& T_field_target) {
        const FootGround under = ground_under(field_, foot, T_field_target);
        if (under.void_at_m)
            found_.add(Danger::no_ground, 0.0, 0.0, 0.0, {*under.void_at_m, under.mean_z_m});
        if (under.points.empty()) return;
        double mean_m = 0.0;
        for (const SolePoint& p : under.points) {
            const double above_m = above_plane(p.p_field_m, p.z_m);
            mean_m += above_m / static_cast<double>(under.points.size());
            check_height(p, above_m);
        }
        check_sole(under, foot, T_field_target);
        check_band(foot, T_field_target, std::clamp(mean_m, -figures_.down_m, figures_.up_m));
    }

    void check_height(const SolePoint& p, double above_m) {
        const Collector::Place at{p.p_field_m, p.z_m};
        // A step down that the movement class allows is not a drop.
        const double drop_m = std::max(figures_.drop_m, figures_.down_m);
        if (above_m > figures_.up_m + kRounding) {
            found_.add(Danger::step_up, above_m, above_m, figures_.up_m, at);
        } else if (above_m < -drop_m - kRounding) {
            found_.add(Danger::drop_off, -above_m, -above_m, drop_m, at);
        } else if (above_m < -figures_.down_m - kRounding) {
            found_.add(Danger::step_down, -above_m, -above_m, figures_.down_m, at);
        } else if (reached_[field_.index(p.i, p.j)] == 0) {
            found_.add(Danger::disconnected, 0.0, 0.0, 0.0, at);
        }
    }

    void check_sole(const FootGround& under, const Rect& foot, const PlanarPose& T_field_target) {
        const Vector2d middle_m = T_field_target * Vector2d(0.5 * (foot.min_m + foot.max_m));
        const double tilt_rad = under.tilt_rad();
        if (!(tilt_rad <= figures_.tilt_rad + kRounding)) {
            found_.add(Danger::tilt,
                       tilt_rad,
                       tilt_rad * kDegPerRad,
                       figures_.tilt_rad * kDegPerRad,
                       {middle_m, under.mean_z_m});
        }
        const auto patch = under.worst_patch(foot.max_m - foot.min_m, figures_.patch_side_m);
        if (!(patch.residual_m <= figures_.residual_m + kRounding)) {
            found_.add(Danger::roughness,
                       patch.residual_m,
                       patch.residual_m,
                       figures_.residual_m,
                       {patch.center_field_m, under.mean_z_m});
        }
    }

    /// Checks the drop band, which is round at the corners of the foot. Heights are relative to the
    /// landed foot.
    void check_band(const Rect& foot, const PlanarPose& T_field_target, double landed_m) {
        const double lowest_m = landed_m - figures_.drop_m - kRounding;  // above the stance plane
        const auto matters = [&](const GroundField::Tile& tile, double, double high_m) {
            return tile.lowest_ground_m - high_m < lowest_m;
        };
        const Rect band =
            SweptBox(grown(foot, figures_.band_m), T_field_target, PlanarPose()).bounds();
        for_samples_in(band, matters, [&](const Vector2d& p_field, const GroundSample& sample) {
            if (above_plane(p_field, sample.ground_m) >= lowest_m) return;
            const Vector2d p_body = T_field_target.inverse_times(p_field);
            const Vector2d nearest = p_body.cwiseMax(foot.min_m).cwiseMin(foot.max_m);
            const double distance_m = (p_body - nearest).norm();
            if (distance_m <= kRounding || distance_m > figures_.band_m + kRounding) return;
            const double plane_z_m = stance_.plane.at(p_field);
            found_.add(Danger::edge_too_near,
                       -distance_m,
                       distance_m,
                       figures_.band_m,
                       {p_field, std::isnan(sample.ground_m) ? plane_z_m : sample.ground_m});
        });
    }

    /// Calls f(p_field, sample) for the samples in `area`, in tiles that `matters` selects.
    /// `matters(tile, low, high)` gets the lowest and highest height of the stance plane in the
    /// tile.
    template <typename Matters, typename F>
    void for_samples_in(const Rect& area, Matters&& matters, F&& f) const {
        const auto range = field_.range_of(area);
        for (const GroundField::Tile& tile : field_.tiles()) {
            const int min_i = std::max(range.min_i, tile.range.min_i);
            const int max_i = std::min(range.max_i, tile.range.max_i);
            const int min_j = std::max(range.min_j, tile.range.min_j);
            const int max_j = std::min(range.max_j, tile.range.max_j);
            if (min_i > max_i || min_j > max_j) continue;
            const Vector2d low = GroundField::point_m(min_i, min_j);
            const Vector2d high = GroundField::point_m(max_i, max_j);
            const Vector2d& slope = stance_.plane.slope;
            const double middle_m = stance_.plane.at(0.5 * (low + high));
            const double spread_m = 0.5 * slope.cwiseAbs().dot(high - low) + kRounding;
            if (!matters(tile, middle_m - spread_m, middle_m + spread_m)) continue;
            for (int j = min_j; j <= max_j; ++j) {
                for (int i = min_i; i <= max_i; ++i) f(GroundField::point_m(i, j), field_.at(i, j));
            }
        }
    }

    void check_way(const Rect& foot) {
        const SweptBox way(
            grown(foot, figures_.foot_margin_m), T_field_body_, figures_.T_start_target);
        const auto matters = [&](const GroundField::Tile& tile, double low_m, double high_m) {
            return tile.highest_ground_m - low_m > figures_.clearance_m ||
                   tile.lowest_underside_m - high_m < figures_.lower_edge_m;
        };
        for_samples_in(way.bounds(), matters, [&](const Vector2d& p_field, const auto& sample) {
            const double above_m = above_plane(p_field, sample.ground_m);
            const double hangs_m = above_plane(p_field, sample.underside_m);
            const bool too_high = above_m > figures_.clearance_m + kRounding;
            if (!too_high && !(hangs_m < figures_.lower_edge_m - kRounding)) return;
            const double value_m = too_high ? above_m : hangs_m;
            const double limit_m = too_high ? figures_.clearance_m : figures_.lower_edge_m;
            if (!found_.is_worse(Danger::obstacle_in_way, value_m) || !way.covers(p_field)) return;
            found_.add(Danger::obstacle_in_way,
                       value_m,
                       value_m,
                       limit_m,
                       {p_field, stance_.plane.at(p_field) + value_m});
        });
    }

    void check_body(const Figures::Part& part) {
        const SweptBox way(
            grown(part.box, figures_.sway_m), T_field_body_, figures_.T_start_target);
        const auto matters = [&](const GroundField::Tile& tile, double low_m, double high_m) {
            return tile.highest_top_m - low_m > part.low_m &&
                   tile.lowest_underside_m - high_m < part.high_m;
        };
        for_samples_in(way.bounds(), matters, [&](const Vector2d& p_field, const auto& sample) {
            const double top_m = above_plane(p_field, sample.top_m);
            if (!(top_m > part.low_m + kRounding)) return;
            const double begins_m = std::max(above_plane(p_field, sample.underside_m), part.low_m);
            if (!(begins_m < part.high_m - kRounding)) return;
            const Danger danger =
                begins_m > figures_.hips_m ? Danger::overhang_too_low : Danger::body_hits;
            if (!found_.is_worse(danger, -begins_m) || !way.covers(p_field)) return;
            found_.add(danger,
                       -begins_m,
                       begins_m,
                       part.high_m,
                       {p_field, stance_.plane.at(p_field) + begins_m});
        });
    }

    const GroundField& field_;
    const std::vector<char>& reached_;
    const Figures& figures_;
    PlanarPose T_field_body_;
    Stance stance_;
    Collector found_;
};

}  // namespace

/// Finds the stance. The slope is a median, so that a sill under the toes does not tilt the ground
/// plane ahead.
Stance stand(const GroundField& field, const Figures& figures, const PlanarPose& T_field_body) {
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

std::vector<Finding> dangers_at(const GroundField& field,
                                const std::vector<char>& reached,
                                const Figures& figures,
                                const PlanarPose& T_field_body) {
    return Inspector(field, reached, figures, T_field_body).inspect();
}

}  // namespace surefoot::sim::rules

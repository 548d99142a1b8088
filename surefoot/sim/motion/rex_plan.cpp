// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/rex_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/checked_index.hpp"

namespace surefoot::sim {
namespace {

constexpr double kHalfTurn_rad = std::numbers::pi;
// Limit of 5.5 h at 10 s a step; a longer path is an error in the script.
constexpr std::size_t kMaxSteps = 2000;
/// Smallest reduction of the distance that is worth a step of ten seconds.
constexpr double kWorthwhile_m = 0.04;
/// ASSUMPTION: 1 sigma of the landing error relative to the commanded position.
constexpr double kLandingSigma_m = 0.003;
constexpr double kLandingSigma_rad = 0.2 * kRadPerDeg;

double wrapped(double angle_rad) {
    return std::remainder(angle_rad, 2.0 * kHalfTurn_rad);
}

/// A way to walk. `bearing_rad` is the direction of travel in base_link: 0 = ahead, pi = back,
/// +-pi/2 = left and right.
struct Gait {
    Move move;
    double bearing_rad;
    double step_m;
    /// True: all sectors are allowed; false: only those near the direction of travel.
    bool any_sector = false;
};

double distance_m(const RexStand& from, const Waypoint& to) {
    return std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
}

int turns(double from_rad, double to_rad, double turn_rad) {
    return saturated_integer<int>(std::round(wrapped(to_rad - from_rad) / turn_rad));
}

class Planner {
  public:
    Planner(const RexStepSizes& sizes, const RexStand& start, Rng& rng)
        : sizes_(sizes), movements_(rex_movements(sizes)), now_(start), rng_(rng) {}

    void wait(double time_s) { wait_s_ += time_s; }
    void go_to(const Waypoint& goal);

    [[nodiscard]] std::vector<RexStep> steps() && { return std::move(steps_); }
    [[nodiscard]] std::size_t count() const { return steps_.size(); }
    [[nodiscard]] double pending_wait_s() const { return wait_s_; }

  private:
    void step(const RexMovement& movement);
    void turn_to(double yaw_rad);
    void walk(const Waypoint& goal, const Gait& gait);
    [[nodiscard]] Gait choose(const Waypoint& goal) const;
    [[nodiscard]] bool allowed(const RexMovement& movement, const Gait& gait) const;
    [[nodiscard]] double turn_rad() const { return sizes_.turn_deg * kRadPerDeg; }

    RexStepSizes sizes_;
    std::vector<RexMovement> movements_;
    RexStand now_;
    Rng& rng_;
    std::vector<RexStep> steps_;
    double wait_s_ = 0.0;
};

void Planner::step(const RexMovement& movement) {
    RexStep step;
    step.wait_s = wait_s_;
    step.movement = movement;
    step.before = now_;
    step.after = moved(now_, movement, 1.0);
    step.after.x_m += kLandingSigma_m * rng_.normal();
    step.after.y_m += kLandingSigma_m * rng_.normal();
    step.after.yaw_rad += kLandingSigma_rad * rng_.normal();
    now_ = step.after;
    wait_s_ = 0.0;
    steps_.push_back(step);
}

void Planner::turn_to(double yaw_rad) {
    const RexMovement left = movements_[movements_.size() - 2];
    const RexMovement right = movements_.back();
    for (int left_over = turns(now_.yaw_rad, yaw_rad, turn_rad());
         left_over != 0 && count() < kMaxSteps;
         left_over = turns(now_.yaw_rad, yaw_rad, turn_rad())) {
        step(left_over > 0 ? left : right);
    }
}

Gait Planner::choose(const Waypoint& goal) const {
    const std::array<Gait, 4> gaits{{{Move::ahead, 0.0, sizes_.forward_m},
                                     {Move::back, kHalfTurn_rad, sizes_.backward_m},
                                     {Move::side, 0.5 * kHalfTurn_rad, sizes_.sideways_m},
                                     {Move::side, -0.5 * kHalfTurn_rad, sizes_.sideways_m}}};
    const double heading_rad = std::atan2(goal.y_m - now_.y_m, goal.x_m - now_.x_m);
    Gait best = gaits[0];
    double fewest = std::numeric_limits<double>::infinity();
    for (const Gait& gait : gaits) {
        if (goal.move != Move::automatic && goal.move != gait.move) continue;
        const double yaw_rad = heading_rad - gait.bearing_rad;
        const double steps = std::abs(turns(now_.yaw_rad, yaw_rad, turn_rad())) +
                             std::ceil(distance_m(now_, goal) / gait.step_m) +
                             std::abs(turns(yaw_rad, goal.yaw_rad, turn_rad()));
        if (steps < fewest) {
            fewest = steps;
            best = gait;
        }
    }
    return best;
}

bool Planner::allowed(const RexMovement& movement, const Gait& gait) const {
    if (movement.turn_rad != 0.0) return false;
    if (gait.any_sector) return true;
    const double along = std::cos(gait.bearing_rad) * movement.forward_m +
                         std::sin(gait.bearing_rad) * movement.left_m;
    // Allows the sectors near the direction of travel, also those of the inner ring. A sideways
    // step is short, so a sector nearly ahead moves just as far to the side.
    return along > (gait.move == Move::side ? 0.45 : 0.3) * gait.step_m;
}

void Planner::walk(const Waypoint& goal, const Gait& gait) {
    while (count() < kMaxSteps) {
        const RexMovement* best = nullptr;
        double nearest_m = distance_m(now_, goal) - kWorthwhile_m;
        for (const RexMovement& movement : movements_) {
            if (!allowed(movement, gait)) continue;
            const double left_m = distance_m(moved(now_, movement, 1.0), goal);
            if (left_m < nearest_m) {
                nearest_m = left_m;
                best = &movement;
            }
        }
        if (best == nullptr) return;
        step(*best);
    }
}

void Planner::go_to(const Waypoint& goal) {
    // The shortest forward step is half a step. With Move::automatic, a point nearer than half of
    // the shortest step counts as reached.
    const double near_m = goal.move == Move::automatic ? 0.25 * sizes_.forward_m : kWorthwhile_m;
    if (distance_m(now_, goal) > near_m) {
        Gait gait = choose(goal);
        turn_to(std::atan2(goal.y_m - now_.y_m, goal.x_m - now_.x_m) - gait.bearing_rad);
        walk(goal, gait);
        // Other sectors correct the lateral error that remains because turns have steps of 15 deg.
        gait.any_sector = true;
        if (distance_m(now_, goal) > 0.4 * sizes_.forward_m) walk(goal, gait);
    }
    turn_to(goal.yaw_rad);
}

}  // namespace

std::vector<RexMovement> rex_movements(const RexStepSizes& sizes) {
    std::vector<RexMovement> movements;
    const auto sector = [&](int command, double angle_rad, double scale) {
        const double forward = std::cos(angle_rad);
        const double reach_m = forward > 0.0 ? sizes.forward_m : sizes.backward_m;
        movements.push_back({command,
                             scale * reach_m * forward,
                             -scale * sizes.sideways_m * std::sin(angle_rad),
                             0.0});
    };
    for (int i = 0; i < 8; ++i) sector(1 + i, i * 45.0 * kRadPerDeg, 0.5);
    for (int i = 0; i < 16; ++i) sector(9 + i, i * 22.5 * kRadPerDeg, 1.0);
    movements.push_back({25, 0.0, 0.0, sizes.turn_deg * kRadPerDeg});
    movements.push_back({26, 0.0, 0.0, -sizes.turn_deg * kRadPerDeg});
    return movements;
}

RexStand moved(const RexStand& stand, const RexMovement& movement, double share) {
    const double c = std::cos(stand.yaw_rad);
    const double s = std::sin(stand.yaw_rad);
    return {stand.x_m + share * (c * movement.forward_m - s * movement.left_m),
            stand.y_m + share * (s * movement.forward_m + c * movement.left_m),
            stand.yaw_rad + share * movement.turn_rad};
}

Result<RexPlan> plan_rex_steps(const std::vector<Waypoint>& waypoints,
                               const RexStepSizes& sizes,
                               Rng& rng) {
    const Waypoint& first = waypoints.front();
    RexPlan plan;
    plan.start = {first.x_m, first.y_m, first.yaw_rad};
    Planner planner(sizes, plan.start, rng);
    planner.wait(first.pause_s);
    for (std::size_t i = 1; i < waypoints.size(); ++i) {
        planner.go_to(waypoints[i]);
        if (planner.count() >= kMaxSteps) {
            return usage_error(
                fmt::format("simulator: the path of the rex to waypoint {} takes {} steps "
                            "or more; shorten the path",
                            i,
                            kMaxSteps));
        }
        planner.wait(waypoints[i].pause_s);
    }
    plan.last_wait_s = planner.pending_wait_s();
    plan.steps = std::move(planner).steps();
    return plan;
}

}  // namespace surefoot::sim

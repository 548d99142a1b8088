// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/motion_scripts.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

#include "surefoot/sim/motion/rex_plan.hpp"

namespace surefoot::sim {
namespace {

constexpr double kQuarter_rad = 0.5 * std::numbers::pi;
constexpr double kHalf_rad = std::numbers::pi;
constexpr double kLook_s = 1.0;   ///< standing time before the first movement
constexpr double kPause_s = 0.5;  ///< standing time between two movements

MotionScript through(MotionModel motion_model, std::vector<Waypoint> stops) {
    MotionScript script;
    script.motion_model = motion_model;
    script.waypoints = std::move(stops);
    return script;
}

constexpr Waypoint kStart{0.0, 0.0, 0.0, kLook_s, 0.0, Move::automatic};

/// Number of backward steps from the turn to the edge.
constexpr int kStepsToEdge = 2;
/// Distance of the ankles, which carry the weight, from the edge.
constexpr double kAnkleToEdge_m = 0.02;

}  // namespace

MotionScript approach_script(MotionModel motion_model, double distance_m) {
    return through(motion_model, {kStart, {distance_m, 0.0, 0.0, kPause_s, 0.0, Move::ahead}});
}

MotionScript turn_round_script(MotionModel motion_model, double turn_rad) {
    return through(motion_model,
                   {kStart, {0.0, 0.0, turn_rad, kPause_s}, {0.0, 0.0, 0.0, kPause_s}});
}

MotionScript back_to_table_script(MotionModel motion_model, double table_x_m, double left_m) {
    // The machine extends 0.33 m behind base_link, so it stops about 0.1 m before the table.
    constexpr double kBehind_m = 0.45;
    return through(motion_model,
                   {kStart,
                    {table_x_m - left_m, 0.0, 0.0, kPause_s, 0.0, Move::ahead},
                    {table_x_m - left_m, 0.0, kHalf_rad, kPause_s},
                    {table_x_m - kBehind_m, 0.0, kHalf_rad, kPause_s, 0.0, Move::back}});
}

MotionScript sidestep_through_door_script(MotionModel motion_model,
                                          double door_x_m,
                                          double door_y_m,
                                          double beyond_m) {
    // The machine needs room to turn before the wall: half of its depth (0.33 m) and its sway.
    constexpr double kBefore_m = 0.6;
    const double before_x_m = door_x_m - kBefore_m;
    return through(motion_model,
                   {kStart,
                    {before_x_m, door_y_m, 0.0, kPause_s, 0.0, Move::ahead},
                    {before_x_m, door_y_m, -kQuarter_rad, kPause_s},
                    {door_x_m + beyond_m, door_y_m, -kQuarter_rad, kPause_s, 0.0, Move::side}});
}

double descending_edge_x_m(int steps_ahead) {
    const RexStepSizes sizes;
    return steps_ahead * sizes.forward_m + kStepsToEdge * sizes.backward_m + kAnkleToEdge_m;
}

MotionScript descend_backwards_script(int steps_ahead, double riser_m) {
    const RexStepSizes sizes;
    const double turn_x_m = steps_ahead * sizes.forward_m;
    const double brink_x_m = turn_x_m + kStepsToEdge * sizes.backward_m;
    return through(
        MotionModel::rex,
        {kStart,
         {turn_x_m, 0.0, 0.0, kPause_s, 0.0, Move::ahead},
         {turn_x_m, 0.0, kHalf_rad, kPause_s},
         {brink_x_m, 0.0, kHalf_rad, kPause_s, 0.0, Move::back},
         {brink_x_m + sizes.backward_m, 0.0, kHalf_rad, kPause_s, -riser_m, Move::back}});
}

MotionScript pivot_and_reverse_script(MotionModel motion_model, double distance_m) {
    return through(motion_model,
                   {kStart,
                    {0.0, 0.0, kQuarter_rad, kPause_s},
                    {0.0, -distance_m, kQuarter_rad, kPause_s, 0.0, Move::back}});
}

}  // namespace surefoot::sim

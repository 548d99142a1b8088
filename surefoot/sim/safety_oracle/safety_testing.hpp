// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "surefoot/core/machine.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/sim/motion/planar.hpp"
#include "surefoot/sim/scenes/scene.hpp"

/// Small worlds for the tests of the safety oracle.
namespace surefoot::sim::testing {

inline constexpr double kSoleDepth_m = 0.99;

/// The REX of machines/rex.yaml without half steps; sim must not read machine files.
inline Machine rex() {
    Machine m;
    m.sole_depth_tenth_mm = 9'900;
    m.left_foot = {570, 1'800, 3'660, 1'900};
    m.right_foot = {570, -1'800, 3'660, 1'900};
    m.body.parts[0] = {{0, 0, 6'600, 6'450}, 1'440, 20'500};
    m.body.count = 1;
    m.body.sway_tenth_mm = 500;
    const auto set = [&](std::size_t code, std::int32_t forward, std::int32_t left, double deg) {
        Movement& movement = m.movements[code];
        movement.configured = true;
        movement.forward_tenth_mm = forward;
        movement.left_tenth_mm = left;
        movement.cos_turn = std::cos(deg * std::numbers::pi / 180.0);
        movement.sin_turn = std::sin(deg * std::numbers::pi / 180.0);
    };
    set(1, 2'000, 0, 0.0);
    set(9, 4'000, 0, 0.0);
    set(11, 2'830, -710, 0.0);
    set(13, 0, -1'000, 0.0);
    set(17, -2'500, 0, 0.0);
    set(21, 0, 1'000, 0.0);
    set(23, 2'830, 710, 0.0);
    set(25, 0, 0, 15.0);
    set(26, 0, 0, -15.0);
    GateLimits& l = m.limits;
    l.step[0] = {true, 200, 200};
    l.step[1] = {false, 1'800, 1'800};
    l.min_normal_z = std::cos(6.0 * std::numbers::pi / 180.0);
    l.patch_side_tenth_mm = 500;
    l.patch_residual_tenth_mm = 250;
    l.patch_sigma_tenth_mm = 30;
    l.patch_independent_cells = 4;
    l.cell_sigma_tenth_mm = 120;
    l.swing_clearance_tenth_mm = 400;
    l.foot_margin_tenth_mm = 200;
    l.drop_tenth_mm = 500;
    l.drop_band_tenth_mm = 1'000;
    l.drop_evidence = 1;
    l.drift_tenth_mm = 250;
    l.frame_age_ns = l.pose_age_ns = 200'000'000;
    l.verdict_ttl_ns = 300'000'000;
    return m;
}

inline constexpr std::array<int, 9> kCommands{1, 9, 11, 13, 17, 21, 23, 25, 26};
inline constexpr int kForward = 9;
inline constexpr int kRight = 13;
inline constexpr int kBack = 17;
inline constexpr int kLeft = 21;
inline constexpr int kTurnLeft = 25;
inline constexpr int kTurnRight = 26;
/// Distances from base_link to toes and heels, and to the side of the feet.
inline constexpr double kToe_m = 0.24;
inline constexpr double kFootSide_m = 0.275;
inline constexpr double kStep_m = 0.4;
inline constexpr double kSpacing_m = 0.005;  ///< spacing of the oracle's samples

/// Pose of base_link over ground of height z_m.
inline Pose standing(double x_m, double y_m, double yaw_rad, double z_m = 0.0) {
    Pose T;
    T.rotation = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ());
    T.translation_m = {x_m, y_m, z_m + kSoleDepth_m};
    return T;
}

/// A floor of 8 x 8 m plus test objects; a scene can be built rotated or mirrored.
class World {
  public:
    World() { material_ = scene.add_material({}); }
    /// Moves all further objects by T; with `mirrored`, left and right are swapped first.
    explicit World(const PlanarPose& T, bool mirrored = false) : World() {
        T_ = T;
        mirror_ = mirrored ? -1.0 : 1.0;
    }
    World& floor(double z_m = 0.0, std::vector<Pit> pits = {}) {
        scene.add_floor(Floor({{-4.0, -4.0}, {4.0, 4.0}}, z_m, std::move(pits)), material_, 0);
        return *this;
    }
    /// Ranges (from, to) along x, y and z.
    World& box(Eigen::Vector2d x, Eigen::Vector2d y, Eigen::Vector2d z) {
        return prism(x, y, z.x(), {z.y(), Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()});
    }
    /// Top surface: z = top_m + slope . p.
    World& slab(Eigen::Vector2d x,
                Eigen::Vector2d y,
                double bottom_m,
                Eigen::Vector2d slope,
                double top_m = 0.0) {
        return prism(x, y, bottom_m, {top_m, slope, Eigen::Vector2d::Zero()});
    }
    Scene scene;

  private:
    World& prism(const Eigen::Vector2d& x,
                 const Eigen::Vector2d& y,
                 double bottom_m,
                 const Prism::Top& top) {
        std::vector<Eigen::Vector2d> corners{
            {x[0], y[0]}, {x[1], y[0]}, {x[1], y[1]}, {x[0], y[1]}};
        if (mirror_ < 0.0) std::swap(corners[1], corners[3]);
        const auto move = [&](Eigen::Vector2d p) {
            p.y() *= mirror_;
            return Eigen::Vector2d(T_ * p);
        };
        for (auto& corner : corners) corner = move(corner);
        const Eigen::Vector2d slope = T_.rotated({top.slope.x(), mirror_ * top.slope.y()});
        scene.add(Prism(corners, bottom_m, {top.top_m, slope, move(top.reference_m)}),
                  material_,
                  Label::object);
        return *this;
    }
    int material_ = 0;
    PlanarPose T_;
    double mirror_ = 1.0;
};

}  // namespace surefoot::sim::testing

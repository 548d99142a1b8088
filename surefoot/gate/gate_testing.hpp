// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "surefoot/core/machine.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/gate/verdict_text.hpp"
#include "surefoot/grid/snapshot_builder.hpp"

/// Shared by the tests of the gate: the REX, test terrain and a function that asks the gate.
namespace surefoot::gate::testing {

inline constexpr std::int64_t kNowNs = 5'000'000'000;
inline constexpr std::int64_t kMs = 1'000'000;
inline constexpr double kResolutionM = 0.025;

// Joystick codes of the REX.
inline constexpr std::uint8_t kForward = 9;
inline constexpr std::uint8_t kRight = 13;
inline constexpr std::uint8_t kBackward = 17;
inline constexpr std::uint8_t kLeft = 21;
inline constexpr std::uint8_t kTurnLeft = 25;
inline constexpr std::uint8_t kTurnRight = 26;

/// The machine of machines/rex.yaml.
inline Machine rex() {
    Machine m;
    m.sole_depth_tenth_mm = 9900;
    m.left_foot = {570, 1800, 3660, 1900};
    m.right_foot = {570, -1800, 3660, 1900};
    m.ankle_from_heel_tenth_mm = 1260;
    m.body.parts[0] = {{0, 0, 6600, 6450}, 1440, 20500};
    m.body.count = 1;
    m.body.sway_tenth_mm = 500;
    const auto set = [&m](int code, int forward, int left, double turn_deg) {
        Movement& movement = m.movements[static_cast<std::size_t>(code)];
        movement.configured = true;
        movement.forward_tenth_mm = forward;
        movement.left_tenth_mm = left;
        movement.cos_turn = std::cos(turn_deg * std::numbers::pi / 180.0);
        movement.sin_turn = std::sin(turn_deg * std::numbers::pi / 180.0);
    };
    for (int sector = 0; sector < 16; ++sector) {
        const double angle = sector * std::numbers::pi / 8.0;  // clockwise from forward
        const double ahead = std::cos(angle) * (std::cos(angle) > 0.0 ? 4000.0 : 2500.0);
        const auto forward = static_cast<int>(std::lround(ahead));
        const auto left = static_cast<int>(std::lround(-1000.0 * std::sin(angle)));
        set(9 + sector, forward, left, 0.0);
        if (sector % 2 == 0) set(1 + sector / 2, forward / 2, left / 2, 0.0);
    }
    set(kTurnLeft, 0, 0, 15.0);
    set(kTurnRight, 0, 0, -15.0);
    GateLimits& l = m.limits;
    l.step[0] = {true, 200, 200};
    l.step[1] = {false, 1800, 1800};
    l.min_normal_z = std::cos(6.0 * std::numbers::pi / 180.0);
    l.patch_residual_tenth_mm = 250;
    l.patch_sigma_tenth_mm = 30;
    l.patch_independent_cells = 4;
    l.cell_sigma_tenth_mm = 120;
    l.swing_clearance_tenth_mm = 400;
    l.foot_margin_tenth_mm = 200;
    l.drop_tenth_mm = 500;
    l.drop_band_tenth_mm = 1000;
    l.drop_evidence = 128;
    l.drift_tenth_mm = 250;
    l.tread_share_permille = 800;
    l.tread_overhang_tenth_mm = 730;
    l.frame_age_ns = 200 * kMs;
    l.pose_age_ns = 200 * kMs;
    l.future_tolerance_ns = 5 * kMs;
    l.verdict_ttl_ns = 300 * kMs;
    l.attestation_radius_tenth_mm = 10000;
    return m;
}

/// The REX with legs instead of one box, and movements for stairs ahead and backward.
inline Machine stair_rex() {
    Machine m = rex();
    m.limits.step[1] = {true, 1800, 1800};
    m.movements[kForward].movement_class = m.movements[kBackward].movement_class =
        MovementClass::stair;
    m.movements[kForward].forward_tenth_mm = 4200;
    m.movements[kBackward].forward_tenth_mm = -4500;
    m.body.parts[0] = {{700, 2300, 3000, 2800}, 1100, 6100};
    m.body.parts[1] = {{700, -2350, 3000, 2700}, 1100, 6100};
    m.body.parts[2] = {{-100, 0, 7200, 9400}, 6200, 20500};
    m.body.count = 3;
    m.body.sway_tenth_mm = 200;
    return m;
}

/// Ground of 240 x 240 cells of 25 mm. The machine stands at the origin of odom and faces +x. The
/// ground is flat, known and fresh unless a test changes it.
struct Terrain {
    grid::GridGeometry geometry{kResolutionM, 240, 240, {-3.0, -3.0}};
    grid::Layer height{240, 240, 0.0F};
    grid::Layer variance{240, 240, 16e-6F};  // (4 mm)^2
    grid::Layer drift{240, 240, 0.005F};
    grid::Layer clearance{240, 240, kNanF};
    grid::SnapshotInput input;

    Terrain() {
        input.T_odom_body.translation_m = {0.0, 0.0, 0.99};
        input.frame_time_ns = kNowNs - 50 * kMs;
        input.pose_time_ns = kNowNs - 10 * kMs;
        input.gravity_source = grid::GravitySource::imu;
        input.tilt_sigma_rad = 0.0;
        input.health = grid::SnapshotHealth::ok;
        input.camera = CameraState::ok;
        input.version = 42;
        input.config_hash = 4711;
    }
    /// Sets a layer in the cells whose centre lies in [x0, x1) x [y0, y1) in odom.
    Terrain& paint(grid::Layer& layer, double x0, double x1, double y0, double y1, double value) {
        for (int v = 0; v < geometry.ny; ++v) {
            for (int u = 0; u < geometry.nx; ++u) {
                const Eigen::Vector2d c = geometry.center_m({u, v});
                if (c.x() >= x0 && c.x() < x1 && c.y() >= y0 && c.y() < y1)
                    layer.at(u, v) = static_cast<float>(value);
            }
        }
        return *this;
    }
    Terrain& box(double x0, double x1, double y0, double y1, double height_m) {
        return paint(height, x0, x1, y0, y1, height_m);
    }
    /// Draws a map seen from above, forward = up, machine in the middle. One character = 0.2 x 0.2
    /// m: '.' floor, '?' unknown, digit = tenths of a metre up, 'd' = 0.3 m down.
    Terrain& draw(const std::vector<std::string>& rows) {
        const double top_m = 0.1 * static_cast<double>(rows.size());
        for (std::size_t r = 0; r < rows.size(); ++r) {
            const double left_m = 0.1 * static_cast<double>(rows[r].size());
            for (std::size_t c = 0; c < rows[r].size(); ++c) {
                const char symbol = rows[r][c];
                const double x1 = top_m - 0.2 * static_cast<double>(r);
                const double y1 = left_m - 0.2 * static_cast<double>(c);
                const double value = symbol == '?'   ? static_cast<double>(kNanF)
                                     : symbol == 'd' ? -0.3
                                     : symbol == '.' ? 0.0
                                                     : 0.1 * (symbol - '0');
                box(x1 - 0.2, x1, y1 - 0.2, y1, value);
            }
        }
        return *this;
    }
    [[nodiscard]] std::unique_ptr<grid::MapSnapshot> snapshot() {
        input.geometry = geometry;
        input.height_m = std::as_const(height).view();
        input.variance_m2 = std::as_const(variance).view();
        input.drift_m = std::as_const(drift).view();
        input.clearance_m = std::as_const(clearance).view();
        auto map = std::make_unique<grid::MapSnapshot>();
        if (!build_snapshot(input, *map)) map->magic = 0;  // the gate then says INTERNAL
        return map;
    }
};

inline constexpr GateHealth kReady{GateState::ready, {}};

/// Index of the snapshot cell that holds a point.
inline std::size_t cell_at(const grid::MapSnapshot& map, double x_m, double y_m) {
    const auto ix = static_cast<std::int64_t>(std::floor(
        (x_m * 1e4 - static_cast<double>(map.origin_x_tenth_mm)) / map.resolution_tenth_mm));
    const auto iy = static_cast<std::int64_t>(std::floor(
        (y_m * 1e4 - static_cast<double>(map.origin_y_tenth_mm)) / map.resolution_tenth_mm));
    return static_cast<std::size_t>(iy * map.nx + ix);
}

using grid::seal;

inline Verdict ask(const grid::MapSnapshot& map, std::uint8_t command) {
    return decide(rex(), query_at_body(command, map), map, kReady, kNowNs);
}
inline Verdict ask(Terrain& terrain, std::uint8_t command) {
    return ask(*terrain.snapshot(), command);
}

/// All reasons as text, for failure messages.
inline std::string words(const Verdict& verdict) {
    std::string text = std::string(to_string(verdict.decision)) + ":";
    for (const std::string_view reason : names_of(verdict.reasons))
        text += " " + std::string(reason);
    return text;
}

}  // namespace surefoot::gate::testing

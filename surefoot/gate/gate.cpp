// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/gate.hpp"

#include <algorithm>
#include <limits>

#include "surefoot/gate/findings.hpp"
#include "surefoot/gate/foot_support.hpp"
#include "surefoot/gate/footprints.hpp"
#include "surefoot/gate/ground.hpp"
#include "surefoot/gate/regions.hpp"
#include "surefoot/gate/tilt.hpp"
#include "surefoot/gate/tread_support.hpp"

namespace surefoot::gate {
namespace {

/// Limits of 100 km and 1 km. Within these limits every product of the exact geometry fits into 64
/// bits.
constexpr std::int64_t kFarthestTenthMm = 1'000'000'000;
constexpr std::int64_t kHighestTenthMm = 10'000'000;

constexpr bool within(std::int64_t value, std::int64_t bound) noexcept {
    return value >= -bound && value <= bound;
}

void check_process(const GateHealth& health, std::int64_t now_ns, Findings& findings) noexcept {
    if (health.state == GateState::warmup)
        findings.deny(Reason::warmup);
    else if (health.state != GateState::ready)
        findings.deny(Reason::not_ready);
    // A valid steady clock is not negative and is below half of its range.
    if (!(now_ns >= 0 && now_ns <= std::numeric_limits<std::int64_t>::max() / 2))
        findings.deny(Reason::clock);
    for (int i = 0; i < kReasonCount; ++i) {
        const auto fault = static_cast<Reason>(i);
        if (health.faults.contains(fault))
            findings.deny(is_error(fault) ? fault : Reason::internal);
    }
    if (health.faults.bits() >> static_cast<unsigned>(kReasonCount) != 0)
        findings.deny(Reason::internal);
}

void check_numbers(const Query& query, const GateLimits& limits, Findings& findings) noexcept {
    const double norm_sq = query.cos_yaw * query.cos_yaw + query.sin_yaw * query.sin_yaw;
    const bool pose = within(query.x_tenth_mm, kFarthestTenthMm) &&
                      within(query.y_tenth_mm, kFarthestTenthMm) && norm_sq > 0.999 &&
                      norm_sq < 1.001;
    const bool stance = query.stance_source == StanceHeight::map ||
                        (query.stance_source == StanceHeight::given &&
                         within(query.stance_height_tenth_mm, kHighestTenthMm));
    const AttestedArea& area = query.attested;
    const bool attested =
        !area.active ||
        (within(area.center_x_tenth_mm, kFarthestTenthMm) &&
         within(area.center_y_tenth_mm, kFarthestTenthMm) && area.radius_tenth_mm > 0 &&
         area.radius_tenth_mm <= limits.attestation_radius_tenth_mm &&
         within(area.height_tenth_mm, kHighestTenthMm));
    if (!(pose && stance && attested)) findings.deny(Reason::bad_number);
}

/// Tests that a stamp is neither too old nor too far in the future. Unsigned differences cannot
/// overflow.
void check_stamp(std::int64_t stamp_ns,
                 std::int64_t now_ns,
                 std::int64_t max_age_ns,
                 std::int64_t future_tolerance_ns,
                 Reason stale,
                 Findings& findings) noexcept {
    const auto stamp = static_cast<std::uint64_t>(stamp_ns);
    const auto now = static_cast<std::uint64_t>(now_ns);
    if (stamp_ns > now_ns) {
        if (stamp - now > static_cast<std::uint64_t>(future_tolerance_ns))
            findings.deny(Reason::time_skew);
    } else if (now - stamp > static_cast<std::uint64_t>(max_age_ns)) {
        findings.deny(stale);
    }
}

void check_freshness(const grid::MapSnapshot& map,
                     const GateLimits& limits,
                     std::int64_t now_ns,
                     Findings& findings) noexcept {
    const std::int64_t future_ns = limits.future_tolerance_ns;
    check_stamp(
        map.frame_time_ns, now_ns, limits.frame_age_ns, future_ns, Reason::frame_stale, findings);
    check_stamp(
        map.pose_time_ns, now_ns, limits.pose_age_ns, future_ns, Reason::pose_stale, findings);
}

void check_pose_health(grid::SnapshotHealth health, Findings& findings) noexcept {
    if (health == grid::SnapshotHealth::degraded)
        findings.deny(Reason::not_ready);
    else if (health != grid::SnapshotHealth::ok)
        findings.deny(Reason::pose_lost);
}

void check_camera(CameraState camera, Findings& findings) noexcept {
    if (camera == CameraState::frozen)
        findings.deny(Reason::frame_frozen);
    else if (camera == CameraState::corrupt)
        findings.deny(Reason::frame_corrupt);
    else if (camera == CameraState::overexposed)
        findings.deny(Reason::exposure);
    else if (camera == CameraState::dark)
        findings.deny(Reason::blind);
    else if (camera == CameraState::moved)
        findings.deny(Reason::mount_moved);
    else if (camera == CameraState::leaning)
        findings.deny(Reason::plane_invalid);
    else if (camera != CameraState::ok)
        findings.deny(Reason::not_ready);
}

/// Tests the snapshot independently of the query, without reading the cells. `camera`: the camera
/// state of the map, or a state that counts instead.
void judge_snapshot(const GateLimits& limits,
                    const grid::MapSnapshot& map,
                    CameraState camera,
                    std::int64_t now_ns,
                    Findings& findings) noexcept {
    findings.prove(Proof::snapshot_intact, [&] {
        if (!grid::is_sealed(map)) findings.deny(Reason::internal);
    });
    findings.prove(Proof::stamps_fresh, [&] { check_freshness(map, limits, now_ns, findings); });
    findings.prove(Proof::gravity_known, [&] {
        if (map.gravity_source != grid::GravitySource::plane &&
            map.gravity_source != grid::GravitySource::imu)
            findings.deny(Reason::plane_invalid);
        // Refuses if the vertical is so uncertain that level ground might break the tilt limit.
        if (!keeps_tilt_limit(steepest_tan_sq(0.0, vertical_bound_tan(map, limits)), limits))
            findings.deny(Reason::plane_invalid);
    });
    findings.prove(Proof::pose_healthy, [&] { check_pose_health(map.health, findings); });
    findings.prove(Proof::camera_healthy, [&] { check_camera(camera, findings); });
}

/// True if measured ground under the feet lies at the height of the soles. The tolerance is the
/// largest step limit plus twice the swing clearance, for bent knees. Also true without measured
/// ground, because there is nothing to compare.
bool stands_on_map(const Machine& machine, const grid::MapSnapshot& map) noexcept {
    const Query here = query_at_body(0, map);
    const Sweep standing =
        sweep_of(machine,
                 fixed_pose(here.x_tenth_mm, here.y_tenth_mm, here.cos_yaw, here.sin_yaw),
                 Movement{});
    const Stance stance = find_stance(Ground(map, here, machine.limits), here, standing, true);
    if (!stance.known) return true;
    std::int64_t step = 0;
    for (const StepLimits& limits : machine.limits.step) {
        if (limits.enabled)
            step = std::max<std::int64_t>({step, limits.up_tenth_mm, limits.down_tenth_mm});
    }
    return within(map.body_z_tenth_mm - machine.sole_depth_tenth_mm - stance.plane.height_tenth_mm,
                  step + 2 * std::int64_t{machine.limits.swing_clearance_tenth_mm});
}

/// Tests everything except the terrain. All tests must pass before the ground is read.
void judge_readiness(const Machine& machine,
                     const Query& query,
                     const grid::MapSnapshot& map,
                     const GateHealth& health,
                     std::int64_t now_ns,
                     Findings& findings) noexcept {
    findings.prove(Proof::process_ready, [&] { check_process(health, now_ns, findings); });
    findings.prove(Proof::machine_valid, [&] {
        if (machine.problem() != nullptr) findings.deny(Reason::config);
    });
    findings.prove(Proof::numbers_valid, [&] { check_numbers(query, machine.limits, findings); });
    judge_snapshot(machine.limits, map, map.camera, now_ns, findings);
    findings.prove(Proof::command_known, [&] {
        if (movement_for(machine, query.command) == nullptr) findings.deny(Reason::unknown_command);
    });
}

/// Tests the ground of a movement on flat ground, except the ground under the present feet.
void judge_walk(const Scene& scene, Findings& findings) noexcept {
    findings.prove(Proof::corridors_clear, [&] { check_corridors(scene, findings); });
    findings.prove(Proof::body_clear, [&] { check_body(scene, findings); });
    findings.prove(Proof::bands_solid, [&] { check_bands(scene, findings); });
    const ReachableSurfaces reachable = surfaces_of_stance(scene);
    const auto& feet = scene.sweep.feet;
    findings.prove(Proof::left_supported, [&] {
        check_landing(scene, feet[0], scene.machine.left_foot, reachable, findings);
    });
    findings.prove(Proof::right_supported, [&] {
        check_landing(scene, feet[1], scene.machine.right_foot, reachable, findings);
    });
}

/// Tests the ground of a movement on stairs, except the ground under the present feet.
void judge_stair(Scene scene, Findings& findings) noexcept {
    const Treads treads = find_treads(scene);
    scene.lift_tenth_mm = lift_of(treads);
    findings.prove(Proof::corridors_clear, [&] { check_corridors(scene, findings); });
    findings.prove(Proof::body_clear, [&] {
        check_body_on_stairs(scene, findings);
        check_body_lowered(scene, treads, findings);
    });
    findings.prove(Proof::bands_solid, [&] { check_tread_bands(scene, treads, findings); });
    ReachableSurfaces reachable = surfaces_of_stance(scene);
    add_a_step_away(scene, reachable);
    const auto& feet = scene.sweep.feet;
    findings.prove(Proof::left_supported, [&] {
        check_tread(scene, feet[0], scene.machine.left_foot, treads[0], reachable, findings);
    });
    findings.prove(Proof::right_supported, [&] {
        check_tread(scene, feet[1], scene.machine.right_foot, treads[1], reachable, findings);
    });
}

/// Tests the ground of one sweep, region by region (regions.hpp).
void judge_sweep(const Machine& machine,
                 const Query& query,
                 const Ground& ground,
                 const Sweep& sweep,
                 Findings& findings) noexcept {
    findings.prove(Proof::cells_intact, [&] {
        if (!ground.is_intact(ground.zone_of(sweep))) findings.deny(Reason::internal);
    });
    if (!findings.reasons().empty()) return;  // a damaged map gives no terrain reasons
    const Movement& movement = *movement_for(machine, query.command);
    const bool stairs = movement.movement_class == MovementClass::stair;
    const Scene scene{machine, movement, ground, sweep, find_stance(ground, query, sweep, stairs)};
    findings.evidence.stance_known = scene.stance.known;
    findings.evidence.stance_height_tenth_mm = scene.stance.plane.height_tenth_mm;

    findings.prove(Proof::stance_known, [&] {
        if (stairs)
            check_stance_on_treads(scene, findings);
        else
            check_stance(scene, findings);
    });
    if (!scene.stance.known) {  // no height to compare with; unknown cells are already reported
        findings.deny(reason_of_unknown(Knowledge::unknown));
        return;
    }
    if (stairs)
        judge_stair(scene, findings);
    else
        judge_walk(scene, findings);
}

/// Tests the terrain. Call it only if judge_readiness() denied nothing.
void judge_terrain(const Machine& machine,
                   const Query& query,
                   const grid::MapSnapshot& map,
                   Findings& findings) noexcept {
    const Movement& movement = *movement_for(machine, query.command);
    const FixedPose start =
        fixed_pose(query.x_tenth_mm, query.y_tenth_mm, query.cos_yaw, query.sin_yaw);
    const Ground ground(map, query, machine.limits);
    const Findings before = findings;
    judge_sweep(machine, query, ground, sweep_of(machine, start, movement), findings);
    // Cells may have drifted far from their position: repeat all tests with widened regions.
    const std::int64_t drift = findings.evidence.max_drift_tenth_mm;
    const std::int64_t margin = drift_margin(machine.limits, drift);
    if (margin == 0 || !findings.reasons().empty()) return;
    findings = before;
    findings.evidence.max_drift_tenth_mm = drift;  // the regions were widened by this drift
    judge_sweep(machine, query, ground, sweep_of(machine, start, movement, margin), findings);
}

/// Completes the verdict. ERROR has priority over NOT_TRAVERSABLE, and NOT_TRAVERSABLE over OK. The
/// verdict is OK only if no test denied and all proofs hold.
void seal(const Machine& machine,
          const grid::MapSnapshot& map,
          const Findings& findings,
          Verdict& verdict) noexcept {
    verdict.evidence = findings.evidence;
    verdict.evidence.unproven = findings.unproven();
    verdict.reasons = findings.reasons();
    if (verdict.reasons.empty() && !findings.complete()) verdict.reasons.add(Reason::internal);
    verdict.primary = verdict.reasons.primary();
    if (verdict.primary == Reason::none) {
        verdict.decision = Decision::ok;
        verdict.valid_until_ns = verdict.decided_ns + machine.limits.verdict_ttl_ns;
    } else if (!is_error(verdict.primary)) {
        verdict.decision = Decision::not_traversable;
        show_worst_cell(map, findings, verdict.primary, verdict.evidence);
    }
}

}  // namespace

const Movement* movement_for(const Machine& machine, std::uint8_t command) noexcept {
    if (command == 0 || command >= Machine::kMovementCodes) return nullptr;
    const Movement& movement = machine.movements[command];
    const auto movement_class = static_cast<std::size_t>(movement.movement_class);
    const bool usable = movement.configured && movement_class < machine.limits.step.size() &&
                        machine.limits.step[movement_class].enabled;
    return usable ? &movement : nullptr;
}

Query make_query(
    std::uint8_t command, double x_m, double y_m, double cos_yaw, double sin_yaw) noexcept {
    constexpr double kTenthMmPerM = 1e4;
    Query query;
    query.command = command;
    const double x = x_m * kTenthMmPerM;
    const double y = y_m * kTenthMmPerM;
    const auto bound = static_cast<double>(kFarthestTenthMm);
    if (!(x >= -bound && x <= bound && y >= -bound && y <= bound)) return query;
    // in range: within kFarthestTenthMm, as checked above
    query.x_tenth_mm = static_cast<std::int64_t>(x < 0.0 ? x - 0.5 : x + 0.5);
    query.y_tenth_mm = static_cast<std::int64_t>(y < 0.0 ? y - 0.5 : y + 0.5);  // in range: as x
    query.cos_yaw = cos_yaw;
    query.sin_yaw = sin_yaw;
    return query;
}

Query query_at_body(std::uint8_t command, const grid::MapSnapshot& map) noexcept {
    Query query;
    query.command = command;
    query.x_tenth_mm = map.body_x_tenth_mm;
    query.y_tenth_mm = map.body_y_tenth_mm;
    query.cos_yaw = map.body_cos_yaw;
    query.sin_yaw = map.body_sin_yaw;
    return query;
}

ReasonSet snapshot_faults(const Machine& machine,
                          const grid::MapSnapshot& map,
                          std::int64_t now_ns) noexcept {
    Findings findings;
    // Every step leans the camera. No movement may begin during a lean, but a lean is not a fault.
    const bool leans = map.camera == CameraState::leaning;
    judge_snapshot(machine.limits, map, leans ? CameraState::ok : map.camera, now_ns, findings);
    if (!grid::is_intact(map))
        findings.deny(Reason::internal);
    else if (!stands_on_map(machine, map))
        findings.deny(Reason::plane_invalid);
    return findings.reasons();
}

Verdict decide(const Machine& machine,
               const Query& query,
               const grid::MapSnapshot& map,
               const GateHealth& health,
               std::int64_t now_ns) noexcept {
    Verdict verdict;
    verdict.command = query.command;
    verdict.connection = query.connection;
    verdict.sequence = query.sequence;
    verdict.map_version = map.version;
    verdict.config_hash = map.config_hash;
    verdict.frame_time_ns = map.frame_time_ns;
    verdict.pose_time_ns = map.pose_time_ns;
    verdict.decided_ns = now_ns;

    Findings findings;
    judge_readiness(machine, query, map, health, now_ns, findings);
    if (findings.reasons().empty()) judge_terrain(machine, query, map, findings);
    seal(machine, map, findings, verdict);
    return verdict;
}

}  // namespace surefoot::gate

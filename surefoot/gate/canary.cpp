// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/canary.hpp"

#include <array>

#include "surefoot/gate/footprints.hpp"
#include "surefoot/gate/gate.hpp"

namespace surefoot::gate {
namespace {

// The cosine and sine of this yaw are exact. Its direction is not parallel to a grid axis.
constexpr double kCosYaw = 0.8;
constexpr double kSinYaw = 0.6;
constexpr std::int64_t kNowNs = 1'000'000'000'000;
constexpr std::int32_t kSideTenthMm = 250;
constexpr std::uint16_t kSigmaTenthMm = 10;

/// The inputs of an OK verdict on level ground. A canary may change them.
struct Setting {
    const Machine& machine;
    grid::MapSnapshot& map;
    Query& query;
    GateHealth& health;
    std::int64_t& now_ns;
    const FootSweep& foot;  ///< the foot whose ground is changed
};

/// Makes a level, known, fresh and healthy map with the machine in its middle. If the map is too
/// small for a movement, the canary fails, because outside cells are never OK.
void make_level(grid::MapSnapshot& map) noexcept {
    map.magic = grid::MapSnapshot::kMagic;
    map.layout = grid::MapSnapshot::kLayout;
    map.version = 1;
    map.config_hash = 1;
    map.frame_time_ns = kNowNs;
    map.pose_time_ns = kNowNs;
    map.resolution_tenth_mm = kSideTenthMm;
    map.nx = grid::MapSnapshot::kMaxSide;
    map.ny = grid::MapSnapshot::kMaxSide;
    map.edge_count = 0;
    map.origin_x_tenth_mm = -kSideTenthMm * map.nx / 2;
    map.origin_y_tenth_mm = -kSideTenthMm * map.ny / 2;
    map.body_x_tenth_mm = 37;  // not on a grid line
    map.body_y_tenth_mm = -53;
    map.body_z_tenth_mm = 0;
    map.body_cos_yaw = kCosYaw;
    map.body_sin_yaw = kSinYaw;
    map.gravity_source = grid::GravitySource::imu;
    map.tilt_sigma_urad = 0;
    map.health = grid::SnapshotHealth::ok;
    map.camera = CameraState::ok;
    map.height_tenth_mm.fill(0);
    map.sigma_tenth_mm.fill(kSigmaTenthMm);
    map.drift_tenth_mm.fill(0);
    map.clearance_tenth_mm.fill(grid::MapSnapshot::kNoCeiling);
    map.component.fill(1);
    map.drop_evidence.fill(0);
    map.source.fill(grid::EvidenceSource::measured);
    map.edges.fill({});
    grid::seal(map);
}

/// Returns a point well inside a landing foot, as far as possible from the present position of this
/// foot. The middle of the landing foot is not enough: in a short step, the machine already stands
/// on the ground there.
grid::FixedPoint new_ground(const FootSweep& foot) noexcept {
    const grid::FixedPoint center = foot.landing_center;
    const auto from_stance =
        [&](grid::FixedPoint p) {  // sum of the squared distances to all corners of the stance area
            std::int64_t sum_sq = 0;
            for (const grid::FixedPoint q : foot.stance.points())
                sum_sq += (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y);
            return sum_sq;
        };
    grid::FixedPoint farthest = center;
    for (const grid::FixedPoint corner : foot.landing.points()) {
        const grid::FixedPoint inside{(center.x + 3 * corner.x) / 4, (center.y + 3 * corner.y) / 4};
        if (from_stance(inside) > from_stance(farthest)) farthest = inside;
    }
    return farthest;
}

/// Changes a cell of the ground that the foot newly touches. If the cell lies outside the map,
/// changes the nearest cell at the rim of the map. Then the canary fails and reports the case.
template <typename Change>
void change_one_cell(const Setting& s, Change&& change) noexcept {
    const grid::FixedPoint place = new_ground(s.foot);
    const auto index = [&](std::int64_t at, std::int64_t origin) {
        const std::int64_t i = grid::floor_div(at - origin, s.map.resolution_tenth_mm);
        return i < 0 ? 0 : i >= s.map.nx ? std::int64_t{s.map.nx} - 1 : i;
    };
    const std::int64_t ix = index(place.x, s.map.origin_x_tenth_mm);
    const std::int64_t iy = index(place.y, s.map.origin_y_tenth_mm);
    change(static_cast<std::size_t>(iy * s.map.nx + ix));
}

/// Changes the cell of change_one_cell() and its neighbour, because a single cell counts as a
/// pebble.
template <typename Change>
void change_two_cells(const Setting& s, Change&& change) noexcept {
    change_one_cell(s, [&](std::size_t i) {
        change(i);
        change(i > 0 ? i - 1 : i + 1);
    });
}

std::int32_t limit_of(const Setting& s, bool up) noexcept {
    const auto movement_class =
        static_cast<std::size_t>(s.machine.movements[s.query.command].movement_class);
    const StepLimits& step = s.machine.limits.step[movement_class];
    return up ? step.up_tenth_mm : step.down_tenth_mm;
}

struct Fault {
    Reason expected;
    void (*happen)(const Setting&);
};

constexpr auto kFaults = std::to_array<Fault>({
    // Faults that perception reports, and faults of time stamps.
    {Reason::frame_stale,
     [](const Setting& s) { s.map.frame_time_ns -= s.machine.limits.frame_age_ns + 1; }},
    {Reason::pose_stale,
     [](const Setting& s) { s.map.pose_time_ns -= s.machine.limits.pose_age_ns + 1; }},
    {Reason::time_skew,
     [](const Setting& s) { s.map.pose_time_ns += s.machine.limits.future_tolerance_ns + 1; }},
    {Reason::plane_invalid,
     [](const Setting& s) { s.map.gravity_source = grid::GravitySource::assumed; }},
    {Reason::plane_invalid,
     [](const Setting& s) { s.map.tilt_sigma_urad = grid::MapSnapshot::kUnknownTilt; }},
    {Reason::pose_lost, [](const Setting& s) { s.map.health = grid::SnapshotHealth::lost; }},
    {Reason::blind, [](const Setting& s) { s.map.camera = CameraState::dark; }},
    {Reason::exposure, [](const Setting& s) { s.map.camera = CameraState::overexposed; }},
    {Reason::frame_frozen, [](const Setting& s) { s.map.camera = CameraState::frozen; }},
    {Reason::frame_corrupt, [](const Setting& s) { s.map.camera = CameraState::corrupt; }},
    {Reason::mount_moved, [](const Setting& s) { s.map.camera = CameraState::moved; }},
    {Reason::plane_invalid, [](const Setting& s) { s.map.camera = CameraState::leaning; }},
    {Reason::internal, [](const Setting& s) { s.map.magic = 0; }},
    // Faults of the gate and of the query.
    {Reason::not_ready, [](const Setting& s) { s.health.state = GateState::degraded; }},
    {Reason::warmup, [](const Setting& s) { s.health.state = GateState::warmup; }},
    {Reason::pose_jump, [](const Setting& s) { s.health.faults.add(Reason::pose_jump); }},
    {Reason::clock, [](const Setting& s) { s.now_ns = -1; }},
    {Reason::unknown_command, [](const Setting& s) { s.query.command = 0; }},
    {Reason::bad_number, [](const Setting& s) { s.query.cos_yaw *= 2.0; }},
});

/// Faults of the ground, tested under each foot.
constexpr auto kGroundFaults = std::to_array<Fault>({
    {Reason::unknown_cells,
     [](const Setting& s) {
         change_one_cell(s, [&](std::size_t i) {
             s.map.height_tenth_mm[i] = grid::MapSnapshot::kUnknownHeight;
             s.map.source[i] = grid::EvidenceSource::unknown;
         });
     }},
    // An operator attests ground, but rays prove that it is lower.
    {Reason::unknown_cells,
     [](const Setting& s) {
         const GateLimits& limits = s.machine.limits;
         change_one_cell(s, [&](std::size_t i) {
             s.map.height_tenth_mm[i] = -limits.drop_tenth_mm - 1;
             s.map.source[i] = grid::EvidenceSource::unknown;
         });
         s.query.attested = {limits.attestation_radius_tenth_mm > 0,
                             s.query.x_tenth_mm,
                             s.query.y_tenth_mm,
                             limits.attestation_radius_tenth_mm,
                             0};
     }},
    {Reason::not_resolvable,
     [](const Setting& s) {
         change_one_cell(s, [&](std::size_t i) { s.map.sigma_tenth_mm[i] = 0xffff; });
     }},
    {Reason::memory_uncertain,
     [](const Setting& s) {
         change_one_cell(s, [&](std::size_t i) { s.map.drift_tenth_mm[i] = 0xffff; });
     }},
    {Reason::disconnected,
     [](const Setting& s) { change_one_cell(s, [&](std::size_t i) { s.map.component[i] = 2; }); }},
    {Reason::drop_off,
     [](const Setting& s) {
         change_one_cell(s, [&](std::size_t i) { s.map.drop_evidence[i] = 255; });
     }},
    {Reason::body_clearance,
     [](const Setting& s) {
         change_one_cell(s, [&](std::size_t i) {
             s.map.clearance_tenth_mm[i] =
                 static_cast<std::uint16_t>(s.machine.body.lower_edge_tenth_mm());
         });
     }},
    {Reason::corridor_blocked,
     [](const Setting& s) {
         const std::int32_t higher = s.machine.limits.swing_clearance_tenth_mm + 1;
         change_one_cell(s, [&](std::size_t i) { s.map.height_tenth_mm[i] = higher; });
     }},
    {Reason::step_too_high,
     [](const Setting& s) {
         const std::int32_t higher = limit_of(s, true) + 10;
         change_two_cells(s, [&](std::size_t i) { s.map.height_tenth_mm[i] = higher; });
     }},
    {Reason::step_too_low,
     [](const Setting& s) {
         const std::int32_t lower = limit_of(s, false) + 10;
         change_two_cells(s, [&](std::size_t i) { s.map.height_tenth_mm[i] = -lower; });
     }},
    {Reason::drop_off,
     [](const Setting& s) {
         const std::int32_t lower = s.machine.limits.drop_tenth_mm + 1;
         change_one_cell(s, [&](std::size_t i) { s.map.height_tenth_mm[i] = -lower; });
     }},
});

/// Changes of a map after it was sealed.
constexpr auto kDamages = std::to_array<Fault>({
    {Reason::internal,
     [](const Setting& s) {
         change_one_cell(s, [&](std::size_t i) { ++s.map.sigma_tenth_mm[i]; });
     }},
});

constexpr std::size_t kFaultCount = kFaults.size() + 2 * kGroundFaults.size() + kDamages.size();

/// A canary that breaks a rule: its rule, its foot, and whether the change happens after the map
/// was sealed.
struct Broken {
    const Fault& fault;
    std::size_t foot = 0;
    bool after_sealing = false;
};
Broken broken_rule(std::size_t index) noexcept {
    if (index < kFaults.size()) return {kFaults[index]};
    index -= kFaults.size();
    if (index < 2 * kGroundFaults.size())
        return {kGroundFaults[index % kGroundFaults.size()], index / kGroundFaults.size()};
    return {kDamages[index - 2 * kGroundFaults.size()], 0, true};
}

std::int64_t length_sq(const Movement& m) noexcept {
    return std::int64_t{m.forward_tenth_mm} * m.forward_tenth_mm +
           std::int64_t{m.left_tenth_mm} * m.left_tenth_mm;
}

/// True if `a` is better for the canaries than `b`. Walking is better than stairs, because the
/// broken rules are rules for flat ground: on stairs, some of the faults would be treads. A longer
/// movement is better, because it covers more ground.
bool is_harder(const Movement& a, const Movement& b) noexcept {
    if (a.movement_class != b.movement_class) return a.movement_class == MovementClass::walk;
    return length_sq(a) > length_sq(b);
}

}  // namespace

const int Canaries::kBrokenRules = static_cast<int>(kFaultCount);

Canaries::Canaries(const Machine& machine) noexcept : machine_(machine) {
    if (machine.problem() != nullptr) return;  // judge_all() fails, because the verdict is CONFIG
    for (std::size_t i = 1; i < machine.movements.size(); ++i) {
        const auto code = static_cast<std::uint8_t>(i);
        if (movement_for(machine, code) == nullptr) continue;
        ++first_fault_;
        if (longest_ == 0 || is_harder(machine.movements[code], machine.movements[longest_]))
            longest_ = code;
    }
}

Canaries::Outcome Canaries::judge(int index) noexcept {
    Outcome outcome;
    index %= count();
    outcome.command = longest_;
    if (index < first_fault_) {  // movement `index` on level ground
        int left = index;
        outcome.command = 1;
        while (movement_for(machine_, outcome.command) == nullptr || left-- > 0) ++outcome.command;
    }
    make_level(map_);
    Query query = query_at_body(outcome.command, map_);
    GateHealth health{GateState::ready, {}};
    std::int64_t now_ns = kNowNs;
    if (index >= first_fault_) {
        const Broken broken = broken_rule(static_cast<std::size_t>(index - first_fault_));
        const Sweep sweep =
            sweep_of(machine_,
                     fixed_pose(query.x_tenth_mm, query.y_tenth_mm, query.cos_yaw, query.sin_yaw),
                     machine_.movements[longest_]);
        broken.fault.happen({machine_, map_, query, health, now_ns, sweep.feet[broken.foot]});
        if (!broken.after_sealing) grid::seal(map_);
        outcome.expected = broken.fault.expected;
    }
    const Verdict verdict = decide(machine_, query, map_, health, now_ns);
    outcome.name = to_string(outcome.expected);
    outcome.found = verdict.primary;
    outcome.passed =
        outcome.expected == Reason::none
            ? verdict.allows_step(now_ns)
            : !verdict.allows_step(now_ns) &&
                  verdict.decision ==
                      (is_error(outcome.expected) ? Decision::error : Decision::not_traversable) &&
                  verdict.reasons.contains(outcome.expected);
    return outcome;
}

Canaries::Outcome Canaries::judge_all() noexcept {
    Outcome outcome;
    for (int i = 0; i < count(); ++i) {
        outcome = judge(i);
        if (!outcome.passed) break;
    }
    return outcome;
}

}  // namespace surefoot::gate

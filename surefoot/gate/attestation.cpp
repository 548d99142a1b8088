// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/attestation.hpp"

namespace surefoot::gate {

std::int64_t least_attested_radius_sq(const Machine& machine) noexcept {
    const auto reach = [](std::int64_t center, std::int64_t size) {
        return (center < 0 ? -center : center) + (size + 1) / 2;
    };
    std::int64_t farthest_sq = 0;
    for (const GroundBox* foot : {&machine.left_foot, &machine.right_foot}) {
        const std::int64_t x = reach(foot->center_x_tenth_mm, foot->length_tenth_mm);
        const std::int64_t y = reach(foot->center_y_tenth_mm, foot->width_tenth_mm);
        farthest_sq = x * x + y * y > farthest_sq ? x * x + y * y : farthest_sq;
    }
    return farthest_sq;
}

bool Attestation::attest(const Machine& machine,
                         const grid::MapSnapshot& map,
                         std::int64_t radius_tenth_mm,
                         std::int64_t now_ns) noexcept {
    if (machine.problem() != nullptr || !grid::is_intact(map)) return false;
    if (!(radius_tenth_mm > 0 && radius_tenth_mm <= machine.limits.attestation_radius_tenth_mm))
        return false;
    if (radius_tenth_mm * radius_tenth_mm < least_attested_radius_sq(machine)) return false;
    revoke();
    area_.active = true;
    area_.center_x_tenth_mm = map.body_x_tenth_mm;
    area_.center_y_tenth_mm = map.body_y_tenth_mm;
    area_.radius_tenth_mm = static_cast<std::int32_t>(radius_tenth_mm);
    area_.height_tenth_mm =
        // in range: is_intact() bounds body_z to 10^9, Machine::problem() sole_depth to 30 000
        static_cast<std::int32_t>(map.body_z_tenth_mm - machine.sole_depth_tenth_mm);
    longest_lost_ns_ = machine.limits.pose_age_ns;
    known_ns_ = now_ns;
    return true;
}

void Attestation::observe(const grid::MapSnapshot& map, std::int64_t now_ns) noexcept {
    if (!area_.active) return;
    const bool lost =
        map.health != grid::SnapshotHealth::ok && map.health != grid::SnapshotHealth::degraded;
    const bool too_long = (lost || lost_) && now_ns - known_ns_ > longest_lost_ns_;
    lost_ = lost;
    if (!lost) known_ns_ = now_ns;
    const std::int64_t dx = map.body_x_tenth_mm - area_.center_x_tenth_mm;
    const std::int64_t dy = map.body_y_tenth_mm - area_.center_y_tenth_mm;
    const std::int64_t radius = area_.radius_tenth_mm;
    const bool near = dx >= -radius && dx <= radius && dy >= -radius && dy <= radius;
    if (too_long || !near || dx * dx + dy * dy > radius * radius) revoke();
}

}  // namespace surefoot::gate

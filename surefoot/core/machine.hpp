// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace surefoot {

/// A rectangle on the ground, parallel to the axes of base_link. Lengths are integers in units of
/// 0.1 mm ("tenth_mm") as in the map snapshot, so that every computer decides the same.
struct GroundBox {
    std::int32_t center_x_tenth_mm = 0;  ///< position of the centre, forward of base_link
    std::int32_t center_y_tenth_mm = 0;  ///< position of the centre, left of base_link
    std::int32_t length_tenth_mm = 0;    ///< along x
    std::int32_t width_tenth_mm = 0;     ///< along y
};

/// Space that some links of the machine, or its user, fill during a movement. The box moves with
/// base_link straight to the target. It covers every position of the links on the way, including
/// the weight shift of the body. Heights count from the soles.
struct BodyPart {
    GroundBox box;
    std::int32_t low_tenth_mm = 0;   ///< lower edge: lower obstacles pass below the part
    std::int32_t high_tenth_mm = 0;  ///< upper edge: obstacles that hang higher are no hindrance
};

/// The machine and its user without the feet.
struct Body {
    static constexpr int kMaxParts = 8;
    std::array<BodyPart, kMaxParts> parts{};
    std::int32_t count = 0;
    std::int32_t sway_tenth_mm = 0;  ///< margin of the parts for motion beyond their boxes

    [[nodiscard]] constexpr std::span<const BodyPart> all() const noexcept {
        const bool sound = count >= 0 && count <= kMaxParts;
        return {parts.data(), sound ? static_cast<std::size_t>(count) : 0};
    }
    /// Below this height only the feet need room. The height is 0 if there are no parts.
    [[nodiscard]] constexpr std::int32_t lower_edge_tenth_mm() const noexcept {
        std::int32_t lowest = 0;
        for (const BodyPart& part : all()) {
            if (lowest == 0 || part.low_tenth_mm < lowest) lowest = part.low_tenth_mm;
        }
        return lowest;
    }
};

/// Selects the step limits of a movement: flat walking and stairs have separate limits.
enum class MovementClass : std::uint8_t { walk = 0, stair = 1 };
inline constexpr int kMovementClassCount = 2;

/// Motion of base_link for one joystick code, relative to its current pose.
struct Movement {
    bool configured = false;
    MovementClass movement_class = MovementClass::walk;
    std::array<char, 8> name{};  ///< name for people and logs, zero-terminated
    std::int32_t forward_tenth_mm = 0;
    std::int32_t left_tenth_mm = 0;
    double cos_turn = 1.0;  ///< cosine of the change of yaw; left turns are positive
    double sin_turn = 0.0;
};

struct StepLimits {
    bool enabled = false;
    std::int32_t up_tenth_mm = 0;
    std::int32_t down_tenth_mm = 0;
};

/// Limits of the step gate. No default allows any step: a machine file must state all limits.
struct GateLimits {
    std::array<StepLimits, kMovementClassCount> step{};
    double min_normal_z = 1.0;                  ///< cosine of the largest tilt of a foot plane
    std::int32_t patch_side_tenth_mm = 500;     ///< side of the square patches under a foot
    std::int32_t patch_residual_tenth_mm = 0;   ///< limit of |residual| + sigma_factor * sigma
    std::int32_t patch_sigma_tenth_mm = 0;      ///< a patch with a larger sigma is not resolvable
    double sigma_factor = 3.4;                  ///< 3.4: error probability 3e-4 (one-sided, normal)
    std::int32_t patch_independent_cells = 1;   ///< largest number of independent errors in a patch
    std::int32_t cell_sigma_tenth_mm = 0;       ///< a cell with a larger sigma is not resolvable
    std::int32_t swing_clearance_tenth_mm = 0;  ///< highest obstacle below a swinging foot
    std::int32_t foot_margin_tenth_mm = 0;      ///< margin around the path of a foot
    std::int32_t drop_tenth_mm = 0;             ///< ground that lies lower by more is a drop
    std::int32_t drop_band_tenth_mm = 0;        ///< no drop may lie this near to a landing foot
    std::uint8_t drop_evidence = 0;             ///< smallest evidence (1-255) of a drop in a cell
    std::int32_t drift_tenth_mm = 0;            ///< limit of 1-sigma drift since a cell was seen
    /// Class stair: the share of a foot's length that its tread must carry, in thousandths, and the
    /// largest overhang of the foot beyond the nosing.
    std::int32_t tread_share_permille = 1'000;
    std::int32_t tread_overhang_tenth_mm = 0;
    std::int64_t frame_age_ns = 0;
    std::int64_t pose_age_ns = 0;
    std::int64_t future_tolerance_ns = 0;          ///< a stamp may be this far in the future
    std::int64_t verdict_ttl_ns = 0;               ///< validity time of an OK
    std::int32_t attestation_radius_tenth_mm = 0;  ///< largest radius of an operator attestation
};

/// A walking machine for the step gate: an immutable value that is read from a machine file.
struct Machine {
    static constexpr int kMovementCodes = 27;  ///< number of codes; code 0 = joystick at rest

    std::int32_t sole_depth_tenth_mm = 0;  ///< distance of the soles below base_link
    GroundBox left_foot;                   ///< the feet before and after a movement
    GroundBox right_foot;
    std::int32_t ankle_from_heel_tenth_mm = 0;  ///< position of the ankle; the tread must carry it
    Body body;
    std::array<Movement, kMovementCodes> movements{};
    GateLimits limits;

    /// Returns the first reason why the machine cannot be used, or nullptr. Calls no libm function
    /// and allocates no memory, because the gate calls it before every decision.
    [[nodiscard]] constexpr const char* problem() const noexcept;
};

namespace detail {

/// Returns false if `value` is NaN.
template <typename T>
constexpr bool within(T value, T min, T max) noexcept {
    return value >= min && value <= max;
}

constexpr const char* problem_of(const GroundBox& box) noexcept {
    // With limits of 10 m every product of the exact geometry stays far inside 64 bits.
    if (!within(box.center_x_tenth_mm, -100'000, 100'000) ||
        !within(box.center_y_tenth_mm, -100'000, 100'000))
        return "center_x_m and center_y_m of feet and body parts must be -10 to 10 m";
    if (!within(box.length_tenth_mm, 100, 20'000) || !within(box.width_tenth_mm, 100, 20'000))
        return "length_m and width_m of feet and body parts must be 0.01 to 2 m";
    return nullptr;
}

constexpr const char* problem_of(const Body& body) noexcept {
    if (!within(body.sway_tenth_mm, 0, 5'000)) return "body.sway_m must be 0 to 0.5 m";
    if (!within(body.count, 1, Body::kMaxParts)) return "body.parts must have 1 to 8 parts";
    for (const BodyPart& part : body.all()) {
        if (const char* why = problem_of(part.box)) return why;
        if (!within(part.low_tenth_mm, 1, 20'000) ||
            !within(part.high_tenth_mm, part.low_tenth_mm + 1, 30'000))
            return "body part: low_m must be 0.0001 to 2 m, and high_m above low_m and up to 3 m";
    }
    return nullptr;
}

constexpr const char* problem_of(const Movement& movement) noexcept {
    if (!movement.configured) return nullptr;
    if (!within(movement.forward_tenth_mm, -20'000, 20'000) ||
        !within(movement.left_tenth_mm, -20'000, 20'000))
        return "forward_m and left_m of a movement must be -2 to 2 m";
    const double norm_sq =
        movement.cos_turn * movement.cos_turn + movement.sin_turn * movement.sin_turn;
    if (!within(norm_sq, 0.999'999, 1.000'001)) return "cos_turn and sin_turn give no unit vector";
    // The swept hull joins start and target by straight lines. Up to 30 deg an arc leaves the hull
    // by less than 16 mm for a corner 0.46 m from base_link. Margin and sway cover this distance.
    if (!(movement.cos_turn >= 0.866)) return "turn_deg of a movement must be -30 to 30";
    if (static_cast<int>(movement.movement_class) >= kMovementClassCount)
        return "the class of a movement must be walk or stair";
    if (movement.name.back() != '\0') return "the name of a movement must have at most 7 bytes";
    return nullptr;
}

constexpr const char* problem_of(const GateLimits& limits) noexcept {
    for (const StepLimits& step : limits.step) {
        if (!within(step.up_tenth_mm, 0, 3'000) || !within(step.down_tenth_mm, 0, 3'000))
            return "up_m and down_m of limits.walk and limits.stair must be 0 to 0.3 m";
    }
    if (!within(limits.min_normal_z, 0.98, 1.0)) return "limits.tilt_deg must be 0 to 11.4 deg";
    if (!within(limits.patch_side_tenth_mm, 200, 1'000)) return "patch_side_m must be 0.02-0.1 m";
    if (!within(limits.patch_residual_tenth_mm, 1, 500) ||
        !within(limits.patch_sigma_tenth_mm, 1, 100) || !within(limits.cell_sigma_tenth_mm, 1, 300))
        return "set patch_residual_m <= 0.05, patch_sigma_m <= 0.01, cell_sigma_m <= 0.03, all > 0";
    if (!within(limits.sigma_factor, 3.0, 10.0)) return "limits.sigma_factor must be 3 to 10";
    if (!within(limits.patch_independent_cells, 1, 16))
        return "limits.patch_independent_cells must be 1 to 16";
    if (!within(limits.swing_clearance_tenth_mm, 1, 2'000) ||
        !within(limits.foot_margin_tenth_mm, 0, 2'000))
        return "swing_clearance_m must be 0.0001 to 0.2 m, and foot_margin_m 0 to 0.2 m";
    if (!within(limits.drop_tenth_mm, 1, 1'000) || !within(limits.drop_band_tenth_mm, 500, 5'000) ||
        limits.drop_evidence == 0)
        return "drop_m must be 0.0001-0.1 m, drop_band_m 0.05-0.5 m, and drop_evidence above 0";
    if (!within(limits.drift_tenth_mm, 1, 1'000)) return "limits.drift_m must be 0.0001 to 0.1 m";
    if (!within(limits.tread_share_permille, 500, 1'000) ||
        !within(limits.tread_overhang_tenth_mm, 0, 1'000))
        return "tread_share must be 0.5 to 1, and tread_overhang_m 0 to 0.1 m";
    // No value switches a time limit off.
    constexpr std::int64_t kSecondNs = 1'000'000'000;
    if (!within(limits.frame_age_ns, std::int64_t{1}, kSecondNs) ||
        !within(limits.pose_age_ns, std::int64_t{1}, kSecondNs) ||
        !within(limits.verdict_ttl_ns, std::int64_t{1}, kSecondNs) ||
        !within(limits.future_tolerance_ns, std::int64_t{0}, kSecondNs / 10))
        return "frame_age_ms, pose_age_ms, verdict_ttl_ms need 1-1000, future_tolerance_ms 0-100";
    if (!within(limits.attestation_radius_tenth_mm, 0, 20'000))
        return "the attestation radius (attestation_radius_m) must be 0 to 2 m";
    return nullptr;
}

}  // namespace detail

constexpr const char* Machine::problem() const noexcept {
    if (!detail::within(sole_depth_tenth_mm, 1, 30'000)) return "sole_depth_m must be 0.0001-3 m";
    for (const GroundBox* box : {&left_foot, &right_foot}) {
        if (const char* why = detail::problem_of(*box)) return why;
    }
    for (const GroundBox* foot : {&left_foot, &right_foot}) {
        if (foot->length_tenth_mm > 16 * limits.patch_side_tenth_mm ||
            foot->width_tenth_mm > 16 * limits.patch_side_tenth_mm)
            return "a foot must be at most 16 times limits.patch_side_m long and wide";
        if (!detail::within(ankle_from_heel_tenth_mm, 0, foot->length_tenth_mm))
            return "ankle_from_heel_m must be 0 to the length of each foot";
    }
    if (const char* why = detail::problem_of(body)) return why;
    if (movements[0].configured) return "code 0 is the joystick at rest and cannot be a movement";
    for (const Movement& movement : movements) {
        if (const char* why = detail::problem_of(movement)) return why;
    }
    return detail::problem_of(limits);
}

}  // namespace surefoot

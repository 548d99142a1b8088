// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace surefoot::gate {

/// Why a step is not OK. The order is the order of precedence: the first reason that applies is the
/// primary one. Codes of an ERROR come before those of the terrain.
enum class Reason : std::uint8_t {
    // ERROR: the gate cannot judge.
    internal,
    config,
    clock,
    bad_message,
    bad_number,
    frame_id,
    seq,
    unknown_command,
    not_ready,
    warmup,
    mount_moved,
    pose_jump,
    pose_lost,
    plane_invalid,
    blind,
    exposure,
    frame_corrupt,
    frame_frozen,
    time_skew,
    frame_stale,
    pose_stale,
    map_stale,
    expired,
    deadline,
    overload,
    audit,
    // NOT_TRAVERSABLE: perception is healthy; the terrain says no, or is not known.
    outside_map,
    drop_off,
    step_too_high,
    step_too_low,
    corridor_blocked,
    body_clearance,
    unknown_cells,
    slope,
    roughness,
    disconnected,
    memory_uncertain,
    not_resolvable,
    support_area,  ///< too little of a foot on its tread
    edge_margin,   ///< enough of it only if the edge lies just where it seems to
    none,          ///< only an OK has no reason
};
inline constexpr int kReasonCount = static_cast<int>(Reason::none);

/// The code as in messages and logs: "UNKNOWN_CELLS".
[[nodiscard]] const char* to_string(Reason reason) noexcept;

[[nodiscard]] constexpr bool is_error(Reason reason) noexcept {
    return reason < Reason::outside_map;
}

/// A fault that stays until an operator re-arms the gate: what the map was built on is in doubt.
[[nodiscard]] constexpr bool is_latched(Reason reason) noexcept {
    return reason == Reason::internal || reason == Reason::config || reason == Reason::clock ||
           reason == Reason::mount_moved || reason == Reason::pose_jump;
}

/// A set of reasons in one word.
class ReasonSet {
  public:
    constexpr ReasonSet() noexcept = default;
    constexpr explicit ReasonSet(Reason reason) noexcept { add(reason); }

    constexpr void add(Reason reason) noexcept {
        if (reason != Reason::none) bits_ |= std::uint64_t{1} << static_cast<unsigned>(reason);
    }
    constexpr void add(ReasonSet other) noexcept { bits_ |= other.bits_; }
    [[nodiscard]] constexpr bool contains(Reason reason) const noexcept {
        return reason != Reason::none && (bits_ >> static_cast<unsigned>(reason) & 1U) != 0;
    }
    [[nodiscard]] constexpr bool empty() const noexcept { return bits_ == 0; }
    /// The reason of highest precedence, or `none`.
    [[nodiscard]] constexpr Reason primary() const noexcept {
        for (int i = 0; i < kReasonCount; ++i) {
            if (contains(static_cast<Reason>(i))) return static_cast<Reason>(i);
        }
        return Reason::none;
    }
    [[nodiscard]] constexpr std::uint64_t bits() const noexcept { return bits_; }
    friend constexpr bool operator==(ReasonSet, ReasonSet) = default;

  private:
    std::uint64_t bits_ = 0;
};
static_assert(kReasonCount <= 64);

}  // namespace surefoot::gate

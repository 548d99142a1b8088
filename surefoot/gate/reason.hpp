// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace surefoot::gate {

/// The reason why a step is not OK. The order defines the precedence: the first reason that applies
/// is the primary reason. ERROR codes come before terrain codes.
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
    // NOT_TRAVERSABLE: perception is healthy, but the terrain is unsafe or unknown.
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
    support_area,  ///< too little of a foot is on its tread
    edge_margin,   ///< support is enough only if the edge position has no error
    none,          ///< only an OK has no reason
};
inline constexpr int kReasonCount = static_cast<int>(Reason::none);

/// Returns the code of a reason in messages and logs, for example "UNKNOWN_CELLS".
[[nodiscard]] const char* to_string(Reason reason) noexcept;

[[nodiscard]] constexpr bool is_error(Reason reason) noexcept {
    return reason < Reason::outside_map;
}

/// True for a reason that latches at once: the gate stays in FAULT until an operator re-arms it.
[[nodiscard]] constexpr bool is_latched(Reason reason) noexcept {
    return reason == Reason::internal || reason == Reason::config || reason == Reason::clock ||
           reason == Reason::mount_moved || reason == Reason::pose_jump;
}

/// A set of reasons, stored as bits.
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
    /// Returns the reason of highest precedence, or `none` for an empty set.
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

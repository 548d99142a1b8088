// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/gate/reason.hpp"

namespace surefoot::gate {

enum class Decision : std::uint8_t { error = 0, not_traversable = 1, ok = 2 };
/// "ERROR", "NOT_TRAVERSABLE", "OK".
[[nodiscard]] const char* to_string(Decision decision) noexcept;

enum class Foot : std::uint8_t { none, left, right };

/// The numbers behind a verdict. Lengths in units of 0.1 mm.
struct Evidence {
    /// The cell that decided (centre, odom); of the primary reason.
    bool has_worst_cell = false;
    std::int64_t worst_x_tenth_mm = 0;
    std::int64_t worst_y_tenth_mm = 0;
    Foot foot = Foot::none;           ///< the landing foot that the primary reason is about
    std::int64_t value_tenth_mm = 0;  ///< what was found there, in the unit of the limit ...
    std::int64_t limit_tenth_mm = 0;  ///< ... that it broke; both 0 where no length decides

    bool stance_known = false;
    std::int64_t stance_height_tenth_mm = 0;  ///< odom z of the ground under the present feet
    std::int64_t cells = 0;                   ///< cells asked, those of several tests counted again
    std::int64_t known_cells = 0;             ///< of these measured or vouched
    std::int64_t vouched_cells = 0;           ///< of these on an operator's word
    std::int64_t height_delta_tenth_mm = 0;   ///< of the landing foot that differs most from stance
    double max_tilt_tan_sq = 0.0;             ///< squared tangent of the steeper foot plane's tilt
    double max_patch_sigma_sq_tenth_mm2 = 0.0;
    std::int64_t max_drift_tenth_mm = 0;
    std::int64_t min_clearance_tenth_mm =
        0xffff;  ///< free height over the cells asked; 0xffff = open
};

/// The gate's answer about one movement. A default Verdict is an ERROR; only decide() makes an OK,
/// out of a complete list of proofs. It is worth nothing after `valid_until_ns`.
struct Verdict {
    Decision decision = Decision::error;
    ReasonSet reasons{Reason::internal};
    Reason primary = Reason::internal;
    Evidence evidence;
    std::uint8_t command = 0;
    std::uint64_t sequence = 0;
    std::uint64_t map_version = 0;
    std::uint64_t config_hash = 0;
    std::int64_t frame_time_ns = 0;
    std::int64_t pose_time_ns = 0;
    std::int64_t decided_ns = 0;
    std::int64_t valid_until_ns = 0;

    /// The only question that a client may act on.
    [[nodiscard]] constexpr bool allows_step(std::int64_t now_ns) const noexcept {
        return decision == Decision::ok && reasons.empty() && now_ns >= decided_ns &&
               now_ns < valid_until_ns;
    }
};

}  // namespace surefoot::gate

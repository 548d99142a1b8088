// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/gate/reason.hpp"

namespace surefoot::gate {

enum class Decision : std::uint8_t { error = 0, not_traversable = 1, ok = 2 };
/// Returns "ERROR", "NOT_TRAVERSABLE" or "OK".
[[nodiscard]] const char* to_string(Decision decision) noexcept;

enum class Foot : std::uint8_t { none, left, right };

/// Facts that must all be proven before the gate says OK.
enum class Proof : std::uint8_t {
    process_ready,    ///< the state is `ready`, no fault is raised, the clock is valid
    machine_valid,    ///< Machine::problem() finds no problem
    snapshot_intact,  ///< the header is valid (grid::is_sealed); see `cells_intact`
    numbers_valid,    ///< pose, stance height and attested area of the query are valid
    stamps_fresh,     ///< frame and pose stamps are not too old or too far in the future
    gravity_known,    ///< gravity is measured, and its error is small enough
    pose_healthy,     ///< the odometry is neither lost nor degraded
    camera_healthy,   ///< images are new, intact and well exposed; the mount did not move
    command_known,    ///< the machine file has this movement, and its class is enabled
    cells_intact,     ///< the rows that the gate reads did not change after sealing
    stance_known,     ///< the ground under the present feet is known and has no drop
    corridors_clear,  ///< no obstacle in the path of either foot
    body_clear,       ///< no obstacle in the path of the body
    bands_solid,      ///< no drop under or around either landing foot
    left_supported,   ///< the left landing foot has safe ground
    right_supported,  ///< the right landing foot has safe ground
    count
};
/// Returns the name of a proof, for example "corridors_clear".
[[nodiscard]] const char* to_string(Proof proof) noexcept;

/// The numbers behind a verdict. Lengths are in units of 0.1 mm.
struct Evidence {
    /// The cell with the worst finding of the primary reason (its centre in odom).
    bool has_worst_cell = false;
    std::int64_t worst_x_tenth_mm = 0;
    std::int64_t worst_y_tenth_mm = 0;
    Foot foot = Foot::none;           ///< foot at the worst cell; `none`: body or no cell
    std::int64_t value_tenth_mm = 0;  ///< value of the worst finding; 0 if the value is no length
    std::int64_t limit_tenth_mm = 0;  ///< limit of the worst finding; 0 if the limit is no length
    bool overhead = false;            ///< true: the value is the lower side of a hanging object

    std::uint32_t unproven = 0;  ///< bit i: Proof i does not hold. If an earlier test fails, the
                                 ///< ground is not read: no proof about it holds

    bool stance_known = false;
    std::int64_t stance_height_tenth_mm = 0;  ///< odom z of the ground under the present feet
    std::int64_t cells = 0;                   ///< tested cells; a cell counts once per region
    std::int64_t known_cells = 0;             ///< tested cells that are measured or attested
    std::int64_t attested_cells = 0;          ///< tested cells with the attested height
    std::int64_t height_delta_tenth_mm = 0;   ///< largest rise or fall of a landing foot
    /// Squared tangent of the steeper foot plane's tilt, with the uncertainty of the vertical
    /// added.
    double max_tilt_tan_sq = 0.0;
    double max_patch_sigma_sq_tenth_mm2 = 0.0;
    std::int64_t max_drift_tenth_mm = 0;
    std::int64_t min_clearance_tenth_mm =
        0xffff;  ///< lowest free height above the tested cells; 0xffff = nothing overhead

    [[nodiscard]] constexpr bool lacks(Proof proof) const noexcept {
        return (unproven >> static_cast<unsigned>(proof) & 1U) != 0;
    }
};

/// The gate's answer about one movement. A default Verdict is an ERROR. Only decide() makes an OK,
/// from a complete list of proofs. The verdict is invalid from `valid_until_ns` on.
struct Verdict {
    Decision decision = Decision::error;
    ReasonSet reasons{Reason::internal};
    Reason primary = Reason::internal;
    Evidence evidence;
    std::uint8_t command = 0;
    std::uint64_t connection = 0;  ///< copied from the query, like `sequence`
    std::uint64_t sequence = 0;
    std::uint64_t map_version = 0;
    std::uint64_t config_hash = 0;
    std::int64_t frame_time_ns = 0;
    std::int64_t pose_time_ns = 0;
    std::int64_t decided_ns = 0;
    std::int64_t valid_until_ns = 0;

    /// Returns true if a client may act now. Clients must use no other test.
    [[nodiscard]] constexpr bool allows_step(std::int64_t now_ns) const noexcept {
        return decision == Decision::ok && reasons.empty() && now_ns >= decided_ns &&
               now_ns < valid_until_ns;
    }
};

}  // namespace surefoot::gate

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/machine.hpp"
#include "surefoot/gate/verdict.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::gate {

/// Where the height of the ground under the present feet comes from.
enum class StanceHeight : std::uint8_t {
    map,   ///< mean of the cells under both feet
    given  ///< told by the caller (joint sensors, arming); the cells must be known all the same
};

/// Ground that an operator answered for when arming: unknown cells that lie wholly inside count as
/// flat ground at `height`. Measured cells keep what was measured: a word never covers an obstacle.
/// It holds only while base_link is inside; the caller forgets it for good after leaving, logs it
/// and shows it. Off by default.
struct AttestedArea {
    bool active = false;
    std::int64_t center_x_tenth_mm = 0;  ///< odom
    std::int64_t center_y_tenth_mm = 0;
    std::int32_t radius_tenth_mm = 0;
    std::int32_t height_tenth_mm = 0;
};

/// "May I make this movement from here?" A default query is refused: its pose is no pose.
struct Query {
    std::uint8_t command = 0;     ///< joystick code 1..26, see system_facts.md 7.2
    std::int64_t x_tenth_mm = 0;  ///< base_link in odom
    std::int64_t y_tenth_mm = 0;
    double cos_yaw = 0.0;
    double sin_yaw = 0.0;
    StanceHeight stance_source = StanceHeight::map;
    std::int32_t stance_height_tenth_mm = 0;  ///< odom z, for StanceHeight::given
    AttestedArea attested;
    /// Who asks, and which question of theirs this is: returned in the verdict, which answers no
    /// other question.
    std::uint64_t connection = 0;
    std::uint64_t sequence = 0;
};

/// The movement behind a command code, or nullptr: code 0, codes beyond the table, codes without an
/// entry and classes that are switched off all come out the same.
[[nodiscard]] const Movement* movement_for(const Machine& machine, std::uint8_t command) noexcept;

/// Query from coordinates in m. A coordinate that is not finite or beyond 100 km leaves the pose
/// invalid, and the gate answers BAD_NUMBER.
[[nodiscard]] Query make_query(
    std::uint8_t command, double x_m, double y_m, double cos_yaw, double sin_yaw) noexcept;
/// Query at the pose that the snapshot was taken at.
[[nodiscard]] Query query_at_body(std::uint8_t command, const grid::MapSnapshot& map) noexcept;

/// State of the process around the gate. Only `ready` can give an OK.
enum class GateState : std::uint8_t { init, warmup, ready, degraded, fault, stopping };

struct GateHealth {
    GateState state = GateState::init;
    ReasonSet faults;  ///< ERROR codes that monitors raise; a terrain code among them is INTERNAL
};

/// What speaks against a snapshot at `now_ns`, whatever is asked of it: damage, age, a stamp of the
/// future, gravity, pose, camera: decide() asks the same. And ground that was measured where the
/// feet stand but does not lie where the soles are (PLANE_INVALID), which only a machine that
/// stands on the map can say. Empty = it may be used.
[[nodiscard]] ReasonSet snapshot_faults(const Machine& machine,
                                        const grid::MapSnapshot& map,
                                        std::int64_t now_ns) noexcept;

/// Is the movement safe? Pure: no clock, no allocation, no input or output, no libm; the same bytes
/// give the same verdict on every machine. Written so that everything missing, broken, NaN, too old
/// or from the future inhibits. Thread-safe; cost below 0.2 ms.
[[nodiscard]] Verdict decide(const Machine& machine,
                             const Query& query,
                             const grid::MapSnapshot& map,
                             const GateHealth& health,
                             std::int64_t now_ns) noexcept;

}  // namespace surefoot::gate

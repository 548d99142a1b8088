// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/machine.hpp"
#include "surefoot/gate/verdict.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::gate {

/// Source of the height of the ground under the feet before the movement.
enum class StanceHeight : std::uint8_t {
    map,   ///< mean height of the known cells under both feet
    given  ///< the caller gives it (joint sensors, arming); the cells must be known as well
};

/// Ground that an operator attested. Unknown cells wholly inside count as flat ground at `height`,
/// unless a ray proves them lower. Measured cells keep their heights, except uncertain cells within
/// 15 mm of `height`. So no measured obstacle above 15 mm is hidden. Valid only while base_link is
/// inside. The caller logs the attestation, and ends it for good when base_link leaves the area.
struct AttestedArea {
    bool active = false;
    std::int64_t center_x_tenth_mm = 0;  ///< odom
    std::int64_t center_y_tenth_mm = 0;
    std::int32_t radius_tenth_mm = 0;
    std::int32_t height_tenth_mm = 0;
};

/// The question "may I make this movement from here?" Without a valid pose it is refused.
struct Query {
    std::uint8_t command = 0;     ///< joystick code 1..26 (docs/reference/glossary.md)
    std::int64_t x_tenth_mm = 0;  ///< base_link in odom
    std::int64_t y_tenth_mm = 0;
    double cos_yaw = 0.0;
    double sin_yaw = 0.0;
    StanceHeight stance_source = StanceHeight::map;
    std::int32_t stance_height_tenth_mm = 0;  ///< odom z of the ground, for StanceHeight::given
    AttestedArea attested;
    /// Identifies the client and its question. The verdict returns both numbers and answers only
    /// this question.
    std::uint64_t connection = 0;
    std::uint64_t sequence = 0;
};

/// Returns the movement of a command code. Returns nullptr for code 0, codes beyond the table,
/// codes without an entry and disabled classes.
[[nodiscard]] const Movement* movement_for(const Machine& machine, std::uint8_t command) noexcept;

/// Makes a query from coordinates in m. If a coordinate is not finite or beyond 100 km, the pose
/// stays invalid and the gate answers BAD_NUMBER.
[[nodiscard]] Query make_query(
    std::uint8_t command, double x_m, double y_m, double cos_yaw, double sin_yaw) noexcept;
/// Makes a query at the pose of the snapshot.
[[nodiscard]] Query query_at_body(std::uint8_t command, const grid::MapSnapshot& map) noexcept;

/// State of the gate process. Only `ready` can give an OK.
enum class GateState : std::uint8_t { init, warmup, ready, degraded, fault, stopping };

struct GateHealth {
    GateState state = GateState::init;
    ReasonSet faults;  ///< ERROR codes raised by monitors; a terrain code here becomes INTERNAL
};

/// Returns the faults of a snapshot at `now_ns` that do not depend on the query: damage, age, a
/// stamp in the future, gravity, pose, camera. decide() applies these tests, too, but looks for
/// damage only in the rows that it reads. Only this function ignores CameraState::leaning and tests
/// that measured ground under the feet is at sole height (PLANE_INVALID). Empty = usable snapshot.
[[nodiscard]] ReasonSet snapshot_faults(const Machine& machine,
                                        const grid::MapSnapshot& map,
                                        std::int64_t now_ns) noexcept;

/// Decides whether a movement is safe. Pure: uses no clock, allocation, input, output or libm, so
/// the same bytes give the same verdict on every machine. Missing, damaged, NaN, outdated or future
/// input always inhibits. Thread-safe. Costs less than 0.2 ms.
[[nodiscard]] Verdict decide(const Machine& machine,
                             const Query& query,
                             const grid::MapSnapshot& map,
                             const GateHealth& health,
                             std::int64_t now_ns) noexcept;

}  // namespace surefoot::gate

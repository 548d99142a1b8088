// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/machine.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::gate {

/// Square of the least radius of an attested area [(0.1 mm)^2]: the area around base_link holds
/// both soles. A smaller one says nothing about the ground that the machine stands on.
[[nodiscard]] std::int64_t least_attested_radius_sq(const Machine& machine) noexcept;

/// The operator's attestation of the ground where the machine stands, as long as it holds. The
/// camera cannot see that ground, and without an attestation the first step is refused. Off until
/// somebody attests; void for good once base_link has left the area or nobody knew where it was, or
/// when it is revoked.
class Attestation {
  public:
    /// Level ground under the soles, within `radius_tenth_mm` of base_link. False, and nothing
    /// changes, when the radius is below the least one or beyond the machine file's limit, or when
    /// the snapshot is of no use.
    [[nodiscard]] bool attest(const Machine& machine,
                              const grid::MapSnapshot& map,
                              std::int64_t radius_tenth_mm,
                              std::int64_t now_ns) noexcept;
    /// Looks where the machine is now. A pose that is lost for longer than a pose may be old
    /// (`pose_age` of the machine file) says nothing of that any more, and neither does any later
    /// one.
    void observe(const grid::MapSnapshot& map, std::int64_t now_ns) noexcept;
    /// After a fault, a restart, or on somebody's wish.
    void revoke() noexcept { *this = Attestation{}; }
    [[nodiscard]] const AttestedArea& area() const noexcept { return area_; }

  private:
    AttestedArea area_;
    std::int64_t longest_lost_ns_ = 0;
    std::int64_t known_ns_ = 0;  ///< when the pose was known last
    bool lost_ = false;
};

}  // namespace surefoot::gate

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/machine.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::gate {

/// Squared least radius of an attested area [(0.1 mm)^2]: the area around base_link must contain
/// both soles. A smaller area does not cover the ground under the machine.
[[nodiscard]] std::int64_t least_attested_radius_sq(const Machine& machine) noexcept;

/// The operator's attestation of the ground where the machine stands, and its validity. The camera
/// cannot see that ground, so the gate refuses the first step without an attestation. Initially
/// there is no attestation. Each attestation ends for good when base_link leaves the area, when the
/// pose is lost for too long, or by revoke(). Not thread-safe.
class Attestation {
  public:
    /// Attests level ground under the soles, within `radius_tenth_mm` of base_link. Returns false
    /// and changes nothing if the machine is invalid or the snapshot damaged. The same holds for a
    /// radius below the least radius or above the limit of the machine file.
    [[nodiscard]] bool attest(const Machine& machine,
                              const grid::MapSnapshot& map,
                              std::int64_t radius_tenth_mm,
                              std::int64_t now_ns) noexcept;
    /// Ends the attestation if base_link is outside the area, or if the pose is lost for longer
    /// than the largest age of a pose (`pose_age` of the machine file). A later valid pose does not
    /// restore the attestation.
    void observe(const grid::MapSnapshot& map, std::int64_t now_ns) noexcept;
    /// Ends the attestation. For use after a fault, after a restart, or on request.
    void revoke() noexcept { *this = Attestation{}; }
    [[nodiscard]] const AttestedArea& area() const noexcept { return area_; }

  private:
    AttestedArea area_;
    std::int64_t longest_lost_ns_ = 0;
    std::int64_t known_ns_ = 0;  ///< time of the last known pose [ns]
    bool lost_ = false;
};

}  // namespace surefoot::gate

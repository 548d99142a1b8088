// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "surefoot/gate/verdict.hpp"

namespace surefoot::gate {

/// What has to be shown, all of it, before the gate says OK.
enum class Proof : std::uint8_t {
    process_ready,    ///< state ready, no fault raised
    machine_valid,    ///< the machine file passes its own check
    snapshot_intact,  ///< layout, ranges and checksum
    numbers_valid,    ///< pose, heights and areas of the query
    stamps_fresh,     ///< neither old nor from the future
    gravity_known,    ///< measured, not assumed
    pose_healthy,     ///< odometry neither lost nor degraded
    camera_healthy,   ///< its images are new and whole
    command_known,    ///< the machine file has this movement and its class is enabled
    stance_known,     ///< ground under the present feet
    corridors_clear,  ///< nothing in the way of either foot
    body_clear,       ///< nothing in the way of the body
    bands_solid,      ///< no drop beyond either landing foot
    left_supported,   ///< ground under the left landing foot
    right_supported,  ///< the same for the right one
    count
};

/// One broken rule: where, how much, against which limit.
struct Finding {
    std::int64_t cell_x = 0;  ///< in cells of the snapshot; may lie outside of it
    std::int64_t cell_y = 0;
    std::int64_t value_tenth_mm = 0;
    std::int64_t limit_tenth_mm = 0;
    std::int64_t severity = 0;  ///< the worst one of each reason is kept, the first among equals
    Foot foot = Foot::none;
};

/// Collects proofs and broken rules while a decision is made.
class Findings {
  public:
    void deny(Reason reason) noexcept {
        reasons_.add(reason);
        ++denials_;
    }
    void deny(Reason reason, const Finding& finding) noexcept;
    /// Runs the test; the proof holds when it denied nothing.
    template <typename Test>
    void prove(Proof proof, Test&& test) noexcept {
        const std::uint64_t before = denials_;
        test();
        if (denials_ == before) proofs_ |= bit(proof);
    }
    [[nodiscard]] ReasonSet reasons() const noexcept { return reasons_; }
    [[nodiscard]] bool complete() const noexcept { return proofs_ == bit(Proof::count) - 1U; }
    /// The worst finding of a reason, or nullptr when it was denied without a place.
    [[nodiscard]] const Finding* worst(Reason reason) const noexcept;

    Evidence evidence;  ///< numbers that every verdict carries

  private:
    static constexpr std::uint32_t bit(Proof proof) noexcept {
        return std::uint32_t{1} << static_cast<unsigned>(proof);
    }

    ReasonSet reasons_;
    std::uint64_t denials_ = 0;
    std::uint32_t proofs_ = 0;
    std::array<Finding, kReasonCount> worst_{};
    std::array<bool, kReasonCount> has_worst_{};
};

}  // namespace surefoot::gate

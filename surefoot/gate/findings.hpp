// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "surefoot/gate/verdict.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::gate {

/// One broken rule: its cell, the value and the limit.
struct Finding {
    std::int64_t cell_x = 0;  ///< position [cells]; may lie outside the snapshot
    std::int64_t cell_y = 0;
    std::int64_t value_tenth_mm = 0;
    std::int64_t limit_tenth_mm = 0;
    std::int64_t severity = 0;  ///< the most severe finding per reason is kept; if equal, the first
    Foot foot = Foot::none;
    bool overhead = false;  ///< overhanging obstacle; the value is the height of its lower side
};

/// Collects proofs and broken rules during one decision.
class Findings {
  public:
    void deny(Reason reason) noexcept {
        reasons_.add(reason);
        ++denials_;
    }
    void deny(Reason reason, const Finding& finding) noexcept;
    /// Runs `test`. The proof holds if the test denied nothing.
    template <typename Test>
    void prove(Proof proof, Test&& test) noexcept {
        const std::uint64_t before = denials_;
        test();
        if (denials_ == before) proofs_ |= bit(proof);
    }
    [[nodiscard]] ReasonSet reasons() const noexcept { return reasons_; }
    [[nodiscard]] bool complete() const noexcept { return unproven() == 0; }
    /// Returns the proofs that do not hold: bit i stands for Proof i, as in Evidence.
    [[nodiscard]] std::uint32_t unproven() const noexcept {
        return (bit(Proof::count) - 1U) & ~proofs_;
    }
    /// Returns the most severe finding of a reason, or nullptr if no finding names a cell.
    [[nodiscard]] const Finding* worst(Reason reason) const noexcept;

    Evidence evidence;  ///< numbers that every verdict contains

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

/// Copies cell, foot, value and limit of the primary reason's worst finding into the evidence.
void show_worst_cell(const grid::MapSnapshot& map,
                     const Findings& findings,
                     Reason primary,
                     Evidence& evidence) noexcept;

}  // namespace surefoot::gate

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "surefoot/gate/verdict.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::gate {

/// One broken rule: where, how much, against which limit.
struct Finding {
    std::int64_t cell_x = 0;  ///< in cells of the snapshot; may lie outside of it
    std::int64_t cell_y = 0;
    std::int64_t value_tenth_mm = 0;
    std::int64_t limit_tenth_mm = 0;
    std::int64_t severity = 0;  ///< the worst one of each reason is kept, the first among equals
    Foot foot = Foot::none;
    bool overhead = false;  ///< it hangs: the value is the height at which it begins
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
    [[nodiscard]] bool complete() const noexcept { return unproven() == 0; }
    /// The proofs that do not hold, a bit each, as in Evidence.
    [[nodiscard]] std::uint32_t unproven() const noexcept {
        return (bit(Proof::count) - 1U) & ~proofs_;
    }
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

/// Where the primary reason was worst, and by how much, into the evidence.
void show_worst_cell(const grid::MapSnapshot& map,
                     const Findings& findings,
                     Reason primary,
                     Evidence& evidence) noexcept;

}  // namespace surefoot::gate

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/machine.hpp"
#include "surefoot/gate/reason.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::gate {

/// Canaries: inputs of decide() with known verdicts. Level ground must be OK for every movement of
/// the machine. Each other canary breaks one rule in the longest movement (walking before stairs).
/// Rules of the ground are broken under each foot. Canaries detect a gate with a constant verdict.
/// Judge all canaries before the gate is armed. Then judge one after the other while the gate runs.
///
/// Holds one map of 0.9 MB, so allocate it on the heap. Allocates nothing after construction. One
/// canary costs less than a millisecond.
class Canaries {
  public:
    explicit Canaries(const Machine& machine) noexcept;

    [[nodiscard]] int count() const noexcept { return first_fault_ + kBrokenRules; }
    /// Result of one canary. `name`: code of `expected`, for example "UNKNOWN_CELLS"; "NONE" = OK.
    struct Outcome {
        bool passed = false;
        const char* name = "";
        std::uint8_t command = 0;
        Reason expected = Reason::none;  ///< `none` = OK
        Reason found = Reason::internal;
    };
    /// Judges canary `index` modulo count().
    [[nodiscard]] Outcome judge(int index) noexcept;
    /// Judges all canaries. Returns the first failure, or the last canary if all pass.
    [[nodiscard]] Outcome judge_all() noexcept;

  private:
    static const int kBrokenRules;

    Machine machine_;
    grid::MapSnapshot map_;
    int first_fault_ = 0;       ///< number of movements = first canary that breaks a rule
    std::uint8_t longest_ = 0;  ///< movement of the canaries that break a rule
};

}  // namespace surefoot::gate

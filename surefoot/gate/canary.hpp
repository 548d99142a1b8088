// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/machine.hpp"
#include "surefoot/gate/reason.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::gate {

/// Maps whose verdicts are known: level ground for every movement of the machine, and for its
/// longest movement one broken rule at a time, those of the ground under either foot. They go the
/// way of every question, through decide(), so that a gate that has come to say OK (or nothing
/// else) is noticed. Asked before the gate is armed, and one after the other while it runs.
///
/// Holds one map of 0.9 MB: belongs on the heap. Nothing is allocated afterwards; a canary costs
/// less than a millisecond.
class Canaries {
  public:
    explicit Canaries(const Machine& machine) noexcept;

    [[nodiscard]] int count() const noexcept { return first_fault_ + kBrokenRules; }
    /// "level ground, movement 9", "unknown_cells".
    struct Outcome {
        bool passed = false;
        const char* name = "";
        std::uint8_t command = 0;
        Reason expected = Reason::none;  ///< `none` = OK
        Reason found = Reason::internal;
    };
    /// Judges canary `index`, taken modulo count().
    [[nodiscard]] Outcome judge(int index) noexcept;
    /// All of them; the first that failed, or the last one.
    [[nodiscard]] Outcome judge_all() noexcept;

  private:
    static const int kBrokenRules;

    Machine machine_;
    grid::MapSnapshot map_;
    int first_fault_ = 0;       ///< = number of movements
    std::uint8_t longest_ = 0;  ///< movement that the faults are asked with
};

}  // namespace surefoot::gate

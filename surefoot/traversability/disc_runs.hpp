// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <vector>

namespace surefoot::traversability {

/// A disc as runs of cells along x: its row dy is the columns -h ... h around the centre. What is
/// known of a run (a sum, a maximum) is worked out once and serves every disc that contains it, so
/// that a disc costs as much as its rows, not as its cells.
struct DiscRuns {
    /// Larger discs are left to the plain filters: the memory for their runs would not stay near.
    static constexpr int kMaxReach = 24;

    int reach = 0;           ///< largest |dy| [cells]
    std::vector<int> width;  ///< [|dy|] -> index of h in the list of half widths
};

/// The runs of several discs that read the same layer.
class RunsOfDiscs {
  public:
    struct Wanted {
        double radius_m;
        DiscRuns& runs;
    };
    /// Fills the runs of all discs and the list of their half widths; keeps its memory.
    void build(double resolution_m, std::initializer_list<Wanted> discs);

    /// Distinct half widths, ascending.
    [[nodiscard]] const std::vector<int>& half_widths() const noexcept { return half_widths_; }
    [[nodiscard]] int reach() const noexcept { return reach_; }
    /// How many rows a disc of that reach covers, times the distinct half widths: what a kernel
    /// keeps at a time.
    [[nodiscard]] std::size_t kept_runs() const noexcept {
        return static_cast<std::size_t>(2 * reach_ + 1) * half_widths_.size();
    }

  private:
    int reach_ = 0;
    std::vector<int> half_widths_;
};

}  // namespace surefoot::traversability

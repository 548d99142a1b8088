// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <vector>

namespace surefoot::traversability {

/// A disc as runs of cells along x: row dy covers the columns -h ... h around the centre. A figure
/// of a run (a sum, a maximum) is computed once and used by every disc that contains the run. So
/// the cost of a disc grows with its rows, not with its cells.
struct DiscRuns {
    /// Larger discs use the plain filters: the memory for their runs would exceed the cache.
    static constexpr int kMaxReach = 24;

    int reach = 0;           ///< largest |dy| [cells]
    std::vector<int> width;  ///< element |dy|: index of h in `RunsOfDiscs::half_widths`
};

/// The runs of several discs that read the same layer.
class RunsOfDiscs {
  public:
    struct Wanted {
        double radius_m;
        DiscRuns& runs;
    };
    /// Fills the runs of all discs and the list of their half widths; reuses its memory.
    void build(double resolution_m, std::initializer_list<Wanted> discs);

    /// Distinct half widths, ascending.
    [[nodiscard]] const std::vector<int>& half_widths() const noexcept { return half_widths_; }
    [[nodiscard]] int reach() const noexcept { return reach_; }
    /// Returns the number of runs that a kernel keeps at a time: the number of rows of the largest
    /// disc times the number of distinct half widths.
    [[nodiscard]] std::size_t kept_runs() const noexcept {
        return static_cast<std::size_t>(2 * reach_ + 1) * half_widths_.size();
    }

  private:
    int reach_ = 0;
    std::vector<int> half_widths_;
};

}  // namespace surefoot::traversability

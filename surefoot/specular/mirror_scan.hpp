// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "surefoot/specular/mirror_patch.hpp"
#include "surefoot/specular/pair_sums.hpp"

namespace surefoot::specular {

/// The likeliest mirror line of a patch.
struct PatchLine {
    double score = 0.0;        ///< standard deviations of the noise of other lines
    double unique = 0.0;       ///< score over the next best one of the patch
    double correlation = 0.0;  ///< of the cells before the line with those behind it
    double at = 0.0;           ///< in fine cells across the lines, at the middle of the patch
    double lean_rad = 0.0;     ///< turn of its normal, counter-clockwise, from that of the patch
    int first_cell = 0;        ///< the part of it that was seen, in fine cells
    int last_cell = 0;
    int pairs = 0;  ///< cells that mirror each other
};

/// Looks for the line about which the floor is its own mirror image.
///
/// A mirror on a floor makes a second floor that is the first one reversed. All lines are tried at
/// half of the resolution, and the best ones again at all of it, with small turns. The noise is
/// what the lines beside a line show over the same part of it: their median and their median
/// deviation. No allocation after construction.
class MirrorScan {
  public:
    MirrorScan();

    /// Nothing where too little is known. `near`: only lines within 2 cells of it.
    [[nodiscard]] std::optional<PatchLine> find(const MirrorPatch& patch,
                                                std::optional<double> near = {});

  private:
    void find_candidates(const PatchDetail& coarse);
    [[nodiscard]] PatchLine refine(const PatchDetail& fine, int twice);
    [[nodiscard]] PatchLine rated(PatchLine line, int first, int last, double raw);

    std::vector<int> candidates_;     ///< lines of the fine detail
    std::vector<PairSums> coarse_;    ///< of each line of the coarse detail
    std::vector<double> stands_out_;  ///< likewise: the most that a run of it stands out
    std::vector<double> scores_;
    std::vector<PairSums> beside_;  ///< of the lines beside a candidate
    std::vector<double> noise_;
    double mean_square_ = 0.0;  ///< of the fine detail
};

}  // namespace surefoot::specular

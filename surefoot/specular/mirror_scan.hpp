// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "surefoot/specular/mirror_patch.hpp"
#include "surefoot/specular/pair_sums.hpp"

namespace surefoot::specular {

/// The most likely mirror line of a patch.
struct PatchLine {
    double score = 0.0;        ///< score in standard deviations of the noise of other lines
    double unique = 0.0;       ///< score over the second best score of the patch
    double correlation = 0.0;  ///< correlation of the cells before and behind the line
    double at = 0.0;           ///< in fine cells across the lines, at the middle of the patch
    double lean_rad = 0.0;     ///< rotation of its normal from that of the patch, counter-clockwise
    int first_cell = 0;        ///< the visible part of the line, in fine cells
    int last_cell = 0;
    int pairs = 0;  ///< number of cell pairs that mirror each other
};

/// Searches the line about which the floor is its own mirror image.
///
/// A mirror on a floor shows a second floor: the first one reversed. The search tries all lines at
/// half the resolution, then the best ones at full resolution with small rotations. The noise is
/// measured on the lines beside a line, over the same part: their median and median absolute
/// deviation. No allocation after construction.
class MirrorScan {
  public:
    MirrorScan();

    /// Nothing where too little is known. `near`: only lines within 2 cells of this position.
    [[nodiscard]] std::optional<PatchLine> find(const MirrorPatch& patch,
                                                std::optional<double> near = {});

  private:
    void find_candidates(const PatchDetail& coarse);
    [[nodiscard]] PatchLine refine(const PatchDetail& fine, int twice);
    [[nodiscard]] PatchLine rated(PatchLine line, int first, int last, double raw);

    std::vector<int> candidates_;     ///< lines of the fine detail
    std::vector<PairSums> coarse_;    ///< one per line of the coarse detail
    std::vector<double> stands_out_;  ///< one per line of the coarse detail: excess of its best run
    std::vector<double> scores_;
    std::vector<PairSums> beside_;  ///< sums of the lines beside a candidate
    std::vector<double> noise_;
    double mean_square_ = 0.0;  ///< mean square of the fine detail
};

}  // namespace surefoot::specular

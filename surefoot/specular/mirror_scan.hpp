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
    double unique = 0.0;       ///< score divided by the second best score of the patch
    double correlation = 0.0;  ///< correlation of the cells before and behind the line
    double at = 0.0;  ///< position across the lines, in fine cells, at the middle of the patch
    double lean_rad = 0.0;  ///< rotation of its normal from that of the patch, counter-clockwise
    int first_cell = 0;     ///< start of the observed part of the line, in fine cells
    int last_cell = 0;
    int pairs = 0;  ///< number of cell pairs that mirror each other
};

/// Searches for the line about which the floor is its own mirror image.
///
/// A mirror on a floor shows a second floor: the first floor reversed. The search tries all lines
/// at half the resolution, then the best lines at full resolution with small rotations. The noise
/// is measured on neighbouring lines, over the same part: their median, and their mean absolute
/// deviation from it. No allocation after construction.
class MirrorScan {
  public:
    MirrorScan();

    /// Returns nothing if too few cells are known. `near`: only lines within 2 cells of this value.
    [[nodiscard]] std::optional<PatchLine> find(const MirrorPatch& patch,
                                                std::optional<double> near = {});

  private:
    void find_candidates(const PatchDetail& coarse);
    [[nodiscard]] PatchLine refine(const PatchDetail& fine, int twice);
    [[nodiscard]] PatchLine rated(PatchLine line, int first, int last, double raw);

    std::vector<int> candidates_;     ///< lines of the fine detail
    std::vector<PairSums> coarse_;    ///< one per line of the coarse detail
    std::vector<double> stands_out_;  ///< per line of the coarse detail: excess of its best part
    std::vector<double> scores_;
    std::vector<PairSums> beside_;  ///< sums of the lines beside a candidate
    std::vector<double> noise_;
    double mean_square_ = 0.0;  ///< mean square of the fine detail
};

}  // namespace surefoot::specular

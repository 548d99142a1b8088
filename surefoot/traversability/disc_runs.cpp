// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/disc_runs.hpp"

#include <algorithm>

#include "surefoot/traversability/disc.hpp"

namespace surefoot::traversability {

void RunsOfDiscs::build(double resolution_m, std::initializer_list<Wanted> discs) {
    reach_ = 0;
    half_widths_.clear();
    for (const Wanted& disc : discs) {
        disc.runs.reach = Disc::reach_of(disc.radius_m, resolution_m);
        disc.runs.width.clear();
        for (int dy = 0; dy <= disc.runs.reach; ++dy)
            disc.runs.width.push_back(Disc::half_width_of(disc.radius_m, resolution_m, dy));
        half_widths_.insert(half_widths_.end(), disc.runs.width.begin(), disc.runs.width.end());
        reach_ = std::max(reach_, disc.runs.reach);
    }
    std::sort(half_widths_.begin(), half_widths_.end());
    half_widths_.erase(std::unique(half_widths_.begin(), half_widths_.end()), half_widths_.end());
    for (const Wanted& disc : discs) {
        for (int& width : disc.runs.width) {
            const auto at = std::lower_bound(half_widths_.begin(), half_widths_.end(), width);
            width = static_cast<int>(at - half_widths_.begin());
        }
    }
}

}  // namespace surefoot::traversability

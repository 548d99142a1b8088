// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/speckles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace surefoot::stereo {

int SpeckleFilter::root_of(int run) {
    const auto at = [&](int index) -> Run& { return runs_[static_cast<std::size_t>(index)]; };
    while (at(run).parent != run) {
        at(run).parent = at(at(run).parent).parent;
        run = at(run).parent;
    }
    return run;
}

void SpeckleFilter::join(int a, int b) {
    a = root_of(a);
    b = root_of(b);
    if (a == b) return;
    Run& low = runs_[static_cast<std::size_t>(std::min(a, b))];
    Run& high = runs_[static_cast<std::size_t>(std::max(a, b))];
    high.parent = std::min(a, b);
    low.size += high.size;
}

/// Joins the runs of row v with those of the row above wherever two pixels agree.
void SpeckleFilter::connect(const Image<float>& disparity_px, int v, float same_px) {
    const float* const above = disparity_px.row(v - 1);
    const float* const here = disparity_px.row(v);
    int upper = row_first_[static_cast<std::size_t>(v - 1)];
    const int upper_end = row_first_[static_cast<std::size_t>(v)];
    int lower = upper_end;
    const int lower_end = row_first_[static_cast<std::size_t>(v + 1)];
    while (upper < upper_end && lower < lower_end) {
        const Run& a = runs_[static_cast<std::size_t>(upper)];
        const Run& b = runs_[static_cast<std::size_t>(lower)];
        const int first = std::max(a.first, b.first);
        const int last = std::min(a.last, b.last);
        int u = first;
        while (u <= last && !(std::abs(above[u] - here[u]) <= same_px)) ++u;
        if (u <= last) join(upper, lower);
        (a.last < b.last ? upper : lower) += 1;
    }
}

void SpeckleFilter::remove(int min_size, double same_px, Image<float>& disparity_px) {
    const int width = disparity_px.width();
    const int height = disparity_px.height();
    const auto limit = static_cast<float>(same_px);
    runs_.clear();
    row_first_.clear();
    row_first_.push_back(0);
    for (int v = 0; v < height; ++v) {
        in_row_.find(disparity_px.row(v), width, limit);
        in_row_.for_each([&](int first, int last) {
            runs_.push_back({first, last, static_cast<int>(runs_.size()), last - first + 1});
        });
        row_first_.push_back(static_cast<int>(runs_.size()));
        if (v > 0) connect(disparity_px, v, limit);
    }
    for (int v = 0; v < height; ++v) {
        float* const d = disparity_px.row(v);
        for (int run = row_first_[static_cast<std::size_t>(v)];
             run < row_first_[static_cast<std::size_t>(v + 1)];
             ++run) {
            if (runs_[static_cast<std::size_t>(root_of(run))].size >= min_size) continue;
            const Run& island = runs_[static_cast<std::size_t>(run)];
            std::fill(
                d + island.first, d + island.last + 1, std::numeric_limits<float>::quiet_NaN());
        }
    }
}

}  // namespace surefoot::stereo

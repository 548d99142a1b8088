// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/speckles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/assert.hpp"
#include "surefoot/stereo/row_blocks.hpp"

namespace surefoot::stereo {
namespace {

// In the functions below, `at` returns the run with a given number.

template <typename At>
int root_of(const At& at, int run) {
    while (at(run).parent != run) {
        at(run).parent = at(at(run).parent).parent;
        run = at(run).parent;
    }
    return run;
}

/// Joins two islands. The smaller number becomes the root, so that roots do not depend on the order
/// of joining.
template <typename At>
void join(const At& at, int a, int b) {
    a = root_of(at, a);
    b = root_of(at, b);
    if (a == b) return;
    auto& low = at(std::min(a, b));
    auto& high = at(std::max(a, b));
    high.parent = std::min(a, b);
    low.size += high.size;
}

/// Numbers of the runs of a row, from `begin` to `end` (exclusive).
struct RowOfRuns {
    const float* disparity_px = nullptr;
    int begin = 0;
    int end = 0;
};

/// Joins the runs of a row with those of the row above where two pixels agree.
template <typename At>
void connect(const At& at, const RowOfRuns& above, const RowOfRuns& here, float same_px) {
    int upper = above.begin;
    int lower = here.begin;
    while (upper < above.end && lower < here.end) {
        const auto& a = at(upper);
        const auto& b = at(lower);
        const int first = std::max(a.first, b.first);
        const int last = std::min(a.last, b.last);
        int u = first;
        while (u <= last && !(std::abs(above.disparity_px[u] - here.disparity_px[u]) <= same_px))
            ++u;
        if (u <= last) join(at, upper, lower);
        (a.last < b.last ? upper : lower) += 1;
    }
}

}  // namespace

SpeckleFilter::Run& SpeckleFilter::at(int number) {
    constexpr int kPlace = (1 << kPlaceBits) - 1;
    return bands_[static_cast<std::size_t>(number >> kPlaceBits)]
        .runs[static_cast<std::size_t>(number & kPlace)];
}

SpeckleFilter::Band& SpeckleFilter::band_of(int v) {
    return bands_[static_cast<std::size_t>(v / kBandRows)];
}

/// Finds the islands of one band, independently of other bands.
void SpeckleFilter::find_islands(int first_row,
                                 int last_row,
                                 const Image<float>& disparity_px,
                                 float same_px) {
    Band& band = band_of(first_row);
    const auto found = [&] { return static_cast<int>(band.runs.size()); };
    band.runs.clear();
    band.row_first.assign(1, 0);
    RowOfRuns above;
    for (int v = first_row; v < last_row; ++v) {
        RowOfRuns here{disparity_px.row(v), found(), 0};
        band.in_row.find(here.disparity_px, disparity_px.width(), same_px);
        band.in_row.for_each([&](int first, int last) {
            band.runs.push_back({first, last, found(), last - first + 1});
        });
        here.end = found();
        band.row_first.push_back(here.end);
        Run* const runs = band.runs.data();
        connect([runs](int place) -> Run& { return runs[place]; }, above, here, same_px);
        above = here;
    }
    // A parent never comes after its run. So when the loop reaches a run, the parent already holds
    // the number of its root.
    const int number = first_row / kBandRows << kPlaceBits;
    for (int place = 0; place < found(); ++place) {
        Run& run = band.runs[static_cast<std::size_t>(place)];
        const bool is_root = run.parent == place;
        run.parent =
            is_root ? number + place : band.runs[static_cast<std::size_t>(run.parent)].parent;
    }
}

/// Joins islands between rows v - 1 and v.
void SpeckleFilter::join_over_border(int v, const Image<float>& disparity_px, float same_px) {
    const auto row = [&](int row_v) {
        const int band = row_v / kBandRows;
        const std::vector<int>& first = bands_[static_cast<std::size_t>(band)].row_first;
        const auto in_band = static_cast<std::size_t>(row_v - band * kBandRows);
        const int number = band << kPlaceBits;
        return RowOfRuns{
            disparity_px.row(row_v), number + first[in_band], number + first[in_band + 1]};
    };
    connect([this](int number) -> Run& { return at(number); }, row(v - 1), row(v), same_px);
}

void SpeckleFilter::remove_islands(int first_row,
                                   int last_row,
                                   int min_size,
                                   Image<float>& disparity_px) {
    const Band& band = band_of(first_row);
    int parent = -1;  // parent of the previous run; the next run often has the same parent
    bool small = false;
    for (int v = first_row; v < last_row; ++v) {
        float* const d = disparity_px.row(v);
        const auto row = static_cast<std::size_t>(v - first_row);
        for (int place = band.row_first[row]; place < band.row_first[row + 1]; ++place) {
            const Run& run = band.runs[static_cast<std::size_t>(place)];
            if (run.parent != parent) {
                parent = run.parent;
                small = island_size(parent) < min_size;
            }
            if (small)
                std::fill(d + run.first, d + run.last + 1, std::numeric_limits<float>::quiet_NaN());
        }
    }
}

/// Does not modify the tree, because bands call it in parallel.
int SpeckleFilter::island_size(int run) {
    while (at(run).parent != run) run = at(run).parent;
    return at(run).size;
}

void SpeckleFilter::remove(Executor& executor,
                           int min_size,
                           double same_px,
                           Image<float>& disparity_px) {
    const int height = disparity_px.height();
    SUREFOOT_ASSERT(disparity_px.width() < kMaxSide_px && height < kMaxSide_px);
    const auto limit = static_cast<float>(same_px);
    const auto bands = static_cast<std::size_t>((height + kBandRows - 1) / kBandRows);
    if (bands_.size() < bands) bands_.resize(bands);
    for_row_blocks<kBandRows>(executor, height, [&](int first, int last) {
        find_islands(first, last, disparity_px, limit);
    });
    for (int v = kBandRows; v < height; v += kBandRows) join_over_border(v, disparity_px, limit);
    for_row_blocks<kBandRows>(executor, height, [&](int first, int last) {
        remove_islands(first, last, min_size, disparity_px);
    });
}

}  // namespace surefoot::stereo

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/error_histogram.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/assert.hpp"

namespace surefoot::eval {
namespace {

/// Returns the lower end of every bin. Repeated multiplication gives the same result on every
/// machine.
using Edges = std::array<double, ErrorHistogram::kBins>;
Edges make_edges() {
    Edges edges{};
    double edge_m = ErrorHistogram::kFirstEdge_m;
    for (std::size_t bin = 1; bin < edges.size(); ++bin) {
        edges[bin] = edge_m;
        edge_m *= ErrorHistogram::kGrowth;
    }
    return edges;
}

const Edges& edges() {
    static const Edges all = make_edges();
    return all;
}

}  // namespace

void ErrorHistogram::add(double error_m) {
    if (std::isnan(error_m)) return;
    const auto after = std::upper_bound(edges().begin(), edges().end(), std::abs(error_m));
    add_count(static_cast<int>(after - edges().begin()) - 1, 1);
}

void ErrorHistogram::add_count(int bin, std::int64_t count) {
    SUREFOOT_ASSERT(bin >= 0 && bin < kBins);
    counts_[static_cast<std::size_t>(bin)] += count;
    count_ += count;
}

ErrorHistogram& ErrorHistogram::operator+=(const ErrorHistogram& other) {
    for (int bin = 0; bin < kBins; ++bin) add_count(bin, other.count_in(bin));
    return *this;
}

double ErrorHistogram::percentile(double fraction) const {
    SUREFOOT_ASSERT(fraction >= 0.0 && fraction <= 1.0);
    if (count_ == 0) return std::nan("");
    const double wanted = fraction * static_cast<double>(count_);
    double below = 0.0;
    for (std::size_t bin = 0; bin + 1 < counts_.size(); ++bin) {
        const auto here = static_cast<double>(counts_[bin]);
        if (here > 0.0 && below + here >= wanted) {
            const double share = (wanted - below) / here;
            return edges()[bin] + share * (edges()[bin + 1] - edges()[bin]);
        }
        below += here;
    }
    return edges().back();
}

}  // namespace surefoot::eval

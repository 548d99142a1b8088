// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace surefoot::eval {

/// Histogram of |error| [m], for percentiles over many maps without keeping every error. The upper
/// end of each bin is 1.1 times that of the previous bin: the resolution of `percentile`. Adding
/// histograms is exact and does not depend on the order.
class ErrorHistogram {
  public:
    /// First bin up to 0.1 mm, then 97 bins up to 1.04 m, then one bin for all larger errors.
    static constexpr int kBins = 99;
    static constexpr double kFirstEdge_m = 1e-4;
    static constexpr double kGrowth = 1.1;

    /// Ignores NaN.
    void add(double error_m);
    /// Adds `count` errors to `bin`, which must be in [0, kBins).
    void add_count(int bin, std::int64_t count);
    ErrorHistogram& operator+=(const ErrorHistogram& other);

    [[nodiscard]] std::int64_t count() const noexcept { return count_; }
    [[nodiscard]] std::int64_t count_in(int bin) const {
        return counts_[static_cast<std::size_t>(bin)];
    }
    /// Returns the |error| below which `fraction` (0 to 1) of all errors lie, linear within the
    /// bin; NaN without errors. An error in the last bin counts as the lower end of that bin.
    [[nodiscard]] double percentile(double fraction) const;

    friend bool operator==(const ErrorHistogram&, const ErrorHistogram&) = default;

  private:
    std::array<std::int64_t, kBins> counts_{};
    std::int64_t count_ = 0;
};

}  // namespace surefoot::eval

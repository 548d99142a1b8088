// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace surefoot::stairs {

/// Mean of the last observations of a quantity. Their errors change between observations, and some
/// are outliers in spite of a small stated sigma.
///
/// Inliers lie within three of their sigmas of the weighted median (weights 1 / sigma). The result
/// is the minimum-variance mean of the inliers. One outlier does not move it; five of thirty hardly
/// do. Unlike with ObservationWeight, its sigma can be below those of the observations. This sigma
/// is the larger one of propagated sigma and scatter, plus the shared error.
class RobustMean {
  public:
    static constexpr int kMostObservations = 31;

    struct Mean {
        double value = 0.0;
        double sigma = 0.0;
    };

    /// Precondition: `sigma` is positive. Beyond `most_observations` (at most kMostObservations)
    /// the oldest observation is dropped.
    void add(double value, double sigma, int most_observations);
    [[nodiscard]] bool empty() const { return count_ == 0; }
    /// `shared`: one sigma of the error common to all observations. NaN if empty.
    [[nodiscard]] Mean mean(double shared) const;

  private:
    struct Observation {
        double value = 0.0;
        double sigma = 0.0;
    };

    [[nodiscard]] double median() const;

    std::array<Observation, kMostObservations> observations_{};  ///< oldest first
    int count_ = 0;
};

}  // namespace surefoot::stairs

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace surefoot::stairs {

/// Mean of the last looks at a quantity whose errors change from look to look, and of which some
/// looks know nothing although they say so.
///
/// About the weighted median (weights 1 / sigma) those looks count that lie within three of their
/// sigmas, as they are sure: the mean of least variance. One bad look does not move it, and five in
/// thirty hardly do. Unlike ObservationWeight it is surer than its looks: its sigma is the larger
/// one of what theirs leave and of what their scatter leaves, with what all looks share beside it.
class RobustMean {
  public:
    static constexpr int kMostObservations = 31;

    struct Mean {
        double value = 0.0;
        double sigma = 0.0;
    };

    /// `sigma`: positive. Of more than `most_observations` (at most kMostObservations) the oldest
    /// is forgotten.
    void add(double value, double sigma, int most_observations);
    [[nodiscard]] bool empty() const { return count_ == 0; }
    /// `shared`: one sigma of the errors that all looks share. NaN of nothing.
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

// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace surefoot::stairs {

/// The weight of a new observation of a quantity, and the sigma of the mean. Observations of one
/// map are correlated: the map already contains the earlier ones, and wrong matches repeat. So a
/// mean is steadier than its observations, but not more certain:
/// - the mean counts at most as much as `most_observations` observations with the best sigma;
/// - its sigma is the best sigma, or the scatter of the observations if that is larger. A lower
///   sigma would need independent errors, and the errors of one map are not independent.
class ObservationWeight {
  public:
    /// Returns the gain: the fraction of `difference` by which the mean moves. `var`: variance of
    /// the observation; `difference`: observation minus mean.
    [[nodiscard]] double take(double var, double difference, double most_observations);
    /// Adds the variance of the drift between two observations.
    void drift(double var);
    [[nodiscard]] double sigma() const;
    /// Joins a second track of the same feature; the better of the two counts.
    void join(const ObservationWeight& other);

  private:
    bool empty_ = true;
    double mean_var_ =
        0.0;  ///< variance of the mean for independent errors; at least best_var_ / (most - 1)
    double best_var_ = 0.0;
    double scatter_var_ = 0.0;
};

}  // namespace surefoot::stairs

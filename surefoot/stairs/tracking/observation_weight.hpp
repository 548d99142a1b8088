// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace surefoot::stairs {

/// How much a look at a quantity counts against the looks before it, and how sure the mean of them
/// is. Looks at one map are not independent: each shows again what the ones before have put into
/// it, and wrong matches repeat themselves. So a mean is steadier than its looks, but no surer:
/// - it never counts for more than `most_observations` looks as good as the best one;
/// - its sigma is that of the best look, or the scatter of the looks where that is larger. A lower
///   one would need errors that change from look to look; those of one map hardly do.
class ObservationWeight {
  public:
    /// The share of the way from the mean to the look that the mean moves. `var`: of the look;
    /// `difference`: of the look from the mean.
    [[nodiscard]] double take(double var, double difference, double most_observations);
    /// What lies between two looks.
    void drift(double var);
    [[nodiscard]] double sigma() const;
    /// The other one is of the same thing: the better one of both counts.
    void join(const ObservationWeight& other);

  private:
    bool empty_ = true;
    double mean_var_ =
        0.0;  ///< as if looks were independent, but not below the best / most_observations
    double best_var_ = 0.0;
    double scatter_var_ = 0.0;
};

}  // namespace surefoot::stairs

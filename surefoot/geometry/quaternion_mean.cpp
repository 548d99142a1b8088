// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/quaternion_mean.hpp"

#include <Eigen/Eigenvalues>

#include "surefoot/core/assert.hpp"

namespace surefoot::geometry {

std::optional<Eigen::Quaterniond> quaternion_mean(std::span<const Eigen::Quaterniond> rotations,
                                                  std::span<const double> weights) {
    SUREFOOT_ASSERT(weights.empty() || weights.size() == rotations.size());
    Eigen::Matrix4d M = Eigen::Matrix4d::Zero();
    double total = 0.0;
    for (std::size_t i = 0; i < rotations.size(); ++i) {
        const double weight = weights.empty() ? 1.0 : weights[i];
        if (!(weight >= 0.0)) return std::nullopt;
        const Eigen::Vector4d q = rotations[i].normalized().coeffs();
        M += weight * q * q.transpose();  // eq. (12)
        total += weight;
    }
    if (!(total > 0.0) || !M.allFinite()) return std::nullopt;

    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(M / total);
    const Eigen::Vector4d& values = solver.eigenvalues();  // in ascending order; their sum is 1
    constexpr double kMinGap = 1e-9;
    if (!(values[3] - values[2] > kMinGap)) return std::nullopt;
    Eigen::Quaterniond mean(Eigen::Vector4d(solver.eigenvectors().col(3)));
    if (mean.w() < 0.0) mean.coeffs() = -mean.coeffs();
    return mean.normalized();
}

}  // namespace surefoot::geometry

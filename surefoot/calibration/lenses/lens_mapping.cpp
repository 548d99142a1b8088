// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/lenses/lens_mapping.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "surefoot/core/unknown.hpp"

namespace surefoot::calibration {
namespace {

/// Step of central differences. The image is linear in the first four parameters and almost linear
/// in the coefficients; a step of 1e-5 keeps ten digits.
constexpr double kStep = 1e-5;
constexpr int kColumns = 9;
constexpr int kRows = 7;

}  // namespace

std::optional<Eigen::Matrix2d> mapping_covariance_px2(LensKind kind,
                                                      const Eigen::VectorXd& parameters,
                                                      const Eigen::MatrixXd& covariance,
                                                      const Eigen::Vector2d& pixel) {
    const auto ray = camera::unproject(model_of(kind, parameters), pixel);
    if (!ray) return std::nullopt;
    Eigen::Matrix2Xd J(2, parameters.size());
    for (Eigen::Index i = 0; i < parameters.size(); ++i) {
        Eigen::VectorXd moved = parameters;
        moved[i] += kStep;
        const auto above = camera::project(model_of(kind, moved), *ray);
        moved[i] -= 2.0 * kStep;
        const auto below = camera::project(model_of(kind, moved), *ray);
        if (!above || !below) return std::nullopt;
        J.col(i) = (*above - *below) / (2.0 * kStep);
    }
    return Eigen::Matrix2d(J * covariance * J.transpose());
}

MappingSigmas mapping_sigmas_px(LensKind kind,
                                const Eigen::VectorXd& parameters,
                                const Eigen::MatrixXd& covariance,
                                ImageSize size) {
    std::vector<double> sigmas_px;
    for (int row = 0; row < kRows; ++row) {
        for (int column = 0; column < kColumns; ++column) {
            const Eigen::Vector2d pixel((size.width - 1) * column / (kColumns - 1.0),
                                        (size.height - 1) * row / (kRows - 1.0));
            const auto moved = mapping_covariance_px2(kind, parameters, covariance, pixel);
            if (!moved) continue;
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(*moved);
            sigmas_px.push_back(std::sqrt(axes.eigenvalues()[1]));
        }
    }
    if (sigmas_px.empty()) return {kNan, kNan};
    std::sort(sigmas_px.begin(), sigmas_px.end());
    return {sigmas_px[sigmas_px.size() / 2], sigmas_px.back()};
}

}  // namespace surefoot::calibration

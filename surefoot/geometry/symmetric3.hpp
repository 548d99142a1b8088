// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace surefoot::geometry {

/// Symmetric 3x3 matrix, for example a covariance.
struct Symmetric3 {
    double xx = 0.0;
    double xy = 0.0;
    double xz = 0.0;
    double yy = 0.0;
    double yz = 0.0;
    double zz = 0.0;

    [[nodiscard]] Eigen::Matrix3d matrix() const;
};

/// All eigenvalues in ascending order, with their unit eigenvectors as columns.
struct EigenSystem3 {
    Eigen::Vector3d values = Eigen::Vector3d::Zero();
    Eigen::Matrix3d vectors = Eigen::Matrix3d::Identity();
};

/// Cyclic Jacobi rotations (Golub and Van Loan, section 8.5): accurate for every finite matrix.
/// Uses plain IEEE arithmetic, so the bits are the same on every machine.
[[nodiscard]] EigenSystem3 eigen_system(const Symmetric3& m) noexcept;

/// The direction in which a cloud of points is thinnest.
struct SmallestAxis {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit vector; its sign is arbitrary
    double smallest = 0.0;                                 ///< eigenvalue of `direction`
    double middle = 0.0;                                   ///< the next larger eigenvalue
};

/// Returns the axis of the smallest eigenvalue of a finite positive semi-definite matrix. Uses
/// Jacobi only if the next eigenvalue is near. Axis error <= 1e-9 rad if the axis is unique.
[[nodiscard]] SmallestAxis smallest_axis(const Symmetric3& m) noexcept;

}  // namespace surefoot::geometry

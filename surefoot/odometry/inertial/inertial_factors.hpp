// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "surefoot/odometry/inertial/inertial_solver.hpp"

/// Parts of the least-squares problem of `inertial_solver`. Each part adds normal equations H step
/// = b. Order of the unknowns: previous state (15), present state (15), tilt (2).
namespace surefoot::odometry::inertial {

inline constexpr int kFrame = 15;  ///< unknowns of a frame, gravity excluded
inline constexpr int kAll = 2 * kFrame + 2;
inline constexpr int kPresent = kFrame;
inline constexpr int kSharedTilt = 2 * kFrame;
using VectorAll = Eigen::Matrix<double, kAll, 1>;
using MatrixAll = Eigen::Matrix<double, kAll, kAll>;

/// Inverse of a covariance or information matrix whose components have very different units. All
/// entries are NaN if the matrix is not positive definite.
template <int Size>
Eigen::Matrix<double, Size, Size> inverse_of(const Eigen::Matrix<double, Size, Size>& M) {
    using Square = Eigen::Matrix<double, Size, Size>;
    const Eigen::Matrix<double, Size, 1> scale = M.diagonal().cwiseSqrt().cwiseInverse();
    const Square scaled = scale.asDiagonal() * M * scale.asDiagonal();
    const Eigen::LLT<Square> llt(scaled);
    if (llt.info() != Eigen::Success) return Square::Constant(std::nan(""));
    const Square inverse = scale.asDiagonal() * llt.solve(Square::Identity()) * scale.asDiagonal();
    return 0.5 * (inverse + inverse.transpose());
}

/// Two states with a common gravity direction.
struct Pair {
    InertialState previous;
    InertialState present;
};

[[nodiscard]] Pair moved(const Pair& pair, const VectorAll& step);

struct Normal {
    MatrixAll H = MatrixAll::Zero();
    VectorAll b = VectorAll::Zero();
    double cost = 0.0;

    template <int Rows>
    void add(const Eigen::Matrix<double, Rows, 1>& residual,
             const Eigen::Matrix<double, Rows, kAll>& J,
             const Eigen::Matrix<double, Rows, Rows>& information) {
        const Eigen::Matrix<double, kAll, Rows> weighted = J.transpose() * information;
        H.noalias() += weighted * J;
        b.noalias() -= weighted * residual;
        cost += residual.dot(information * residual);
    }
};

/// Adds the belief about the previous frame as a prior.
void add_prior(const InertialState& mean, const Matrix17& information, const Pair& at, Normal& n);

/// Motion of the IMU from the previous to the present frame.
struct MotionFactor {
    const ImuMotion& motion;
    Matrix9 information;
    Vector6 bias_information;
    double gravity_m_s2;

    MotionFactor(const InertialModel& model, const ImuMotion& m)
        : motion(m), information(inverse_of<9>(m.covariance)), gravity_m_s2(model.gravity_m_s2) {
        const auto walked = [&](double density) { return 1.0 / (density * density * m.dt_s); };
        bias_information.head<3>().setConstant(walked(model.noise.gyro_walk_rad_s2_sqrt_hz));
        bias_information.tail<3>().setConstant(walked(model.noise.accel_walk_m_s3_sqrt_hz));
    }
    void add_to(const Pair& at, Normal& n) const;
    void add_bias_walk(const Pair& at, Normal& n) const;
};

/// Point observations of the present frame.
struct PointsFactor {
    const VisualEvidence& seen;
    const Pose& T_imu_camera;
    Matrix6 camera_by_imu = adjoint(T_imu_camera.inverse());
    std::vector<std::uint8_t> inlier = std::vector<std::uint8_t>(seen.matches.size());
    int inliers = 0;
    double residual_px = 0.0;

    void add_to(const Pair& at, Normal& n);
};

/// A pose of the present frame that is known from another source.
struct PoseFactor {
    const PoseEvidence& known;
    Matrix6 information = inverse_of<6>(known.covariance);

    void add_to(const Pair& at, Normal& n) const;
};

/// Placeholder for a frame without visual evidence.
struct NothingSeen {
    void add_to(const Pair&, Normal&) const {}
};

}  // namespace surefoot::odometry::inertial

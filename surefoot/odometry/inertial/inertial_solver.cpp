// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/inertial/inertial_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "surefoot/odometry/inertial/inertial_factors.hpp"

namespace surefoot::odometry {
namespace {

using inertial::inverse_of;
using inertial::kFrame;
using inertial::MatrixAll;
using inertial::MotionFactor;
using inertial::Normal;
using inertial::NothingSeen;
using inertial::Pair;
using inertial::PointsFactor;
using inertial::PoseFactor;
using inertial::VectorAll;

/// Returns the covariance of the present state and gravity after the previous state is
/// marginalised.
Matrix17 present_covariance(const MatrixAll& H) {
    const Eigen::Matrix<double, kFrame, kFrame> H_pp = H.topLeftCorner<kFrame, kFrame>();
    const Eigen::Matrix<double, kFrame, kInertialSize> H_pr =
        H.topRightCorner<kFrame, kInertialSize>();
    const Matrix17 information = H.bottomRightCorner<kInertialSize, kInertialSize>() -
                                 H_pr.transpose() * inverse_of<kFrame>(H_pp) * H_pr;
    return inverse_of<kInertialSize>(information);
}

/// Levenberg-Marquardt over both states; `Evidence` is any evidence about the present state.
template <typename Evidence>
class JointProblem {
  public:
    JointProblem(const InertialModel& model,
                 const InertialBelief& before,
                 const ImuMotion& motion,
                 Evidence& evidence)
        : before_(before),
          prior_(inverse_of<kInertialSize>(before.covariance)),
          motion_(model, motion),
          evidence_(evidence) {}

    [[nodiscard]] Normal at(const Pair& pair) {
        Normal normal;
        add_prior(before_.state, prior_, pair, normal);
        motion_.add_to(pair, normal);
        evidence_.add_to(pair, normal);
        return normal;
    }

    /// Minimises the cost, starting at `pair`. Returns false if a step is not finite.
    [[nodiscard]] bool minimise(int iterations, Pair& pair, Normal& normal) {
        normal = at(pair);
        double damping = 1e-9;
        for (int k = 0; k < iterations; ++k) {
            MatrixAll damped = normal.H;
            damped.diagonal() *= 1.0 + damping;
            const VectorAll step = damped.ldlt().solve(normal.b);
            if (!step.allFinite()) return false;
            const Pair trial = moved(pair, step);
            Normal next = at(trial);
            if (next.cost <= normal.cost) {
                const bool converged = normal.cost - next.cost <= 1e-10 * normal.cost;
                pair = trial;
                normal = next;
                damping *= 0.1;
                if (converged) break;
            } else {
                damping = std::max(damping, 1e-6) * 20.0;
                if (damping > 1e4) break;
            }
        }
        // Evaluates the evidence again, because it stores the last pair at which it was evaluated.
        normal = at(pair);
        return true;
    }

  private:
    const InertialBelief& before_;
    Matrix17 prior_;
    MotionFactor motion_;
    Evidence& evidence_;
};

InertialState predicted_state(const InertialModel& model,
                              const InertialState& i,
                              const ImuMotion& motion) {
    const double dt = motion.dt_s;
    const Eigen::Vector3d gravity = -model.gravity_m_s2 * i.up_odom();
    InertialState j = i;
    j.T_odom_imu.rotation = (i.T_odom_imu.rotation * motion.rotation_at(i.bias)).normalized();
    j.velocity_m_s += dt * gravity + i.T_odom_imu.rotation * motion.velocity_at(i.bias);
    j.T_odom_imu.translation_m += dt * i.velocity_m_s + 0.5 * dt * dt * gravity +
                                  i.T_odom_imu.rotation * motion.position_at(i.bias);
    return j;
}

template <typename Evidence>
InertialSolution solve(const InertialModel& model,
                       const InertialBelief& before,
                       const ImuMotion& motion,
                       const Pose& T_odom_imu_start,
                       int iterations,
                       Evidence& evidence) {
    Pair pair{before.state, predicted_state(model, before.state, motion)};
    pair.present.T_odom_imu = T_odom_imu_start;
    Normal normal;
    InertialSolution solution;
    if (!JointProblem(model, before, motion, evidence).minimise(iterations, pair, normal))
        return solution;
    solution.belief.state = pair.present;
    solution.belief.covariance = present_covariance(normal.H);
    solution.found = solution.belief.covariance.allFinite() && pair.present.T_odom_imu.all_finite();
    return solution;
}

}  // namespace

Eigen::Vector3d InertialState::up_odom() const {
    return R_odom_level * (exp_so3({tilt_rad.x(), tilt_rad.y(), 0.0}) * Eigen::Vector3d::UnitZ());
}

InertialState perturbed(const InertialState& state, const Vector17& delta) {
    InertialState result = state;
    result.T_odom_imu = perturbed(state.T_odom_imu, Vector6(delta.segment<6>(kPoseAt)));
    result.velocity_m_s += delta.segment<3>(kVelocityAt);
    result.bias.gyro_rad_s += delta.segment<3>(kGyroBiasAt);
    result.bias.accel_m_s2 += delta.segment<3>(kAccelBiasAt);
    result.tilt_rad += delta.segment<2>(kTiltAt);
    return result;
}

Vector17 difference(const InertialState& from, const InertialState& to) {
    Vector17 delta;
    delta << difference(from.T_odom_imu, to.T_odom_imu), to.velocity_m_s - from.velocity_m_s,
        to.bias.gyro_rad_s - from.bias.gyro_rad_s, to.bias.accel_m_s2 - from.bias.accel_m_s2,
        to.tilt_rad - from.tilt_rad;
    return delta;
}

InertialBelief predict(const InertialModel& model,
                       const InertialBelief& before,
                       const ImuMotion& motion) {
    // Nothing contradicts the prediction, so it is the minimum. Only the covariance must be
    // computed.
    const Pair pair{before.state, predicted_state(model, before.state, motion)};
    NothingSeen nothing;
    return {pair.present,
            present_covariance(JointProblem(model, before, motion, nothing).at(pair).H)};
}

InertialSolution fuse(const InertialModel& model,
                      const InertialBelief& before,
                      const ImuMotion& motion,
                      const VisualEvidence& seen,
                      const Pose& T_odom_camera_start) {
    PointsFactor points{seen, model.T_imu_camera};
    InertialSolution solution = solve(model,
                                      before,
                                      motion,
                                      T_odom_camera_start * model.T_imu_camera.inverse(),
                                      seen.config.iterations,
                                      points);
    solution.inlier = std::move(points.inlier);
    solution.inliers = points.inliers;
    solution.residual_px = points.residual_px;
    return solution;
}

InertialSolution fuse(const InertialModel& model,
                      const InertialBelief& before,
                      const ImuMotion& motion,
                      const PoseEvidence& known) {
    constexpr int kIterations = 8;  // enough, because the problem is nearly linear
    PoseFactor factor{known};
    return solve(model, before, motion, known.T_odom_imu, kIterations, factor);
}

InertialBelief with_vision_counted_once(const InertialBelief& belief,
                                        const Matrix6& visual_covariance) {
    InertialBelief result = belief;
    // Vision is part of the belief, so the difference normally has no negative direction. Robust
    // weights at two slightly different poses can cause a negative direction. The covariance in
    // such a direction stays unchanged.
    result.covariance.topLeftCorner<6, 6>() +=
        positive_part(visual_covariance - belief.covariance.topLeftCorner<6, 6>());
    return result;
}

Matrix6 positive_part(const Matrix6& symmetric) {
    const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(symmetric);
    return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
           eigen.eigenvectors().transpose();
}

Matrix6 carried_covariance(const Matrix6& covariance_ab, const Pose& T_b_c) {
    const Matrix6 J = adjoint(T_b_c.inverse());
    return J * covariance_ab * J.transpose();
}

}  // namespace surefoot::odometry

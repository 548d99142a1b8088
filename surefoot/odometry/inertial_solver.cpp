// SPDX-License-Identifier: Apache-2.0
// The unknowns of a frame are ordered (previous 15, present 15, tilt 2).
#include "surefoot/odometry/inertial_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace surefoot::odometry {
namespace {

constexpr int kFrame = 15;  ///< unknowns of a frame without gravity
constexpr int kAll = 2 * kFrame + 2;
constexpr int kPresent = kFrame;
constexpr int kSharedTilt = 2 * kFrame;
using VectorAll = Eigen::Matrix<double, kAll, 1>;
using MatrixAll = Eigen::Matrix<double, kAll, kAll>;

/// Inverse of a covariance or information whose components have very different units; not finite
/// when it has none.
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

/// Two states that share gravity.
struct Pair {
    InertialState previous;
    InertialState present;
};

Pair moved(const Pair& pair, const VectorAll& step) {
    Vector17 previous;
    Vector17 present;
    previous << step.head<kFrame>(), step.tail<2>();
    present << step.segment<kFrame>(kPresent), step.tail<2>();
    return {perturbed(pair.previous, previous), perturbed(pair.present, present)};
}

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

/// Of up_odom by the tilt.
Eigen::Matrix<double, 3, 2> up_by_tilt(const InertialState& state) {
    const Eigen::Vector3d tilt(state.tilt_rad.x(), state.tilt_rad.y(), 0.0);
    const Eigen::Matrix3d J = -(state.R_odom_level * exp_so3(tilt)).toRotationMatrix() *
                              skew(Eigen::Vector3d::UnitZ()) * right_jacobian_so3(tilt);
    return J.leftCols<2>();
}

/// The previous frame's belief.
void add_prior(const InertialState& mean, const Matrix17& information, const Pair& at, Normal& n) {
    const Vector17 error = difference(mean, at.previous);
    Eigen::Matrix<double, kInertialSize, kAll> J =
        Eigen::Matrix<double, kInertialSize, kAll>::Zero();
    J.topLeftCorner<kFrame, kFrame>().setIdentity();
    J.bottomRightCorner<2, 2>().setIdentity();
    J.topLeftCorner<3, 3>() =
        (mean.T_odom_imu.rotation.conjugate() * at.previous.T_odom_imu.rotation).toRotationMatrix();
    J.block<3, 3>(3, 3) = inverse_right_jacobian_so3(error.segment<3>(3));
    n.add<kInertialSize>(error, J, information);
}

/// The IMU's motion from the previous to the present frame.
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

void MotionFactor::add_to(const Pair& at, Normal& n) const {
    const InertialState& i = at.previous;
    const InertialState& j = at.present;
    const double dt = motion.dt_s;
    const Eigen::Matrix3d R_i_odom = i.T_odom_imu.R().transpose();
    const Eigen::Matrix3d R_i_j = R_i_odom * j.T_odom_imu.R();
    const Eigen::Vector3d lift = gravity_m_s2 * i.up_odom();  // minus gravity
    // Forster et al. 2017, (45)
    const Eigen::Vector3d turn = log_so3(motion.rotation_at(i.bias).conjugate() *
                                         i.T_odom_imu.rotation.conjugate() * j.T_odom_imu.rotation);
    const Eigen::Vector3d gain = R_i_odom * (j.velocity_m_s - i.velocity_m_s + dt * lift);
    const Eigen::Vector3d path =
        R_i_odom * (j.T_odom_imu.translation_m - i.T_odom_imu.translation_m - dt * i.velocity_m_s +
                    0.5 * dt * dt * lift);
    Vector9 residual;
    residual << turn, gain - motion.velocity_at(i.bias), path - motion.position_at(i.bias);

    Eigen::Matrix<double, 9, kAll> J = Eigen::Matrix<double, 9, kAll>::Zero();
    const Eigen::Matrix3d by_turn = inverse_right_jacobian_so3(turn);
    J.block<3, 3>(0, 3) = -by_turn * R_i_j.transpose();
    J.block<3, 3>(0, kPresent + 3) = by_turn;
    const Eigen::Vector3d corrected =
        motion.d_rotation_d_gyro * (i.bias.gyro_rad_s - motion.bias.gyro_rad_s);
    J.block<3, 3>(0, kGyroBiasAt) = -by_turn * exp_so3(turn).toRotationMatrix().transpose() *
                                    right_jacobian_so3(corrected) * motion.d_rotation_d_gyro;
    const Eigen::Matrix<double, 3, 2> by_tilt = gravity_m_s2 * R_i_odom * up_by_tilt(i);
    J.block<3, 3>(3, 3) = skew(gain);
    J.block<3, 3>(3, kVelocityAt) = -R_i_odom;
    J.block<3, 3>(3, kPresent + kVelocityAt) = R_i_odom;
    J.block<3, 3>(3, kGyroBiasAt) = -motion.d_velocity_d_gyro;
    J.block<3, 3>(3, kAccelBiasAt) = -motion.d_velocity_d_accel;
    J.block<3, 2>(3, kSharedTilt) = dt * by_tilt;
    J.block<3, 3>(6, 0) = -Eigen::Matrix3d::Identity();
    J.block<3, 3>(6, 3) = skew(path);
    J.block<3, 3>(6, kPresent) = R_i_j;
    J.block<3, 3>(6, kVelocityAt) = -dt * R_i_odom;
    J.block<3, 3>(6, kGyroBiasAt) = -motion.d_position_d_gyro;
    J.block<3, 3>(6, kAccelBiasAt) = -motion.d_position_d_accel;
    J.block<3, 2>(6, kSharedTilt) = 0.5 * dt * dt * by_tilt;
    n.add<9>(residual, J, information);
    add_bias_walk(at, n);
}

void MotionFactor::add_bias_walk(const Pair& at, Normal& n) const {
    Vector6 walk;
    walk << at.present.bias.gyro_rad_s - at.previous.bias.gyro_rad_s,
        at.present.bias.accel_m_s2 - at.previous.bias.accel_m_s2;
    for (int k = 0; k < 6; ++k) {
        const int before = kGyroBiasAt + k;
        const int after = kPresent + before;
        const double weight = bias_information[k];
        n.H(before, before) += weight;
        n.H(after, after) += weight;
        n.H(before, after) -= weight;
        n.H(after, before) -= weight;
        n.b[before] += weight * walk[k];
        n.b[after] -= weight * walk[k];
        n.cost += weight * walk[k] * walk[k];
    }
}

/// Adjoint: how a perturbation of T_a_b moves T_a_b * T_b_c.
Matrix6 carry(const Pose& T_b_c) {
    const Pose T_c_b = T_b_c.inverse();
    const Eigen::Matrix3d R = T_c_b.R();
    Matrix6 J = Matrix6::Zero();
    J.topLeftCorner<3, 3>() = R;
    J.topRightCorner<3, 3>() = skew(T_c_b.translation_m) * R;
    J.bottomRightCorner<3, 3>() = R;
    return J;
}

/// The points of the present frame.
struct PointsFactor {
    const VisualEvidence& seen;
    const Pose& T_imu_camera;
    Matrix6 camera_by_imu = carry(T_imu_camera);
    std::vector<std::uint8_t> inlier = std::vector<std::uint8_t>(seen.matches.size());
    int inliers = 0;
    double residual_px = 0.0;

    void add_to(const Pair& at, Normal& n) {
        const Pose T_odom_camera = at.present.T_odom_imu * T_imu_camera;
        const VisualNormalEquations v = visual_normal_equations(
            seen.rig, seen.config, seen.matches, T_odom_camera, seen.config.gate_sigmas, inlier);
        const double weight = 1.0 / (seen.residual_scale * seen.residual_scale);
        const Matrix6 J_weighted = weight * camera_by_imu.transpose();
        n.H.block<6, 6>(kPresent, kPresent).noalias() += J_weighted * v.H * camera_by_imu;
        n.b.segment<6>(kPresent).noalias() += J_weighted * v.b;
        n.cost += weight * v.cost;
        inliers = v.inliers;
        residual_px = std::sqrt(v.square_px / (2.0 * std::max(v.inliers, 1)));
    }
};

struct PoseFactor {
    const PoseEvidence& known;
    Matrix6 information = inverse_of<6>(known.covariance);

    void add_to(const Pair& at, Normal& n) const {
        const Vector6 error = difference(known.T_odom_imu, at.present.T_odom_imu);
        Eigen::Matrix<double, 6, kAll> J = Eigen::Matrix<double, 6, kAll>::Zero();
        J.block<3, 3>(0, kPresent) =
            (known.T_odom_imu.rotation.conjugate() * at.present.T_odom_imu.rotation)
                .toRotationMatrix();
        J.block<3, 3>(3, kPresent + 3) = inverse_right_jacobian_so3(error.tail<3>());
        n.add<6>(error, J, information);
        if (!known.standing_sigma_m_s) return;
        const double weight = 1.0 / (*known.standing_sigma_m_s * *known.standing_sigma_m_s);
        const Eigen::Vector3d& velocity = at.present.velocity_m_s;
        constexpr int kAt = kPresent + kVelocityAt;
        n.H.diagonal().segment<3>(kAt).array() += weight;
        n.b.segment<3>(kAt) -= weight * velocity;
        n.cost += weight * velocity.squaredNorm();
    }
};

struct NothingSeen {
    void add_to(const Pair&, Normal&) const {}
};

/// Covariance of the present state and gravity after the previous state is marginalised.
Matrix17 present_covariance(const MatrixAll& H) {
    const Eigen::Matrix<double, kFrame, kFrame> H_pp = H.topLeftCorner<kFrame, kFrame>();
    const Eigen::Matrix<double, kFrame, kInertialSize> H_pr =
        H.topRightCorner<kFrame, kInertialSize>();
    const Matrix17 information = H.bottomRightCorner<kInertialSize, kInertialSize>() -
                                 H_pr.transpose() * inverse_of<kFrame>(H_pp) * H_pr;
    return inverse_of<kInertialSize>(information);
}

/// Levenberg-Marquardt over both states with any evidence about the present one.
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

    /// The minimum from `pair` on; false when a step is not finite.
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
        // The evidence remembers the last pair it was asked about.
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
    // Nothing contradicts the prediction: it is the minimum, and only the covariance is to be
    // found.
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
    constexpr int kIterations = 8;  // all but linear
    PoseFactor factor{known};
    return solve(model, before, motion, known.T_odom_imu, kIterations, factor);
}

InertialBelief with_vision_counted_once(const InertialBelief& belief,
                                        const Matrix6& visual_covariance) {
    InertialBelief result = belief;
    const Matrix6 shared = visual_covariance - belief.covariance.topLeftCorner<6, 6>();
    // Vision is part of the belief, so that the difference has no negative direction, but for
    // robust weights at two slightly different poses: those directions stay as they are.
    const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(shared);
    result.covariance.topLeftCorner<6, 6>() += eigen.eigenvectors() *
                                               eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
                                               eigen.eigenvectors().transpose();
    return result;
}

Matrix6 carried_covariance(const Matrix6& covariance_ab, const Pose& T_b_c) {
    const Matrix6 J = carry(T_b_c);
    return J * covariance_ab * J.transpose();
}

}  // namespace surefoot::odometry

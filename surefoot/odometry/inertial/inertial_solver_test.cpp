// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/inertial/inertial_solver.hpp"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/odometry/synthetic_testing.hpp"

namespace surefoot::odometry {
namespace {

constexpr double kRate_hz = 200.0;
constexpr double kFrame_s = 0.05;

InertialModel test_model() {
    InertialModel model;
    model.T_imu_camera = {exp_so3({-1.2, 1.1, -1.3}), {0.05, -0.08, 0.02}};
    return model;
}

Eigen::Vector3d random3(Rng& rng, double sigma) {
    const double x = rng.normal();
    const double y = rng.normal();
    return sigma * Eigen::Vector3d(x, y, rng.normal());
}

/// Error-free readings of a machine that swings and turns, for up to `seconds`.
std::vector<ImuSample> clean_samples(double seconds) {
    std::vector<ImuSample> samples;
    const int n = static_cast<int>(seconds * kRate_hz) + 2;
    samples.reserve(static_cast<std::size_t>(n));
    for (int k = 0; k < n; ++k) {
        const double t = k / kRate_hz;
        samples.push_back(
            {ns_from_seconds(t),
             {0.5 * std::sin(3.0 * t), 0.4 * std::cos(2.1 * t), 0.3 * std::sin(1.3 * t + 1.0)},
             {0.8 * std::cos(4.0 * t), 1.0 * std::sin(2.7 * t), 9.8 + 1.2 * std::cos(5.0 * t)}});
    }
    return samples;
}

void spoil(std::vector<ImuSample>& samples, const ImuNoise& noise, const ImuBias& bias, Rng& rng) {
    for (ImuSample& s : samples) {
        s.angular_velocity_rad_s += bias.gyro_rad_s;
        s.angular_velocity_rad_s +=
            random3(rng, noise.gyro_density_rad_s_sqrt_hz * std::sqrt(kRate_hz));
        s.specific_force_m_s2 += bias.accel_m_s2;
        s.specific_force_m_s2 +=
            random3(rng, noise.accel_density_m_s2_sqrt_hz * std::sqrt(kRate_hz));
    }
}

ImuMotion motion_of(const std::vector<ImuSample>& samples,
                    int frame,
                    const ImuNoise& noise,
                    const ImuBias& bias) {
    const auto result = preintegrate({},
                                     noise,
                                     samples,
                                     ns_from_seconds(frame * kFrame_s),
                                     ns_from_seconds((frame + 1) * kFrame_s),
                                     bias);
    EXPECT_EQ(result.problem, ImuProblem::none);
    return result.motion;
}

/// Final state of a machine after error-free readings; its own sensor's biases stay.
InertialState moved_by(const InertialState& truth, const ImuMotion& clean) {
    Matrix17 any = Matrix17::Identity();
    InertialState unbiased = truth;
    unbiased.bias = {};
    InertialState after = predict(test_model(), {unbiased, any}, clean).state;
    after.bias = truth.bias;
    return after;
}

/// Landmarks that a camera at the pose observes with this noise.
std::vector<PointMatch> points_seen(const Pose& T_odom_camera,
                                    int count,
                                    double sigma_px,
                                    Rng& rng) {
    std::vector<PointMatch> matches(static_cast<std::size_t>(count));
    for (PointMatch& match : matches) {
        const double z_m = rng.uniform(0.8, 5.0);
        const double x_m = rng.uniform(-0.8, 0.8) * z_m;
        const Eigen::Vector3d p(x_m, rng.uniform(-0.45, 0.45) * z_m, z_m);
        match.p_world_m = T_odom_camera * p;
        match.pixel_px = project_stereo(testing::rectified_rig(), p) + random3(rng, sigma_px);
    }
    return matches;
}

Vector17 usual_sigmas() {
    Vector17 sigma;
    sigma << 1e-3, 2e-3, 1e-3, 1e-3, 1e-3, 2e-3,  // pose
        0.05, 0.04, 0.05,                         // velocity
        5e-3, 4e-3, 5e-3,                         // gyroscope
        0.1, 0.1, 0.08,                           // accelerometer
        0.02, 0.02;                               // tilt
    return sigma;
}

/// A previous belief with errors, a noisy motion, and points.
struct TwoFrames {
    InertialModel model = test_model();
    camera::RectifiedRig rig = testing::rectified_rig();
    PoseSolverConfig config;
    InertialState truth;
    InertialBelief before;
    ImuMotion motion;
    InertialState truth_after;
    std::vector<PointMatch> matches;

    explicit TwoFrames(std::uint64_t seed, int points = 40) {
        Rng rng(seed);
        truth.T_odom_imu = {exp_so3(random3(rng, 0.8)), random3(rng, 1.0)};
        truth.velocity_m_s = random3(rng, 0.4);
        truth.bias = {random3(rng, 0.01), random3(rng, 0.1)};
        truth.R_odom_level = exp_so3(random3(rng, 0.5));
        truth.tilt_rad = {0.03, -0.02};
        // Correlated, as real beliefs are.
        Matrix17 mix;
        for (int k = 0; k < mix.size(); ++k) mix(k) = 0.2 * rng.normal();
        mix += Matrix17::Identity();
        const Matrix17 root = usual_sigmas().asDiagonal() * mix;
        before.covariance = root * root.transpose();
        Vector17 unit;
        for (int k = 0; k < kInertialSize; ++k) unit[k] = rng.normal();
        before.state = perturbed(truth, root * unit);
        auto samples = clean_samples(0.2);
        truth_after = moved_by(truth, motion_of(samples, 1, model.noise, {}));
        spoil(samples, model.noise, truth.bias, rng);
        motion = motion_of(samples, 1, model.noise, before.state.bias);
        config.sigma_px = 0.5;
        matches = points_seen(truth_after.T_odom_imu * model.T_imu_camera, points, 0.5, rng);
    }
    [[nodiscard]] InertialSolution solved() const {
        const Pose T_start = truth_after.T_odom_imu * model.T_imu_camera;
        return fuse(model, before, motion, {rig, config, matches}, T_start);
    }
};

using Vector32 = Eigen::Matrix<double, 32, 1>;

/// The two states, offset from fixed states: (previous 15, present 15, tilt 2).
struct Offset {
    InertialState previous;
    InertialState present;

    Offset(const InertialState& i, const InertialState& j, const double* x) {
        const Eigen::Map<const Vector32> step(x);
        Vector17 a;
        Vector17 b;
        a << step.head<15>(), step.tail<2>();
        b << step.segment<15>(15), step.tail<2>();
        previous = perturbed(i, a);
        present = perturbed(j, b);
    }
};

/// Residuals of the previous belief and the IMU, whitened: 17 + 9 + 6.
struct ImuCost {
    const TwoFrames& f;
    const InertialState& i0;
    const InertialState& j0;

    bool operator()(const double* x, double* residual) const {
        const Offset at(i0, j0, x);
        const InertialState& i = at.previous;
        const InertialState& j = at.present;
        Eigen::Map<Vector32> r(residual);
        r.head<17>() = f.before.covariance.llt().matrixL().solve(difference(f.before.state, i));
        // Gravity and the definition of ImuMotion, written independently of the solver.
        const double dt = f.motion.dt_s;
        const Eigen::Vector3d g = -f.model.gravity_m_s2 *
                                  (i.R_odom_level * exp_so3({i.tilt_rad.x(), i.tilt_rad.y(), 0.0}))
                                      .toRotationMatrix()
                                      .col(2);
        const Eigen::Quaterniond R = i.T_odom_imu.rotation;
        const Eigen::Vector3d v = i.velocity_m_s + g * dt + R * f.motion.velocity_at(i.bias);
        const Eigen::Vector3d p = i.T_odom_imu.translation_m + i.velocity_m_s * dt +
                                  0.5 * g * dt * dt + R * f.motion.position_at(i.bias);
        Vector9 e;
        e << log_so3((R * f.motion.rotation_at(i.bias)).conjugate() * j.T_odom_imu.rotation),
            R.conjugate() * (j.velocity_m_s - v), R.conjugate() * (j.T_odom_imu.translation_m - p);
        r.segment<9>(17) = f.motion.covariance.llt().matrixL().solve(e);
        const double root_dt = std::sqrt(dt);
        r.segment<3>(26) = (j.bias.gyro_rad_s - i.bias.gyro_rad_s) /
                           (f.model.noise.gyro_walk_rad_s2_sqrt_hz * root_dt);
        r.tail<3>() = (j.bias.accel_m_s2 - i.bias.accel_m_s2) /
                      (f.model.noise.accel_walk_m_s3_sqrt_hz * root_dt);
        return true;
    }
};

struct PointCost {
    const TwoFrames& f;
    const PointMatch& match;
    const InertialState& i0;
    const InertialState& j0;

    bool operator()(const double* x, double* residual) const {
        const Offset at(i0, j0, x);
        const Pose T = at.present.T_odom_imu * f.model.T_imu_camera;
        Eigen::Map<Eigen::Vector3d> r(residual);
        r = (match.pixel_px - project_stereo(f.rig, T.inverse() * match.p_world_m)) /
            f.config.sigma_px;
        return true;
    }
};

/// Offset of Ceres' minimum from our minimum, and Ceres' covariance of (present, tilt).
Vector32 offset_of_ceres(const TwoFrames& f, const InertialSolution& ours, Matrix17& covariance) {
    // Our previous state is marginalised, so the start is its belief.
    const InertialState& i0 = f.before.state;
    InertialState j0 = ours.belief.state;
    j0.tilt_rad = i0.tilt_rad;  // shared unknown: its offset is relative to the belief
    Vector32 x = Vector32::Zero();
    ceres::Problem problem;
    problem.AddResidualBlock(
        new ceres::NumericDiffCostFunction<ImuCost, ceres::CENTRAL, 32, 32>(new ImuCost{f, i0, j0}),
        nullptr,
        x.data());
    for (std::size_t k = 0; k < f.matches.size(); ++k)
        if (ours.inlier[k] != 0)
            problem.AddResidualBlock(
                new ceres::NumericDiffCostFunction<PointCost, ceres::CENTRAL, 3, 32>(
                    new PointCost{f, f.matches[k], i0, j0}),
                new ceres::HuberLoss(f.config.huber_sigmas),
                x.data());
    ceres::Solver::Options options;
    options.function_tolerance = 1e-16;
    options.parameter_tolerance = 1e-14;
    options.gradient_tolerance = 1e-14;
    options.max_num_iterations = 200;
    options.linear_solver_type = ceres::DENSE_QR;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    ceres::Covariance estimator(ceres::Covariance::Options{});
    Eigen::Matrix<double, 32, 32, Eigen::RowMajor> all;
    const std::vector<std::pair<const double*, const double*>> block = {{x.data(), x.data()}};
    EXPECT_TRUE(estimator.Compute(block, &problem));
    estimator.GetCovarianceBlock(x.data(), x.data(), all.data());
    covariance = all.bottomRightCorner<17, 17>();
    return x;
}

TEST(InertialSolver, AgreesWithCeres) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        TwoFrames f(100 + seed);
        f.config.iterations = 60;
        const auto ours = f.solved();
        ASSERT_TRUE(ours.found);
        ASSERT_GT(ours.inliers, 30);
        Matrix17 covariance;
        const Vector32 x = offset_of_ceres(f, ours, covariance);
        Vector17 off = x.tail<17>();  // present and tilt
        off.tail<2>() -= ours.belief.state.tilt_rad - f.before.state.tilt_rad;
        EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-6) << off.transpose();
    }
}

/// Without Huber weights the covariance equals that of the same least-squares problem.
TEST(InertialSolver, CovarianceIsThatOfCeres) {
    TwoFrames f(7);
    f.config.huber_sigmas = f.config.gate_sigmas = 20.0;
    f.config.iterations = 60;
    const auto ours = f.solved();
    ASSERT_TRUE(ours.found);
    Matrix17 theirs;
    offset_of_ceres(f, ours, theirs);
    const Vector17 scale = theirs.diagonal().cwiseSqrt().cwiseInverse();
    const Matrix17 off =
        scale.asDiagonal() * (ours.belief.covariance - theirs) * scale.asDiagonal();
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-4) << off;
}

/// Many runs of thirty frames, each with new points. The error must match the covariance, for all
/// seventeen components and for the pose, after vision and after half a second without vision.
TEST(InertialSolver, BeliefsAreHonest) {
    constexpr int kRuns = 120;
    constexpr int kSeen = 30;
    constexpr int kBlind = 10;
    const auto clean = clean_samples((kSeen + kBlind + 1) * kFrame_s);
    const InertialModel model = test_model();
    double nees_seen = 0.0;
    double nees_blind = 0.0;
    double nees_blind_pose = 0.0;
    for (int run = 0; run < kRuns; ++run) {
        Rng rng(5000 + static_cast<std::uint64_t>(run));
        InertialState truth;
        truth.bias = {random3(rng, 5e-3), random3(rng, 0.1)};
        truth.tilt_rad = random3(rng, 0.02).head<2>();
        InertialBelief belief;
        belief.covariance = usual_sigmas().cwiseAbs2().asDiagonal();
        Vector17 wrong;
        for (int k = 0; k < kInertialSize; ++k) wrong[k] = usual_sigmas()[k] * rng.normal();
        belief.state = perturbed(truth, wrong);
        auto samples = clean;
        spoil(samples, model.noise, truth.bias, rng);
        PoseSolverConfig config;
        config.sigma_px = 0.4;
        const auto rig = testing::rectified_rig();
        for (int frame = 0; frame < kSeen + kBlind; ++frame) {
            truth = moved_by(truth, motion_of(clean, frame, model.noise, {}));
            const ImuMotion motion = motion_of(samples, frame, model.noise, belief.state.bias);
            if (frame < kSeen) {
                const auto matches =
                    points_seen(truth.T_odom_imu * model.T_imu_camera, 30, 0.4, rng);
                const auto solution = fuse(model,
                                           belief,
                                           motion,
                                           {rig, config, matches},
                                           truth.T_odom_imu * model.T_imu_camera);
                ASSERT_TRUE(solution.found);
                belief = solution.belief;
            } else {
                belief = predict(model, belief, motion);
            }
            const Vector17 error = difference(belief.state, truth);
            const double nees = error.dot(belief.covariance.llt().solve(error));
            if (frame == kSeen - 1) nees_seen += nees / kRuns;
            if (frame == kSeen + kBlind - 1) {
                nees_blind += nees / kRuns;
                const Vector6 pose = error.head<6>();
                nees_blind_pose +=
                    pose.dot(belief.covariance.topLeftCorner<6, 6>().llt().solve(pose)) / kRuns;
            }
        }
    }
    std::printf("NEES of 17: seen %.1f, blind %.1f; of 6 blind: %.1f\n",
                nees_seen,
                nees_blind,
                nees_blind_pose);
    // The mean of 120 runs scatters by 0.53. It may lie below 17, because the random walk of the
    // model does not occur. It may lie above 17, because Huber's weights expect more noise than
    // there is.
    EXPECT_NEAR(nees_seen, 17.0, 2.5);
    EXPECT_NEAR(nees_blind, 17.0, 2.5);
    EXPECT_NEAR(nees_blind_pose, 6.0, 1.2);
}

/// A pose with the information of the points is as good as the points, except for robust weights.
TEST(InertialSolver, APoseWithItsCovarianceIsAsGoodAsItsPoints) {
    TwoFrames f(21, 60);
    f.config.huber_sigmas = f.config.gate_sigmas = 20.0;
    f.config.iterations = 60;
    const Pose T_start = f.truth_after.T_odom_imu * f.model.T_imu_camera;
    const auto visual = refine_pose(f.rig, f.config, f.matches, T_start);
    ASSERT_TRUE(visual.found);
    const Pose T_camera_imu = f.model.T_imu_camera.inverse();
    const double scale = std::max(visual.residual_scale, kMinResidualScale);
    const auto points =
        fuse(f.model, f.before, f.motion, {f.rig, f.config, f.matches, scale}, T_start);
    const auto pose = fuse(f.model,
                           f.before,
                           f.motion,
                           PoseEvidence{visual.T_world_camera * T_camera_imu,
                                        carried_covariance(visual.covariance, T_camera_imu),
                                        std::nullopt});
    ASSERT_TRUE(points.found && pose.found);
    const Vector17 sigma = points.belief.covariance.diagonal().cwiseSqrt();
    const Vector17 off = difference(points.belief.state, pose.belief.state).cwiseQuotient(sigma);
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 0.03) << off.transpose();
    const Matrix17 change = sigma.cwiseInverse().asDiagonal() *
                            (points.belief.covariance - pose.belief.covariance) *
                            sigma.cwiseInverse().asDiagonal();
    EXPECT_LT(change.cwiseAbs().maxCoeff(), 0.03);
}

TEST(InertialSolver, StandingShowsTheBiasOfTheGyroscope) {
    const InertialModel model = test_model();
    Rng rng(3);
    InertialState truth;
    truth.T_odom_imu = {exp_so3({0.3, -0.2, 0.9}), {0.1, 0.2, 0.3}};
    truth.bias = {{0.02, -0.03, 0.01}, Eigen::Vector3d::Zero()};
    std::vector<ImuSample> samples;
    samples.reserve(500);
    const Eigen::Vector3d lift =
        truth.T_odom_imu.rotation.conjugate() * Eigen::Vector3d(0.0, 0.0, model.gravity_m_s2);
    for (int k = 0; k < 500; ++k)
        samples.push_back({ns_from_seconds(k / kRate_hz), Eigen::Vector3d::Zero(), lift});
    spoil(samples, model.noise, truth.bias, rng);
    InertialBelief belief;
    belief.covariance = (3.0 * usual_sigmas()).cwiseAbs2().asDiagonal();
    belief.state.T_odom_imu = truth.T_odom_imu;
    Vector6 sigma_held;
    sigma_held << 2e-4, 2e-4, 2e-4, 1e-4, 1e-4, 1e-4;
    const Matrix6 held = sigma_held.cwiseAbs2().asDiagonal();
    for (int frame = 0; frame < 40; ++frame) {
        const auto solution = fuse(model,
                                   belief,
                                   motion_of(samples, frame, model.noise, belief.state.bias),
                                   PoseEvidence{truth.T_odom_imu, held, 5e-3});
        ASSERT_TRUE(solution.found);
        belief = solution.belief;
    }
    const Eigen::Vector3d off = belief.state.bias.gyro_rad_s - truth.bias.gyro_rad_s;
    const Eigen::Vector3d sigma = belief.covariance.diagonal().segment<3>(kGyroBiasAt).cwiseSqrt();
    EXPECT_LT(sigma.maxCoeff(), 1.5e-3);
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 3.0 * sigma.maxCoeff()) << off.transpose();
    EXPECT_LT(belief.state.velocity_m_s.norm(), 9e-3);  // 5 mm/s per frame were added
}

TEST(InertialSolver, SharedLandmarksKeepThePoseAsUnsureAsOneFrame) {
    const TwoFrames f(9);
    const auto solution = f.solved();
    ASSERT_TRUE(solution.found);
    const Matrix6 vision =
        4.0 * solution.belief.covariance.topLeftCorner<6, 6>();  // less certain than both together
    const auto kept = with_vision_counted_once(solution.belief, vision);
    EXPECT_LT((kept.covariance.topLeftCorner<6, 6>() - vision).norm(), 1e-9 * vision.norm());
    Matrix17 change = kept.covariance - solution.belief.covariance;
    change.topLeftCorner<6, 6>().setZero();
    EXPECT_EQ(change.norm(), 0.0);
    // More certain vision removes nothing.
    const auto same = with_vision_counted_once(solution.belief, 0.01 * vision);
    EXPECT_LT((same.covariance - solution.belief.covariance).norm(), 1e-15);
}

TEST(InertialSolver, ABrokenBeliefGivesNoSolution) {
    TwoFrames f(11);
    f.before.covariance(3, 3) = -1.0;
    EXPECT_FALSE(f.solved().found);
    f.before.covariance.setZero();
    EXPECT_FALSE(f.solved().found);
}

}  // namespace
}  // namespace surefoot::odometry

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/bundle/board_bundle.hpp"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "surefoot/calibration/boards/disc_image.hpp"
#include "surefoot/calibration/boards/growing_image.hpp"
#include "surefoot/calibration/lenses/lens_projection.hpp"

namespace surefoot::calibration {
namespace {

constexpr int kPinhole = 12;  ///< block size of all pinhole kinds; unused parameters stay 0
constexpr int kFisheye = 8;

/// The denominator of the rational model can cancel its numerator. Views do not determine the
/// coefficients along that direction, so this prior keeps the coefficients near zero. For corner
/// noise of 0.15 px the prior has standard deviation 3. Coefficients of real lenses have this size
/// (Azure Kinect: numerator 0.5 -2.6 1.5, denominator 0.4 -2.5 1.4).
constexpr double kPriorWeight_px = 0.05;
constexpr double kRationalBound = 20.0;
/// Weight of missing image growth [px per unit of the growth at the centre]. A lack of 0.01 then
/// weighs as much as a residual of 0.05 px.
constexpr double kGrowthWeight_px = 5.0;
constexpr int kGrowthRounds = 4;
/// Largest cost of holding the growth, as a multiple of the variance of a coordinate: two sigma. A
/// larger cost means that boards in that image part contradict the limit.
constexpr double kMostObjection = 4.0;
constexpr std::array<int, 6> kRadial{4, 5, 8, 9, 10, 11};  ///< k1 k2 k3 k4 k5 k6

using PoseBlock = std::array<double, 6>;  ///< rotation vector [rad], translation [m]

PoseBlock block_of(const Pose& T) {
    const Eigen::Vector3d w = log_so3(T.rotation);
    const Eigen::Vector3d& t = T.translation_m;
    return {w.x(), w.y(), w.z(), t.x(), t.y(), t.z()};
}

Pose pose_of(const PoseBlock& b) {
    return {exp_so3({b[0], b[1], b[2]}), {b[3], b[4], b[5]}};
}

template <typename T>
void transform(const T* pose, const T* p, T* result) {
    ceres::AngleAxisRotatePoint(pose, p, result);
    for (int i = 0; i < 3; ++i) result[i] += pose[3 + i];
}

template <typename T>
void transform_inverse(const T* pose, const T* p, T* result) {
    const T back[3] = {-pose[0], -pose[1], -pose[2]};
    const T shifted[3] = {p[0] - pose[3], p[1] - pose[4], p[2] - pose[5]};
    ceres::AngleAxisRotatePoint(back, shifted, result);
}

/// Reprojection error of one sight in the left or right image. The sight is a point, or a disc if
/// `disc_radius_m` is above 0.
template <bool kIsFisheye>
struct Reprojection {
    Eigen::Vector3d point;
    Eigen::Vector2d pixel;
    double disc_radius_m = 0.0;

    template <typename T>
    bool operator()(const T* lens, const T* T_left_board, T* residual) const {
        const auto seen = [&](const T* p_board, T* predicted) {
            T p[3];
            transform(T_left_board, p_board, p);
            return project(lens, p, predicted);
        };
        return compare(seen, residual);
    }

    template <typename T>
    bool operator()(const T* lens,
                    const T* T_left_right,
                    const T* T_left_board,
                    T* residual) const {
        const auto seen = [&](const T* p_board, T* predicted) {
            T p_left[3];
            T p[3];
            transform(T_left_board, p_board, p_left);
            transform_inverse(T_left_right, p_left, p);
            return project(lens, p, predicted);
        };
        return compare(seen, residual);
    }

    /// `seen` maps a board position into the image.
    template <typename T, typename Seen>
    bool compare(const Seen& seen, T* residual) const {
        const auto beside = [&](double x, double y, T* predicted) {
            const T p_board[3] = {
                T(point.x() + disc_radius_m * x), T(point.y() + disc_radius_m * y), T(point.z())};
            return seen(p_board, predicted);
        };
        T predicted[2];
        if (!(disc_radius_m > 0.0 ? disc_image<T>(beside, predicted) : beside(0.0, 0.0, predicted)))
            return false;
        residual[0] = pixel.x() - predicted[0];
        residual[1] = pixel.y() - predicted[1];
        return true;
    }

    template <typename T>
    static bool project(const T* lens, const T* p, T* predicted) {
        return kIsFisheye ? project_fisheye(lens, p, predicted)
                          : project_pinhole(lens, p, predicted);
    }
};

struct Prior {
    template <typename T>
    bool operator()(const T* lens, T* residual) const {
        for (const int i : kRadial) *residual++ = lens[i] * kPriorWeight_px;
        return true;
    }
};

template <bool kIsFisheye>
ceres::CostFunction* cost_of(const Sight& sight, double disc_radius_m) {
    constexpr int kLens = kIsFisheye ? kFisheye : kPinhole;
    using Functor = Reprojection<kIsFisheye>;
    // The cost function takes ownership of the functor.
    auto* functor = new Functor{sight.point_board_m, sight.pixel, disc_radius_m};
    if (sight.camera == 0) return new ceres::AutoDiffCostFunction<Functor, 2, kLens, 6>(functor);
    return new ceres::AutoDiffCostFunction<Functor, 2, kLens, 6, 6>(functor);
}

/// Returns the indices of the lens parameters that stay fixed.
std::vector<int> fixed_parameters(LensKind kind, Freedom freedom) {
    const int block = kind == LensKind::fisheye ? kFisheye : kPinhole;
    const int used = static_cast<int>(parameter_names(kind).size());
    const int moving = freedom == Freedom::focal ? 2 : freedom == Freedom::low_order ? 6 : used;
    std::vector<int> fixed;
    for (int i = moving; i < block; ++i) fixed.push_back(i);
    return fixed;
}

/// The Ceres problem, on copies of the bundle's values.
class Graph {
  public:
    Graph(const BoardBundle& bundle, const BundleOptions& options) : bundle_(bundle) {
        const bool fisheye = bundle.kind == LensKind::fisheye;
        for (const Eigen::VectorXd& lens : bundle.lenses) {
            lenses_.emplace_back().fill(0.0);
            for (int i = 0; i < lens.size(); ++i)
                lenses_.back()[static_cast<std::size_t>(i)] = lens[i];
        }
        T_left_right_ = block_of(bundle.T_left_right);
        for (const Pose& T : bundle.T_left_board) poses_.push_back(block_of(T));
        for (const Sight& sight : bundle.sights) {
            auto* cost = fisheye ? cost_of<true>(sight, bundle.disc_radius_m)
                                 : cost_of<false>(sight, bundle.disc_radius_m);
            auto* loss = options.huber_px > 0.0 ? new ceres::HuberLoss(options.huber_px) : nullptr;
            double* lens = lenses_[static_cast<std::size_t>(sight.camera)].data();
            double* pose = poses_[static_cast<std::size_t>(sight.view)].data();
            if (sight.camera == 0)
                problem_.AddResidualBlock(cost, loss, lens, pose);
            else
                problem_.AddResidualBlock(cost, loss, lens, T_left_right_.data(), pose);
        }
        for (Lens& lens : lenses_) set_freedom(lens.data(), options.freedom);
    }

    /// Adds a cost term for each lens whose image folds back before the image corners
    /// (growing_image.hpp). The next `run` then avoids this fold. Returns false if no lens needs
    /// the term.
    bool hold_growth() {
        bool turns_back = false;
        for (Lens& lens : lenses_) {
            turns_back =
                (bundle_.kind == LensKind::fisheye ? hold_growth_of<FisheyeGrowth>(lens)
                                                   : hold_growth_of<PinholeGrowth>(lens)) ||
                turns_back;
        }
        return turns_back;
    }

    /// Removes the distortion of the lenses, for a new start of `run`.
    void straighten() {
        for (Lens& lens : lenses_) std::fill(lens.begin() + 4, lens.end(), 0.0);
    }

    std::optional<double> run(const BundleOptions& options) {
        ceres::Solver::Options settings;
        // With fixed lenses, the second group can be empty, so the boards are not eliminated.
        const bool alone = options.freedom == Freedom::poses;
        settings.linear_solver_type = alone ? ceres::DENSE_QR : ceres::DENSE_SCHUR;
        settings.num_threads = 1;
        settings.max_num_iterations = options.max_iterations;
        settings.function_tolerance = options.tolerance;
        settings.parameter_tolerance = options.tolerance;
        settings.logging_type = ceres::SILENT;
        if (!alone) settings.linear_solver_ordering.reset(boards_first());
        ceres::Solver::Summary summary;
        ceres::Solve(settings, &problem_, &summary);
        if (!summary.IsSolutionUsable()) return std::nullopt;
        return summary.final_cost;
    }

    void store(BoardBundle& bundle) const {
        for (std::size_t i = 0; i < lenses_.size(); ++i) {
            for (int k = 0; k < bundle.lenses[i].size(); ++k)
                bundle.lenses[i][k] = lenses_[i][static_cast<std::size_t>(k)];
        }
        bundle.T_left_right = pose_of(T_left_right_);
        for (std::size_t i = 0; i < poses_.size(); ++i) bundle.T_left_board[i] = pose_of(poses_[i]);
    }

    /// Returns the covariance of the lenses and of the pose of the right camera, for residuals with
    /// a variance of 1 px^2. The coordinates are those of the parameter blocks.
    std::optional<Eigen::MatrixXd> covariance() {
        ceres::Covariance::Options settings;
        settings.algorithm_type = ceres::SPARSE_QR;
        settings.num_threads = 1;
        ceres::Covariance result(settings);
        std::vector<const double*> blocks;
        for (double* block : shared_blocks()) blocks.push_back(block);
        if (!result.Compute(blocks, &problem_)) return std::nullopt;
        int rows = 0;
        for (const double* block : blocks) rows += problem_.ParameterBlockSize(block);
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> all(rows, rows);
        if (!result.GetCovarianceMatrix(blocks, all.data())) return std::nullopt;
        return Eigen::MatrixXd(all);
    }

  private:
    using Lens = std::array<double, kPinhole>;

    template <typename Profile>
    bool hold_growth_of(Lens& lens) {
        const GrowthCheck check = check_growth<Profile>(lens.data(), bundle_.size);
        if (!check.turns_back) return false;
        using Lack = GrowthLack<Profile>;
        problem_.AddResidualBlock(
            new ceres::AutoDiffCostFunction<Lack, kGrowthPlaces, Profile::kParameters>(
                new Lack{check.places, kGrowthWeight_px}),
            nullptr,
            lens.data());
        return true;
    }

    /// Returns the order that eliminates the boards first. The solver takes ownership of the order.
    ceres::ParameterBlockOrdering* boards_first() {
        auto* order = new ceres::ParameterBlockOrdering;
        for (PoseBlock& pose : poses_)
            if (problem_.HasParameterBlock(pose.data())) order->AddElementToGroup(pose.data(), 0);
        for (double* block : shared_blocks()) order->AddElementToGroup(block, 1);
        return order;
    }

    std::vector<double*> shared_blocks() {
        std::vector<double*> blocks;
        for (Lens& lens : lenses_) blocks.push_back(lens.data());
        if (lenses_.size() > 1) blocks.push_back(T_left_right_.data());
        return blocks;
    }

    void set_freedom(double* lens, Freedom freedom) {
        if (freedom == Freedom::poses) {
            problem_.SetParameterBlockConstant(lens);
            return;
        }
        const std::vector<int> fixed = fixed_parameters(bundle_.kind, freedom);
        const int block = bundle_.kind == LensKind::fisheye ? kFisheye : kPinhole;
        if (!fixed.empty()) problem_.SetManifold(lens, new ceres::SubsetManifold(block, fixed));
        for (const int focal : {0, 1}) problem_.SetParameterLowerBound(lens, focal, 1.0);
        if (bundle_.kind != LensKind::rational || freedom != Freedom::everything) return;
        for (const int radial : kRadial) {
            problem_.SetParameterLowerBound(lens, radial, -kRationalBound);
            problem_.SetParameterUpperBound(lens, radial, kRationalBound);
        }
        problem_.AddResidualBlock(
            new ceres::AutoDiffCostFunction<Prior, 6, kPinhole>(new Prior), nullptr, lens);
    }

    const BoardBundle& bundle_;
    std::vector<Lens> lenses_;
    PoseBlock T_left_right_{};
    std::vector<PoseBlock> poses_;
    ceres::Problem problem_;
};

/// Returns the derivative of theta in R Exp(theta) by the rotation vector of R: the right Jacobian
/// of SO(3) (Sola et al. 2018, equation 143).
Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& w) {
    const double angle = w.norm();
    const Eigen::Matrix3d W = skew(w);
    if (angle < 1e-5) return Eigen::Matrix3d::Identity() - 0.5 * W;
    const double a = (1.0 - std::cos(angle)) / (angle * angle);
    const double b = (angle - std::sin(angle)) / (angle * angle * angle);
    return Eigen::Matrix3d::Identity() - a * W + b * W * W;
}

/// Adds the growth limit and runs the solver, until no lens image folds back or kGrowthRounds
/// rounds have passed. Returns the cost. Returns nullopt if no lens image folds back at the start,
/// or if the solver fails.
std::optional<double> run_held(Graph& graph, const BundleOptions& options) {
    std::optional<double> held;
    for (int round = 0; round < kGrowthRounds && graph.hold_growth(); ++round) {
        held = graph.run(options);
        if (!held) return held;
    }
    return held;
}

}  // namespace

std::optional<double> solve(BoardBundle& bundle, const BundleOptions& options) {
    Graph graph(bundle, options);
    const std::optional<double> cost = graph.run(options);
    if (!cost) return cost;
    graph.store(bundle);
    if (!options.hold_growth) return cost;
    // The cost is half the sum of squares of two residuals per sight, each with this variance.
    const double variance_px2 = *cost / static_cast<double>(bundle.sights.size());
    const double most = *cost + 0.5 * kMostObjection * variance_px2;
    std::optional<double> held = run_held(graph, options);
    // A lens that folds back may be beyond a pole of its profile. No step leads from there to a
    // growing image, so the solver starts again without distortion.
    if (held && *held > most) {
        graph.straighten();
        held = graph.run(options);
        if (held) held = run_held(graph, options).value_or(*held);
    }
    if (!held || *held > most) return cost;
    graph.store(bundle);
    return held;
}

namespace {

template <bool kIsFisheye>
std::vector<Eigen::Vector2d> residuals_of(const BoardBundle& bundle) {
    std::vector<std::array<double, kPinhole>> lenses(bundle.lenses.size());
    for (std::size_t i = 0; i < lenses.size(); ++i)
        std::copy(bundle.lenses[i].begin(), bundle.lenses[i].end(), lenses[i].begin());
    const Pose T_right_left = bundle.T_left_right.inverse();
    std::vector<Eigen::Vector2d> residuals;
    for (const Sight& sight : bundle.sights) {
        const Pose& T_left_board = bundle.T_left_board[static_cast<std::size_t>(sight.view)];
        const Pose T_camera_board = sight.camera == 1 ? T_right_left * T_left_board : T_left_board;
        const double* lens = lenses[static_cast<std::size_t>(sight.camera)].data();
        const Reprojection<kIsFisheye> sighting{
            sight.point_board_m, sight.pixel, bundle.disc_radius_m};
        const auto seen = [&](const double* p_board, double* predicted) {
            const Eigen::Vector3d p =
                T_camera_board * Eigen::Vector3d(p_board[0], p_board[1], p_board[2]);
            return sighting.project(lens, p.data(), predicted);
        };
        Eigen::Vector2d residual;
        if (!sighting.compare(seen, residual.data()))
            residual.setConstant(std::numeric_limits<double>::quiet_NaN());
        residuals.push_back(residual);
    }
    return residuals;
}

}  // namespace

std::vector<Eigen::Vector2d> residuals_px(const BoardBundle& bundle) {
    return bundle.kind == LensKind::fisheye ? residuals_of<true>(bundle)
                                            : residuals_of<false>(bundle);
}

std::optional<Eigen::MatrixXd> covariance(const BoardBundle& bundle, double sigma_px) {
    Graph graph(bundle, {});
    const std::optional<Eigen::MatrixXd> all = graph.covariance();
    if (!all) return std::nullopt;
    const Eigen::Index block = bundle.kind == LensKind::fisheye ? kFisheye : kPinhole;
    const Eigen::Index used = bundle.lenses.front().size();
    const auto lenses = static_cast<Eigen::Index>(bundle.lenses.size());
    const Eigen::Index pose = lenses > 1 ? 6 : 0;
    // Maps the blocks to the result. Unused lens parameters are dropped. The pose changes from
    // (rotation vector, translation) to (translation, rotation) in the right camera's frame.
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(lenses * used + pose, all->rows());
    for (Eigen::Index i = 0; i < lenses; ++i)
        J.block(i * used, i * block, used, used).setIdentity();
    if (pose > 0) {
        const Eigen::Index row = lenses * used;
        const Eigen::Index column = lenses * block;
        J.block<3, 3>(row, column + 3) = bundle.T_left_right.R().transpose();
        J.block<3, 3>(row + 3, column) = right_jacobian(log_so3(bundle.T_left_right.rotation));
    }
    return Eigen::MatrixXd(sigma_px * sigma_px * J * *all * J.transpose());
}

}  // namespace surefoot::calibration

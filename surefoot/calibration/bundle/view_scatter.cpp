// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/bundle/view_scatter.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace surefoot::calibration {
namespace {

constexpr double kStep = 1e-6;       ///< relative step of a coefficient or distance; step of an
                                     ///< angle [rad]
constexpr double kRankLimit = 1e-9;  ///< rank threshold of the QR decomposition, for columns of
                                     ///< length 1
constexpr int kPose = 6;

Pose moved(const Pose& T, int coordinate, double step) {
    Pose change;
    if (coordinate < 3)
        change.translation_m[coordinate] = step * std::max(1e-3, T.translation_m.norm());
    else
        change.rotation = exp_so3(step * Eigen::Vector3d::Unit(coordinate - 3));
    return T * change;
}

/// Returns the bundle after one step of a single parameter. The first six columns are the pose
/// coordinates of all boards; the other columns are shared parameters (lenses, right camera).
BoardBundle stepped(const BoardBundle& bundle, int column, double step) {
    BoardBundle there = bundle;
    if (column < kPose) {
        for (Pose& T : there.T_left_board) T = moved(T, column, step);
        return there;
    }
    int left = column - kPose;
    for (Eigen::VectorXd& lens : there.lenses) {
        const auto size = static_cast<int>(lens.size());
        if (left < size) {
            lens[left] += step * std::max(1.0, std::abs(lens[left]));
            return there;
        }
        left -= size;
    }
    there.T_left_right = moved(there.T_left_right, left, step);
    return there;
}

int columns_of(const BoardBundle& bundle) {
    const auto lenses = static_cast<int>(bundle.lenses.size());
    return kPose + lenses * static_cast<int>(bundle.lenses.front().size()) +
           (lenses > 1 ? kPose : 0);
}

/// Returns the Jacobian with one row per coordinate of a sight; the columns of the boards come
/// first. Entries without a derivative are zero.
Eigen::MatrixXd jacobian(const BoardBundle& bundle) {
    const auto rows = static_cast<Eigen::Index>(2 * bundle.sights.size());
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows, columns_of(bundle));
    for (int column = 0; column < J.cols(); ++column) {
        const auto ahead = residuals_px(stepped(bundle, column, kStep));
        const auto back = residuals_px(stepped(bundle, column, -kStep));
        for (std::size_t i = 0; i < ahead.size(); ++i) {
            const Eigen::Vector2d change = (ahead[i] - back[i]) / (2.0 * kStep);
            if (change.allFinite())
                J.block<2, 1>(2 * static_cast<Eigen::Index>(i), column) = change;
        }
    }
    return J;
}

/// Part of a vector's squared length that columns explain, and the rank of these columns.
struct Explained {
    double square = 0.0;
    double rank = 0.0;
};

Explained explained(Eigen::MatrixXd columns, const Eigen::VectorXd& r) {
    for (Eigen::Index i = 0; i < columns.cols(); ++i) {
        const double length = columns.col(i).norm();
        if (length > 0.0) columns.col(i) /= length;
    }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns.rows(), columns.cols());
    qr.setThreshold(kRankLimit);
    qr.compute(columns);
    const Eigen::VectorXd turned = qr.householderQ().adjoint() * r;
    return {turned.head(qr.rank()).squaredNorm(), static_cast<double>(qr.rank())};
}

}  // namespace

double between_views_sigma_px(const BoardBundle& bundle) {
    const std::vector<Eigen::Vector2d> residuals = residuals_px(bundle);
    const Eigen::MatrixXd all = jacobian(bundle);
    double square = 0.0;
    double freedom =
        -static_cast<double>(all.cols() - kPose);  // minus parameters of the common cameras
    int views = 0;
    for (std::size_t view = 0; view < bundle.T_left_board.size(); ++view) {
        std::vector<Eigen::Index> rows;
        for (std::size_t i = 0; i < bundle.sights.size(); ++i) {
            if (static_cast<std::size_t>(bundle.sights[i].view) != view) continue;
            if (!residuals[i].allFinite()) continue;
            rows.push_back(2 * static_cast<Eigen::Index>(i));
        }
        const auto count = static_cast<Eigen::Index>(rows.size());
        // With few sights, a separate camera per view would explain all residuals, also the noise.
        if (2 * count <= all.cols()) continue;
        Eigen::MatrixXd J(2 * count, all.cols());
        Eigen::VectorXd r(2 * count);
        for (Eigen::Index k = 0; k < count; ++k) {
            const Eigen::Index row = rows[static_cast<std::size_t>(k)];
            J.middleRows<2>(2 * k) = all.middleRows<2>(row);
            r.segment<2>(2 * k) = residuals[static_cast<std::size_t>(row / 2)];
        }
        const Explained own = explained(J, r);
        const Explained pose = explained(J.leftCols(kPose), r);
        square += own.square - pose.square;
        freedom += own.rank - pose.rank;
        ++views;
    }
    if (views < 2 || !(freedom > 0.0)) return std::numeric_limits<double>::quiet_NaN();
    return std::sqrt(std::max(0.0, square) / freedom);
}

double stated_sigma_px(const BoardBundle& bundle, double sigma_px) {
    const double between_px = between_views_sigma_px(bundle);
    return between_px > sigma_px ? between_px : sigma_px;
}

}  // namespace surefoot::calibration

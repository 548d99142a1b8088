// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/trajectory/trajectory.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::eval {
namespace {

constexpr double kShortestPath_m = 1e-3;

std::vector<std::size_t> order_by_time(const Trajectory& trajectory) {
    std::vector<std::size_t> order(trajectory.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return trajectory[a].time_ns < trajectory[b].time_ns;
    });
    return order;
}

struct Candidate {
    std::int64_t difference_ns;
    std::size_t estimate_rank;  // position of the estimated pose in time order
    std::size_t truth_rank;
    [[nodiscard]] auto key() const { return std::tuple(difference_ns, estimate_rank, truth_rank); }
};

/// Returns all pairs within the tolerance, ordered by the time of the estimated pose.
std::vector<Candidate> candidates_within(const Trajectory& estimate,
                                         const std::vector<std::size_t>& estimate_order,
                                         const Trajectory& truth,
                                         const std::vector<std::size_t>& truth_order,
                                         std::int64_t tolerance_ns) {
    std::vector<Candidate> candidates;
    std::size_t first = 0;
    for (std::size_t e = 0; e < estimate_order.size(); ++e) {
        const std::int64_t time_ns = estimate[estimate_order[e]].time_ns;
        const auto truth_time_ns = [&](std::size_t rank) {
            return truth[truth_order[rank]].time_ns;
        };
        while (first < truth_order.size() && truth_time_ns(first) < time_ns - tolerance_ns) ++first;
        for (std::size_t t = first;
             t < truth_order.size() && truth_time_ns(t) <= time_ns + tolerance_ns;
             ++t) {
            candidates.push_back({std::abs(truth_time_ns(t) - time_ns), e, t});
        }
    }
    return candidates;
}

Eigen::Matrix3d best_rotation(const Eigen::Matrix3d& covariance) {
    // Umeyama 1991 eq. 40-43: R = U S V^T with S = diag(1, 1, det U det V) against reflections.
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d signs(1.0, 1.0, 1.0);
    if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs.z() = -1.0;
    return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

Eigen::Matrix3Xd positions(const Trajectory& trajectory,
                           const std::vector<PosePair>& pairs,
                           std::size_t PosePair::*which) {
    Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(pairs.size()));
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        points.col(static_cast<Eigen::Index>(k)) =
            trajectory[pairs[k].*which].T_world_body.translation_m;
    }
    return points;
}

double rms(const std::vector<double>& values) {
    double sum_sq = 0.0;
    for (const double value : values) sum_sq += value * value;
    return std::sqrt(sum_sq / static_cast<double>(values.size()));
}

double path_length(const Eigen::Matrix3Xd& points_m) {
    double length_m = 0.0;
    for (Eigen::Index k = 1; k < points_m.cols(); ++k) {
        length_m += (points_m.col(k) - points_m.col(k - 1)).norm();
    }
    return length_m;
}

/// Returns the pair that ends an interval starting at pair `start`. For an interval of 0, this is
/// the next pair. Otherwise it is the pair nearest to the time `interval_ns` later; its time may
/// differ by half an interval. Returns nullopt for intervals that reach beyond the last pair:
/// shorter intervals would make the error look smaller.
std::optional<std::size_t> interval_end(const Trajectory& estimate,
                                        const std::vector<PosePair>& pairs,
                                        std::size_t start,
                                        std::int64_t interval_ns,
                                        std::int64_t tolerance_ns) {
    if (interval_ns <= 0) {
        return start + 1 < pairs.size() ? std::optional(start + 1) : std::nullopt;
    }
    const auto time_ns = [&](std::size_t k) { return estimate[pairs[k].estimate].time_ns; };
    const std::int64_t wanted_ns = time_ns(start) + interval_ns;
    if (wanted_ns > time_ns(pairs.size() - 1) + tolerance_ns) return std::nullopt;
    const auto from = pairs.begin() + static_cast<std::ptrdiff_t>(start) + 1;
    const auto after =
        std::lower_bound(from, pairs.end(), wanted_ns, [&](const PosePair& p, auto t) {
            return estimate[p.estimate].time_ns < t;
        });
    auto end = static_cast<std::size_t>(after - pairs.begin());
    const auto off_ns = [&](std::size_t k) { return std::abs(time_ns(k) - wanted_ns); };
    if (end > start + 1 && (end == pairs.size() || off_ns(end - 1) <= off_ns(end))) --end;
    if (end >= pairs.size() || off_ns(end) > interval_ns / 2) return std::nullopt;
    return end;
}

Result<void> check_finite(const Trajectory& trajectory, const char* name) {
    for (std::size_t k = 0; k < trajectory.size(); ++k) {
        if (trajectory[k].T_world_body.all_finite()) continue;
        return input_error(fmt::format(
            "eval trajectory: pose {} of the {} (time {:.6f} s) holds a value that is not a finite "
            "number; remove that line or compute the pose again",
            k,
            name,
            seconds_from_ns(trajectory[k].time_ns)));
    }
    return {};
}

std::string span_text(const Trajectory& trajectory) {
    if (trajectory.empty()) return "is empty";
    const auto [low, high] = std::minmax_element(
        trajectory.begin(), trajectory.end(), [](const StampedPose& a, const StampedPose& b) {
            return a.time_ns < b.time_ns;
        });
    return fmt::format("has {} poses from {:.3f} s to {:.3f} s",
                       trajectory.size(),
                       seconds_from_ns(low->time_ns),
                       seconds_from_ns(high->time_ns));
}

Error too_few(const Trajectory& estimate,
              const Trajectory& truth,
              std::size_t matched,
              std::size_t needed,
              double tolerance_s) {
    return input_error(
        fmt::format("eval trajectory: {} poses match within {:.0f} ms, at least {} are needed; the "
                    "estimate {}, "
                    "the truth {}: check that both use the same clock and overlap in time",
                    matched,
                    1e3 * tolerance_s,
                    needed,
                    span_text(estimate),
                    span_text(truth)));
}

Result<void> add_relative_errors(TrajectoryErrors& errors,
                                 const Trajectory& estimate,
                                 const Trajectory& truth,
                                 const EvalTrajectoryConfig& config) {
    const std::int64_t interval_ns = ns_from_seconds(config.rpe_interval_s);
    const std::int64_t tolerance_ns = ns_from_seconds(config.tolerance_s);
    std::vector<double> trans_m;
    std::vector<double> rot_deg;
    for (std::size_t start = 0; start < errors.pairs.size(); ++start) {
        const auto end = interval_end(estimate, errors.pairs, start, interval_ns, tolerance_ns);
        if (!end) continue;
        const Pose error = relative_error(estimate, truth, errors.pairs[start], errors.pairs[*end]);
        trans_m.push_back(error.translation_m.norm());
        rot_deg.push_back(kDegPerRad * log_so3(error.rotation).norm());
    }
    if (trans_m.empty()) {
        return input_error(
            fmt::format("eval trajectory: no two matched poses are {:g} s apart (a deviation of "
                        "half this time is allowed); choose rpe_interval_s shorter than the "
                        "recording, or 0 for successive poses",
                        config.rpe_interval_s));
    }
    errors.rpe_trans_rmse_m = rms(trans_m);
    errors.rpe_rot_rmse_deg = rms(rot_deg);
    return {};
}

}  // namespace

void EvalTrajectoryConfig::describe(ConfigVisitor& visitor) {
    static constexpr std::array<const char*, 3> kNames = {"se3", "yaw", "none"};
    visitor.enumeration(
        "align",
        align,
        kNames,
        "alignment of the estimate with the truth before positions are compared: se3 = rotation "
        "and shift, yaw = rotation about the vertical and shift, none = no alignment");
    visitor.number("tolerance_s",
                   tolerance_s,
                   0.0,
                   10.0,
                   "largest time difference between an estimated pose and the true pose that is "
                   "matched with it");
    visitor.number("rpe_interval_s",
                   rpe_interval_s,
                   0.0,
                   3600.0,
                   "time over which relative pose errors are computed; 0 = from each matched pose "
                   "to the next");
}

std::vector<PosePair> associate(const Trajectory& estimate,
                                const Trajectory& truth,
                                double tolerance_s) {
    const auto estimate_order = order_by_time(estimate);
    const auto truth_order = order_by_time(truth);
    auto candidates = candidates_within(
        estimate, estimate_order, truth, truth_order, ns_from_seconds(tolerance_s));
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        return a.key() < b.key();
    });
    std::vector<std::optional<std::size_t>> match(estimate_order.size());
    std::vector<bool> taken(truth_order.size(), false);
    for (const Candidate& candidate : candidates) {
        if (match[candidate.estimate_rank] || taken[candidate.truth_rank]) continue;
        match[candidate.estimate_rank] = candidate.truth_rank;
        taken[candidate.truth_rank] = true;
    }
    std::vector<PosePair> pairs;
    for (std::size_t rank = 0; rank < match.size(); ++rank) {
        if (match[rank]) pairs.push_back({estimate_order[rank], truth_order[*match[rank]]});
    }
    return pairs;
}

Pose align_positions(const Eigen::Matrix3Xd& estimate_m,
                     const Eigen::Matrix3Xd& truth_m,
                     Alignment align) {
    if (align == Alignment::none || estimate_m.cols() == 0) return {};
    const Eigen::Vector3d estimate_mean = estimate_m.rowwise().mean();
    const Eigen::Vector3d truth_mean = truth_m.rowwise().mean();
    const Eigen::Matrix3d covariance =
        (truth_m.colwise() - truth_mean) * (estimate_m.colwise() - estimate_mean).transpose();
    Pose T_truth_estimate;
    if (align == Alignment::se3) {
        T_truth_estimate.rotation = Eigen::Quaterniond(best_rotation(covariance)).normalized();
    } else {
        // Setting d/dyaw of sum |q - Rz(yaw) p|^2 to 0 leaves the in-plane cross and dot products.
        const double yaw =
            std::atan2(covariance(1, 0) - covariance(0, 1), covariance(0, 0) + covariance(1, 1));
        T_truth_estimate.rotation = exp_so3({0.0, 0.0, yaw});
    }
    T_truth_estimate.translation_m = truth_mean - T_truth_estimate.rotation * estimate_mean;
    return T_truth_estimate;
}

Pose relative_error(const Trajectory& estimate,
                    const Trajectory& truth,
                    const PosePair& a,
                    const PosePair& b) {
    const Pose moved =
        estimate[a.estimate].T_world_body.inverse() * estimate[b.estimate].T_world_body;
    const Pose true_move = truth[a.truth].T_world_body.inverse() * truth[b.truth].T_world_body;
    return true_move.inverse() * moved;
}

Result<TrajectoryErrors> evaluate_trajectory(const Trajectory& estimate,
                                             const Trajectory& truth,
                                             const EvalTrajectoryConfig& config) {
    if (auto checked = check_finite(estimate, "estimate"); !checked) return checked.error();
    if (auto checked = check_finite(truth, "truth"); !checked) return checked.error();
    TrajectoryErrors errors;
    errors.pairs = associate(estimate, truth, config.tolerance_s);
    const std::size_t needed = config.align == Alignment::se3 ? 3 : 2;
    if (errors.pairs.size() < needed) {
        return too_few(estimate, truth, errors.pairs.size(), needed, config.tolerance_s);
    }
    errors.matched = static_cast<int>(errors.pairs.size());

    const Eigen::Matrix3Xd estimate_m = positions(estimate, errors.pairs, &PosePair::estimate);
    const Eigen::Matrix3Xd truth_m = positions(truth, errors.pairs, &PosePair::truth);
    errors.T_truth_estimate = align_positions(estimate_m, truth_m, config.align);
    for (Eigen::Index k = 0; k < truth_m.cols(); ++k) {
        const Eigen::Vector3d aligned_m = errors.T_truth_estimate * estimate_m.col(k).eval();
        errors.position_error_m.push_back((aligned_m - truth_m.col(k)).norm());
    }
    errors.ate_rmse_m = rms(errors.position_error_m);

    const Status relative = add_relative_errors(errors, estimate, truth, config);
    if (!relative) return relative.error();

    errors.path_length_m = path_length(truth_m);
    errors.end_error_m = relative_error(estimate, truth, errors.pairs.front(), errors.pairs.back())
                             .translation_m.norm();
    errors.drift_percent = errors.path_length_m < kShortestPath_m
                               ? std::numeric_limits<double>::quiet_NaN()
                               : 100.0 * errors.end_error_m / errors.path_length_m;
    return errors;
}

Trajectory transformed(const Pose& T_truth_estimate, const Trajectory& estimate) {
    Trajectory moved = estimate;
    for (StampedPose& pose : moved) pose.T_world_body = T_truth_estimate * pose.T_world_body;
    return moved;
}

}  // namespace surefoot::eval

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/pose_graph.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/rng.hpp"

namespace surefoot::place_recognition {
namespace {

constexpr double kSigma_m = 0.01;
constexpr double kSigma_rad = 0.002;

Matrix6 covariance_of(double sigma_m, double sigma_rad) {
    Vector6 variances;
    variances << Eigen::Vector3d::Constant(sigma_m * sigma_m),
        Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
    return variances.asDiagonal();
}

const Matrix6 kMotion = covariance_of(kSigma_m, kSigma_rad);
const Matrix6 kSure = covariance_of(0.002, 0.0005);

Vector6 noise(double sigma_m, double sigma_rad, Rng& rng) {
    Vector6 v;
    for (int i = 0; i < 6; ++i) v[i] = (i < 3 ? sigma_m : sigma_rad) * rng.normal();
    return v;
}

/// Poses once around a square of 4 m, level, facing ahead.
std::vector<Pose> round_walk() {
    std::vector<Pose> poses{Pose{}};
    for (int side = 0; side < 4; ++side) {
        for (int i = 0; i < 8; ++i)
            poses.push_back(poses.back() * Pose{Eigen::Quaterniond::Identity(), {0.5, 0.0, 0.0}});
        for (int i = 0; i < 3; ++i)
            poses.push_back(poses.back() * Pose{exp_so3({0.0, 0.0, M_PI / 6.0}), {0.0, 0.0, 0.0}});
    }
    return poses;
}

PoseGraph drifting(const std::vector<Pose>& truth, const Pose& T_map_first, Rng& rng) {
    PoseGraph graph;
    graph.add_first(T_map_first);
    for (std::size_t i = 1; i < truth.size(); ++i)
        graph.add_next(
            perturbed(truth[i - 1].inverse() * truth[i], noise(kSigma_m, kSigma_rad, rng)),
            kMotion);
    return graph;
}

double end_error_m(const PoseGraph& graph, const std::vector<Pose>& truth) {
    return difference(truth.back(), graph.T_map_body(graph.nodes() - 1)).head<3>().norm();
}

TEST(PoseGraph, ALoopThatClosesTakesTheDriftOut) {
    const auto truth = round_walk();
    const int last = static_cast<int>(truth.size()) - 1;
    double before_m = 0.0;
    double after_m = 0.0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        Rng rng(seed);
        PoseGraph graph = drifting(truth, truth[0], rng);
        graph.hold_first();
        before_m += end_error_m(graph, truth);
        const int loop = graph.recognise(0, last, truth[0].inverse() * truth.back(), kSure);
        ASSERT_TRUE(graph.solve());
        after_m += end_error_m(graph, truth);
        EXPECT_LT(graph.chi2(loop), 10.0) << seed;
        EXPECT_EQ(graph.T_map_body(0).matrix(), truth[0].matrix()) << "the first node is held";
    }
    EXPECT_GT(before_m, 0.5);
    EXPECT_LT(after_m, 0.1 * before_m);
}

TEST(PoseGraph, ASavedPlaceSaysWhereTheWholeRunWas) {
    const auto truth = round_walk();
    Rng rng(1);
    // This run's odom began at an arbitrary pose in the map.
    PoseGraph graph = drifting(truth, Pose{exp_so3({0.0, 0.0, 2.0}), {7.0, -3.0, 0.1}}, rng);
    EXPECT_FALSE(graph.solve()) << "nothing fixes the graph";
    graph.place(5, truth[5]);
    for (const int node : {5, 6, 7, 40})
        graph.recognise_fixed(node, truth[static_cast<std::size_t>(node)], kSure);
    ASSERT_TRUE(graph.solve());
    for (const int node : {0, 6, 40})
        EXPECT_LT(difference(truth[static_cast<std::size_t>(node)], graph.T_map_body(node))
                      .head<3>()
                      .norm(),
                  0.1)
            << node;
}

TEST(PoseGraph, AWrongRecognitionAmongRightOnesIsOutvoted) {
    const auto truth = round_walk();
    Rng rng(3);
    PoseGraph graph = drifting(truth, truth[0], rng);
    graph.hold_first();
    const int last = static_cast<int>(truth.size()) - 1;
    graph.recognise(0, last, truth[0].inverse() * truth.back(), kSure);
    graph.recognise(1, last - 2, truth[1].inverse() * truth[truth.size() - 3], kSure);
    Pose wrong = truth[2].inverse() * truth[20];
    wrong.translation_m.x() += 1.5;
    const int bad = graph.recognise(2, 20, wrong, kSure);
    ASSERT_TRUE(graph.solve());
    EXPECT_LT(end_error_m(graph, truth), 0.02);
    EXPECT_GT(graph.chi2(bad), 1000.0);
    graph.forget_from(bad);
    ASSERT_TRUE(graph.solve());
    EXPECT_LT(end_error_m(graph, truth), 0.02);
}

/// Check: at the solution no small change of any pose lowers the sum of squares, which is computed
/// here independently.
TEST(PoseGraph, TheSolutionIsTheLowestPlace) {
    const auto truth = round_walk();
    Rng rng(5);
    std::vector<Pose> motions;
    PoseGraph graph;
    graph.add_first(truth[0]);
    graph.hold_first();
    for (std::size_t i = 1; i < truth.size(); ++i) {
        motions.push_back(perturbed(truth[i - 1].inverse() * truth[i], noise(0.03, 0.02, rng)));
        graph.add_next(motions.back(), covariance_of(0.03, 0.02));
    }
    const Pose loop = truth[0].inverse() * truth.back();
    graph.recognise(0, graph.nodes() - 1, loop, covariance_of(0.03, 0.02));
    ASSERT_TRUE(graph.solve());
    std::vector<Pose> poses;
    for (int i = 0; i < graph.nodes(); ++i) poses.push_back(graph.T_map_body(i));
    // 1e-5 squared: the graph adds this to every covariance.
    const Matrix6 information = (covariance_of(0.03, 0.02) + 1e-10 * Matrix6::Identity()).inverse();
    const auto cost = [&] {
        double sum = 0.0;
        for (std::size_t i = 1; i < poses.size(); ++i) {
            const Vector6 e = difference(motions[i - 1], poses[i - 1].inverse() * poses[i]);
            sum += e.dot(information * e);
        }
        const Vector6 e = difference(loop, poses.front().inverse() * poses.back());
        return sum + 16.0 * std::log1p(e.dot(information * e) / 16.0);
    };
    const double least = cost();
    for (std::size_t i = 1; i < poses.size(); i += 4) {
        for (int axis = 0; axis < 6; ++axis) {
            for (const double sign : {-1.0, 1.0}) {
                const Pose kept = poses[i];
                poses[i] = perturbed(kept, sign * 1e-3 * Vector6::Unit(axis));
                EXPECT_GT(cost(), least) << i << " " << axis;
                poses[i] = kept;
            }
        }
    }
}

}  // namespace
}  // namespace surefoot::place_recognition

// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/geometry/cloud_alignment.hpp"

namespace surefoot::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Points = std::vector<Vector3f>;

/// Ground with steps along x and y like a height map: no points on the faces.
class SteppedGround {
  public:
    explicit SteppedGround(Rng& rng) {
        for (int axis = 0; axis < 2; ++axis) {
            double at_m = rng.uniform(0.3, 0.7);
            for (int step = 0; step < 3; ++step) {
                edges_.push_back({axis, at_m, rng.uniform(0.08, 0.25)});
                at_m += rng.uniform(0.25, 0.6);
            }
        }
    }
    [[nodiscard]] double height_m(const Vector2d& xy_m) const {
        double z_m = 0.0;
        for (const Edge& edge : edges_) z_m += xy_m[edge.axis] >= edge.at_m ? edge.rise_m : 0.0;
        return z_m;
    }

  private:
    struct Edge {
        Eigen::Index axis;
        double at_m;
        double rise_m;
    };
    std::vector<Edge> edges_;
};

struct Cell {
    double spacing_m;
    double noise_m;
    bool lattice;  ///< true: points on a lattice; false: as many random points
};

/// The ground in the axes of a rotated and shifted sensor: `T_ground_sensor` maps its points onto
/// the ground.
Points seen(const SteppedGround& ground, const Pose& T_ground_sensor, const Cell& cell, Rng& rng) {
    constexpr double kSide_m = 2.0;
    const auto count = static_cast<int>(std::lround(kSide_m / cell.spacing_m));
    const Vector2d phase_m(rng.uniform(0.0, cell.spacing_m), rng.uniform(0.0, cell.spacing_m));
    Points points_m;
    for (int i = 0; i < count * count; ++i) {
        const Vector2d own_m =
            cell.lattice ? Vector2d(phase_m + cell.spacing_m * Vector2d(i % count, i / count))
                         : Vector2d(rng.uniform(0.0, kSide_m), rng.uniform(0.0, kSide_m));
        const Vector3d there_m = T_ground_sensor * Vector3d(own_m.x(), own_m.y(), 0.0);
        const double z_m = ground.height_m(there_m.head<2>()) - T_ground_sensor.translation_m.z() +
                           cell.noise_m * rng.normal();
        points_m.push_back(Vector3d(own_m.x(), own_m.y(), z_m).cast<float>());
    }
    return points_m;
}

struct Nees {
    double place = 0.0;  ///< mean of (error / sigma)^2
    double turn = 0.0;
    double worst = 0.0;  ///< largest error / sigma
    int converged = 0;
};

Nees nees_of(const Cell& cell, int pairs, std::uint64_t seed) {
    Nees nees;
    for (int i = 0; i < pairs; ++i) {
        Rng rng(seed + static_cast<std::uint64_t>(i));
        const SteppedGround ground(rng);
        const Pose truth{exp_so3({0.0, 0.0, rng.uniform(-0.05, 0.05)}),
                         {rng.uniform(-0.03, 0.03), rng.uniform(-0.03, 0.03), 0.01}};
        const KdTree reference(seen(ground, Pose{}, cell, rng));
        const Points moved_m = seen(ground, truth, cell, rng);
        const CloudAlignment found = align_clouds(reference, moved_m, Pose{}, {});
        Vector3d middle_m = Vector3d::Zero();
        for (const Vector3f& p_m : moved_m)
            middle_m += p_m.cast<double>() / static_cast<double>(moved_m.size());
        const Pose& T = found.T_reference_moved;
        const double place = (T * middle_m - truth * middle_m).norm() / found.sigma_m;
        const double turn =
            Eigen::AngleAxisd(truth.rotation.inverse() * T.rotation).angle() / found.sigma_rad;
        nees.converged += found.converged() ? 1 : 0;
        nees.place += place * place / pairs;
        nees.turn += turn * turn / pairs;
        nees.worst = std::max({nees.worst, place, turn});
    }
    return nees;
}

TEST(AlignmentSigma, CoversTheErrorOnLatticesAndAtRandom) {
    constexpr int kPairs = 12;
    for (const Cell cell : {Cell{0.05, 0.0, true},
                            Cell{0.05, 0.002, true},
                            Cell{0.03, 0.002, true},
                            Cell{0.05, 0.005, false}}) {
        SCOPED_TRACE(::testing::Message()
                     << 1e3 * cell.spacing_m << " mm, noise " << 1e3 * cell.noise_m << " mm, "
                     << (cell.lattice ? "lattice" : "random"));
        const Nees nees = nees_of(cell, kPairs, 100);
        // The mean of the squares is 1 for a right sigma, and less for an upper bound.
        EXPECT_LT(nees.place, 1.5);
        EXPECT_LT(nees.turn, 1.5);
        EXPECT_LT(nees.worst, 3.0);
        EXPECT_GT(nees.place, 0.05);
        EXPECT_GE(nees.converged, kPairs - 2);
    }
}

/// A terrain of four levels with the same 1600 points in both clouds. A search for nearest points
/// alone is 0.5 deg off.
TEST(AlignmentSigma, CoversTheErrorOfTheSameLatticeTurned) {
    Points points_m;
    for (int iy = 0; iy < 40; ++iy) {
        for (int ix = 0; ix < 40; ++ix) {
            const double z_m = (ix > 20 ? 0.2 : 0.0) + (iy > 26 ? 0.3 : 0.0);
            points_m.push_back(Vector3d(0.05 * ix, 0.05 * iy, z_m).cast<float>());
        }
    }
    const Pose turned{exp_so3({0.0, 0.0, 2.0 * M_PI / 180.0}), {0.065, -0.053, 0.01}};
    Points moved_m;
    for (const Vector3f& p_m : points_m)
        moved_m.push_back((turned * p_m.cast<double>()).cast<float>());
    const CloudAlignment found = align_clouds(KdTree(points_m), moved_m, Pose{}, {});
    const Pose rest = found.T_reference_moved * turned;
    const Vector3d middle_m(1.0, 1.0, 0.2);
    EXPECT_LT((rest * middle_m - middle_m).norm(), 2.0 * found.sigma_m);
    EXPECT_LT(Eigen::AngleAxisd(rest.rotation).angle(), 2.0 * found.sigma_rad);
    EXPECT_GT(found.edge_directions + found.border_directions, 0);
}

TEST(AlignmentSigma, FivePointsAreNoAnswer) {
    const Points reference_m{{87.7047F, 242.494F, 820.505F},
                             {596.134F, 96.3877F, 443.522F},
                             {490.549F, 163.573F, 752.207F},
                             {116.400F, 400.618F, 529.142F},
                             {440.963F, 600.882F, 755.546F}};
    Points moved_m;
    for (const Vector3f& p_m : reference_m) moved_m.push_back(p_m + Vector3f(0.7F, 0.0F, 0.0F));
    const CloudAlignment found = align_clouds(KdTree(reference_m), moved_m, Pose{}, {});
    EXPECT_EQ(found.outcome, AlignmentOutcome::too_few_points);
    // A thousand points on the same five reference points add no evidence.
    Points many_m;
    for (int i = 0; i < 1000; ++i) many_m.push_back(moved_m[static_cast<std::size_t>(i % 5)]);
    EXPECT_EQ(align_clouds(KdTree(reference_m), many_m, Pose{}, {}).outcome,
              AlignmentOutcome::too_few_points);
}

TEST(AlignmentSigma, CloudsApartAreNoAnswer) {
    // Two floors: no evidence fixes them sideways.
    Rng rng(3);
    const auto floor = [&](double x_m) {
        Points points_m;
        for (int i = 0; i < 1600; ++i) {
            points_m.push_back(
                Vector3d(x_m + 0.05 * (i % 40), 0.05 * (i / 40), 0.002 * rng.normal())
                    .cast<float>());
        }
        return points_m;
    };
    const KdTree reference(floor(0.0));
    const CloudAlignment near = align_clouds(reference, floor(0.0), Pose{}, {});
    EXPECT_TRUE(near.converged());
    EXPECT_GT(near.overlap, 0.9);
    const CloudAlignment far = align_clouds(reference, floor(100.0), Pose{}, {});
    EXPECT_EQ(far.outcome, AlignmentOutcome::no_overlap);
    EXPECT_LT(far.overlap, 0.01);
    // An overlapping corner of 10 % is enough; half a percent is not.
    EXPECT_TRUE(align_clouds(reference, floor(1.7), Pose{}, {}).overlap > 0.05);
}

}  // namespace
}  // namespace surefoot::geometry

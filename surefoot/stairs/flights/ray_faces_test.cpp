// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/flights/ray_faces.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "surefoot/stairs/flights/ray_scene_testing.hpp"

namespace surefoot::stairs {
namespace {

using testing::flight;
using testing::RayScene;

/// Edges of steps up along +x from the lowest, each moved by its value of `off_m`.
std::vector<Edge> edges_up(const std::vector<double>& off_m, double riser_m, double going_m) {
    std::vector<Edge> edges;
    for (std::size_t k = 0; k < off_m.size(); ++k) {
        const auto step = static_cast<double>(k);
        Edge edge;
        edge.from_m = {step * going_m + off_m[k], 0.6};
        edge.to_m = {step * going_m + off_m[k], -0.6};
        edge.lower_m = step * riser_m;
        edge.upper_m = (step + 1.0) * riser_m;
        edge.across_sigma_m = 0.5;
        edges.push_back(edge);
    }
    return edges;
}

TEST(RayFaces, risers_come_to_where_their_faces_are_seen) {
    for (const double yaw_deg : {-8.0, 0.0, 11.0}) {
        RayScene scene(flight(3, -0.18, 0.29), 0.9, yaw_deg * kRadPerDeg, 0.03);
        scene.add_noise(0.3, 21);
        std::vector<Edge> edges = edges_up({0.05, -0.06, 0.04}, 0.18, 0.29);
        RayFaces{}.place(scene.terrain(), edges);
        for (std::size_t k = 0; k < edges.size(); ++k) {
            EXPECT_NEAR(edges[k].middle_m().x(), static_cast<double>(k) * 0.29, 0.003) << yaw_deg;
            EXPECT_NEAR(edges[k].from_m.x(), edges[k].to_m.x(), 1e-12);
            EXPECT_LT(edges[k].across_sigma_m, 0.012);
            EXPECT_GT(edges[k].across_sigma_m, 0.001);
        }
    }
}

// Below a board the floor behind the board is visible. This floor is no face, at any distance.
TEST(RayFaces, a_riser_that_one_sees_through_is_open_and_does_not_move_to_the_floor_behind_it) {
    for (const bool open : {false, true}) {
        RayScene scene(flight(1, -0.2, 0.25), 0.7, 0.05, 0.0, open);
        scene.add_noise(0.2, 23);
        std::vector<Edge> edges = edges_up({0.0}, 0.2, 0.25);
        Terrain terrain = scene.terrain();
        terrain.view->unmapped_px = 3.0;
        RayFaces{}.place(terrain, edges);
        EXPECT_EQ(edges[0].open, open);
        // The map ends before the board, by the pixels that it omits.
        const Eigen::Vector3d board_m(0.0, 0.0, 0.2);
        const double before_m = open ? terrain.view->unmapped_m(board_m, {1.0, 0.0}) : 0.0;
        EXPECT_NEAR(edges[0].middle_m().x(), -before_m, 0.004);
        EXPECT_EQ(before_m > 0.01, open);
    }
}

TEST(RayFaces, what_is_not_seen_stays_where_the_map_has_it) {
    RayScene scene(flight(2, -0.18, 0.29), 0.9, 0.0);
    const std::vector<Edge> given = edges_up({0.03, 0.03}, 0.18, 0.29);
    const auto stays = [&](const Terrain& terrain, std::vector<Edge> edges) {
        const std::vector<Edge> before = edges;
        RayFaces{}.place(terrain, edges);
        for (std::size_t k = 0; k < edges.size(); ++k)
            if (edges[k].from_m != before[k].from_m || edges[k].across_sigma_m != 0.5) return false;
        return true;
    };
    EXPECT_FALSE(stays(scene.terrain(), given));
    std::vector<Edge> down = given;  // the faces of these edges point away from the camera
    for (Edge& edge : down) std::swap(edge.from_m, edge.to_m);
    EXPECT_TRUE(stays(scene.terrain(), down));
    EXPECT_TRUE(stays(scene.terrain(), edges_up({0.5}, 0.18, 0.29)));  // no face stands there
    std::vector<Edge> aside = given;
    for (Edge& edge : aside) {
        edge.from_m.y() += 4.0;
        edge.to_m.y() += 4.0;
    }
    EXPECT_TRUE(stays(scene.terrain(), aside));
    Terrain blind = scene.terrain();
    blind.disparity_px = {};
    EXPECT_TRUE(stays(blind, given));
    // Too few matches are rejected.
    for (int v = 0; v < scene.disparity_px_.height(); ++v)
        for (int u = 0; u < scene.disparity_px_.width(); ++u)
            if (u % 20 != 0) scene.disparity_px_.at(u, v) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(stays(scene.terrain(), given));
}

}  // namespace
}  // namespace surefoot::stairs

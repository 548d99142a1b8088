// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/patch.hpp"

#include <gtest/gtest.h>

#include "surefoot/odometry/synthetic_testing.hpp"

namespace surefoot::odometry {
namespace {

constexpr int kSize_px = 96;
/// Both images are rounded to whole grey levels: about 0.3 grey of noise on gradients of a few grey
/// levels per pixel, averaged over 81 pixels. The rest is the error of bilinear interpolation.
constexpr double kAlignment_px = 0.05;

/// A texture in a view: pixel p shows the texture at `A p + shift`.
GreyImage draw(const Eigen::Matrix2d& A,
               const Eigen::Vector2d& shift,
               double gain = 1.0,
               double offset = 0.0) {
    GreyImage image(kSize_px, kSize_px);
    for (int v = 0; v < kSize_px; ++v) {
        for (int u = 0; u < kSize_px; ++u) {
            const Eigen::Vector2d at = (A * Eigen::Vector2d(u, v) + shift) * 0.006;
            const double grey =
                gain * testing::texture_grey(0, at.x() + 1.0, at.y() + 1.0) + offset;
            image.at(u, v) = static_cast<std::uint8_t>(std::clamp(grey + 0.5, 0.0, 255.0));
        }
    }
    return image;
}

TEST(Patch, FindsAShiftBelowAPixel) {
    const GreyImage host = draw(Eigen::Matrix2d::Identity(), {0.0, 0.0});
    for (const Eigen::Vector2d& shift :
         {Eigen::Vector2d(0.37, -0.21), Eigen::Vector2d(-1.6, 0.9)}) {
        const GreyImage view = draw(Eigen::Matrix2d::Identity(), shift);
        for (const Eigen::Vector2d& at :
             {Eigen::Vector2d(40.0, 40.0), Eigen::Vector2d(52.3, 47.8)}) {
            const auto patch = warp_patch(*cut_patch(host.view(), at), Eigen::Matrix2d::Identity());
            ASSERT_TRUE(patch);
            const auto found = align_patch(*patch, view.view(), at, 4.0);
            ASSERT_TRUE(found);
            EXPECT_LT((found->raw_px - (at - shift)).norm(), kAlignment_px) << shift.transpose();
            EXPECT_GT(found->correlation, 0.98);
        }
    }
}

TEST(Patch, ThereIsNoneOutsideOfTheImageHoweverFar) {
    const GreyImage image = draw(Eigen::Matrix2d::Identity(), {0.0, 0.0});
    EXPECT_TRUE(cut_patch(image.view(), {48.0, 48.0}));
    // The column 2^32 + 48 must not wrap around to 48.
    for (const double far : {4294967344.0, -4294967248.0, 1e300, -1.0, std::nan("")}) {
        EXPECT_FALSE(cut_patch(image.view(), {far, 48.0})) << far;
        EXPECT_FALSE(cut_patch(image.view(), {48.0, far})) << far;
    }
}

TEST(Patch, DoesNotCareForGainAndOffset) {
    const GreyImage host = draw(Eigen::Matrix2d::Identity(), {0.0, 0.0});
    const GreyImage view = draw(Eigen::Matrix2d::Identity(), {0.6, 0.4}, 0.6, 40.0);
    const auto patch =
        warp_patch(*cut_patch(host.view(), {48.0, 48.0}), Eigen::Matrix2d::Identity());
    const auto found = align_patch(*patch, view.view(), {48.0, 48.0}, 4.0);
    ASSERT_TRUE(found);
    EXPECT_LT((found->raw_px - Eigen::Vector2d(47.4, 47.6)).norm(), kAlignment_px);
}

TEST(Patch, WarpUndoesRotationAndScale) {
    Eigen::Matrix2d host_from_view;
    host_from_view << 1.1, -0.4, 0.4, 1.1;
    const GreyImage host = draw(Eigen::Matrix2d::Identity(), {0.0, 0.0});
    const Eigen::Vector2d centre(48.0, 48.0);
    const GreyImage view = draw(host_from_view, centre - host_from_view * centre);
    const auto patch = warp_patch(*cut_patch(host.view(), centre), host_from_view);
    ASSERT_TRUE(patch);
    const auto found = align_patch(*patch, view.view(), centre + Eigen::Vector2d(0.8, -0.5), 4.0);
    ASSERT_TRUE(found);
    EXPECT_LT((found->raw_px - centre).norm(), 2.0 * kAlignment_px);  // resampled twice
}

TEST(Patch, NothingWithoutTextureOrOutside) {
    const GreyImage flat(kSize_px, kSize_px, 77);
    EXPECT_FALSE(warp_patch(*cut_patch(flat.view(), {48.0, 48.0}), Eigen::Matrix2d::Identity()));
    GreyImage edge(kSize_px, kSize_px, 20);  // an edge leaves its own direction open
    for (int v = 0; v < kSize_px; ++v)
        for (int u = kSize_px / 2; u < kSize_px; ++u) edge.at(u, v) = 200;
    EXPECT_FALSE(warp_patch(*cut_patch(edge.view(), {48.0, 48.0}), Eigen::Matrix2d::Identity()));
    EXPECT_FALSE(cut_patch(flat.view(), {5.0, 48.0}));
    EXPECT_FALSE(cut_patch(flat.view(), {48.0, kSize_px - 3.0}));
    const GreyImage host = draw(Eigen::Matrix2d::Identity(), {0.0, 0.0});
    const auto host_patch = cut_patch(host.view(), {48.0, 48.0});
    EXPECT_FALSE(warp_patch(*host_patch, 3.0 * Eigen::Matrix2d::Identity()));
    const auto patch = warp_patch(*host_patch, Eigen::Matrix2d::Identity());
    EXPECT_FALSE(align_patch(*patch, host.view(), {2.0, 2.0}, 4.0));
    EXPECT_FALSE(align_patch(*patch, host.view(), {std::nan(""), 48.0}, 4.0));
}

}  // namespace
}  // namespace surefoot::odometry

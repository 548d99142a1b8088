// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/refine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>
#include <vector>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/stereo/scene_testing.hpp"
#include "surefoot/stereo/stereo_targets_testing.hpp"

namespace surefoot::stereo {
namespace {

const test::SyntheticPair& plane() {
    static const test::SyntheticPair pair = [] {
        test::SceneConfig config;
        config.width = 400;
        config.height = 240;
        config.focal_px = 220.0;
        config.contrast_grey = 6.0;
        return test::Scene(config).render();
    }();
    return pair;
}

struct Refined {
    Image<float> disparity_px;
    Image<float> residual_grey;
    Image<float> gradient_grey_px;
    Image<float> shift_px;
};

Refined refine(const GreyImage& left,
               const GreyImage& right,
               Image<float> start,
               Executor& executor,
               const Image<std::uint8_t>* jump_distance_px = nullptr) {
    const int width = left.width();
    const Image<float> empty(width, left.height());
    Refined result{std::move(start), empty, empty, empty};
    SubpixelRefiner refiner{RefineConfig{}};
    const Image<std::uint8_t> far_from_jumps(width, left.height(), 255);
    refiner.refine(left.view(),
                   right.view(),
                   result.disparity_px,
                   Filter::none,
                   jump_distance_px != nullptr ? *jump_distance_px : far_from_jumps,
                   executor,
                   result.disparity_px,
                   [&](int v, const RefinedRow& row) {
                       std::copy_n(row.residual_grey, width, result.residual_grey.row(v));
                       std::copy_n(row.gradient_grey_px, width, result.gradient_grey_px.row(v));
                       std::copy_n(row.shift_px, width, result.shift_px.row(v));
                   });
    return result;
}

struct Errors {
    double mean_px = 0.0;
    double rms_px = 0.0;
};

/// Pixels away from the border, where windows are complete.
Errors errors_of(const Image<float>& disparity_px, const Image<float>& truth_px) {
    constexpr int kMargin_px = 20;
    double sum = 0.0;
    double sum_sq = 0.0;
    int count = 0;
    for (int v = kMargin_px; v < truth_px.height() - kMargin_px; ++v) {
        for (int u = kMargin_px; u < truth_px.width() - kMargin_px; ++u) {
            const double error = static_cast<double>(disparity_px.at(u, v) - truth_px.at(u, v));
            if (std::isnan(error)) continue;
            sum += error;
            sum_sq += error * error;
            ++count;
        }
    }
    return {sum / count, std::sqrt(sum_sq / count)};
}

std::vector<float> smoothed(const std::vector<float>& row) {
    constexpr int kRadius = 4;
    std::vector<float> padded(row.size() + 2 * kRadius, kNanF);
    std::copy(row.begin(), row.end(), padded.begin() + kRadius);
    std::vector<float> out(row.size());
    smooth_along(padded.data() + kRadius, static_cast<int>(row.size()), kRadius, 1.5, out.data());
    return out;
}

TEST(SmoothAlong, KeepsASlantedPlane) {
    std::vector<float> row(20);
    for (std::size_t u = 0; u < row.size(); ++u) row[u] = 10.0F + 0.25F * static_cast<float>(u);
    EXPECT_EQ(smoothed(row), row);  // quarters are exact
}

TEST(SmoothAlong, DoesNotMixSurfacesAndKeepsTheUnknownUnknown) {
    std::vector<float> row(12, 5.0F);
    std::fill(row.begin() + 6, row.end(), 9.0F);
    row[3] = kNanF;
    const std::vector<float> out = smoothed(row);
    for (std::size_t u = 0; u < row.size(); ++u) {
        if (u == 3) {
            EXPECT_TRUE(std::isnan(out[u]));
        } else {
            EXPECT_EQ(out[u], row[u]) << u;
        }
    }
}

/// First pixel of every row, for a column of values that are each repeated over a row.
std::vector<float> smoothed_down(const std::vector<float>& column) {
    constexpr int kWidth = 70;  // more than any register
    Image<float> in(kWidth, static_cast<int>(column.size()));
    for (int v = 0; v < in.height(); ++v)
        std::fill_n(in.row(v), kWidth, column[static_cast<std::size_t>(v)]);
    std::vector<float> out;
    out.reserve(column.size());
    std::vector<float> row(kWidth);
    for (int v = 0; v < in.height(); ++v) {
        smooth_down(in, v, 4, 1.5, row.data());
        for (const float value : row) {
            const bool is_same = value == row[0] || (std::isnan(value) && std::isnan(row[0]));
            EXPECT_TRUE(is_same) << v;
        }
        out.push_back(row[0]);
    }
    return out;
}

TEST(SmoothDown, KeepsAPlane) {
    std::vector<float> plane(20);
    for (std::size_t v = 0; v < plane.size(); ++v) plane[v] = 10.0F + 0.25F * static_cast<float>(v);
    EXPECT_EQ(smoothed_down(plane), plane);
}

TEST(SmoothDown, DoesNotMoveEdgesAndKeepsTheUnknownUnknown) {
    std::vector<float> step(14, 5.0F);
    std::fill(step.begin() + 7, step.end(), 6.0F);  // within the limit of one surface
    std::vector<float> out = smoothed_down(step);
    EXPECT_FLOAT_EQ(out[4], 5.0F + 2.0F / 9.0F) << "rows 0 to 8";
    EXPECT_FLOAT_EQ(out[6], 5.0F + 4.0F / 9.0F) << "rows 2 to 10";
    EXPECT_FLOAT_EQ(out[7], 6.0F - 4.0F / 9.0F) << "rows 3 to 11";
    std::fill(step.begin() + 7, step.end(), 9.0F);
    step[3] = kNanF;
    out = smoothed_down(step);
    for (std::size_t v = 0; v < step.size(); ++v) {
        if (v == 3)
            EXPECT_TRUE(std::isnan(out[v]));
        else
            EXPECT_EQ(out[v], step[v]) << v;
    }
}

TEST(SubpixelRefiner, RemovesALeanOfTheWholeSurface) {
    Serial serial;
    const test::SyntheticPair& pair = plane();
    Image<float> start = pair.disparity_px;
    for (std::size_t i = 0; i < start.size(); ++i) start.data()[i] += 0.15F;
    const Refined refined = refine(pair.left, pair.right, start, serial);
    const Errors errors = errors_of(refined.disparity_px, pair.disparity_px);
    std::printf(
        "from a lean of 0.150 px: mean %+.3f px, rms %.3f px\n", errors.mean_px, errors.rms_px);
    // The prior of 0.2 px reduces the correction where texture is weak.
    EXPECT_LT(std::abs(errors.mean_px), 0.03);
    EXPECT_LT(errors.rms_px, 0.09);
}

TEST(SubpixelRefiner, RemovesThePreferenceForWholePixelsAndScatter) {
    Serial serial;
    const test::SyntheticPair& pair = plane();
    Rng rng(9);
    Image<float> start = pair.disparity_px;
    for (std::size_t i = 0; i < start.size(); ++i) {
        const double d = static_cast<double>(start.data()[i]);
        start.data()[i] +=
            static_cast<float>(-0.12 * std::sin(2.0 * std::numbers::pi * d) + 0.15 * rng.normal());
    }
    const Errors before = errors_of(start, pair.disparity_px);
    const Refined refined = refine(pair.left, pair.right, start, serial);
    const Errors after = errors_of(refined.disparity_px, pair.disparity_px);
    std::printf(
        "whole-pixel preference and scatter: rms %.3f -> %.3f px\n", before.rms_px, after.rms_px);
    EXPECT_GT(before.rms_px, 0.16);
    EXPECT_LT(after.rms_px, 0.5 * before.rms_px);
}

TEST(SubpixelRefiner, BrightnessOfTheEyesDoesNotMatter) {
    Serial serial;
    const test::SyntheticPair& pair = plane();
    GreyImage brighter = pair.right;
    for (std::size_t i = 0; i < brighter.size(); ++i) {
        brighter.data()[i] = static_cast<std::uint8_t>(std::min(255, brighter.data()[i] + 20));
    }
    const Refined same = refine(pair.left, pair.right, pair.disparity_px, serial);
    const Refined bright = refine(pair.left, brighter, pair.disparity_px, serial);
    const Errors difference = errors_of(bright.disparity_px, same.disparity_px);
    // Grey differences are limited to 32 levels. With 20 more, a few true differences reach the
    // limit.
    EXPECT_LT(difference.rms_px, 0.02);
}

TEST(SubpixelRefiner, WithoutTextureNothingMoves) {
    Serial serial;
    const GreyImage grey(60, 50, 90);
    const Image<float> start(60, 50, 10.5F);
    const Refined refined = refine(grey, grey, start, serial);
    EXPECT_EQ(refined.disparity_px, start);
    EXPECT_EQ(refined.gradient_grey_px.at(40, 25), 0.0F);
}

TEST(SubpixelRefiner, UnknownStaysUnknownEvenInTinyImages) {
    Serial serial;
    for (const int side : {1, 2, 7}) {
        const GreyImage grey(side, side, 90);
        const Refined refined = refine(grey, grey, Image<float>(side, side, kNanF), serial);
        EXPECT_TRUE(std::isnan(refined.disparity_px.at(0, 0)));
        EXPECT_TRUE(std::isnan(refined.shift_px.at(0, 0)));
    }
}

/// The definition of SubpixelRefiner with its default configuration, pixel by pixel.
class PlainRefinement {
  public:
    PlainRefinement(const GreyImage& left,
                    const GreyImage& right,
                    const Image<std::uint8_t>& jump_distance_px,
                    const Image<float>& found_px)
        : width_(left.width()), height_(left.height()), found_px_(found_px) {
        evidence_.reserve(left.size());
        along_px_ = down_px_ = found_px;
        for_pixels([&](int u, int v) { along_px_.at(u, v) = smoothed(found_px, u, v, 1, 0); });
        for_pixels([&](int u, int v) { down_px_.at(u, v) = smoothed(along_px_, u, v, 0, 1); });
        for_pixels([&](int u, int v) {
            const bool near_jump = jump_distance_px.at(u, v) <= config_.jump_margin_px;
            evidence_.push_back(near_jump ? Evidence{} : warped(left, right, u, v));
        });
    }

    /// The disparity and the by-products of the refinement.
    struct Pixel {
        float disparity_px, residual_grey, gradient_grey_px, shift_px;
    };
    [[nodiscard]] Pixel solved(int u, int v) const {
        if (std::isnan(found_px_.at(u, v))) return {kNanF, kNanF, kNanF, kNanF};
        const Sums sums = sum_around(u, v);
        const int side = 2 * config_.window_radius_px + 1;
        const auto n = static_cast<float>(sums.n);
        if (n < 0.2F * static_cast<float>(side * side)) return {down_px_.at(u, v), 32.0F, 0, 0};
        constexpr float kUnit = 1.0F / 256.0F;
        const auto g = static_cast<float>(sums.g);
        const auto e = static_cast<float>(sums.e);
        const float per_pixel = 1.0F / n;
        const float mean_g = g * per_pixel;
        const float gg = std::max(0.0F, (static_cast<float>(sums.gg) - mean_g * g) * kUnit);
        const float ge = (static_cast<float>(sums.ge) - mean_g * e) * kUnit;
        const float ee = (static_cast<float>(sums.ee) - e * per_pixel * e) * kUnit;
        const auto noise = static_cast<float>(config_.min_noise_grey);
        const auto prior = static_cast<float>(config_.prior_sigma_px);
        const float explained = gg > 0.0F ? ge * ge / gg : 0.0F;
        const float variance = std::max(noise * noise, (ee - explained) * per_pixel);
        const float held_back =
            static_cast<float>(config_.correlation) * variance * (1.0F / (prior * prior));
        const float shift = std::clamp(-ge / (gg + held_back), -1.0F, 1.0F);
        return {down_px_.at(u, v) + shift, std::sqrt(variance), std::sqrt(gg * per_pixel), shift};
    }

  private:
    struct Evidence {
        bool used = false;
        int gradient = 0;
        int error = 0;
    };
    struct Sums {
        std::int64_t n = 0, g = 0, e = 0, gg = 0, ge = 0, ee = 0;
    };

    template <typename Work>
    void for_pixels(const Work& work) const {
        for (int v = 0; v < height_; ++v) {
            for (int u = 0; u < width_; ++u) work(u, v);
        }
    }

    [[nodiscard]] float smoothed(const Image<float>& in, int u, int v, int du, int dv) const {
        const float center = in.at(u, v);
        const int radius_px = du != 0 ? config_.smooth_along_px : config_.smooth_down_px;
        float sum = 0.0F;
        float count = 1.0F;
        for (int k = 1; k <= radius_px; ++k) {
            if (!in.contains(u - k * du, v - k * dv) || !in.contains(u + k * du, v + k * dv)) break;
            const float low = in.at(u - k * du, v - k * dv) - center;
            const float high = in.at(u + k * du, v + k * dv) - center;
            if (!(std::abs(low) <= 1.5F && std::abs(high) <= 1.5F)) continue;
            sum += low + high;
            count += 2.0F;
        }
        return center + sum / count;
    }

    /// Binomial 1 2 1 in both directions, in 1/16 grey level.
    [[nodiscard]] static int grey(const GreyImage& image, int u, int v) {
        constexpr int kWeights[] = {1, 2, 1};
        int total = 0;
        for (int dv = -1; dv <= 1; ++dv) {
            for (int du = -1; du <= 1; ++du) {
                total += kWeights[du + 1] * kWeights[dv + 1] *
                         image.at(std::clamp(u + du, 0, image.width() - 1),
                                  std::clamp(v + dv, 0, image.height() - 1));
            }
        }
        return total;
    }

    [[nodiscard]] Evidence warped(const GreyImage& left,
                                  const GreyImage& right,
                                  int u,
                                  int v) const {
        const float x = static_cast<float>(u) - down_px_.at(u, v);
        if (u < 1 || u >= width_ - 1) return {};
        if (!(x >= 1.0F && x < static_cast<float>(width_ - 3))) return {};
        const int place = static_cast<int>(x);
        const float s = x - static_cast<float>(place);
        float tap[4];
        for (int k = 0; k < 4; ++k) tap[k] = static_cast<float>(grey(right, place - 1 + k, v));
        const float error = static_cast<float>(grey(left, u, v)) - (tap[1] + s * (tap[2] - tap[1]));
        if (std::abs(error) > 512.0F) return {};
        const float slope_right = (1.0F - s) * (tap[2] - tap[0]) + s * (tap[3] - tap[1]);
        const auto slope_left = static_cast<float>(grey(left, u + 1, v) - grey(left, u - 1, v));
        const float slope = std::clamp(0.25F * (slope_left + slope_right), -1024.0F, 1024.0F);
        const auto nearest = [](float value) {  // halves round up
            return static_cast<int>(value + 4096.5F) - 4096;
        };
        return {true, nearest(slope), nearest(error)};
    }

    [[nodiscard]] Sums sum_around(int u, int v) const {
        const int r = config_.window_radius_px;
        Sums sums;
        for (int b = std::max(0, v - r); b <= std::min(height_ - 1, v + r); ++b) {
            for (int a = std::max(0, u - r); a <= std::min(width_ - 1, u + r); ++a) {
                const Evidence& here = evidence_[static_cast<std::size_t>(b * width_ + a)];
                sums.n += here.used ? 1 : 0;
                sums.g += here.gradient;
                sums.e += here.error;
                sums.gg += here.gradient * here.gradient;
                sums.ge += here.gradient * here.error;
                sums.ee += here.error * here.error;
            }
        }
        return sums;
    }

    RefineConfig config_;
    int width_;
    int height_;
    const Image<float>& found_px_;
    Image<float> along_px_;
    Image<float> down_px_;
    std::vector<Evidence> evidence_;
};

bool same_float(float a, float b) {
    return a == b || (std::isnan(a) && std::isnan(b));
}

/// Steep edges, surfaces, holes and random disparities; windows contain many or almost no pixels.
struct WildPair {
    WildPair(int width, int height, Rng& rng)
        : left(width, height),
          right(width, height),
          found_px(width, height),
          jump_distance_px(width, height) {
        float surface_px = 6.0F;
        for (std::size_t i = 0; i < left.size(); ++i) {
            const double grey = rng.uniform() < 0.05
                                    ? 255.0
                                    : 100.0 + 40.0 * std::sin(0.3 * static_cast<double>(i));
            right.data()[i] =
                static_cast<std::uint8_t>(std::clamp(grey + 5.0 * rng.normal(), 0.0, 255.0));
            left.data()[i] =
                static_cast<std::uint8_t>(std::clamp(grey + 5.0 * rng.normal(), 0.0, 255.0));
            if (rng.uniform() < 0.02) surface_px = static_cast<float>(rng.uniform(1.0, 15.0));
            const float scatter_px = static_cast<float>(0.4 * rng.normal());
            found_px.data()[i] = rng.uniform() < 0.1 ? kNanF : surface_px + scatter_px;
            jump_distance_px.data()[i] =
                static_cast<std::uint8_t>(rng.uniform() < 0.5 ? 255.0 : rng.uniform(0.0, 15.0));
        }
    }
    GreyImage left;
    GreyImage right;
    Image<float> found_px;
    Image<std::uint8_t> jump_distance_px;
};

TEST(SubpixelRefiner, IsTheDefinitionOnEveryProcessor) {
    Rng rng(12);
    for (const auto& [width, height] : {std::pair{1, 1}, {4, 30}, {7, 3}, {61, 20}, {150, 70}}) {
        const WildPair pair(width, height, rng);
        const PlainRefinement plain(pair.left, pair.right, pair.jump_distance_px, pair.found_px);
        int moved = 0;
        for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
            hwy::SetSupportedTargetsForTest(target);
            Serial serial;
            const Refined found =
                refine(pair.left, pair.right, pair.found_px, serial, &pair.jump_distance_px);
            for (int v = 0; v < height; ++v) {
                for (int u = 0; u < width; ++u) {
                    const auto expected = plain.solved(u, v);
                    ASSERT_PRED2(same_float, found.disparity_px.at(u, v), expected.disparity_px)
                        << hwy::TargetName(target) << " " << width << ": " << u << ", " << v;
                    ASSERT_PRED2(same_float, found.residual_grey.at(u, v), expected.residual_grey);
                    ASSERT_PRED2(
                        same_float, found.gradient_grey_px.at(u, v), expected.gradient_grey_px);
                    ASSERT_PRED2(same_float, found.shift_px.at(u, v), expected.shift_px);
                    moved += std::abs(expected.shift_px) > 0.0F ? 1 : 0;
                }
            }
        }
        hwy::SetSupportedTargetsForTest(0);
        if (width > 50) {
            EXPECT_GT(moved, 0) << "the case tests nothing";
        }
    }
}

TEST(SubpixelRefiner, SameBytesForEveryExecutor) {
    Serial serial;
    Backwards backwards;
    Threads two(2);
    const test::SyntheticPair& pair = plane();
    Image<float> start = pair.disparity_px;
    for (std::size_t i = 0; i < start.size(); ++i)
        start.data()[i] = std::isnan(start.data()[i]) ? 0.5F : start.data()[i];
    const Refined a = refine(pair.left, pair.right, start, serial);
    const Refined b = refine(pair.left, pair.right, start, backwards);
    const Refined c = refine(pair.left, pair.right, start, two);
    EXPECT_EQ(a.disparity_px, b.disparity_px);
    EXPECT_EQ(a.disparity_px, c.disparity_px);
    EXPECT_EQ(a.residual_grey, c.residual_grey);
}

}  // namespace
}  // namespace surefoot::stereo

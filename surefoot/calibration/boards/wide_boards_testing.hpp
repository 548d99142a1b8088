// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/calibration/lenses/lens.hpp"
#include "surefoot/camera/camera_model.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/views.hpp"

/// Images of chessboards through wide lenses, with known corners, for tests and experiments. The
/// background consists of random rectangles.
namespace surefoot::calibration::testing {

/// Radial profile of a wide lens.
enum class WideProfile : std::uint8_t { equidistant, equisolid, stereographic, bought, rational };
inline constexpr const char* kWideProfileNames[] = {
    "equidistant", "equisolid", "stereographic", "bought", "rational"};

/// Lens with `fov_deg` across the image width; its centre lies slightly beside the middle.
/// `rational` reaches 130 deg; all others are fisheyes.
inline camera::Camera wide_camera(WideProfile profile, double fov_deg, ImageSize size) {
    const double half_rad = 0.5 * fov_deg * std::numbers::pi / 180.0;
    const double half_px = 0.5 * size.width;
    const double cx_px = half_px + 0.011 * size.width;
    const double cy_px = 0.5 * size.height - 0.008 * size.height;
    if (profile == WideProfile::rational) {
        camera::PinholeRational lens{
            1.0, 1.0, cx_px, cy_px, 0.51, -0.6, 4e-4, -2e-4, 0.3, 0.8, -0.6, 0.35};
        const double s = std::pow(std::tan(half_rad), 2);
        const double above = 1.0 + s * (lens.k1 + s * (lens.k2 + s * lens.k3));
        const double below = 1.0 + s * (lens.k4 + s * (lens.k5 + s * lens.k6));
        lens.fx_px = half_px / (std::sqrt(s) * above / below);
        lens.fy_px = 1.002 * lens.fx_px;
        return {lens, size.width, size.height};
    }
    constexpr std::array<std::array<double, 4>, 4> kCoefficients{
        {{0.0, 0.0, 0.0, 0.0},
         {-0.0417, 0.00052, 0.0, 0.0},
         {0.0833, 0.00833, 0.00084, 0.0},
         {0.0121, 0.0056, -0.0061, 0.0005}}};
    const auto& k = kCoefficients[static_cast<std::size_t>(profile)];
    const double s = half_rad * half_rad;
    const double image = half_rad * (1.0 + s * (k[0] + s * (k[1] + s * (k[2] + s * k[3]))));
    const double f_px = half_px / image;
    return {camera::KannalaBrandt{f_px, 1.002 * f_px, cx_px, cy_px, k[0], k[1], k[2], k[3]},
            size.width,
            size.height};
}

/// Illumination, focus and noise of an image. Grey values are linear in light.
struct WideImagingConditions {
    const char* name = "clean";
    double paper_dn = 210.0;
    double ink_dn = 30.0;
    double blur_px = 0.6;        ///< Gaussian spot at the left border of the image ...
    double blur_right_px = 0.6;  ///< ... and at the right one
    double noise_dn = 2.0;
    double corner_light = 1.0;  ///< share of the light that reaches the corners of the image
    double right_light = 1.0;   ///< share of the light at the right border
    double margin = 1.4;        ///< width of the white paper margin, in squares
    double shown = 1.0;         ///< share of the outer squares that must be visible
};
inline constexpr std::array<WideImagingConditions, 9> kWideLooks{
    {{},
     {.name = "noise", .blur_px = 0.8, .blur_right_px = 0.8, .noise_dn = 8.0},
     {.name = "blur", .blur_px = 1.8, .blur_right_px = 1.8},
     {.name = "partial blur", .blur_px = 0.6, .blur_right_px = 2.6},
     {.name = "vignetting", .corner_light = 0.15, .right_light = 0.5},
     {.name = "dim", .paper_dn = 66.0, .ink_dn = 38.0, .noise_dn = 2.5, .right_light = 0.6},
     {.name = "overexposed",
      .paper_dn = 420.0,
      .ink_dn = 45.0,
      .blur_px = 1.0,
      .blur_right_px = 1.4},
     {.name = "no margin", .blur_px = 0.8, .blur_right_px = 0.8, .noise_dn = 4.0, .margin = 0.0},
     {.name = "cut off", .noise_dn = 4.0, .shown = 0.3}}};

/// True pixels of the board's points. nullopt if a point is outside the image, or if a square is
/// narrower than `least_step_px` in the image.
inline std::optional<std::vector<Eigen::Vector2d>> true_corners(const Board& board,
                                                                const camera::Camera& camera,
                                                                const Pose& T_camera_board,
                                                                double least_step_px) {
    std::vector<Eigen::Vector2d> pixels;
    for (const Eigen::Vector3d& p_m : board.points_m()) {
        const auto pixel = camera::project(camera.model, T_camera_board * p_m);
        if (!pixel) return std::nullopt;
        pixels.push_back(*pixel);
    }
    for (int i = 0; i < board.columns * board.rows; ++i) {
        const auto at = [&](int k) { return pixels[static_cast<std::size_t>(k)]; };
        if (i % board.columns > 0 && (at(i) - at(i - 1)).norm() < least_step_px)
            return std::nullopt;
        if (i >= board.columns && (at(i) - at(i - board.columns)).norm() < least_step_px)
            return std::nullopt;
    }
    return pixels;
}

/// A random board pose with all printed squares visible, at 0.35 to 1.6 of the longer board side.
/// It is rolled by up to 45 deg and tilted by up to `most_tilt_deg` against the ray to its middle.
/// With `shown` below 1, only this share of the outer squares must be visible.
inline Pose wide_pose(const Board& board,
                      const camera::Camera& camera,
                      double most_tilt_deg,
                      double least_step_px,
                      Rng& rng,
                      double shown = 1.0) {
    constexpr double kBorder_px = 2.0;
    Board squares = board;  // includes the corners of the outer squares
    squares.columns += 2;
    squares.rows += 2;
    const Eigen::Vector3d one(board.spacing_m, board.spacing_m, 0.0);
    const auto is_inside = [&](const Eigen::Vector2d& p) {
        return p.x() > kBorder_px && p.y() > kBorder_px && p.x() < camera.width - 1 - kBorder_px &&
               p.y() < camera.height - 1 - kBorder_px;
    };
    const Eigen::Vector3d middle_m = 0.5 * board.points_m().back();
    const double size_m = board.spacing_m * std::max(squares.columns, squares.rows);
    while (true) {
        const auto ray = camera::unproject(
            camera.model, {rng.uniform(0.0, camera.width), rng.uniform(0.0, camera.height)});
        const double turn = rng.uniform(-std::numbers::pi, std::numbers::pi);
        const double tilt = rng.uniform(0.0, most_tilt_deg) * std::numbers::pi / 180.0;
        const double roll = rng.uniform(-0.25, 0.25) * std::numbers::pi;
        const double distance_m = size_m * rng.uniform(0.35, 1.6);
        if (!ray) continue;
        Pose T;
        T.rotation = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), *ray) *
                     exp_so3(tilt * Eigen::Vector3d(std::cos(turn), std::sin(turn), 0.0)) *
                     exp_so3({0.0, 0.0, roll});
        T.translation_m = distance_m * *ray - T.rotation * middle_m;
        Pose T_outer = T;
        T_outer.translation_m -= T.rotation * one;
        const auto outer = true_corners(squares, camera, T_outer, least_step_px);
        if (!outer) continue;
        // Between the inner corners and the outer ends of their squares.
        Board frame = squares;
        frame.spacing_m *= (board.columns - 1 + 2.0 * shown) / (board.columns + 1);
        Pose T_frame = T;
        T_frame.translation_m -= shown * (T.rotation * one);
        const auto framed = true_corners(frame, camera, T_frame, 0.0);
        const bool inside = framed && std::all_of(framed->begin(), framed->end(), is_inside);
        if (inside) return T;
    }
}

/// Random rectangles, some of them chequered: clutter of a workshop.
inline cv::Mat clutter(ImageSize size, Rng& rng) {
    cv::Mat image(size.height, size.width, CV_32F, cv::Scalar(100.0));
    const auto number = [&](int n) {
        return static_cast<int>(rng.below(static_cast<std::uint64_t>(n)));
    };
    for (int i = 0; i < 60; ++i) {
        const int w = 4 + number(90);
        const int h = 4 + number(90);
        const cv::Rect box(number(size.width) - w / 2, number(size.height) - h / 2, w, h);
        const double first = rng.uniform(20.0, 230.0);
        cv::rectangle(image, box, cv::Scalar(first), cv::FILLED);
        if (i % 10 != 0) continue;
        const double second = rng.uniform(20.0, 230.0);
        for (int row = 0; row < 3; ++row)
            for (int column = row % 2; column < 3; column += 2)
                cv::rectangle(image,
                              cv::Rect(box.x + column * w / 3, box.y + row * h / 3, w / 3, h / 3),
                              cv::Scalar(second),
                              cv::FILLED);
    }
    return image;
}

/// Image of a board, with 4 x 4 samples per pixel and a white paper margin.
inline GreyImage wide_picture(const Board& board,
                              const camera::Camera& camera,
                              const Pose& T_camera_board,
                              const WideImagingConditions& look,
                              std::uint64_t seed) {
    constexpr int kSamples = 4;
    Rng rng(seed);
    const Pose T_board_camera = T_camera_board.inverse();
    const auto place = [&](double u, double v) -> Eigen::Vector2d {
        const auto ray = camera::unproject(camera.model, {u, v});
        if (!ray) return Eigen::Vector2d::Constant(1e6);
        const Eigen::Vector3d d = T_board_camera.rotation * *ray;
        const double t = -T_board_camera.translation_m.z() / d.z();
        if (!(t > 0.0)) return Eigen::Vector2d::Constant(1e6);
        return (T_board_camera.translation_m + t * d).head<2>() / board.spacing_m;
    };
    const int width = camera.width;
    const int height = camera.height;
    cv::Mat light = clutter({width, height}, rng);
    std::vector<Eigen::Vector2d> upper;
    std::vector<Eigen::Vector2d> lower;
    for (int u = 0; u <= width; ++u) lower.push_back(place(u - 0.5, -0.5));
    for (int v = 0; v < height; ++v) {
        upper = lower;
        for (int u = 0; u <= width; ++u)
            lower[static_cast<std::size_t>(u)] = place(u - 0.5, v + 0.5);
        for (int u = 0; u < width; ++u) {
            const auto i = static_cast<std::size_t>(u);
            double sum = 0.0;
            for (int k = 0; k < kSamples * kSamples; ++k) {
                const double s = (k % kSamples + 0.5) / kSamples;
                const double t = (k / kSamples + 0.5) / kSamples;
                const Eigen::Vector2d p = (1.0 - t) * ((1.0 - s) * upper[i] + s * upper[i + 1]) +
                                          t * ((1.0 - s) * lower[i] + s * lower[i + 1]);
                const bool squares =
                    p.x() > -1.0 && p.y() > -1.0 && p.x() < board.columns && p.y() < board.rows;
                const bool paper = p.x() > -1.0 - look.margin && p.y() > -1.0 - look.margin &&
                                   p.x() < board.columns + look.margin &&
                                   p.y() < board.rows + look.margin;
                const bool ink =
                    squares && std::fmod(std::floor(p.x()) + std::floor(p.y()) + 2.0, 2.0) == 0.0;
                sum += ink     ? look.ink_dn
                       : paper ? look.paper_dn
                               : static_cast<double>(light.at<float>(v, u));
            }
            light.at<float>(v, u) = static_cast<float>(sum / (kSamples * kSamples));
        }
    }
    cv::Mat sharp;
    cv::Mat soft;
    cv::GaussianBlur(light, sharp, cv::Size(), look.blur_px);
    cv::GaussianBlur(light, soft, cv::Size(), look.blur_right_px);
    GreyImage image(width, height);
    const double corner_px = std::hypot(0.5 * width, 0.5 * height);
    for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) {
            const double right = (u + 0.5) / width;
            const double out = std::hypot(u - 0.5 * width, v - 0.5 * height) / corner_px;
            const double share = (1.0 - (1.0 - look.corner_light) * out * out) *
                                 (1.0 - (1.0 - look.right_light) * right);
            const double value =
                share * ((1.0 - right) * static_cast<double>(sharp.at<float>(v, u)) +
                         right * static_cast<double>(soft.at<float>(v, u))) +
                look.noise_dn * rng.normal();
            image.row(v)[u] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
        }
    }
    return image;
}

}  // namespace surefoot::calibration::testing

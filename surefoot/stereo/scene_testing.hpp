// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/views.hpp"

/// A textured floor with boxes, rendered for an ideal stereo camera. Gives tests exact truth.
namespace surefoot::stereo::test {

struct Box {
    Eigen::Vector3d low_m, high_m;  ///< x forward, y left, z up, floor at 0
};

struct SceneConfig {
    int width = 672;
    int height = 376;
    double focal_px = 342.0;
    double baseline_m = 0.12;
    double camera_height_m = 1.0;
    double pitch_rad = 0.5585;  ///< 32 deg down
    double roll_rad = 0.0;
    double noise_grey = 2.0;
    double contrast_grey = 9.0;  ///< contrast of each octave of the texture
    double right_gain = 1.0;     ///< exposure of the right camera
    std::uint64_t seed = 1;
    std::vector<Box> boxes;
};

struct SyntheticPair {
    GreyImage left;
    GreyImage right;
    Image<float>
        disparity_px;  ///< truth at the pixel's centre; NaN = empty or hidden from the right
    Image<std::uint8_t> near_edge;  ///< 1 within 6 px of a jump of the truth
};

class Scene {
  public:
    explicit Scene(const SceneConfig& config) : config_(config) {
        const double c = std::cos(config.pitch_rad);
        const double s = std::sin(config.pitch_rad);
        Eigen::Matrix3d R;
        R << 0, -s, c, -1, 0, 0, 0, -c, -s;  // columns: right, down, forward of the camera
        R_world_camera_ =
            R * Eigen::AngleAxisd(config.roll_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    }

    [[nodiscard]] SyntheticPair render() const {
        SyntheticPair pair;
        const Eigen::Vector3d left(0.0, 0.0, config_.camera_height_m);
        const Eigen::Vector3d right = left + config_.baseline_m * R_world_camera_.col(0);
        pair.left = image_from(left, 1.0, 1);
        pair.right = image_from(right, config_.right_gain, 2);
        pair.disparity_px =
            Image<float>(config_.width, config_.height, std::numeric_limits<float>::quiet_NaN());
        Image<float> all(config_.width, config_.height, 0.0F);
        for (int v = 0; v < config_.height; ++v) {
            for (int u = 0; u < config_.width; ++u) {
                const Eigen::Vector3d direction = R_world_camera_ * ray(u, v);
                const auto range = hit(left, direction);
                if (!range) continue;  // ray has z = 1: the range is the depth
                const double disparity = config_.focal_px * config_.baseline_m / *range;
                all.at(u, v) = static_cast<float>(disparity);
                const Eigen::Vector3d p = left + *range * direction;
                const auto seen = hit(right, p - right);
                const bool visible = seen && *seen > 0.999 && u - disparity >= 0.0;
                if (visible) pair.disparity_px.at(u, v) = static_cast<float>(disparity);
            }
        }
        pair.near_edge = edges(all);
        return pair;
    }

  private:
    [[nodiscard]] Eigen::Vector3d ray(double u, double v) const {
        return {(u - 0.5 * (config_.width - 1)) / config_.focal_px,
                (v - 0.5 * (config_.height - 1)) / config_.focal_px,
                1.0};
    }

    /// Smallest range > 0 along `direction` (in its units) to the floor or a box.
    [[nodiscard]] std::optional<double> hit(const Eigen::Vector3d& from,
                                            const Eigen::Vector3d& direction) const {
        double best = direction.z() < -1e-9 ? -from.z() / direction.z() : 1e9;
        for (const Box& box : config_.boxes) {
            double enter = 0.0;
            double leave = 1e9;
            for (int axis = 0; axis < 3; ++axis) {
                const double inverse = 1.0 / direction[axis];
                double a = (box.low_m[axis] - from[axis]) * inverse;
                double b = (box.high_m[axis] - from[axis]) * inverse;
                if (a > b) std::swap(a, b);
                enter = std::max(enter, a);
                leave = std::min(leave, b);
            }
            if (enter > 0.0 && enter < leave) best = std::min(best, enter);
        }
        if (best > 20.0) return std::nullopt;
        return best;
    }

    static double lattice(std::uint64_t seed, std::int64_t x, std::int64_t y, std::int64_t z) {
        std::uint64_t h = seed;
        for (const std::int64_t k : {x, y, z}) h = mix_seed(h, static_cast<std::uint64_t>(k));
        return static_cast<double>(h >> 11) * 0x1.0p-53 * 3.46 - 1.73;  // variance 1
    }

    /// Value noise of a surface point: smooth, with detail from half a metre down to 5 mm.
    [[nodiscard]] double texture(const Eigen::Vector3d& p) const {
        double grey = 118.0;
        std::uint64_t octave = 0;
        for (const double cell_m : {0.5, 0.12, 0.035, 0.012, 0.005}) {
            const Eigen::Vector3d q = (p + Eigen::Vector3d(31.7, 47.3, 0.0013)) / cell_m;
            const Eigen::Vector3d f = q.array().floor();
            const Eigen::Vector3d s =
                (q - f).unaryExpr([](double t) { return t * t * (3.0 - 2.0 * t); });
            double sum = 0.0;
            for (int corner = 0; corner < 8; ++corner) {
                const int i = corner & 1, j = (corner >> 1) & 1, k = corner >> 2;
                const double weight =
                    (i ? s.x() : 1 - s.x()) * (j ? s.y() : 1 - s.y()) * (k ? s.z() : 1 - s.z());
                if (weight < 1e-12) continue;
                sum += weight * lattice(config_.seed * 16 + octave,
                                        static_cast<std::int64_t>(f.x()) + i,
                                        static_cast<std::int64_t>(f.y()) + j,
                                        static_cast<std::int64_t>(f.z()) + k);
            }
            grey += 1.5 * config_.contrast_grey * sum;
            ++octave;
        }
        return grey;
    }

    [[nodiscard]] GreyImage image_from(const Eigen::Vector3d& from,
                                       double gain,
                                       std::uint64_t stream) const {
        GreyImage image(config_.width, config_.height);
        Rng rng(mix_seed(config_.seed, stream));
        for (int v = 0; v < config_.height; ++v) {
            for (int u = 0; u < config_.width; ++u) {
                double grey = 0.0;
                for (int sample = 0; sample < 4; ++sample) {
                    const double du = (sample & 1) != 0 ? 0.25 : -0.25;
                    const double dv = (sample & 2) != 0 ? 0.25 : -0.25;
                    const Eigen::Vector3d direction = R_world_camera_ * ray(u + du, v + dv);
                    const auto range = hit(from, direction);
                    grey += range ? texture(from + *range * direction) : 90.0;
                }
                const double noisy = 0.25 * grey * gain + config_.noise_grey * rng.normal();
                image.at(u, v) = saturated_integer<std::uint8_t>(std::round(noisy));
            }
        }
        return image;
    }

    static Image<std::uint8_t> edges(const Image<float>& disparity) {
        constexpr int kReach_px = 6;
        Image<std::uint8_t> near(disparity.width(), disparity.height(), 0);
        const auto mark = [&](int u, int v) {
            for (int b = std::max(0, v - kReach_px);
                 b <= std::min(near.height() - 1, v + kReach_px);
                 ++b) {
                for (int a = std::max(0, u - kReach_px);
                     a <= std::min(near.width() - 1, u + kReach_px);
                     ++a) {
                    near.at(a, b) = 1;
                }
            }
        };
        for (int v = 1; v < disparity.height(); ++v) {
            for (int u = 1; u < disparity.width(); ++u) {
                const float d = disparity.at(u, v);
                if (std::abs(d - disparity.at(u - 1, v)) > 1.0F ||
                    std::abs(d - disparity.at(u, v - 1)) > 1.0F) {
                    mark(u, v);
                }
            }
        }
        return near;
    }

    SceneConfig config_;
    Eigen::Matrix3d R_world_camera_;
};

}  // namespace surefoot::stereo::test

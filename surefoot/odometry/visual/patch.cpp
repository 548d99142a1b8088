// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/patch.hpp"

#include <cmath>

#include "surefoot/core/nearest_pixel.hpp"

namespace surefoot::odometry {
namespace {

constexpr int kMaxIterations = 15;
constexpr double kConverged_px = 0.01;
/// Lower limit of the weaker of the two mean squared gradients [grey^2/px^2] of a patch.
constexpr double kMinGradientSq = 3.0;

/// Bilinear interpolation; the caller guarantees that all four pixels exist.
inline float sample(const std::uint8_t* corner, std::ptrdiff_t stride, float a, float b) {
    const float top =
        static_cast<float>(corner[0]) * (1.0F - a) + static_cast<float>(corner[1]) * a;
    const float low = static_cast<float>(corner[stride]) * (1.0F - a) +
                      static_cast<float>(corner[stride + 1]) * a;
    return top * (1.0F - b) + low * b;
}

/// Subtracts the mean and returns the norm of the remainder.
float remove_mean(std::array<float, PatchTemplate::kCount>& values) {
    float sum = 0.0F;
    for (const float value : values) sum += value;
    const float mean = sum / static_cast<float>(PatchTemplate::kCount);
    float square = 0.0F;
    for (float& value : values) {
        value -= mean;
        square += value * value;
    }
    return std::sqrt(square);
}

float dot(const std::array<float, PatchTemplate::kCount>& a,
          const std::array<float, PatchTemplate::kCount>& b) {
    float sum = 0.0F;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

/// Removes the part of a gradient that a change of gain explains.
void remove_gain(std::array<float, PatchTemplate::kCount>& gradient, const PatchTemplate& patch) {
    const float share = dot(gradient, patch.value) / (patch.norm * patch.norm);
    for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] -= share * patch.value[i];
}

/// Computes `step_u` and `step_v` from the gradients; returns false without texture.
bool invert_gradients(PatchTemplate& patch,
                      std::array<float, PatchTemplate::kCount>& gradient_u,
                      std::array<float, PatchTemplate::kCount>& gradient_v) {
    remove_mean(gradient_u);
    remove_mean(gradient_v);
    remove_gain(gradient_u, patch);
    remove_gain(gradient_v, patch);
    const double uu = static_cast<double>(dot(gradient_u, gradient_u));
    const double uv = static_cast<double>(dot(gradient_u, gradient_v));
    const double vv = static_cast<double>(dot(gradient_v, gradient_v));
    const double half_trace = 0.5 * (uu + vv);
    const double det = uu * vv - uv * uv;
    const double weaker = half_trace - std::sqrt(std::max(half_trace * half_trace - det, 0.0));
    if (!(weaker > kMinGradientSq * PatchTemplate::kCount)) return false;
    for (std::size_t i = 0; i < patch.value.size(); ++i) {
        const double u = static_cast<double>(gradient_u[i]);
        const double v = static_cast<double>(gradient_v[i]);
        patch.step_u[i] = static_cast<float>((vv * u - uv * v) / det);
        patch.step_v[i] = static_cast<float>((uu * v - uv * u) / det);
    }
    return true;
}

/// Reads the image around a position and removes its mean. Returns false at the image border.
bool read_window(ImageView<const std::uint8_t> image,
                 const Eigen::Vector2d& centre_px,
                 std::array<float, PatchTemplate::kCount>& window,
                 float& norm) {
    constexpr int kRadius = PatchTemplate::kRadius;
    const double u_floor = std::floor(centre_px.x());
    const double v_floor = std::floor(centre_px.y());
    if (!(u_floor >= kRadius && v_floor >= kRadius && u_floor + kRadius + 1 < image.width &&
          v_floor + kRadius + 1 < image.height))
        return false;
    const float a = static_cast<float>(centre_px.x() - u_floor);
    const float b = static_cast<float>(centre_px.y() - v_floor);
    const int u0 = static_cast<int>(u_floor) - kRadius;  // in range: in the image, as checked
    const int v0 = static_cast<int>(v_floor) - kRadius;  // in range: in the image, as checked
    std::size_t i = 0;
    for (int v = 0; v < PatchTemplate::kSize; ++v) {
        const std::uint8_t* row = image.row(v0 + v) + u0;
        for (int u = 0; u < PatchTemplate::kSize; ++u)
            window[i++] = sample(row + u, image.stride, a, b);
    }
    norm = remove_mean(window);
    return true;
}

}  // namespace

std::optional<HostPatch> cut_patch(ImageView<const std::uint8_t> image,
                                   const Eigen::Vector2d& raw_px) {
    constexpr int kRadius = HostPatch::kRadius;
    const auto nearest = nearest_pixel(raw_px.x(), raw_px.y(), image.width, image.height, kRadius);
    if (!nearest) return std::nullopt;
    const auto [u, v] = *nearest;
    HostPatch patch;
    for (int row = 0; row < HostPatch::kSize; ++row) {
        const std::uint8_t* from = image.row(v - kRadius + row) + (u - kRadius);
        std::copy(from,
                  from + HostPatch::kSize,
                  patch.pixels.begin() + static_cast<std::ptrdiff_t>(row) * HostPatch::kSize);
    }
    patch.centre = {static_cast<float>(raw_px.x() - u + kRadius),
                    static_cast<float>(raw_px.y() - v + kRadius)};
    return patch;
}

std::optional<PatchTemplate> warp_patch(const HostPatch& host,
                                        const Eigen::Matrix2d& host_from_view) {
    constexpr int kRadius = PatchTemplate::kRadius + 1;  // one more pixel for the gradients
    constexpr int kSize = 2 * kRadius + 1;
    std::array<float, kSize * kSize> warped{};
    const Eigen::Matrix2f A = host_from_view.cast<float>();
    std::size_t i = 0;
    for (int v = -kRadius; v <= kRadius; ++v) {
        for (int u = -kRadius; u <= kRadius; ++u) {
            const Eigen::Vector2f at =
                host.centre + A * Eigen::Vector2f(static_cast<float>(u), static_cast<float>(v));
            if (!(at.x() >= 0.0F && at.y() >= 0.0F && at.x() < HostPatch::kSize - 1 &&
                  at.y() < HostPatch::kSize - 1))
                return std::nullopt;
            const int u0 = static_cast<int>(at.x());  // in range: inside the patch, see above
            const int v0 = static_cast<int>(at.y());  // in range: inside the patch, see above
            warped[i++] = sample(&host.pixels[static_cast<std::size_t>(v0 * HostPatch::kSize + u0)],
                                 HostPatch::kSize,
                                 at.x() - static_cast<float>(u0),
                                 at.y() - static_cast<float>(v0));
        }
    }
    PatchTemplate patch;
    std::array<float, PatchTemplate::kCount> gradient_u{};
    std::array<float, PatchTemplate::kCount> gradient_v{};
    i = 0;
    for (int v = 1; v < kSize - 1; ++v) {
        for (int u = 1; u < kSize - 1; ++u, ++i) {
            const auto at = static_cast<std::size_t>(v * kSize + u);
            patch.value[i] = warped[at];
            gradient_u[i] = 0.5F * (warped[at + 1] - warped[at - 1]);
            gradient_v[i] = 0.5F * (warped[at + kSize] - warped[at - kSize]);
        }
    }
    patch.norm = remove_mean(patch.value);
    if (!(patch.norm > 0.0F) || !invert_gradients(patch, gradient_u, gradient_v))
        return std::nullopt;
    return patch;
}

std::optional<Alignment> align_patch(const PatchTemplate& patch,
                                     ImageView<const std::uint8_t> image,
                                     const Eigen::Vector2d& start_px,
                                     double max_shift_px) {
    std::array<float, PatchTemplate::kCount> window{};
    Eigen::Vector2d at_px = start_px;
    float norm = 0.0F;
    float product = 0.0F;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
        if (!read_window(image, at_px, window, norm)) return std::nullopt;
        product = dot(window, patch.value);
        if (!(product > 0.0F)) return std::nullopt;  // the image shows the negative of the template
        // The window is the shifted template times a gain. First scales the window to the contrast
        // of the template.
        const double inverse_gain = static_cast<double>(patch.norm * patch.norm / product);
        const Eigen::Vector2d step =
            -inverse_gain * Eigen::Vector2d(static_cast<double>(dot(window, patch.step_u)),
                                            static_cast<double>(dot(window, patch.step_v)));
        at_px += step;
        if (!((at_px - start_px).norm() <= max_shift_px)) return std::nullopt;
        if (step.norm() < kConverged_px) break;
    }
    return Alignment{at_px, static_cast<double>(product / (norm * patch.norm))};
}

}  // namespace surefoot::odometry

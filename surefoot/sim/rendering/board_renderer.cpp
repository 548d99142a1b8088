// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/board_renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/sim/rendering/imaging.hpp"
#include "surefoot/sim/rendering/optics.hpp"

namespace surefoot::sim {
namespace {

/// Samples in each direction that decide whether a pixel has one colour only. They may miss shapes
/// smaller than a third of a pixel.
constexpr int kProbeSamples = 4;

bool inside(const PrintedSheet::Rectangle& box, const Eigen::Vector2d& p_m) {
    return p_m.x() >= box.left_m && p_m.x() < box.right_m && p_m.y() >= box.top_m &&
           p_m.y() < box.bottom_m;
}

/// Finds the colour at a point of the sheet. A grid of square bins stores the shapes that reach
/// into each bin, so that not every shape is tested.
class Sheet {
  public:
    Sheet(const PrintedSheet& sheet, const ImagingConditions& look) : sheet_(sheet), look_(look) {
        bins_.resize(static_cast<std::size_t>(kBins) * kBins);
        for (const auto& box : sheet.rectangles) {
            for_bins(box, [&](Bin& bin) { bin.rectangles.push_back(&box); });
        }
        for (const auto& disc : sheet.discs) {
            const PrintedSheet::Rectangle around{disc.x_m - disc.radius_m,
                                                 disc.y_m - disc.radius_m,
                                                 disc.x_m + disc.radius_m,
                                                 disc.y_m + disc.radius_m};
            for_bins(around, [&](Bin& bin) { bin.discs.push_back(&disc); });
        }
    }

    [[nodiscard]] double colour_at(const Eigen::Vector2d& p_m) const {
        if (!inside(sheet_.paper, p_m)) return look_.background_dn;  // NaN: not on the sheet
        const int place = row_of(p_m.y()) * kBins + column_of(p_m.x());
        const Bin& bin = bins_[static_cast<std::size_t>(place)];
        for (const auto* box : bin.rectangles) {
            if (inside(*box, p_m)) return look_.ink_dn;
        }
        for (const auto* disc : bin.discs) {
            const double dx_m = p_m.x() - disc->x_m;
            const double dy_m = p_m.y() - disc->y_m;
            if (dx_m * dx_m + dy_m * dy_m < disc->radius_m * disc->radius_m) return look_.ink_dn;
        }
        return look_.paper_dn;
    }

  private:
    static constexpr int kBins = 64;
    struct Bin {
        std::vector<const PrintedSheet::Rectangle*> rectangles;
        std::vector<const PrintedSheet::Disc*> discs;
    };

    static int bin_of(double value_m, double low_m, double high_m) {
        const double bin = std::floor(kBins * (value_m - low_m) / (high_m - low_m));
        return clamped_integer<int>(bin, 0, kBins - 1);
    }
    [[nodiscard]] int column_of(double x_m) const {
        return bin_of(x_m, sheet_.paper.left_m, sheet_.paper.right_m);
    }
    [[nodiscard]] int row_of(double y_m) const {
        return bin_of(y_m, sheet_.paper.top_m, sheet_.paper.bottom_m);
    }
    template <typename Add>
    void for_bins(const PrintedSheet::Rectangle& box, const Add& add) {
        for (int row = row_of(box.top_m); row <= row_of(box.bottom_m); ++row) {
            for (int column = column_of(box.left_m); column <= column_of(box.right_m); ++column)
                add(bins_[static_cast<std::size_t>(row * kBins + column)]);
        }
    }

    const PrintedSheet& sheet_;
    const ImagingConditions& look_;
    std::vector<Bin> bins_;
};

/// Point where the ray of a pixel meets the plane of the sheet, in the frame of the sheet. NaN if
/// the ray does not meet the plane.
Eigen::Vector2d place_on_sheet(const camera::Camera& camera,
                               const Pose& T_sheet_camera,
                               const Eigen::Vector2d& pixel) {
    Eigen::Vector2d nowhere = Eigen::Vector2d::Constant(std::nan(""));
    const auto ray = camera::unproject(camera.model, pixel);
    if (!ray) return nowhere;
    const Eigen::Vector3d direction = T_sheet_camera.rotation * *ray;
    const Eigen::Vector3d& origin_m = T_sheet_camera.translation_m;
    const double distance_m = -origin_m.z() / direction.z();
    if (!(distance_m > 0.0) || !std::isfinite(distance_m)) return nowhere;
    return (origin_m + distance_m * direction).head<2>();
}

/// Mean colour of a pixel with these sheet points at its corners: top left, top right, bottom left,
/// bottom right. Points between the corners are interpolated bilinearly. Over one pixel the
/// interpolation is exact to 1e-3 px for every lens that can be calibrated.
double mean_colour(const Sheet& sheet, const std::array<Eigen::Vector2d, 4>& corners_m) {
    double first = 0.0;
    bool uniform = true;
    const auto sum = [&](int samples) {
        double total = 0.0;
        for (int row = 0; row < samples; ++row) {
            const double t = (row + 0.5) / samples;
            const Eigen::Vector2d left_m = (1.0 - t) * corners_m[0] + t * corners_m[2];
            const Eigen::Vector2d right_m = (1.0 - t) * corners_m[1] + t * corners_m[3];
            for (int column = 0; column < samples; ++column) {
                const double s = (column + 0.5) / samples;
                const double colour = sheet.colour_at((1.0 - s) * left_m + s * right_m);
                if (row == 0 && column == 0) first = colour;
                uniform = uniform && colour == first;
                total += colour;
            }
        }
        return total / (samples * samples);
    };
    const double probed = sum(kProbeSamples);
    return uniform ? probed : sum(kEdgeSamples);
}

Image<float> light_of(const PrintedSheet& sheet,
                      const camera::Camera& camera,
                      const Pose& T_camera_sheet,
                      const ImagingConditions& look,
                      Executor& executor) {
    const Sheet colours(sheet, look);
    const Pose T_sheet_camera = T_camera_sheet.inverse();
    Image<float> light_dn(camera.width, camera.height);
    executor.parallel_for(camera.height, [&](int v) {
        const auto corner = [&](int u, int dv) {
            return place_on_sheet(camera, T_sheet_camera, {u - 0.5, v + dv - 0.5});
        };
        Eigen::Vector2d upper_m = corner(0, 0);
        Eigen::Vector2d lower_m = corner(0, 1);
        for (int u = 0; u < camera.width; ++u) {
            const Eigen::Vector2d next_upper_m = corner(u + 1, 0);
            const Eigen::Vector2d next_lower_m = corner(u + 1, 1);
            light_dn.row(v)[u] = static_cast<float>(
                mean_colour(colours, {upper_m, next_upper_m, lower_m, next_lower_m}));
            upper_m = next_upper_m;
            lower_m = next_lower_m;
        }
    });
    return light_dn;
}

}  // namespace

GreyImage render_board(const PrintedSheet& sheet,
                       const camera::Camera& camera,
                       const Pose& T_camera_sheet,
                       const ImagingConditions& look,
                       std::uint64_t seed,
                       Executor& executor) {
    Image<float> light_dn = light_of(sheet, camera, T_camera_sheet, look, executor);
    if (look.blur_sigma_px > 0.0) smear(smear_kernel(look.blur_sigma_px), executor, light_dn);
    const PixelNoise noise;
    const std::uint64_t key = PixelNoise::key(seed, 0);
    GreyImage image(camera.width, camera.height);
    executor.parallel_for(camera.height, [&](int v) {
        for (int u = 0; u < camera.width; ++u) {
            const auto pixel = static_cast<std::uint32_t>(v * camera.width + u);
            const double value = static_cast<double>(light_dn.row(v)[u]) +
                                 look.noise_dn * static_cast<double>(noise.normal(key, pixel));
            image.row(v)[u] = saturated_integer<std::uint8_t>(std::round(value));
        }
    });
    return image;
}

}  // namespace surefoot::sim

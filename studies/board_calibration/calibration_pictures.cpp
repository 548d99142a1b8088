// SPDX-License-Identifier: Apache-2.0
#include "studies/board_calibration/calibration_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/eval/report/canvas.hpp"
#include "surefoot/eval/report/figure.hpp"
#include "surefoot/eval/report/percentile.hpp"

namespace surefoot::app {
namespace {

using eval::PointPx;
namespace palette = eval::palette;

/// Approximate width of a drawn image plane.
constexpr double kWidth_px = 900.0;

/// An empty drawing of the image plane of a camera. `scale`: pixels of the drawing per pixel of the
/// image.
struct Plane {
    eval::Figure figure;
    double scale = 1.0;

    [[nodiscard]] PointPx at(const Eigen::Vector2d& pixel) const {
        // The outer corner of the first pixel lies at (-1/2, -1/2).
        return {figure.plot.left + scale * (pixel.x() + 0.5),
                figure.plot.top + scale * (pixel.y() + 0.5)};
    }
};

Plane plane_of(const calibration::ImageSize& size, const eval::FigureText& text) {
    Plane plane;
    plane.scale = kWidth_px / std::max(1, size.width);
    const int width = std::max(1, eval::nearest_px(plane.scale * size.width));
    const int height = std::max(1, eval::nearest_px(plane.scale * size.height));
    plane.figure = eval::make_figure(width, height, false, {}, text);
    return plane;
}

void stripe(const calibration::Coverage& coverage, eval::Figure& figure) {
    using calibration::Coverage;
    for (int v = 0; v < figure.plot.height; ++v) {
        for (int u = 0; u < figure.plot.width; ++u) {
            const int column = u * Coverage::kColumns / figure.plot.width;
            const int row = v * Coverage::kRows / figure.plot.height;
            if (coverage.points.at(column, row) == 0)
                figure.picture.at(figure.plot.left + u, figure.plot.top + v) =
                    eval::hatched_grey(u, v);
        }
    }
}

/// Returns one flag per view: true if the result uses the view.
std::vector<bool> used_views(const CalibrationRun& run) {
    std::vector<bool> used(run.views.size(), true);
    for (const calibration::RejectedView& rejected : rejected_views(run))
        used[rejected.index] = false;
    return used;
}

/// Returns two images of equal height side by side.
GreyImage side_by_side(const GreyImage& left, const GreyImage& right) {
    GreyImage both(left.width() + right.width(), left.height());
    for (int v = 0; v < left.height(); ++v) {
        std::copy(left.row(v), left.row(v) + left.width(), both.row(v));
        std::copy(right.row(v), right.row(v) + right.width(), both.row(v) + left.width());
    }
    return both;
}

}  // namespace

eval::Picture coverage_picture(const CalibrationRun& run, int camera) {
    const auto& coverage = run.coverage[static_cast<std::size_t>(camera)];
    Plane plane = plane_of(
        run.size,
        {fmt::format("Positions of the board, {}", camera_name(run, camera)),
         fmt::format(
             "{:.0f} % of the image covered; blue: view used, orange: view left out, stripes: no "
             "board",
             100.0 * coverage.seen_share)});
    stripe(coverage, plane.figure);
    const std::vector<bool> used = used_views(run);
    for (std::size_t i = 0; i < run.views.size(); ++i) {
        const auto& view = camera == 0 ? run.views[i].left : run.views[i].right;
        const eval::Rgb8 colour = used[i] ? palette::kSafe : palette::kUnsafe;
        for (const Eigen::Vector2d& pixel : view.pixels)
            eval::fill_circle(plane.figure.picture, plane.at(pixel), 2.5, colour);
    }
    eval::draw_rect(plane.figure.picture, plane.figure.plot, 2, palette::kInk);
    return std::move(plane.figure.picture);
}

eval::Picture tilt_picture(const CalibrationRun& run, int camera) {
    constexpr int kSide_px = 620;
    constexpr double kOuter_deg = 60.0;
    constexpr double kSteepest_deg = 45.0;
    constexpr double kRadiusPerDegree_px = 0.5 * kSide_px / kOuter_deg;
    const auto& coverage = run.coverage[static_cast<std::size_t>(camera)];
    eval::Figure figure =
        eval::make_figure(kSide_px,
                          kSide_px,
                          false,
                          {},
                          {fmt::format("Tilt of the board, {}", camera_name(run, camera)),
                           "tilt in deg; each dot is a view, drawn towards the nearer side of the "
                           "board; stripes: missing tilts"});
    const PointPx center{figure.plot.left + 0.5 * kSide_px, figure.plot.top + 0.5 * kSide_px};
    bool seen[std::size(calibration::kNearSideNames)] = {};
    for (const calibration::ViewShape& view : coverage.views)
        seen[static_cast<std::size_t>(view.near_side)] |=
            view.tilt_deg >= calibration::kEnoughTilt_deg;
    const auto side_of = [](double to_right, double down) {
        using enum calibration::NearSide;
        if (std::abs(to_right) > std::abs(down)) return to_right < 0.0 ? left : right;
        return down < 0.0 ? top : bottom;
    };
    for (int v = 0; v < kSide_px; ++v) {
        for (int u = 0; u < kSide_px; ++u) {
            const double to_right = u - 0.5 * kSide_px;
            const double down = v - 0.5 * kSide_px;
            const double tilt_deg = std::hypot(to_right, down) / kRadiusPerDegree_px;
            if (tilt_deg < calibration::kEnoughTilt_deg || tilt_deg > kSteepest_deg ||
                seen[static_cast<std::size_t>(side_of(to_right, down))])  // in range: an enumerator
                continue;
            figure.picture.at(figure.plot.left + u, figure.plot.top + v) = eval::hatched_grey(u, v);
        }
    }
    for (const double ring_deg : {calibration::kEnoughTilt_deg, kSteepest_deg}) {
        eval::draw_circle(figure.picture, center, ring_deg * kRadiusPerDegree_px, 1, palette::kInk);
        eval::draw_text(figure.picture,
                        {center.u + 4.0, center.v - ring_deg * kRadiusPerDegree_px - 6.0},
                        fmt::format("{:.0f}", ring_deg),
                        {});
    }
    const std::vector<bool> used = used_views(run);
    for (std::size_t i = 0; i < coverage.views.size(); ++i) {
        const calibration::ViewShape& view = coverage.views[i];
        if (view.spacing_px <= 0.0) continue;
        constexpr double kDirection_deg[] = {180.0, 0.0, 270.0, 90.0};  // by NearSide, clockwise
        // Spreads the dots of one side, so that they do not hide each other.
        const double fan_deg = 9.0 * (static_cast<double>(i % 7) - 3.0);
        const double angle_rad =
            (kDirection_deg[static_cast<std::size_t>(view.near_side)] + fan_deg) *
            std::numbers::pi / 180.0;
        const double radius_px = std::min(view.tilt_deg, kOuter_deg) * kRadiusPerDegree_px;
        eval::fill_circle(figure.picture,
                          {center.u + radius_px * std::cos(angle_rad),
                           center.v + radius_px * std::sin(angle_rad)},
                          5.0,
                          used[i] ? palette::kSafe : palette::kUnsafe);
    }
    eval::draw_rect(figure.picture, figure.plot, 2, palette::kInk);
    return std::move(figure.picture);
}

eval::Picture residual_picture(const CalibrationRun& run, const CalibratedCamera& this_camera) {
    std::vector<double> lengths_px;
    for (const auto& view : this_camera.views) {
        for (const auto& residual : view.fit.residuals_px) lengths_px.push_back(residual.norm());
    }
    std::sort(lengths_px.begin(), lengths_px.end());
    const double usual_px = lengths_px.empty() ? 1.0 : eval::percentile_of_sorted(lengths_px, 0.95);
    constexpr double kShown_px = 20.0;  // length of the arrow of the 95th percentile
    const double enlarged = kShown_px / std::max(usual_px, 1e-6);
    const bool right = std::string(this_camera.name) == "right";
    Plane plane = plane_of(run.size,
                           {fmt::format("Measured minus predicted position, {}", this_camera.name),
                            fmt::format("{} points; 95 % of the residuals are within {:.2f} px; "
                                        "arrows enlarged {:.0f} times; orange: point left out",
                                        lengths_px.size(),
                                        usual_px,
                                        enlarged / plane_of(run.size, {}).scale)});
    for (const auto& view : this_camera.views) {
        const auto& seen = right ? run.views[view.index].right : run.views[view.index].left;
        for (std::size_t i = 0; i < view.fit.ids.size(); ++i) {
            const int id = view.fit.ids[i];
            const bool outlier =
                std::find(view.fit.outliers.begin(), view.fit.outliers.end(), id) !=
                view.fit.outliers.end();
            const PointPx from = plane.at(pixel_of(seen, id));
            const Eigen::Vector2d d = enlarged * view.fit.residuals_px[i];
            const eval::Rgb8 colour = outlier ? palette::kUnsafe : palette::kSafe;
            eval::draw_line(
                plane.figure.picture, from, {from.u + d.x(), from.v + d.y()}, 1, colour);
            eval::fill_circle(plane.figure.picture, from, 1.5, colour);
        }
    }
    eval::draw_rect(plane.figure.picture, plane.figure.plot, 2, palette::kInk);
    return std::move(plane.figure.picture);
}

eval::Picture epipolar_picture(const CalibrationRun& run) {
    if (!run.stereo) return {};
    const auto rectifier = camera::Rectifier::make(run.stereo->rig);
    if (!rectifier) return {};
    StereoFrame frame;
    frame.left = run.sample.left;
    frame.right = run.sample.right;
    camera::RectifiedPair pair;
    rectifier->rectify(frame, pair);
    const GreyImage both = side_by_side(pair.left, pair.right);
    eval::Picture picture(both.width(), both.height());
    for (std::size_t i = 0; i < both.size(); ++i)
        picture.data()[i] = {both.data()[i], both.data()[i], both.data()[i]};
    constexpr int kLines = 16;
    for (int line = 0; line < kLines; ++line) {
        const double v = (line + 0.5) * both.height() / kLines;
        eval::draw_line(picture,
                        {0.0, v},
                        {static_cast<double>(both.width()), v},
                        1,
                        line % 2 == 0 ? palette::kGreen : palette::kUnsafe);
    }
    return picture;
}

}  // namespace surefoot::app

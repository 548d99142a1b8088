// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/circle_centres.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <optional>

#include "surefoot/calibration/board_order.hpp"

namespace surefoot::calibration {
namespace {

/// Neighbours that a local map is fitted to: two rings of a grid, half of them at its corner.
constexpr std::size_t kNeighbours = 12;
/// Darker than this share of the contrast counts for the centre of gravity; below is noise.
constexpr double kFaintInk = 0.15;
constexpr double kLeastContrast_dn = 20.0;

/// Perspective first, since a parabola follows it badly on a tilted board; what the lens adds is
/// what it leaves.
std::optional<LocalMap> local_map(const std::vector<Eigen::Vector2d>& places_m,
                                  const std::vector<Eigen::Vector2d>& pixels) {
    std::vector<cv::Point2d> from;
    std::vector<cv::Point2d> to;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        from.emplace_back(places_m[i].x(), places_m[i].y());
        to.emplace_back(pixels[i].x(), pixels[i].y());
    }
    const cv::Mat h = cv::findHomography(from, to);
    if (h.empty()) return std::nullopt;
    Eigen::Matrix3d H;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) H(row, column) = h.at<double>(row, column);
    }
    std::vector<Eigen::Vector2d> rest;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const Eigen::Vector3d seen = H * places_m[i].homogeneous();
        rest.push_back(pixels[i] - seen.hnormalized());
    }
    auto map = fit_local_map(places_m, rest);
    if (!map) return std::nullopt;
    // pixel = (p + A x) / (1 + c x): J = A - p c', H_k = -(J_k c' + c J_k').
    H /= H(2, 2);
    const Eigen::Vector2d p = H.topRightCorner<2, 1>();
    const Eigen::RowVector2d c = H.bottomLeftCorner<1, 2>();
    const Eigen::Matrix2d J = H.topLeftCorner<2, 2>() - p * c;
    const auto bend = [&](Eigen::Index k) -> Eigen::Matrix2d {
        const Eigen::Matrix2d outer = J.row(k).transpose() * c;
        return -(outer + outer.transpose());
    };
    map->pixel += p;
    map->J_px_m += J;
    map->H_u += bend(0);
    map->H_v += bend(1);
    return map;
}

/// The board's map into the image around each of its points.
std::vector<std::optional<LocalMap>> local_maps(const std::vector<Eigen::Vector3d>& board_m,
                                                const std::vector<Eigen::Vector2d>& pixels) {
    std::vector<std::optional<LocalMap>> maps;
    for (const Eigen::Vector3d& here_m : board_m) {
        std::vector<std::size_t> nearest(board_m.size());
        for (std::size_t i = 0; i < nearest.size(); ++i) nearest[i] = i;
        const auto distance = [&](std::size_t i) { return (board_m[i] - here_m).squaredNorm(); };
        std::stable_sort(nearest.begin(), nearest.end(), [&](std::size_t a, std::size_t b) {
            return distance(a) < distance(b);
        });
        nearest.resize(std::min(nearest.size(), kNeighbours));
        std::vector<Eigen::Vector2d> near_m;
        std::vector<Eigen::Vector2d> near_px;
        for (const std::size_t i : nearest) {
            near_m.emplace_back((board_m[i] - here_m).head<2>());
            near_px.push_back(pixels[i]);
        }
        maps.push_back(local_map(near_m, near_px));
    }
    return maps;
}

struct Blob {
    Eigen::Vector2d centre;
    double area_px2 = 0.0;
};

double median_of(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Calls `use(pixel, distance from the centre on the board / reach)` for the pixels within `reach`.
template <typename Use>
void for_pixels_around(const Eigen::Vector2d& centre,
                       const Eigen::Matrix2d& J_px_m,
                       double reach_m,
                       ImageView<const std::uint8_t> image,
                       const Use& use) {
    const Eigen::Matrix2d J_m_px = J_px_m.inverse();
    const Eigen::Vector2d half = reach_m * J_px_m.rowwise().norm();
    const int last_v = std::min(image.height - 1, static_cast<int>(centre.y() + half.y()) + 1);
    const int last_u = std::min(image.width - 1, static_cast<int>(centre.x() + half.x()) + 1);
    for (int v = std::max(0, static_cast<int>(centre.y() - half.y())); v <= last_v; ++v) {
        for (int u = std::max(0, static_cast<int>(centre.x() - half.x())); u <= last_u; ++u) {
            const Eigen::Vector2d pixel(u, v);
            const double distance = (J_m_px * (pixel - centre)).norm() / reach_m;
            if (distance <= 1.0) use(pixel, distance, static_cast<double>(image.row(v)[u]));
        }
    }
}

/// Ink within `reach_m` of a rough centre: its centre of gravity and how much of it there is.
std::optional<Blob> blob_at(const Eigen::Vector2d& centre,
                            const Eigen::Matrix2d& J_px_m,
                            double reach_m,
                            ImageView<const std::uint8_t> image) {
    constexpr double kRing = 0.9;    // beyond is paper
    constexpr double kHeart = 0.25;  // within is ink
    std::vector<double> paper_dn;
    std::vector<double> ink_dn;
    for_pixels_around(centre, J_px_m, reach_m, image, [&](const auto&, double distance, double dn) {
        if (distance > kRing) paper_dn.push_back(dn);
        if (distance < kHeart) ink_dn.push_back(dn);
    });
    if (paper_dn.empty() || ink_dn.empty()) return std::nullopt;
    const double white_dn = median_of(std::move(paper_dn));
    const double contrast_dn = white_dn - median_of(std::move(ink_dn));
    if (contrast_dn < kLeastContrast_dn) return std::nullopt;
    Blob blob{Eigen::Vector2d::Zero(), 0.0};
    double weights = 0.0;
    for_pixels_around(centre, J_px_m, reach_m, image, [&](const auto& pixel, double, double dn) {
        const double ink = (white_dn - dn) / contrast_dn;
        blob.area_px2 += ink;
        if (ink < kFaintInk) return;
        weights += ink;
        blob.centre += ink * pixel;
    });
    blob.centre /= weights;
    return blob;
}

/// From the image of a circle's centre to the centre of gravity of its image, to second order in
/// the radius: mean of pixel(x) det J(x) over the disc, by det J, with E[x x'] = r^2/4.
Eigen::Vector2d offset_of_centroid(const LocalMap& map, double radius_sq_m2) {
    const Eigen::Matrix2d inverse = map.J_px_m.inverse();
    Eigen::Vector2d gradient;  // of log det J
    for (Eigen::Index k = 0; k < 2; ++k) {
        Eigen::Matrix2d slope;
        slope.row(0) = map.H_u.row(k);
        slope.row(1) = map.H_v.row(k);
        gradient[k] = (inverse * slope).trace();
    }
    const Eigen::Vector2d curvature(map.H_u.trace(), map.H_v.trace());
    return 0.25 * radius_sq_m2 * (0.5 * curvature + map.J_px_m * gradient);
}

}  // namespace

std::vector<Eigen::Vector2d> refined_circle_centres(const Board& board,
                                                    const std::vector<Eigen::Vector2d>& rough,
                                                    ImageView<const std::uint8_t> image) {
    const std::vector<Eigen::Vector3d> board_m = board.points_m();
    const bool staggered = board.kind == BoardKind::asymmetric_circles;
    const double nearest_m = staggered ? board.spacing_m / std::numbers::sqrt2 : board.spacing_m;
    const double reach_m = 0.48 * nearest_m;
    std::vector<Eigen::Vector2d> centres = rough;
    std::vector<double> radii_sq_m2;
    constexpr int kRounds = 2;  // the second one looks around the centre of the first
    for (int round = 0; round < kRounds; ++round) {
        const auto maps = local_maps(board_m, centres);
        radii_sq_m2.clear();
        for (std::size_t i = 0; i < centres.size(); ++i) {
            if (!maps[i] || std::abs(maps[i]->J_px_m.determinant()) <= 0.0) continue;
            const auto blob = blob_at(centres[i], maps[i]->J_px_m, reach_m, image);
            if (!blob) continue;
            centres[i] = blob->centre;
            radii_sq_m2.push_back(blob->area_px2 / std::abs(maps[i]->J_px_m.determinant()) /
                                  std::numbers::pi);
        }
    }
    if (radii_sq_m2.empty()) return rough;
    const double radius_sq_m2 = median_of(std::move(radii_sq_m2));
    const auto maps = local_maps(board_m, centres);
    for (std::size_t i = 0; i < centres.size(); ++i) {
        if (maps[i]) centres[i] -= offset_of_centroid(*maps[i], radius_sq_m2);
    }
    return centres;
}

}  // namespace surefoot::calibration

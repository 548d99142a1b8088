// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/circle_centres.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <optional>

#include "surefoot/calibration/boards/board_order.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/geometry/statistics.hpp"

namespace surefoot::calibration {
namespace {

/// Number of circles from which a local map is fitted: one circle and the ring around it. With a
/// second ring the map is too flat: in a fisheye image, the measured radius of the circles is then
/// 0.4 % too large, with one ring 0.27 %.
constexpr std::size_t kNeighbours = 9;
/// Reach of the dark area beyond the rim: about three sigma of a blur of 0.8 px. Farther pixels
/// only add noise, and noise far from the centre moves the centre of gravity most.
constexpr double kSoftRim_px = 2.5;
constexpr double kLeastContrast_dn = 20.0;

/// Returns the derivative of the map from board to image [px/m] at the origin of `places_m`. First
/// fits a perspective map, because a parabola fits a tilted board badly. Then fits the remaining
/// effect of the lens.
std::optional<Eigen::Matrix2d> local_slope(const std::vector<Eigen::Vector2d>& places_m,
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
    H /= H(2, 2);
    std::vector<Eigen::Vector2d> rest;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const Eigen::Vector3d seen = H * places_m[i].homogeneous();
        rest.push_back(pixels[i] - seen.hnormalized());
    }
    const auto map = fit_local_map(places_m, rest);
    if (!map) return std::nullopt;
    // pixel = (p + A x) / (1 + c x) + rest, so J = A - p c' + J of the rest.
    const Eigen::Vector2d p = H.topRightCorner<2, 1>();
    const Eigen::RowVector2d c = H.bottomLeftCorner<1, 2>();
    const Eigen::Matrix2d J_px_m = H.topLeftCorner<2, 2>() - p * c + map->J_px_m;
    if (!(std::abs(J_px_m.determinant()) > 0.0)) return std::nullopt;
    return J_px_m;
}

/// Returns the derivatives (see `local_slope`) around each point of the board.
std::vector<std::optional<Eigen::Matrix2d>> local_slopes(
    const std::vector<Eigen::Vector3d>& board_m, const std::vector<Eigen::Vector2d>& pixels) {
    std::vector<std::optional<Eigen::Matrix2d>> slopes;
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
        slopes.push_back(local_slope(near_m, near_px));
    }
    return slopes;
}

struct Blob {
    Eigen::Vector2d centre;
    double area_px2 = 0.0;
};

/// Calls `use(pixel, distance, grey value)` for the pixels within `reach_m` of the centre on the
/// board. The distance is a share of `reach_m`.
template <typename Use>
void for_pixels_around(const Eigen::Vector2d& centre,
                       const Eigen::Matrix2d& J_px_m,
                       double reach_m,
                       ImageView<const std::uint8_t> image,
                       const Use& use) {
    const Eigen::Matrix2d J_m_px = J_px_m.inverse();
    const Eigen::Vector2d half = reach_m * J_px_m.rowwise().norm();
    const int last_v =
        std::min(image.height - 1, saturated_integer<int>(centre.y() + half.y() + 1.0));
    const int last_u =
        std::min(image.width - 1, saturated_integer<int>(centre.x() + half.x() + 1.0));
    for (int v = std::max(0, saturated_integer<int>(centre.y() - half.y())); v <= last_v; ++v) {
        for (int u = std::max(0, saturated_integer<int>(centre.x() - half.x())); u <= last_u; ++u) {
            const Eigen::Vector2d pixel(u, v);
            const double distance = (J_m_px * (pixel - centre)).norm() / reach_m;
            if (distance <= 1.0) use(pixel, distance, static_cast<double>(image.row(v)[u]));
        }
    }
}

/// Measures the dark area around a rough centre. The centre of gravity counts pixels within
/// `ink_m`. The size counts pixels within `reach_m`, which includes some paper.
std::optional<Blob> blob_at(const Eigen::Vector2d& centre,
                            const Eigen::Matrix2d& J_px_m,
                            double reach_m,
                            double ink_m,
                            ImageView<const std::uint8_t> image) {
    constexpr double kRing = 0.9;    // pixels beyond this share of reach_m are paper
    constexpr double kHeart = 0.25;  // pixels within this share of reach_m are ink
    std::vector<double> paper_dn;
    std::vector<double> ink_dn;
    for_pixels_around(centre, J_px_m, reach_m, image, [&](const auto&, double distance, double dn) {
        if (distance > kRing) paper_dn.push_back(dn);
        if (distance < kHeart) ink_dn.push_back(dn);
    });
    if (paper_dn.empty() || ink_dn.empty()) return std::nullopt;
    const double white_dn = upper_median(std::move(paper_dn));
    const double contrast_dn = white_dn - upper_median(std::move(ink_dn));
    if (contrast_dn < kLeastContrast_dn) return std::nullopt;
    Blob blob{Eigen::Vector2d::Zero(), 0.0};
    double weights = 0.0;
    const double limit = ink_m / reach_m;
    for_pixels_around(
        centre, J_px_m, reach_m, image, [&](const auto& pixel, double distance, double dn) {
            const double ink = (white_dn - dn) / contrast_dn;
            blob.area_px2 += ink;
            if (distance > limit) return;
            weights += ink;
            blob.centre += ink * pixel;
        });
    if (!(weights > 0.0)) return std::nullopt;
    blob.centre /= weights;
    return blob;
}

/// Returns the length of `kSoftRim_px` on the board [m], in the direction of the strongest
/// foreshortening.
double soft_rim_m(const Eigen::Matrix2d& J_px_m) {
    return kSoftRim_px * J_px_m.inverse().operatorNorm();
}

}  // namespace

DiscImages measured_discs(const Board& board,
                          const std::vector<Eigen::Vector2d>& rough,
                          ImageView<const std::uint8_t> image) {
    const std::vector<Eigen::Vector3d> board_m = board.points_m();
    const bool staggered = board.kind == BoardKind::asymmetric_circles;
    const double nearest_m = staggered ? board.spacing_m / std::numbers::sqrt2 : board.spacing_m;
    const double reach_m = 0.48 * nearest_m;
    DiscImages discs{rough, 0.0};
    std::vector<double> radii_sq_m2;
    constexpr int kRounds = 3;  // each round uses the centres and radius of the previous round
    for (int round = 0; round < kRounds; ++round) {
        const auto slopes = local_slopes(board_m, discs.centroids);
        radii_sq_m2.clear();
        for (std::size_t i = 0; i < rough.size(); ++i) {
            if (!slopes[i]) continue;
            const double ink_m =
                round == 0 ? reach_m : std::min(reach_m, discs.radius_m + soft_rim_m(*slopes[i]));
            const auto blob = blob_at(discs.centroids[i], *slopes[i], reach_m, ink_m, image);
            if (!blob) continue;
            discs.centroids[i] = blob->centre;
            radii_sq_m2.push_back(blob->area_px2 / std::abs(slopes[i]->determinant()) /
                                  std::numbers::pi);
        }
        if (radii_sq_m2.empty()) return {rough, 0.0};
        discs.radius_m = std::sqrt(std::max(0.0, upper_median(radii_sq_m2)));
    }
    return discs;
}

}  // namespace surefoot::calibration

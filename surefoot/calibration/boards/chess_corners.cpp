// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/chess_corners.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace surefoot::calibration {
namespace {

/// Initial blur: derivatives of 8-bit images need it, and squares of 4 px tolerate it.
constexpr double kBlur_px = 1.2;
constexpr double kLeastContrast_dn = 5.0;
/// Radii of the ring, largest first: a ring should be large but must not reach into the next
/// squares. The first ring that shows a corner is used.
constexpr std::array kRadii_px{5.0, 3.5, 2.5};
constexpr int kRing = 32;  ///< positions on a ring
constexpr int kBorder_px = 2;
constexpr double kMostBeside_px = 1.2;
/// Largest bend of a line at the corner: the angle between its two halves may differ from 180 deg
/// by at most this angle.
constexpr double kMostBend_rad = 0.5;
/// Smallest angle between two neighbouring edges of a corner (17 deg).
constexpr double kLeastAngle_rad = 0.3;
constexpr std::size_t kMostCorners = 2500;

cv::Mat blurred(ImageView<const std::uint8_t> image) {
    const cv::Mat grey(image.height,
                       image.width,
                       CV_8UC1,
                       const_cast<std::uint8_t*>(image.data),  // only read
                       static_cast<std::size_t>(image.stride));
    cv::Mat light;
    grey.convertTo(light, CV_32F);
    cv::GaussianBlur(light, light, cv::Size(), kBlur_px, kBlur_px, cv::BORDER_REPLICATE);
    return light;
}

/// First and second derivatives of the blurred image at a pixel.
struct Curvature {
    Eigen::Vector2d gradient;
    Eigen::Matrix2d H;
    /// Positive at saddle points.
    [[nodiscard]] double saddle() const { return -H.determinant(); }
};

Curvature curvature_at(const cv::Mat& light, int u, int v) {
    const auto at = [&](int du, int dv) {
        return static_cast<double>(light.at<float>(v + dv, u + du));
    };
    Curvature c;
    c.gradient = 0.5 * Eigen::Vector2d(at(1, 0) - at(-1, 0), at(0, 1) - at(0, -1));
    const double uv = 0.25 * (at(1, 1) - at(-1, 1) - at(1, -1) + at(-1, -1));
    c.H << at(1, 0) - 2.0 * at(0, 0) + at(-1, 0), uv, uv, at(0, 1) - 2.0 * at(0, 0) + at(0, -1);
    return c;
}

/// Returns the interpolated grey value; outside the image, the value of the nearest border pixel.
double bilinear(const cv::Mat& light, const Eigen::Vector2d& place) {
    const Eigen::Vector2d p(std::clamp(place.x(), 0.0, light.cols - 1.0),
                            std::clamp(place.y(), 0.0, light.rows - 1.0));
    const int u = std::min(static_cast<int>(p.x()), light.cols - 2);  // in range: clamped above
    const int v = std::min(static_cast<int>(p.y()), light.rows - 2);  // in range: clamped above
    const double s = p.x() - u;
    const double t = p.y() - v;
    const float* upper = light.ptr<float>(v);
    const float* lower = light.ptr<float>(v + 1);
    return (1.0 - t) *
               ((1.0 - s) * static_cast<double>(upper[u]) + s * static_cast<double>(upper[u + 1])) +
           t * ((1.0 - s) * static_cast<double>(lower[u]) + s * static_cast<double>(lower[u + 1]));
}

/// Angles at which a ring changes between black and white, and the contrast of the ring.
struct Crossings {
    std::vector<double> at_rad;
    bool white_first = false;  ///< true if the ring is white before the first crossing
    double contrast_dn = 0.0;
};

Crossings crossings_of(const cv::Mat& light, const Eigen::Vector2d& centre, double radius_px) {
    std::array<double, kRing> values{};
    for (int i = 0; i < kRing; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kRing;
        values[static_cast<std::size_t>(i)] =
            bilinear(light, centre + radius_px * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
    std::array<double, kRing> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    // Narrow squares contain few positions of the ring: use the mean of the three darkest and the
    // mean of the three brightest values.
    const double dark = (sorted[0] + sorted[1] + sorted[2]) / 3.0;
    const double bright = (sorted[kRing - 1] + sorted[kRing - 2] + sorted[kRing - 3]) / 3.0;
    const double middle = 0.5 * (dark + bright);
    Crossings crossings;
    crossings.contrast_dn = bright - dark;
    crossings.white_first = values[0] > middle;
    for (std::size_t i = 0; i < kRing; ++i) {
        const double here = values[i] - middle;
        const double next = values[(i + 1) % kRing] - middle;
        if ((here > 0.0) == (next > 0.0)) continue;
        crossings.at_rad.push_back(2.0 * std::numbers::pi *
                                   (static_cast<double>(i) + here / (here - next)) / kRing);
    }
    return crossings;
}

std::optional<ChessCorner> corner_at(const cv::Mat& light,
                                     const Eigen::Vector2d& centre,
                                     double radius_px) {
    const Crossings ring = crossings_of(light, centre, radius_px);
    if (ring.at_rad.size() != 4 || ring.contrast_dn < kLeastContrast_dn) return std::nullopt;
    // The square after the first edge must be black.
    const std::size_t first = ring.white_first ? 0 : 1;
    std::array<double, 4> angles{};
    for (std::size_t i = 0; i < 4; ++i)
        angles[i] = ring.at_rad[(i + first) % 4] + (i + first >= 4 ? 2.0 * std::numbers::pi : 0.0);
    for (std::size_t i = 0; i < 2; ++i) {
        if (std::abs(angles[i + 2] - angles[i] - std::numbers::pi) > kMostBend_rad)
            return std::nullopt;
    }
    ChessCorner corner;
    corner.pixel = centre;
    corner.contrast_dn = ring.contrast_dn;
    for (std::size_t i = 0; i < 4; ++i) {
        const double next = i < 3 ? angles[i + 1] : angles[0] + 2.0 * std::numbers::pi;
        if (next - angles[i] < kLeastAngle_rad) return std::nullopt;
        corner.edges[i] = {std::cos(angles[i]), std::sin(angles[i])};
    }
    return corner;
}

/// Returns true if no pixel within two columns and two rows has a stronger saddle. If saddles are
/// equal, the first pixel is the peak.
bool is_peak(const cv::Mat& saddles, int u, int v) {
    const float here = saddles.at<float>(v, u);
    for (int dv = -2; dv <= 2; ++dv) {
        const float* row = saddles.ptr<float>(v + dv);
        for (int du = -2; du <= 2; ++du) {
            const bool before = dv < 0 || (dv == 0 && du < 0);
            if (before ? row[u + du] >= here : row[u + du] > here) return false;
        }
    }
    return true;
}

cv::Mat saddles_of(const cv::Mat& light) {
    cv::Mat saddles(light.size(), CV_32F, cv::Scalar(0.0));
    for (int v = 1; v + 1 < light.rows; ++v) {
        float* row = saddles.ptr<float>(v);
        for (int u = 1; u + 1 < light.cols; ++u)
            row[u] = static_cast<float>(std::max(0.0, curvature_at(light, u, v).saddle()));
    }
    return saddles;
}

/// Returns the position of zero gradient near a pixel [px]; the pixel itself if this position is
/// farther away than kMostBeside_px.
Eigen::Vector2d place_of(const cv::Mat& light, int u, int v) {
    const Curvature c = curvature_at(light, u, v);
    const Eigen::Vector2d beside = -c.H.inverse() * c.gradient;
    Eigen::Vector2d place(u, v);
    if (beside.allFinite() && beside.norm() <= kMostBeside_px) place += beside;
    return place;
}

}  // namespace

std::vector<ChessCorner> chess_corners(ImageView<const std::uint8_t> image) {
    std::vector<ChessCorner> corners;
    if (image.width <= 2 * kBorder_px || image.height <= 2 * kBorder_px) return corners;
    const cv::Mat light = blurred(image);
    const cv::Mat saddles = saddles_of(light);
    // Two perpendicular edges of contrast c have the saddle (c / (pi blur^2))^2. Slanted edges have
    // a smaller saddle.
    constexpr double kSlant = 0.3;
    const double least =
        std::pow(kSlant * kLeastContrast_dn / (std::numbers::pi * kBlur_px * kBlur_px), 2);
    for (int v = kBorder_px; v < light.rows - kBorder_px; ++v) {
        for (int u = kBorder_px; u < light.cols - kBorder_px; ++u) {
            if (static_cast<double>(saddles.at<float>(v, u)) < least || !is_peak(saddles, u, v))
                continue;
            const Eigen::Vector2d place = place_of(light, u, v);
            for (const double radius_px : kRadii_px) {
                const auto corner = corner_at(light, place, radius_px);
                if (!corner) continue;
                corners.push_back(*corner);
                break;
            }
        }
    }
    std::stable_sort(corners.begin(), corners.end(), [](const auto& a, const auto& b) {
        return a.contrast_dn > b.contrast_dn;
    });
    corners.resize(std::min(corners.size(), kMostCorners));
    return corners;
}

}  // namespace surefoot::calibration

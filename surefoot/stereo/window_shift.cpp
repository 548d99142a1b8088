// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/window_shift.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace surefoot::stereo {
namespace {

constexpr int kHalf = kShiftHalf_px;
constexpr int kSide = 2 * kHalf + 1;
constexpr int kTaps = 6;    ///< taps of the interpolation, from 2 pixels before to 3 after
constexpr int kBefore = 2;  ///< taps before the position
constexpr int kMaxRounds = 20;
constexpr double kRefined_px = 0.003;
constexpr double kFarthest_px = 1.0;  ///< largest distance from the whole-pixel match
constexpr double kMostSlant = 0.5;    ///< largest slant [px per px], as of a wall seen at 80 deg
constexpr double kLeastGain = 0.2;
constexpr double kMiddleGrey = 128.0;  ///< makes gain and offset nearly independent
constexpr double kSingular = 1e-6;

/// Shift of the pixel (x, y) of the window: columns_px + slant_x x + slant_y y columns and rows_px
/// rows.
struct Warp {
    double columns_px = 0.0;
    double slant_x = 0.0;
    double slant_y = 0.0;
    double rows_px = 0.0;
};

/// Derivatives of a grey value by (columns, slant_x, slant_y, rows, gain, offset).
using Row = Eigen::Matrix<double, 6, 1>;
using Rows = std::array<Row, static_cast<std::size_t>(kSide) * kSide>;

/// Weights of the pixels -2 ... 3 for the value at t in [0, 1): Lagrange polynomial of degree 5.
/// An interpolation over only two or four pixels moves fine texture toward the whole pixel.
std::array<double, kTaps> taps_at(double t) {
    const double a = t + 2.0, b = t + 1.0, d = t - 1.0, e = t - 2.0, f = t - 3.0;
    return {-b * t * d * e * f / 120.0,
            a * t * d * e * f / 24.0,
            -a * b * d * e * f / 12.0,
            a * b * t * e * f / 12.0,
            -a * b * t * d * f / 24.0,
            a * b * t * d * e / 120.0};
}

bool holds(ImageView<const std::uint8_t> image, int u_px, int v_px, int before, int behind) {
    return u_px - before >= 0 && v_px - before >= 0 && u_px + behind < image.width &&
           v_px + behind < image.height;
}

Rows rows_of(ImageView<const std::uint8_t> left, int u_px, int v_px) {
    Rows rows;
    std::size_t i = 0;
    for (int y = -kHalf; y <= kHalf; ++y) {
        const std::uint8_t* above = left.row(v_px + y - 1) + u_px;
        const std::uint8_t* here = left.row(v_px + y) + u_px;
        const std::uint8_t* below = left.row(v_px + y + 1) + u_px;
        for (int x = -kHalf; x <= kHalf; ++x) {
            const double du = 0.5 * (here[x + 1] - here[x - 1]);
            const double dv = 0.5 * (below[x] - above[x]);
            rows[i++] << du, du * x, du * y, dv, here[x] - kMiddleGrey, 1.0;
        }
    }
    return rows;
}

/// Returns the sum of the rows times the grey values of the right image at the positions given by
/// `warp`. Returns nothing if a position leaves the image.
std::optional<Row> project(
    const Rows& rows, ImageView<const std::uint8_t> right, int u_px, int v_px, const Warp& warp) {
    constexpr int kReach =
        kHalf + static_cast<int>(2 * kMostSlant * kHalf) + 1;  // in range: constants
    constexpr int kWide = 2 * kReach + kTaps;
    // in range: refine_shift() keeps the warp within kFarthest_px of a start that it has checked
    const auto u0 = u_px + static_cast<int>(std::floor(warp.columns_px));
    const auto v0 = v_px + static_cast<int>(std::floor(warp.rows_px));  // in range: as u0
    if (v0 - kHalf - kBefore < 0 || v0 + kHalf + kTaps - kBefore > right.height) return {};
    const auto down = taps_at(warp.rows_px - std::floor(warp.rows_px));
    const int first = u0 - kReach - kBefore;  // column of strip[0]
    std::array<double, kWide> strip{};        // one window row, interpolated between rows
    Row sum = Row::Zero();
    std::size_t i = 0;
    for (int y = -kHalf; y <= kHalf; ++y) {
        const std::uint8_t* from = right.row(v0 + y - kBefore);
        for (int k = std::max(0, -first); k < std::min(kWide, right.width - first); ++k) {
            const std::uint8_t* pixel = from + first + k;
            double grey = 0.0;
            for (int tap = 0; tap < kTaps; ++tap)
                grey += down[static_cast<std::size_t>(tap)] *
                        pixel[static_cast<std::ptrdiff_t>(tap) * right.stride];
            strip[static_cast<std::size_t>(k)] = grey;
        }
        for (int x = -kHalf; x <= kHalf; ++x, ++i) {
            const double at = u_px + x + warp.columns_px + warp.slant_x * x + warp.slant_y * y;
            const double whole = std::floor(at);
            if (whole < kBefore || whole + kTaps - kBefore > right.width) return {};
            const int k = static_cast<int>(whole) - kBefore - first;  // in range: checked above
            const auto along = taps_at(at - whole);
            double grey = 0.0;
            for (int tap = 0; tap < kTaps; ++tap)
                grey +=
                    along[static_cast<std::size_t>(tap)] * strip[static_cast<std::size_t>(k + tap)];
            sum += grey * rows[i];
        }
    }
    return sum;
}

}  // namespace

std::optional<WindowShift> refine_shift(ImageView<const std::uint8_t> left,
                                        ImageView<const std::uint8_t> right,
                                        int u_px,
                                        int v_px,
                                        const WindowShift& start) {
    if (!holds(left, u_px, v_px, kHalf + 1, kHalf + 1)) return {};
    if (!(std::abs(start.columns_px) <= right.width && std::abs(start.rows_px) <= right.height))
        return {};
    const Rows rows = rows_of(left, u_px, v_px);
    Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
    for (const Row& row : rows) information += row * row.transpose();
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> ldlt(information);
    const Row pivots = ldlt.vectorD();
    if (!(pivots.minCoeff() > kSingular * pivots.maxCoeff())) return {};
    Warp warp{start.columns_px, 0.0, 0.0, start.rows_px};
    for (int round = 0; round < kMaxRounds; ++round) {
        const auto sum = project(rows, right, u_px, v_px, warp);
        if (!sum) return {};
        const Row step = ldlt.solve(*sum);
        const double gain = step[4];
        if (!(gain > kLeastGain)) return {};
        warp.columns_px -= step[0] / gain;
        warp.slant_x -= step[1] / gain;
        warp.slant_y -= step[2] / gain;
        warp.rows_px -= step[3] / gain;
        if (!(std::abs(warp.columns_px - start.columns_px) <= kFarthest_px) ||
            !(std::abs(warp.rows_px - start.rows_px) <= kFarthest_px) ||
            !(std::abs(warp.slant_x) + std::abs(warp.slant_y) <= kMostSlant))
            return {};
        if (std::abs(step[0]) + std::abs(step[3]) < kRefined_px * gain)
            return WindowShift{warp.columns_px, warp.rows_px};
    }
    return {};
}

}  // namespace surefoot::stereo

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/corner_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "surefoot/core/nearest_pixel.hpp"

namespace surefoot::calibration {
namespace {

/// Half size of the window, as a share of the step to the next corner. The next edge is one step
/// away.
constexpr double kWindow = 0.5;
/// Largest distance of a pixel from the corner. Farther away, brightness and curvature change; the
/// pixels within this distance average the noise well enough.
constexpr double kMostRadius_px = 8.0;
constexpr double kFirstBlur_px = 0.8;
constexpr double kLeastBlur_px = 0.3;  ///< about the blur by the area of a pixel
constexpr double kMostBlur_px = 5.0;
constexpr int kParameters = 7;
constexpr int kMostSteps = 30;
constexpr double kRefined_px = 1e-4;
/// Least contrast: half the difference between black and white [grey values]. Pure noise has less
/// contrast.
constexpr double kLeastContrast_dn = 4.0;
/// Largest rms of the unexplained grey values, divided by the contrast. A single edge, half a spot
/// or a bright reflection has a larger rms. Sharpened or noisy images of corners have about 0.1.
constexpr double kMostMisfit = 0.3;
/// Largest standard deviation of a corner. A board that moves by several square widths during the
/// exposure still shows edges along its motion, and apparent corners anywhere on them. Corners
/// whose noise is half their contrast still have a smaller deviation than this limit.
constexpr double kMostSpread_px = 0.2;

using Vector7 = Eigen::Matrix<double, kParameters, 1>;
using Matrix7 = Eigen::Matrix<double, kParameters, kParameters>;

/// Indices of the parameters. Indices 0 and 1 are the position.
constexpr int kRowAngle = 2;
constexpr int kColumnAngle = 3;
constexpr int kLogBlur = 4;
constexpr int kMean = 5;
constexpr int kContrast = 6;

struct Sample {
    Eigen::Vector2d pixel;
    double value_dn;
};

std::vector<Sample> samples_of(ImageView<const std::uint8_t> image, const CornerGuess& guess) {
    Eigen::Matrix2d steps;
    steps << guess.along_row_px, guess.along_column_px;
    std::vector<Sample> samples;
    if (!(std::abs(steps.determinant()) > 1.0)) return samples;
    const Eigen::Matrix2d to_board = steps.inverse();
    constexpr int kReach = 9;
    static_assert(kReach > kMostRadius_px);
    const auto near =
        nearest_pixel(guess.pixel.x(), guess.pixel.y(), image.width, image.height, -kReach);
    if (!near) return samples;  // no image pixel is near enough
    const int v_end = std::min(image.height, near->v + kReach + 1);
    const int u_end = std::min(image.width, near->u + kReach + 1);
    samples.reserve(static_cast<std::size_t>((2 * kReach + 1) * (2 * kReach + 1)));
    for (int v = std::max(0, near->v - kReach); v < v_end; ++v) {
        for (int u = std::max(0, near->u - kReach); u < u_end; ++u) {
            const Eigen::Vector2d pixel(u, v);
            const Eigen::Vector2d from_px = pixel - guess.pixel;
            const Eigen::Vector2d share = (to_board * from_px).cwiseAbs();
            if (share.maxCoeff() > kWindow || from_px.norm() > kMostRadius_px) continue;
            samples.push_back({pixel, static_cast<double>(image.row(v)[u])});
        }
    }
    return samples;
}

/// Values of one edge through the corner, at one sample pixel.
struct Edge {
    double step = 0.0;          ///< brightness: -1 on one side of the edge, 1 on the other
    double per_px = 0.0;        ///< derivative of `step` by the distance from the line
    double distance_px = 0.0;   ///< signed distance of the sample from the line
    double per_rad = 0.0;       ///< derivative of the distance by the rotation of the line
    Eigen::Vector2d per_place;  ///< derivative of the distance by the corner position
};

Edge edge_at(const Eigen::Vector2d& from_px, double angle_rad, double bend_per_px, double blur_px) {
    const Eigen::Vector2d along(std::cos(angle_rad), std::sin(angle_rad));
    const Eigen::Vector2d normal(-along.y(), along.x());
    const double t = from_px.dot(along);
    const double n = from_px.dot(normal);
    Edge edge;
    edge.distance_px = n - 0.5 * bend_per_px * t * t;
    edge.per_rad = -t - bend_per_px * t * n;
    edge.per_place = bend_per_px * t * along - normal;
    const double scaled = edge.distance_px / blur_px;
    edge.step = std::erf(scaled / std::numbers::sqrt2);
    edge.per_px = std::sqrt(2.0 / std::numbers::pi) / blur_px * std::exp(-0.5 * scaled * scaled);
    return edge;
}

/// Normal equations of the fit at given parameters.
struct System {
    double cost = 0.0;
    Matrix7 JtJ = Matrix7::Zero();
    Vector7 Jtr = Vector7::Zero();
};

System system_at(const std::vector<Sample>& samples, const CornerGuess& guess, const Vector7& p) {
    System system;
    const double blur_px = std::exp(p[kLogBlur]);
    for (const Sample& sample : samples) {
        const Eigen::Vector2d from_px = sample.pixel - p.head<2>();
        const Edge row = edge_at(from_px, p[kRowAngle], guess.row_bend_per_px, blur_px);
        const Edge column = edge_at(from_px, p[kColumnAngle], guess.column_bend_per_px, blur_px);
        const double row_slope = p[kContrast] * row.per_px * column.step;
        const double column_slope = p[kContrast] * column.per_px * row.step;
        Vector7 J;
        J.head<2>() = row_slope * row.per_place + column_slope * column.per_place;
        J[kRowAngle] = row_slope * row.per_rad;
        J[kColumnAngle] = column_slope * column.per_rad;
        J[kLogBlur] = -row_slope * row.distance_px - column_slope * column.distance_px;
        J[kMean] = 1.0;
        J[kContrast] = row.step * column.step;
        const double residual = sample.value_dn - p[kMean] - p[kContrast] * row.step * column.step;
        system.cost += residual * residual;
        system.JtJ += J * J.transpose();
        system.Jtr += residual * J;
    }
    return system;
}

/// Computes mean and contrast for the guessed edges. The model is linear in both, so one step is
/// enough.
void start_light(const std::vector<Sample>& samples, const CornerGuess& guess, Vector7& p) {
    p[kMean] = 0.0;
    p[kContrast] = 0.0;
    const System system = system_at(samples, guess, p);
    p.tail<2>() = system.JtJ.bottomRightCorner<2, 2>().ldlt().solve(system.Jtr.tail<2>());
}

double angle_of(const Eigen::Vector2d& direction) {
    return std::atan2(direction.y(), direction.x());
}

/// Fixes the blur at its limit if the next step would exceed the limit. The other parameters then
/// converge with a fixed blur.
void hold_blur_at_limit(const Vector7& p, System& system) {
    const double pull = system.Jtr[kLogBlur];
    const bool held =
        pull < 0.0 ? p[kLogBlur] <= std::log(kLeastBlur_px) : p[kLogBlur] >= std::log(kMostBlur_px);
    if (!held) return;
    system.JtJ.row(kLogBlur).setZero();
    system.JtJ.col(kLogBlur).setZero();
    system.JtJ(kLogBlur, kLogBlur) = 1.0;
    system.Jtr[kLogBlur] = 0.0;
}

/// Runs the Levenberg-Marquardt method. Returns the final equations; nullopt without convergence.
std::optional<System> settle(const std::vector<Sample>& samples,
                             const CornerGuess& guess,
                             Vector7& p) {
    System system = system_at(samples, guess, p);
    double damping = 1e-3;
    for (int step = 0; step < kMostSteps; ++step) {
        hold_blur_at_limit(p, system);
        Matrix7 damped = system.JtJ;
        damped.diagonal() *= 1.0 + damping;
        const Vector7 change = damped.ldlt().solve(system.Jtr);
        Vector7 next = p + change;
        next[kLogBlur] =
            std::clamp(next[kLogBlur], std::log(kLeastBlur_px), std::log(kMostBlur_px));
        const System there = system_at(samples, guess, next);
        const bool settled = change.head<2>().norm() < kRefined_px;
        if (there.cost <= system.cost) {
            p = next;
            system = there;
            damping *= 0.1;
        } else {
            damping *= 10.0;  // shorter steps; the loop ends if no step improves the cost
        }
        if (settled) return system;
    }
    return std::nullopt;
}

/// Returns the standard deviation of the position in its most uncertain direction [px].
double spread_px(const System& system, double misfit_dn) {
    Matrix7 damped = system.JtJ;
    damped.diagonal() *= 1.0 + 1e-9;
    const Eigen::LDLT<Matrix7> solver(damped);
    const Eigen::Matrix<double, kParameters, 2> place =
        Eigen::Matrix<double, kParameters, kParameters>::Identity().leftCols<2>();
    const Eigen::Matrix2d inverse = solver.solve(place).topRows<2>();
    const double middle = 0.5 * inverse.trace();
    const double apart =
        std::hypot(0.5 * (inverse(0, 0) - inverse(1, 1)), 0.5 * (inverse(0, 1) + inverse(1, 0)));
    return misfit_dn * std::sqrt(std::max(0.0, middle + apart));
}

}  // namespace

std::optional<Eigen::Vector2d> fit_corner(ImageView<const std::uint8_t> image,
                                          const CornerGuess& guess) {
    const std::vector<Sample> samples = samples_of(image, guess);
    if (samples.size() < 2 * kParameters) return std::nullopt;
    Vector7 p;
    p << guess.pixel, angle_of(guess.along_row_px), angle_of(guess.along_column_px),
        std::log(kFirstBlur_px), 0.0, 0.0;
    start_light(samples, guess, p);
    const std::optional<System> left = settle(samples, guess, p);
    if (!left) return std::nullopt;
    const double misfit_dn = std::sqrt(left->cost / static_cast<double>(samples.size()));
    const double contrast_dn = std::abs(p[kContrast]);
    const bool clear = contrast_dn >= kLeastContrast_dn && misfit_dn <= kMostMisfit * contrast_dn &&
                       spread_px(*left, misfit_dn) <= kMostSpread_px;
    return clear ? std::optional(Eigen::Vector2d(p.head<2>())) : std::nullopt;
}

}  // namespace surefoot::calibration

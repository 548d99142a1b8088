// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/symmetric3.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace surefoot::geometry {
namespace {

constexpr int kMaxSweeps = 16;       // Jacobi converges quadratically: 4 to 6 sweeps are usual
constexpr int kMaxNewtonSteps = 12;  // well separated roots need 2 to 6 steps

/// One Jacobi rotation that annihilates A(p, q) and updates the eigenvectors V.
void rotate(Eigen::Matrix3d& A, Eigen::Matrix3d& V, int p, int q) noexcept {
    if (A(p, q) == 0.0) return;
    const double theta = (A(q, q) - A(p, p)) / (2.0 * A(p, q));
    const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
    const double c = 1.0 / std::sqrt(t * t + 1.0);
    const double s = t * c;
    A(p, p) -= t * A(p, q);
    A(q, q) += t * A(p, q);
    A(p, q) = A(q, p) = 0.0;
    const int r = 3 - p - q;
    const double a_rp = A(r, p);
    const double a_rq = A(r, q);
    A(r, p) = A(p, r) = c * a_rp - s * a_rq;
    A(r, q) = A(q, r) = s * a_rp + c * a_rq;
    for (int i = 0; i < 3; ++i) {
        const double v_p = V(i, p);
        const double v_q = V(i, q);
        V(i, p) = c * v_p - s * v_q;
        V(i, q) = s * v_p + c * v_q;
    }
}

SmallestAxis smallest_axis_by_jacobi(const Symmetric3& m) noexcept {
    const EigenSystem3 system = eigen_system(m);
    return {system.vectors.col(0), system.values[0], system.values[1]};
}

struct Vec {
    double x, y, z;
};
Vec cross(const Vec& a, const Vec& b) noexcept {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double squared_norm(const Vec& a) noexcept {
    return a.x * a.x + a.y * a.y + a.z * a.z;
}

}  // namespace

Eigen::Matrix3d Symmetric3::matrix() const {
    Eigen::Matrix3d M;
    M << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    return M;
}

EigenSystem3 eigen_system(const Symmetric3& m) noexcept {
    Eigen::Matrix3d A = m.matrix();
    Eigen::Matrix3d V = Eigen::Matrix3d::Identity();
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
        const double off = std::abs(A(0, 1)) + std::abs(A(0, 2)) + std::abs(A(1, 2));
        if (off == 0.0) break;
        rotate(A, V, 0, 1);
        rotate(A, V, 0, 2);
        rotate(A, V, 1, 2);
    }
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int a, int b) {
        return A(a, a) < A(b, b) || (A(a, a) == A(b, b) && a < b);
    });
    EigenSystem3 result;
    for (int i = 0; i < 3; ++i) {
        const int from = order[static_cast<std::size_t>(i)];
        result.values[i] = A(from, from);
        result.vectors.col(i) = V.col(from).normalized();
    }
    return result;
}

SmallestAxis smallest_axis(const Symmetric3& m) noexcept {
    // The matrix is scaled to trace 1: its eigenvalues sum to 1 and all limits are pure numbers.
    // Left of its smallest root (which is <= 1/3) the characteristic polynomial p(l) = l^3 - l^2 +
    // c1 l - c0 grows and is concave. Newton's steps from l = 0 therefore never pass that root.
    const double trace = m.xx + m.yy + m.zz;
    if (!(trace > 0.0)) return {};
    const double scale = 1.0 / trace;
    const double xx = m.xx * scale, xy = m.xy * scale, xz = m.xz * scale;
    const double yy = m.yy * scale, yz = m.yz * scale, zz = m.zz * scale;
    const double c1 = (xx * yy - xy * xy) + (xx * zz - xz * xz) + (yy * zz - yz * yz);
    const double c0 =
        xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    double smallest = 0.0;
    for (int step = 0; step < kMaxNewtonSteps; ++step) {
        const double value = ((smallest - 1.0) * smallest + c1) * smallest - c0;
        const double slope = (3.0 * smallest - 2.0) * smallest + c1;
        if (!(slope > 0.0) || value >= 0.0) break;
        const double next = smallest - value / slope;
        if (!(next > smallest)) break;
        smallest = next;
    }

    // The eigenvector is perpendicular to all rows of A - l I. The longest cross product of two
    // rows has the best condition. Its length is (middle - l)(largest - l): below the limit the
    // axis is poorly separated and rounding would rotate it.
    const Vec r0{xx - smallest, xy, xz};
    const Vec r1{xy, yy - smallest, yz};
    const Vec r2{xz, yz, zz - smallest};
    Vec best = cross(r0, r1);
    for (const Vec& candidate : {cross(r0, r2), cross(r1, r2)}) {
        if (squared_norm(candidate) > squared_norm(best)) best = candidate;
    }
    constexpr double kMinLength = 1e-4;  // rounding 1e-16 over 1e-4 rotates by less than 1e-10 rad
    const double length = std::sqrt(squared_norm(best));
    if (!(length > kMinLength)) return smallest_axis_by_jacobi(m);

    // A poor root leaves a residual A v - l v. It rotates v by at most residual / (middle - l).
    const double inverse = 1.0 / length;
    const Vec v{best.x * inverse, best.y * inverse, best.z * inverse};
    const double sum = 1.0 - smallest;           // sum of the other two eigenvalues
    const double product = c1 - smallest * sum;  // product of the other two eigenvalues
    const double root = std::sqrt(std::max(sum * sum - 4.0 * product, 0.0));
    const double middle = 2.0 * product / (sum + root);
    const Vec residual{r0.x * v.x + r0.y * v.y + r0.z * v.z,
                       r1.x * v.x + r1.y * v.y + r1.z * v.z,
                       r2.x * v.x + r2.y * v.y + r2.z * v.z};
    constexpr double kMaxTurn = 1e-10;
    const double gap = middle - smallest;
    if (!(squared_norm(residual) <= kMaxTurn * kMaxTurn * gap * gap)) {
        return smallest_axis_by_jacobi(m);
    }
    // Rayleigh quotient: its error is the square of the error of the vector.
    const double refined = smallest + v.x * residual.x + v.y * residual.y + v.z * residual.z;
    return {Eigen::Vector3d(v.x, v.y, v.z), refined * trace, middle * trace};
}

}  // namespace surefoot::geometry

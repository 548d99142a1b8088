// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/lenses/lens.hpp"

#include "surefoot/core/assert.hpp"

namespace surefoot::calibration {

std::vector<std::string> parameter_names(LensKind kind) {
    switch (kind) {
        case LensKind::pinhole4: return {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"};
        case LensKind::pinhole5: return {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"};
        case LensKind::rational:
            return {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
        case LensKind::fisheye: return {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"};
    }
    return {};
}

camera::CameraModel model_of(LensKind kind, const Eigen::VectorXd& parameters) {
    SUREFOOT_ASSERT(static_cast<std::size_t>(parameters.size()) == parameter_names(kind).size());
    const auto p = [&](int i) { return parameters[i]; };
    switch (kind) {
        case LensKind::fisheye:
            return camera::KannalaBrandt{p(0), p(1), p(2), p(3), p(4), p(5), p(6), p(7)};
        case LensKind::pinhole4:
            return camera::PinholeRadTan{p(0), p(1), p(2), p(3), p(4), p(5), p(6), p(7), 0.0};
        case LensKind::rational:
            return camera::PinholeRational{
                p(0), p(1), p(2), p(3), p(4), p(5), p(6), p(7), p(8), p(9), p(10), p(11)};
        default: return camera::PinholeRadTan{p(0), p(1), p(2), p(3), p(4), p(5), p(6), p(7), p(8)};
    }
}

}  // namespace surefoot::calibration

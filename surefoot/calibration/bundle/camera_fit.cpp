// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/bundle/camera_fit.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::calibration {

std::vector<CameraFit> camera_fits(const BoardBundle& solved,
                                   std::span<const Sight> all,
                                   std::span<const Sight> outliers,
                                   int camera) {
    BoardBundle complete = solved;
    complete.sights.assign(all.begin(), all.end());
    const std::vector<Eigen::Vector2d> residuals = residuals_px(complete);
    std::vector<CameraFit> fits(solved.T_left_board.size());
    for (const Sight& sight : outliers)
        if (sight.camera == camera)
            fits[static_cast<std::size_t>(sight.view)].outliers.push_back(sight.id);
    std::vector<double> square(fits.size(), 0.0);
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].camera != camera) continue;
        const auto view = static_cast<std::size_t>(all[i].view);
        fits[view].ids.push_back(all[i].id);
        fits[view].residuals_px.push_back(residuals[i]);
        const std::vector<int>& out = fits[view].outliers;
        if (std::find(out.begin(), out.end(), all[i].id) == out.end())
            square[view] += residuals[i].squaredNorm();
    }
    for (std::size_t v = 0; v < fits.size(); ++v) {
        const auto used = static_cast<double>(fits[v].ids.size() - fits[v].outliers.size());
        fits[v].rms_px = used > 0.0 ? std::sqrt(square[v] / used) : 0.0;
    }
    return fits;
}

}  // namespace surefoot::calibration

// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/tilt_variance.hpp"

#include <cmath>
#include <limits>

namespace surefoot::grid {

Layer with_tilt_variance(ImageView<const float> variance_m2,
                         const GridGeometry& geometry,
                         double tilt_sigma_rad) {
    Layer sum(variance_m2.width, variance_m2.height);
    for (int iy = 0; iy < variance_m2.height; ++iy) {
        for (int ix = 0; ix < variance_m2.width; ++ix) {
            const float own = variance_m2.at(ix, iy);
            const double tilt = tilt_sigma_rad * geometry.center_m({ix, iy}).norm();
            const float added = std::isfinite(tilt) ? static_cast<float>(tilt * tilt)
                                                    : std::numeric_limits<float>::infinity();
            sum.at(ix, iy) = own + added;
        }
    }
    return sum;
}

}  // namespace surefoot::grid

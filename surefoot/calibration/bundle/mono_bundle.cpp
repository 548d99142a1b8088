// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/bundle/mono_bundle.hpp"

#include "surefoot/calibration/bundle/view_check.hpp"

namespace surefoot::calibration {

BoardBundle mono_bundle(const Board& board,
                        std::span<const BoardView> views,
                        std::span<const std::size_t> kept,
                        ImageSize size,
                        LensKind kind) {
    const std::vector<Eigen::Vector3d> points = board.points_m();
    BoardBundle bundle;
    bundle.kind = kind;
    bundle.size = size;
    bundle.disc_radius_m = disc_radius_m(views);
    bundle.T_left_board.resize(kept.size());
    for (std::size_t v = 0; v < kept.size(); ++v) {
        const BoardView& view = views[kept[v]];
        for (std::size_t i = 0; i < view.ids.size(); ++i)
            bundle.sights.push_back({0,
                                     static_cast<int>(v),
                                     view.ids[i],
                                     points[static_cast<std::size_t>(view.ids[i])],
                                     view.pixels[i]});
    }
    return bundle;
}

}  // namespace surefoot::calibration

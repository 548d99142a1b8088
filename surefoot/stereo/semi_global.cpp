// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/semi_global.hpp"

#include <algorithm>
#include <deque>

#include "surefoot/core/assert.hpp"
#include "surefoot/stereo/semi_global_level.hpp"

namespace surefoot::stereo {

void halve(ImageView<const std::uint8_t> in, GreyImage& out) {
    out.resize((in.width + 1) / 2, (in.height + 1) / 2);
    for (int v = 0; v < out.height(); ++v) {
        const std::uint8_t* const upper = in.row(2 * v);
        const std::uint8_t* const lower = in.row(std::min(2 * v + 1, in.height - 1));
        std::uint8_t* const to = out.row(v);
        const int pairs = in.width / 2;
        for (int u = 0; u < pairs; ++u)
            to[u] = static_cast<std::uint8_t>(
                (upper[2 * u] + upper[2 * u + 1] + lower[2 * u] + lower[2 * u + 1] + 2) / 4);
        if (in.width % 2 != 0)
            to[pairs] = static_cast<std::uint8_t>((upper[2 * pairs] + lower[2 * pairs] + 1) / 2);
    }
}

struct SemiGlobalSearch::Workspace {
    /// A level below full size.
    struct SmallLevel {
        GreyImage left;
        GreyImage right;
        LevelSearch search;
        LevelPrior prior;
    };
    SemiGlobalConfig config;
    LevelSearch full;
    std::deque<SmallLevel> small;  ///< the first has half the full size

    /// Searches the level `index` of `small` and all smaller ones. Returns its prior, or nullptr if
    /// the level would be too narrow.
    const LevelPrior* search_small(std::size_t index,
                                   ImageView<const std::uint8_t> left,
                                   ImageView<const std::uint8_t> right,
                                   int disparities,
                                   Executor& executor) {
        if (left.width / 2 < kLeastLevelWidth_px) return nullptr;
        if (index == small.size()) small.emplace_back();
        SmallLevel& level = small[index];
        const ImageView<const std::uint8_t> from[] = {left, right};
        GreyImage* const to[] = {&level.left, &level.right};
        executor.parallel_for(2, [&](int side) { halve(from[side], *to[side]); });
        SemiGlobalConfig half = config;
        half.disparities = (disparities + 1) / 2;
        const LevelPrior* smaller = search_small(
            index + 1, level.left.view(), level.right.view(), half.disparities, executor);
        level.search.search(
            half, level.left.view(), level.right.view(), smaller, executor, nullptr, &level.prior);
        return &level.prior;
    }
};

SemiGlobalSearch::SemiGlobalSearch(const SemiGlobalConfig& config)
    : workspace_(std::make_unique<Workspace>()) {
    SUREFOOT_ASSERT(!config.problem());
    workspace_->config = config;
}
SemiGlobalSearch::~SemiGlobalSearch() = default;
SemiGlobalSearch::SemiGlobalSearch(SemiGlobalSearch&&) noexcept = default;
SemiGlobalSearch& SemiGlobalSearch::operator=(SemiGlobalSearch&&) noexcept = default;

void SemiGlobalSearch::search(ImageView<const std::uint8_t> left,
                              ImageView<const std::uint8_t> right,
                              Executor& executor,
                              Winners& out) {
    SUREFOOT_ASSERT(left.width == right.width && left.height == right.height && !left.empty());
    Workspace& work = *workspace_;
    const LevelPrior* smaller =
        work.search_small(0, left, right, work.config.disparities, executor);
    work.full.search(work.config, left, right, smaller, executor, &out, nullptr);
}

}  // namespace surefoot::stereo

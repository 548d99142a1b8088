// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "surefoot/stereo/clipped.hpp"
#include "surefoot/stereo/disparity_selection.hpp"
#include "surefoot/stereo/finisher.hpp"
#include "surefoot/stereo/matcher.hpp"
#include "surefoot/stereo/speckles.hpp"

namespace surefoot::stereo {
namespace {

SemiGlobalConfig search_config(const MatcherConfig& config) {
    SemiGlobalConfig search;
    search.disparities = config.disparities;
    return search;
}

class CensusMatcher final : public Matcher {
  public:
    explicit CensusMatcher(const MatcherConfig& config)
        : selection_{config.uniqueness_percent,
                     // in range: MatcherConfig::problem() keeps it in 0-16
                     static_cast<int>(std::lround(config.left_right_tolerance_px))},
          search_(search_config(config)) {}

    void match(ImageView<const std::uint8_t> left,
               ImageView<const std::uint8_t> right,
               Executor& executor,
               DepthImage& depth) override {
        depth.resize(left.width, left.height);
        search_.search(left, right, executor, winners_);
        select_disparities(selection_, winners_, executor, selected_px_);
        clipped_.remove(left, executor, selected_px_);
        speckles_.remove(executor, kSpeckleSize_px, kSpeckleRange_px, selected_px_);
        finisher_.finish(left, right, selected_px_, Filter::median, executor, depth);
    }

  private:
    SelectionConfig selection_;
    SemiGlobalSearch search_;
    Winners winners_;
    Image<float> selected_px_;
    ClippedFilter clipped_;
    SpeckleFilter speckles_;
    Finisher finisher_;
};

}  // namespace

std::unique_ptr<Matcher> make_census_matcher(const MatcherConfig& config) {
    SUREFOOT_ASSERT(!config.problem());
    return std::make_unique<CensusMatcher>(config);
}

}  // namespace surefoot::stereo

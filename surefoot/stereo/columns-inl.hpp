// SPDX-License-Identifier: Apache-2.0
// Sources that foreach_target.h includes once per instruction set include this file as well.
#if defined(SUREFOOT_STEREO_COLUMNS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef SUREFOOT_STEREO_COLUMNS_INL_HPP
#undef SUREFOOT_STEREO_COLUMNS_INL_HPP
#else
#define SUREFOOT_STEREO_COLUMNS_INL_HPP
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace surefoot::stereo::rows::HWY_NAMESPACE {
namespace {

/// Calls here(tag, u) for the columns first ... last - 1, one full register at a time. The last
/// register may repeat some columns. If there are fewer columns than lanes, calls one by one.
template <class Here>
HWY_INLINE void for_columns(int first, int last, const Here& here) {
    const hwy::HWY_NAMESPACE::ScalableTag<float> whole;
    const hwy::HWY_NAMESPACE::CappedTag<float, 1> single;
    const int lanes = static_cast<int>(hwy::HWY_NAMESPACE::Lanes(whole));
    if (last - first < lanes) {
        for (int u = first; u < last; ++u) here(single, u);
        return;
    }
    for (int u = first; u < last - lanes; u += lanes) here(whole, u);
    here(whole, last - lanes);
}

}  // namespace
}  // namespace surefoot::stereo::rows::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

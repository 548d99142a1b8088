// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/colormap.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/checked_index.hpp"

namespace surefoot::eval {
namespace {

// Published maps, kept as 17 anchors at equal distances. Between the anchors, colours are linear in
// sRGB. They differ from the full tables by at most 1 of 255 on average; colormap_test limits the
// largest difference.
// clang-format off
constexpr std::array<Rgb8, 17> kViridis = {{
    {68, 1, 84}, {72, 24, 106}, {71, 45, 123}, {66, 64, 134}, {59, 82, 139},
    {51, 99, 141}, {44, 114, 142}, {38, 130, 142}, {33, 145, 140}, {31, 159, 136},
    {39, 173, 129}, {61, 188, 116}, {92, 200, 99}, {129, 211, 77}, {170, 220, 50},
    {213, 226, 26}, {253, 231, 37}}};
constexpr std::array<Rgb8, 17> kCividis = {{
    {0, 34, 78}, {0, 46, 106}, {26, 56, 111}, {50, 67, 109}, {67, 78, 108},
    {83, 90, 109}, {97, 101, 111}, {111, 112, 115}, {125, 124, 120}, {139, 135, 120},
    {154, 147, 118}, {170, 160, 115}, {187, 173, 109}, {204, 186, 100}, {221, 200, 88},
    {239, 215, 72}, {254, 232, 56}}};
constexpr std::array<Rgb8, 17> kMagma = {{
    {0, 0, 4}, {10, 8, 34}, {29, 17, 71}, {54, 16, 107}, {81, 18, 124},
    {106, 28, 129}, {131, 38, 129}, {156, 46, 127}, {183, 55, 121}, {207, 64, 112},
    {229, 80, 100}, {244, 105, 92}, {251, 135, 97}, {254, 165, 113}, {254, 194, 135},
    {253, 224, 161}, {252, 253, 191}}};
// clang-format on
constexpr double kPaleness = 0.5;  ///< share of white in the pale map
constexpr std::array<Rgb8, 2> kGrey = {{{0, 0, 0}, {255, 255, 255}}};
// ColorMap::safety of Surefoot, around vermillion and blue of Okabe and Ito. There is a jump
// between its two halves, so no cell near the limit gets a colour that belongs to neither side.
constexpr std::array<Rgb8, 4> kUnsafeHalf = {
    {{128, 38, 0}, {200, 80, 0}, {238, 142, 60}, {253, 208, 162}}};
constexpr std::array<Rgb8, 4> kSafeHalf = {
    {{171, 214, 238}, {96, 174, 220}, {24, 120, 186}, {0, 76, 132}}};
constexpr std::array<Rgb8, 7> kBalance = {{{122, 12, 34},
                                           {200, 55, 60},
                                           {242, 160, 138},
                                           {247, 247, 247},
                                           {144, 191, 222},
                                           {46, 118, 181},
                                           {8, 54, 110}}};

/// Returns the anchors of a map. If a map has two halves, `s` chooses the half and is stretched to
/// the length of this half.
std::span<const Rgb8> anchors(ColorMap map, double& s) {
    switch (map) {
        case ColorMap::viridis:
        case ColorMap::pale: return kViridis;
        case ColorMap::cividis: return kCividis;
        case ColorMap::magma: return kMagma;
        case ColorMap::grey: return kGrey;
        case ColorMap::balance: return kBalance;
        case ColorMap::safety: {
            const bool safe = s >= 0.5;
            s = safe ? 2.0 * s - 1.0 : 2.0 * s;
            return safe ? std::span<const Rgb8>(kSafeHalf) : kUnsafeHalf;
        }
    }
    return kGrey;
}

std::uint8_t to_byte(double value) {
    return saturated_integer<std::uint8_t>(std::round(value));
}

double linear_light(std::uint8_t channel) {
    const double s = channel / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);  // IEC 61966-2-1
}

}  // namespace

Rgb8 mixed(Rgb8 a, Rgb8 b, double weight) {
    const auto mix = [weight](std::uint8_t from, std::uint8_t to) {
        return to_byte((1.0 - weight) * from + weight * to);
    };
    return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

Rgb8 color_at(ColorMap map, double s) {
    SUREFOOT_ASSERT(!std::isnan(s));
    s = std::clamp(s, 0.0, 1.0);
    const std::span<const Rgb8> colors = anchors(map, s);
    const double position = s * static_cast<double>(colors.size() - 1);
    // in range: s is clamped to [0, 1] and not NaN, as asserted
    const auto below = std::min(static_cast<std::size_t>(position), colors.size() - 2);
    const Rgb8 color =
        mixed(colors[below], colors[below + 1], position - static_cast<double>(below));
    return map == ColorMap::pale ? mixed(color, palette::kPaper, kPaleness) : color;
}

bool is_diverging(ColorMap map) noexcept {
    return map == ColorMap::safety || map == ColorMap::balance;
}

double lightness(Rgb8 color) {
    const double luminance = 0.2126 * linear_light(color.r) + 0.7152 * linear_light(color.g) +
                             0.0722 * linear_light(color.b);
    return luminance > 216.0 / 24389.0 ? 116.0 * std::cbrt(luminance) - 16.0
                                       : luminance * 24389.0 / 27.0;  // CIE 15:2004
}

Rgb8 ColorScale::operator()(double value) const {
    if (!is_diverging(map)) {
        return color_at(map, high > low ? (value - low) / (high - low) : 0.5);
    }
    if (value < centre) {
        return color_at(map, centre > low ? 0.5 * (value - low) / (centre - low) : 0.0);
    }
    return color_at(map, high > centre ? 0.5 + 0.5 * (value - centre) / (high - centre) : 1.0);
}

}  // namespace surefoot::eval

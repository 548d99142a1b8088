// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace surefoot::eval {

/// One pixel, sRGB.
struct Rgb8 {
    std::uint8_t r = 0;
    std::uint8_t g = 0;
    std::uint8_t b = 0;
    friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

/// Colour maps that stay readable with all common colour vision deficiencies. Sequential maps get
/// monotonically lighter; diverging maps are lightest in the middle. `safety` jumps from orange to
/// blue in the middle: each colour belongs to one side of the limit.
enum class ColorMap : std::uint8_t {
    viridis,  ///< sequential (Smith and van der Walt 2015)
    pale,     ///< sequential: viridis with much white, as a background for coloured lines
    cividis,  ///< sequential (Nunez, Anderton and Renslow 2018)
    magma,    ///< sequential (Smith and van der Walt 2015)
    grey,     ///< sequential, black to white
    safety,   ///< diverging: orange = unsafe, blue = safe (hues of Okabe and Ito 2008)
    balance,  ///< diverging: red = below, blue = above
};

/// Returns the colour at position s, clamped to [0, 1]. s must not be NaN.
[[nodiscard]] Rgb8 color_at(ColorMap map, double s);
[[nodiscard]] bool is_diverging(ColorMap map) noexcept;

/// Returns the CIE 1976 lightness L* of a colour, 0 (black) to 100 (white).
[[nodiscard]] double lightness(Rgb8 color);

/// Mixes two colours: (1 - weight) * a + weight * b, rounded.
[[nodiscard]] Rgb8 mixed(Rgb8 a, Rgb8 b, double weight);

/// Maps values to colours between low and high; a diverging map has its middle at `centre`.
struct ColorScale {
    ColorMap map = ColorMap::viridis;
    double low = 0.0;
    double high = 1.0;
    double centre = 0.5;  ///< used by diverging maps only
    [[nodiscard]] Rgb8 operator()(double value) const;
};

/// Fixed colours of pictures and reports. Colours with a meaning: Okabe and Ito 2008.
namespace palette {
inline constexpr Rgb8 kInk{28, 30, 34};
inline constexpr Rgb8 kSoftInk{96, 100, 108};
inline constexpr Rgb8 kPaper{255, 255, 255};
inline constexpr Rgb8 kFaint{222, 224, 228};
inline constexpr Rgb8 kBlack{0, 0, 0};
inline constexpr Rgb8 kSafe{0, 114, 178};
inline constexpr Rgb8 kUnsafe{213, 94, 0};
inline constexpr Rgb8 kGreen{0, 158, 115};
inline constexpr Rgb8 kPink{204, 121, 167};
inline constexpr Rgb8 kYellow{240, 228, 66};
inline constexpr Rgb8 kOrange{230, 159, 0};
}  // namespace palette

}  // namespace surefoot::eval

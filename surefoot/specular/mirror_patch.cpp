// SPDX-License-Identifier: Apache-2.0
#include "surefoot/specular/mirror_patch.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "surefoot/core/unknown.hpp"

namespace surefoot::specular {
namespace {

constexpr float kCut = 2.5F;  ///< limit of outliers [standard deviations]
/// Ratio of the standard deviation to the mean absolute value of a normal distribution.
constexpr float kSigmaOfMean = 1.2533F;
/// Side of a tile [cells]. A patch consists of whole tiles.
constexpr int kTile = 16;
constexpr float kLeastInTile = 24.0F;  ///< smallest number of known cells in a tile

bool is_known(float value) {
    return value == value;
}

/// Computes the Laplacian of the inner cells with four known neighbours. Other cells become
/// unknown.
void laplacian(const Image<float>& grey, Image<float>& out) {
    std::fill_n(out.row(0), grey.width(), kNanF);
    std::fill_n(out.row(grey.height() - 1), grey.width(), kNanF);
    for (int i = 1; i + 1 < grey.height(); ++i) {
        const float* before = grey.row(i - 1);
        const float* here = grey.row(i);
        const float* after = grey.row(i + 1);
        float* to = out.row(i);
        to[0] = to[grey.width() - 1] = kNanF;
        for (int c = 1; c + 1 < grey.width(); ++c)
            to[c] = 4.0F * here[c] - before[c] - after[c] - here[c - 1] - here[c + 1];
    }
}

struct Strength {
    float sum = 0.0F;  ///< sum of absolute values
    float known = 0.0F;

    /// Returns one standard deviation, or NaN if too few cells are known.
    [[nodiscard]] float sigma() const {
        return known >= kLeastInTile && sum > 0.0F ? kSigmaOfMean * sum / known : kNanF;
    }
};

/// Sums over the cells of lines, one sum per column of a tile, so that one register operation adds
/// many cells.
struct Lanes {
    std::array<float, kTile> sum{};
    std::array<float, kTile> known{};

    void add(const float* from, bool absolute) {
        for (std::size_t c = 0; c < kTile; ++c) {
            const float value = absolute ? std::abs(from[c]) : from[c];
            sum[c] += is_known(value) ? value : 0.0F;
            known[c] += is_known(value) ? 1.0F : 0.0F;
        }
    }
    [[nodiscard]] Strength total() const {
        Strength out;
        for (std::size_t c = 0; c < kTile; ++c) {
            out.sum += sum[c];
            out.known += known[c];
        }
        return out;
    }
};

constexpr int kMostTiles = MirrorPatch::kLines * MirrorPatch::kLineCells / (kTile * kTile);

/// Normalises the strength of the tiles. Weak tiles are not raised to full strength, because they
/// contain mostly noise. Limits outliers.
void level(Image<float>& detail) {
    std::array<Strength, kMostTiles> tiles;
    Strength all;
    std::size_t tile = 0;
    for (int line = 0; line < detail.height(); line += kTile) {
        for (int cell = 0; cell < detail.width(); cell += kTile) {
            Lanes lanes;
            for (int i = line; i < line + kTile; ++i) lanes.add(detail.row(i) + cell, true);
            const Strength here = lanes.total();
            all.sum += here.sum;
            all.known += here.known;
            tiles[tile++] = here;
        }
    }
    tile = 0;
    for (int line = 0; line < detail.height(); line += kTile) {
        for (int cell = 0; cell < detail.width(); cell += kTile) {
            const float scale = 2.0F / (tiles[tile++].sigma() + all.sigma());
            for (int i = line; i < line + kTile; ++i) {
                float* to = detail.row(i) + cell;
                for (int c = 0; c < kTile; ++c) {
                    const float value = to[c] * scale;
                    const float below = value > kCut ? kCut : value;
                    to[c] = below < -kCut ? -kCut : below;
                }
            }
        }
    }
}

/// Subtracts from each line its mean, then the mean of the cells with the same index in all lines.
void center(Image<float>& detail) {
    std::array<float, MirrorPatch::kLineCells> sums{};
    std::array<float, MirrorPatch::kLineCells> counts{};
    const auto width = static_cast<std::size_t>(detail.width());
    for (int i = 0; i < detail.height(); ++i) {
        float* line = detail.row(i);
        Lanes lanes;
        for (std::size_t c = 0; c < width; c += kTile) lanes.add(line + c, false);
        const Strength total = lanes.total();
        const float mean = total.known > 0.0F ? total.sum / total.known : 0.0F;
        for (std::size_t c = 0; c < width; ++c) {
            line[c] -= mean;
            sums[c] += is_known(line[c]) ? line[c] : 0.0F;
            counts[c] += is_known(line[c]) ? 1.0F : 0.0F;
        }
    }
    for (std::size_t c = 0; c < width; ++c) sums[c] = counts[c] > 0.0F ? sums[c] / counts[c] : 0.0F;
    for (int i = 0; i < detail.height(); ++i) {
        float* line = detail.row(i);
        for (std::size_t c = 0; c < width; ++c) line[c] -= sums[c];
    }
}

void write_detail(const Image<float>& detail, PatchDetail& out) {
    const int block_cells = out.line_cells / PatchDetail::kBlocks;
    std::int64_t squares = 0;
    std::int64_t cells = 0;
    for (int i = 0; i < out.lines; ++i) {
        const float* from = detail.row(i);
        std::int16_t* to = out.values.data() + static_cast<std::ptrdiff_t>(i) * out.line_cells;
        std::int16_t* known =
            out.known.data() + static_cast<std::ptrdiff_t>(i) * PatchDetail::kBlocks;
        for (int b = 0; b < PatchDetail::kBlocks; ++b) {
            int in_block = 0;
            int in_squares = 0;
            for (int c = b * block_cells; c < (b + 1) * block_cells; ++c) {
                constexpr auto kUnit = static_cast<float>(PatchDetail::kUnit);
                const float value = is_known(from[c]) ? from[c] * kUnit : 0.0F;
                // in range: at most kCut * kUnit, plus the removed means
                const int rounded = static_cast<int>(value);
                to[c] = static_cast<std::int16_t>(rounded);
                in_block += is_known(from[c]) ? 1 : 0;
                in_squares += rounded * rounded;
            }
            squares += in_squares;
            known[b] = static_cast<std::int16_t>(in_block);
            cells += in_block;
        }
    }
    out.mean_square = cells > 0 ? static_cast<double>(squares) / static_cast<double>(cells) : 0.0;
}

}  // namespace

void PatchDetail::resize(int new_lines, int new_line_cells) {
    lines = new_lines;
    line_cells = new_line_cells;
    values.resize(static_cast<std::size_t>(lines) * static_cast<std::size_t>(line_cells));
    known.resize(static_cast<std::size_t>(lines) * static_cast<std::size_t>(kBlocks));
}

void take_detail(const Image<float>& grey, Image<float>& work, PatchDetail& out) {
    out.resize(grey.height(), grey.width());
    laplacian(grey, work);
    level(work);
    center(work);
    write_detail(work, out);
}

MirrorPatch::MirrorPatch()
    : grey_(kLineCells, kLines),
      half_(kLineCells / 2, kLines / 2),
      work_(kLineCells, kLines),
      half_work_(kLineCells / 2, kLines / 2) {
    fine_.resize(kLines, kLineCells);
    coarse_.resize(kLines / 2, kLineCells / 2);
}

void MirrorPatch::sample(const grid::GridGeometry& geometry,
                         ImageView<const float> brightness,
                         const Eigen::Vector2d& middle_m,
                         double angle_rad) {
    const auto cosine = static_cast<float>(std::cos(angle_rad));
    const auto sine = static_cast<float>(std::sin(angle_rad));
    // Cell centres have integer coordinates here.
    const Eigen::Vector2f middle =
        ((middle_m - geometry.origin_m) / geometry.resolution_m).cast<float>() -
        Eigen::Vector2f::Constant(0.5F);
    const auto last_x = static_cast<float>(geometry.nx - 1);
    const auto last_y = static_cast<float>(geometry.ny - 1);
    for (int i = 0; i < kLines; ++i) {
        const float ahead = static_cast<float>(i) - 0.5F * (kLines - 1);
        float* to = grey_.row(i);
        for (int c = 0; c < kLineCells; ++c) {
            const float side = static_cast<float>(c) - 0.5F * (kLineCells - 1);
            const float x = middle.x() + ahead * cosine - side * sine;
            const float y = middle.y() + ahead * sine + side * cosine;
            to[c] = kNanF;
            if (!(x >= 0.0F && y >= 0.0F && x < last_x && y < last_y)) continue;
            const int ix = static_cast<int>(x);  // in range: inside the picture
            const int iy = static_cast<int>(y);  // in range: inside the picture
            const float a = x - static_cast<float>(ix);
            const float b = y - static_cast<float>(iy);
            const float* low = brightness.row(iy) + ix;
            const float* high = brightness.row(iy + 1) + ix;
            const float under = low[0] + a * (low[1] - low[0]);
            const float over = high[0] + a * (high[1] - high[0]);
            to[c] = under + b * (over - under);
        }
    }
    halve();
    take_detail(grey_, work_, fine_);
    take_detail(half_, half_work_, coarse_);
}

void MirrorPatch::halve() {
    for (int i = 0; i < half_.height(); ++i) {
        const float* first = grey_.row(2 * i);
        const float* second = grey_.row(2 * i + 1);
        float* to = half_.row(i);
        for (int c = 0; c < half_.width(); ++c)
            to[c] = 0.25F * (first[2 * c] + first[2 * c + 1] + second[2 * c] + second[2 * c + 1]);
    }
}

}  // namespace surefoot::specular

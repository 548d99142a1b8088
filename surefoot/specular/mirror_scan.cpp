// SPDX-License-Identifier: Apache-2.0
#include "surefoot/specular/mirror_scan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/geometry/statistics.hpp"

namespace surefoot::specular {
namespace {

constexpr int kBlocks = PatchDetail::kBlocks;
constexpr int kMostApart = 160;  ///< largest distance of mirrored lines [fine cells]
constexpr int kBorder = 24;      ///< fine lines beside the first and the last mirror line
constexpr std::size_t kCandidates = 3;
constexpr int kAround = 4;  ///< half cells around a candidate in which the best line lies
/// Smallest and largest distance [half cells] of the lines on which the noise of a line is
/// measured.
constexpr int kBesideFrom = 10;
constexpr int kBesideTo = 40;
constexpr int kBesideStep = 2;
constexpr int kLeastPairs = 2000;
/// Smallest mean number of known cells before (and behind) the observed part of a line.
constexpr int kLeastDepth = 35;
constexpr std::size_t kLeastBeside = 16;
/// Lower limit of the noise. Independent cells would have a noise of 1. Neighbouring cells are
/// correlated, so a value below the limit comes from chance.
constexpr double kLeastSpread = 1.3;
/// Ratio of the standard deviation to the mean absolute deviation of a normal distribution.
constexpr double kSigmaOfMean = 1.2533;
constexpr double kLeanStep_rad = 0.25 * std::numbers::pi / 180.0;
constexpr int kLeanSteps = 2;
constexpr int kMostShift = 3;  ///< half cells from the middle to the outermost block
constexpr double kNone = -std::numeric_limits<double>::infinity();

/// Part of a line that is tried at half the resolution: the whole line, a half or a third.
struct Part {
    int first;
    int last;
};
constexpr std::array<Part, 7> kParts = {
    {{0, 11}, {0, 5}, {3, 8}, {6, 11}, {0, 3}, {4, 7}, {8, 11}}};

struct Total {
    std::int64_t sum = 0;
    std::int64_t pairs = 0;
};

Total total(const PairSums& sums, int first, int last) {
    Total out;
    for (int b = first; b <= last; ++b) {
        out.sum += sums.sum[static_cast<std::size_t>(b)];
        out.pairs += sums.pairs[static_cast<std::size_t>(b)];
    }
    return out;
}

/// Returns the sum in standard deviations, as if all cells were independent. Returns kNone if too
/// few pairs are known.
double raw_score(const Total& total, double mean_square, int least_pairs) {
    if (total.pairs < least_pairs) return kNone;
    return static_cast<double>(total.sum) /
           (mean_square * std::sqrt(static_cast<double>(total.pairs)));
}

/// Computes the excess of each score over the mean score of the lines 3 to 10 away. Keeps the
/// larger of this excess and the present entry.
void raise_to_excess(const std::vector<double>& scores, std::vector<double>& stands_out) {
    constexpr int kFrom = 3;
    constexpr int kTo = 10;
    const int count = static_cast<int>(scores.size());
    for (int i = 0; i < count; ++i) {
        const double here = scores[static_cast<std::size_t>(i)];
        if (here == kNone) continue;
        double sum = 0.0;
        int known = 0;
        for (int away = kFrom; away <= kTo; ++away) {
            for (const int j : {i - away, i + away}) {
                if (j < 0 || j >= count || scores[static_cast<std::size_t>(j)] == kNone) continue;
                sum += scores[static_cast<std::size_t>(j)];
                ++known;
            }
        }
        if (known == 0) continue;
        double& most = stands_out[static_cast<std::size_t>(i)];
        most = std::max(most, here - sum / known);
    }
}

}  // namespace

MirrorScan::MirrorScan() {
    coarse_.resize(static_cast<std::size_t>(MirrorPatch::kLines - 2 * kBorder));
    stands_out_.resize(coarse_.size());
    scores_.resize(coarse_.size());
    candidates_.reserve(kCandidates);
    beside_.resize(static_cast<std::size_t>((kBesideTo - kBesideFrom) / kBesideStep + 1) * 2);
    noise_.reserve(beside_.size());
}

void MirrorScan::find_candidates(const PatchDetail& coarse) {
    for (std::size_t i = 0; i < coarse_.size(); ++i)
        coarse_[i] = pair_sums(coarse, kBorder + static_cast<int>(i), kMostApart / 2);
    std::fill(stands_out_.begin(), stands_out_.end(), kNone);
    for (const Part& part : kParts) {
        for (std::size_t i = 0; i < coarse_.size(); ++i)
            scores_[i] = raw_score(
                total(coarse_[i], part.first, part.last), coarse.mean_square, kLeastPairs / 4);
        raise_to_excess(scores_, stands_out_);
    }
    candidates_.clear();
    while (candidates_.size() < kCandidates) {
        const auto best = std::max_element(stands_out_.begin(), stands_out_.end());
        if (*best == kNone) return;
        const auto at = best - stands_out_.begin();
        const int line = static_cast<int>(at);  // in range: an index
        candidates_.push_back(2 * (kBorder + line) + 1);
        constexpr std::ptrdiff_t kSame = 4;
        std::fill(stands_out_.begin() + std::max(std::ptrdiff_t{0}, at - kSame),
                  stands_out_.begin() +
                      std::min(static_cast<std::ptrdiff_t>(stands_out_.size()), at + kSame + 1),
                  kNone);
    }
}

/// Computes the score of a line relative to the lines beside it, over the same blocks.
PatchLine MirrorScan::rated(PatchLine line, int first, int last, double raw) {
    noise_.clear();
    for (const PairSums& sums : beside_) {
        const double score = raw_score(total(sums, first, last), mean_square_, kLeastPairs);
        if (score != kNone) noise_.push_back(score);
    }
    if (noise_.size() < kLeastBeside) return line;
    const double highest = *std::max_element(noise_.begin(), noise_.end());
    const double median = upper_median_in_place(noise_);
    double away = 0.0;
    for (const double score : noise_) away += std::abs(score - median);
    const double spread =
        std::max(kSigmaOfMean * away / static_cast<double>(noise_.size()), kLeastSpread);
    line.score = (raw - median) / spread;
    line.unique = line.score / std::max(1.0, (highest - median) / spread);
    return line;
}

PatchLine MirrorScan::refine(const PatchDetail& fine, int twice) {
    std::size_t next = 0;
    for (int away = kBesideFrom; away <= kBesideTo; away += kBesideStep)
        for (const int line : {twice - away, twice + away})
            beside_[next++] = pair_sums(fine, line, kMostApart);
    constexpr int kReach = kAround + kMostShift;
    std::array<PairSums, 2 * kReach + 1> near{};
    for (int i = -kReach; i <= kReach; ++i)
        near[static_cast<std::size_t>(i + kReach)] = pair_sums(fine, twice + i, kMostApart);

    const int cells = fine.line_cells / kBlocks;
    PatchLine best;
    double best_raw = 0.0;
    Part best_part{0, kBlocks - 1};
    for (int lean = -kLeanSteps; lean <= kLeanSteps; ++lean) {
        for (int i = -kAround; i <= kAround; ++i) {
            PairSums leaning;
            for (int b = 0; b < kBlocks; ++b) {
                const double side = (b + 0.5) * cells - 0.5 * fine.line_cells;
                const double shift = std::clamp<double>(
                    std::round(-2.0 * side * lean * kLeanStep_rad), -kMostShift, kMostShift);
                const int whole = static_cast<int>(shift);  // in range: clamped
                const auto from = static_cast<std::size_t>(i + kReach + whole);
                const auto block = static_cast<std::size_t>(b);
                leaning.sum[block] = near[from].sum[block];
                leaning.pairs[block] = near[from].pairs[block];
            }
            for (int first = 0; first < kBlocks; ++first) {
                Total run;
                for (int last = first; last < kBlocks; ++last) {
                    run.sum += leaning.sum[static_cast<std::size_t>(last)];
                    run.pairs += leaning.pairs[static_cast<std::size_t>(last)];
                    const int depth_pairs = kLeastDepth * (last - first + 1) * cells;
                    if (run.pairs < depth_pairs) continue;
                    const double raw = raw_score(run, mean_square_, kLeastPairs);
                    if (!(raw > best_raw)) continue;
                    best_raw = raw;
                    best_part = {first, last};
                    best.correlation = static_cast<double>(run.sum) /
                                       (mean_square_ * static_cast<double>(run.pairs));
                    best.at = 0.5 * (twice + i);
                    best.lean_rad = lean * kLeanStep_rad;
                    best.pairs = static_cast<int>(run.pairs);
                }
            }
        }
    }
    best.first_cell = best_part.first * cells;
    best.last_cell = (best_part.last + 1) * cells - 1;
    return rated(best, best_part.first, best_part.last, best_raw);
}

std::optional<PatchLine> MirrorScan::find(const MirrorPatch& patch, std::optional<double> near) {
    mean_square_ = patch.fine().mean_square;
    if (!(mean_square_ > 0.0) || !(patch.coarse().mean_square > 0.0)) return std::nullopt;
    if (near) {
        candidates_.assign(1, saturated_integer<int>(std::round(2.0 * *near)));
    } else {
        find_candidates(patch.coarse());
    }
    PatchLine best;
    double next = 1.0;
    for (const int twice : candidates_) {
        const PatchLine line = refine(patch.fine(), twice);
        next = std::max(next, std::min(line.score, best.score));
        if (line.score > best.score) best = line;
    }
    if (best.pairs == 0) return std::nullopt;
    best.unique = std::min(best.unique, best.score / next);
    return best;
}

}  // namespace surefoot::specular

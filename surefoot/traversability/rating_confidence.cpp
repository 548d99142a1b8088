// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/rating_confidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::traversability {
namespace {

constexpr float kHighest = std::numeric_limits<float>::max();  ///< largest finite value
constexpr float kGateSigmas = 3.4F;  ///< same value as GateLimits::sigma_factor
constexpr float kSqrt2 = 1.41421356F;
constexpr float kRangeSigma = 0.87F;  ///< largest sigma of a range of errors [sigma of one error]
constexpr float kCertain = 6.0F;      ///< beyond so many sigmas the probability (1e-9) is ignored

/// One integer holds both sums of a run of cells: the number of known cells in the high bits, the
/// variances in the low bits, in units of (0.03 mm)^2. Differences of such sums are exact, also
/// after an overflow.
constexpr int kCountShift = 44;
constexpr double kVariancesPerM2 = 1e9;
constexpr double kLargestVariance_m2 = 0.1;  ///< 170 000 such variances fit into the low bits
constexpr std::uint64_t kVarianceMask = (std::uint64_t{1} << kCountShift) - 1;

std::uint64_t packed(float height_m, float var_m2) noexcept {
    if (!std::isfinite(height_m)) return 0;
    const double v_m2 = static_cast<double>(var_m2);
    const double used_m2 = v_m2 < kLargestVariance_m2 ? std::max(v_m2, 0.0) : kLargestVariance_m2;
    // Rounded up: below the limit, no cell gets a smaller variance than it has.
    return (std::uint64_t{1} << kCountShift) +
           // in range: used_m2 is in [0, 0.1]; NaN has become 0.1
           static_cast<std::uint64_t>(used_m2 * kVariancesPerM2) + 1;
}

float count_of(std::uint64_t sum) noexcept {
    return static_cast<float>(static_cast<std::int64_t>(sum >> kCountShift));
}
float variance_m2_of(std::uint64_t sum) noexcept {
    return static_cast<float>(static_cast<double>(static_cast<std::int64_t>(sum & kVarianceMask)) /
                              kVariancesPerM2);
}

/// Returns P(x > z) of a standard normal x for z >= 0. A z above kCertain counts as kCertain.
inline float upper_tail(float z) noexcept {
    const float x = z > kCertain ? kCertain : z;
    const float p =
        1.0F + x * (0.0498673470F +
                    x * (0.0211410061F +
                         x * (0.0032776263F +
                              x * (0.0000380036F + x * (0.0000488906F + x * 0.0000053830F)))));
    const float p2 = p * p;
    const float p4 = p2 * p2;
    const float p8 = p4 * p4;
    return 0.5F / (p8 * p8);
}

/// Returns the mean range of n standard normal numbers (Tippett 1925), taken for the next larger n
/// of his table.
float mean_range(int n) noexcept {
    struct Row {
        int n;
        float range;
    };
    constexpr std::array<Row, 8> kRows{{{5, 2.326F},
                                        {10, 3.078F},
                                        {20, 3.735F},
                                        {30, 4.086F},
                                        {60, 4.639F},
                                        {100, 5.015F},
                                        {200, 5.492F},
                                        {1000, 6.483F}}};
    for (const Row& row : kRows)
        if (n <= row.n) return row.range;
    return 8.0F;  // n = 17 000 has 7.8
}

/// Returns the mean square of the distances along x of all cells of a disc.
double moment_m2(const std::vector<int>& half_width, int cells, double resolution_m) noexcept {
    double sum = 0.0;
    for (const int h : half_width) sum += h * (h + 1.0) * (2.0 * h + 1.0) / 3.0;
    return sum / cells * resolution_m * resolution_m;
}

}  // namespace

float normal_cdf(float z) noexcept {
    const float tail = upper_tail(std::abs(z));
    return z < 0.0F ? tail : 1.0F - tail;
}

RatingConfidence::RunDisc::RunDisc(double radius_m, double resolution_m) {
    const int reach = Disc::reach_of(radius_m, resolution_m);
    half_width.reserve(2 * static_cast<std::size_t>(reach) + 1);
    for (int dy = -reach; dy <= reach; ++dy) {
        half_width.push_back(Disc::half_width_of(radius_m, resolution_m, dy));
        cells += 2 * half_width.back() + 1;
    }
}

RatingConfidence::RatingConfidence(const TraversabilityConfig& config, double resolution_m)
    : config_(config),
      surface_(config.normals.radius_m, resolution_m),
      steps_(config.step.second_radius_m, resolution_m),
      patch_(config.resolve.radius_m, resolution_m),
      inverse_moment_m2_(
          static_cast<float>(1.0 / moment_m2(surface_.half_width, surface_.cells, resolution_m))),
      error_range_(mean_range(RunDisc(config.step.first_radius_m, resolution_m).cells)) {
    SUREFOOT_ASSERT(surface_.cells > 1);
}

void RatingConfidence::compute(const Input& input, ConfidenceLayers& out) {
    nx_ = input.height_m.width;
    ny_ = input.height_m.height;
    SUREFOOT_ASSERT(input.rating.has_size(nx_, ny_));
    for (grid::Layer* layer : {&sigma_m_,
                               &slope_sigma_rad_,
                               &roughness_sigma_m_,
                               &out.confidence,
                               &out.smallest_step_m,
                               &out.not_resolvable}) {
        layer->resize(nx_, ny_);
    }
    add_up_rows(input);
    for (int iy = 0; iy < ny_; ++iy) {
        sum_disc(surface_, iy);
        find_sigmas(iy);
        sum_disc(patch_, iy);
        find_patches(input, iy, out);
    }
    find_flips(input);
    for (int iy = 0; iy < ny_; ++iy) {
        find_confidence(input.rating, iy, out.confidence.row(iy));
    }
}

void RatingConfidence::add_up_rows(const Input& input) {
    margin_ = std::max(surface_.reach(), patch_.reach()) + 1;
    const auto stride = static_cast<std::size_t>(nx_ + 2 * margin_);
    before_.resize(stride * static_cast<std::size_t>(ny_));
    for (std::vector<float>* row : {&known_, &variance_m2_})
        row->resize(static_cast<std::size_t>(nx_));
    sum_.resize(static_cast<std::size_t>(nx_));
    for (int iy = 0; iy < ny_; ++iy) {
        std::uint64_t* before = before_.data() + static_cast<std::size_t>(iy) * stride;
        const float* height_m = input.height_m.row(iy);
        const float* var_m2 = input.height_var_m2.row(iy);
        std::uint64_t sum = 0;
        std::fill_n(before, margin_, sum);
        for (int ix = 0; ix < nx_; ++ix) {
            before[margin_ + ix] = sum;
            sum += packed(height_m[ix], var_m2[ix]);
        }
        std::fill_n(before + margin_ + nx_, margin_, sum);
    }
}

void RatingConfidence::sum_disc(const RunDisc& disc, int iy) {
    const int nx = nx_;
    std::uint64_t* sum = sum_.data();
    std::fill_n(sum, nx, std::uint64_t{0});
    const auto stride = static_cast<std::ptrdiff_t>(nx_ + 2 * margin_);
    const int first = std::max(iy - disc.reach(), 0);
    const int last = std::min(iy + disc.reach(), ny_ - 1);
    for (int row = first; row <= last; ++row) {
        const int h = disc.half_width[static_cast<std::size_t>(row - iy + disc.reach())];
        const std::uint64_t* before = before_.data() + row * stride + margin_;
        const std::uint64_t* begin = before - h;
        const std::uint64_t* end = before + h + 1;
        for (int ix = 0; ix < nx; ++ix) sum[ix] += end[ix] - begin[ix];
    }
    for (int ix = 0; ix < nx; ++ix) {
        known_[static_cast<std::size_t>(ix)] = count_of(sum[ix]);
        variance_m2_[static_cast<std::size_t>(ix)] = variance_m2_of(sum[ix]);
    }
}

void RatingConfidence::find_sigmas(int iy) {
    const int nx = nx_;
    const auto independent = static_cast<float>(config_.confidence.independent_cells);
    const float per_cell = 1.0F / static_cast<float>(surface_.cells);
    const float inverse_moment_m2 = 2.0F * inverse_moment_m2_;
    const float* known = known_.data();
    const float* variance_m2 = variance_m2_.data();
    float* sigma_m = sigma_m_.row(iy);
    float* slope_sigma = slope_sigma_rad_.row(iy);
    float* roughness_sigma_m = roughness_sigma_m_.row(iy);
    for (int ix = 0; ix < nx; ++ix) {
        const float n = known[ix];
        const float v_m2 = variance_m2[ix] / n;
        const float k = n < independent ? n : independent;
        const float spare = k > 2.0F ? k - 1.0F : 1.0F;
        sigma_m[ix] = std::sqrt(v_m2);
        slope_sigma[ix] = std::sqrt(inverse_moment_m2 * v_m2 / k) / (n * per_cell);
        roughness_sigma_m[ix] = std::sqrt(v_m2 * (1.0F + 1.5F / spare));
    }
}

void RatingConfidence::find_patches(const Input& input, int iy, ConfidenceLayers& out) {
    const int nx = nx_;
    const auto independent = static_cast<float>(config_.confidence.independent_cells);
    const auto step_m = static_cast<float>(config_.resolve.step_m);
    const float* height_m = input.height_m.row(iy);
    const float* known = known_.data();
    const float* variance_m2 = variance_m2_.data();
    float* smallest_m = out.smallest_step_m.row(iy);
    float* hidden = out.not_resolvable.row(iy);
    for (int ix = 0; ix < nx; ++ix) {
        const float n = known[ix];
        const float k = n < independent ? n : independent;
        const float sigma_m = std::sqrt(variance_m2[ix] / (n * k));
        const bool unknown = !(std::abs(height_m[ix]) <= kHighest);
        const float flag = kGateSigmas * sigma_m > step_m ? 1.0F : 0.0F;
        smallest_m[ix] = unknown ? kNanF : kGateSigmas * sigma_m;
        hidden[ix] = unknown ? kNanF : flag;
    }
}

void RatingConfidence::find_flips(const Input& input) {
    flips_.resize(nx_, ny_);
    flips_.fill(0.0F);
    const auto critical_m = static_cast<float>(config_.step.critical_m);
    for (int iy = 0; iy < ny_; ++iy) {
        const float* step_m = input.step_height_m.cell(0, iy);
        const float* sigma_m = sigma_m_.row(iy);
        for (int ix = 0; ix < nx_; ++ix) {
            const float over_m = step_m[ix] - critical_m;
            // Distance of the required error from its mean [sigma].
            const float sigmas = over_m > 0.0F ? (over_m / sigma_m[ix] - error_range_) / kRangeSigma
                                               : -over_m / (kSqrt2 * sigma_m[ix]);
            // false for an unknown step
            if (sigmas < kCertain) spread_flip(normal_cdf(-sigmas), ix, iy);
        }
    }
}

void RatingConfidence::spread_flip(float probability, int ix, int iy) {
    const int first = std::max(iy - steps_.reach(), 0);
    const int last = std::min(iy + steps_.reach(), ny_ - 1);
    for (int row = first; row <= last; ++row) {
        const int h = steps_.half_width[static_cast<std::size_t>(row - iy + steps_.reach())];
        const int end = std::min(ix + h, nx_ - 1);
        float* flips = flips_.row(row);
        for (int column = std::max(ix - h, 0); column <= end; ++column) {
            flips[column] += probability;
        }
    }
}

void RatingConfidence::find_confidence(const TraversabilityLayers& rating,
                                       int iy,
                                       float* confidence) const {
    const TraversabilityConfig& c = config_;
    const double weights = c.weights.slope + c.weights.step + c.weights.roughness;
    const auto w_slope = static_cast<float>(c.weights.slope / weights);
    const auto w_step = static_cast<float>(c.weights.step / weights);
    const auto w_roughness = static_cast<float>(c.weights.roughness / weights);
    const auto per_slope = static_cast<float>(1.0 / c.slope.critical_rad);
    const auto per_step = static_cast<float>(1.0 / c.step.critical_m);
    const auto per_roughness = static_cast<float>(1.0 / c.roughness.critical_m);
    const auto threshold = static_cast<float>(c.confidence.safe_threshold);
    const bool zero_dominates = c.combine == Combine::zero_dominates;
    const float* normal_z = rating.normal_z.row(iy);
    const float* slope = rating.slope.row(iy);
    const float* step = rating.step.row(iy);
    const float* roughness = rating.roughness.row(iy);
    const float* sum = rating.traversability.row(iy);
    const float* sigma_m = sigma_m_.row(iy);
    const float* slope_rad = slope_sigma_rad_.row(iy);
    const float* roughness_m = roughness_sigma_m_.row(iy);
    const float* flips = flips_.row(iy);
    const float step_error = (error_range_ + kRangeSigma) * per_step;
    const float slope_counts = zero_dominates && w_slope > 0.0F ? 1.0F : 0.0F;
    const float roughness_counts = zero_dominates && w_roughness > 0.0F ? 1.0F : 0.0F;
    const int nx = nx_;
    for (int ix = 0; ix < nx; ++ix) {
        const float slope_sigma = slope_rad[ix] * normal_z[ix] * normal_z[ix] * per_slope;
        const float roughness_sigma = roughness_m[ix] * per_roughness;
        const float step_sigma = (1.0F - step[ix]) * step_error * sigma_m[ix];
        const float sigma =
            w_slope * slope_sigma + w_step * step_sigma + w_roughness * roughness_sigma;
        const float mean = w_slope * slope[ix] + w_step * step[ix] + w_roughness * roughness[ix];
        const float margin = mean - threshold;
        const float zeros = slope_counts * upper_tail(slope[ix] / slope_sigma) +
                            roughness_counts * upper_tail(roughness[ix] / roughness_sigma);
        const float wrong =
            upper_tail(std::abs(margin) / sigma) + flips[ix] + (margin < 0.0F ? 0.0F : zeros);
        const float rest = 1.0F - wrong;
        const float right = rest > 0.0F ? rest : 0.0F;
        // The zero comes from the rule alone: another layer is unknown, or the sum is safe without
        // the rule.
        const float half = rest < 0.5F ? right : 0.5F;
        const float by_zero = margin < 0.0F ? right : half;
        const float known = sum[ix] > 0.0F ? right : by_zero;
        confidence[ix] = sum[ix] >= 0.0F ? known : kNanF;
    }
}

}  // namespace surefoot::traversability

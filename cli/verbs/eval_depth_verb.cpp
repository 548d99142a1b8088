// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <limits>
#include <optional>

#include "cli/json/eval_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "surefoot/eval/depth/depth_errors.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/images/pfm.hpp"

namespace surefoot::app {
namespace {

struct EvalDepthOptions {
    CommonOptions common;
    std::string estimate;
    std::string truth;
    /// Value that means 1 px of disparity in the truth image; 0 = by the file type.
    double scale = 0.0;
    std::string mask;   ///< mask image: pixels above 200 are compared; empty = all pixels
    std::string sigma;  ///< PFM of the standard deviation of the estimate [px]; empty = none
};

/// Code that means 1 px of disparity, if --scale is not given. The unit of 16-bit images is 1/256
/// px, as in KITTI; the unit of 8-bit images is 1 px.
constexpr double kScale16 = 256.0;
constexpr double kScale8 = 1.0;
/// Smallest mask value of a pixel that is compared. Masks of Middlebury contain 255 = visible in
/// both cameras, 128 = occluded in one camera, 0 = no ground truth. Other masks contain only 0 and
/// 255.
constexpr int kLeastMask = 201;

/// Converts an image of codes to disparities [px]. Code 0 means "no ground truth", as in KITTI.
template <typename Code>
Image<float> disparity_of(const Image<Code>& codes, double scale) {
    Image<float> disparity_px(codes.width(), codes.height());
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const auto code = codes.data()[i];
        disparity_px.data()[i] = code == 0 ? std::numeric_limits<float>::quiet_NaN()
                                           : static_cast<float>(static_cast<double>(code) / scale);
    }
    return disparity_px;
}

/// Ground-truth disparity, and the divisor by which its codes were divided.
struct Truth {
    Image<float> disparity_px;
    double scale = 1.0;
};

Result<Truth> read_truth(const std::string& path, double scale) {
    if (io::extension_of(path) == ".pfm") {
        auto truth_px = io::read_pfm(path);
        if (!truth_px) return truth_px.error();
        if (scale <= 0.0) return Truth{std::move(truth_px).value(), 1.0};
        for (std::size_t i = 0; i < truth_px->size(); ++i)
            truth_px->data()[i] =
                static_cast<float>(static_cast<double>(truth_px->data()[i]) / scale);
        return Truth{std::move(truth_px).value(), scale};
    }
    const auto bytes = io::read_file(path, io::limits::kImageBytes);
    if (!bytes) return bytes.error();
    const auto header = io::check_image(*bytes, path);
    if (!header) return header.error();
    if (header->bits == 16) {
        const auto codes = io::parse_depth_codes(*bytes, path);
        if (!codes) return codes.error();
        const double used = scale > 0.0 ? scale : kScale16;
        return Truth{disparity_of(*codes, used), used};
    }
    const auto codes = io::parse_grey_image(*bytes, path);
    if (!codes) return codes.error();
    const double used = scale > 0.0 ? scale : kScale8;
    return Truth{disparity_of(*codes, used), used};
}

Result<GreyImage> read_mask(const std::string& path) {
    if (path.empty()) return GreyImage{};
    auto mask = io::read_grey_image(path);
    if (!mask) return mask;
    for (std::size_t i = 0; i < mask->size(); ++i)
        mask->data()[i] = mask->data()[i] >= kLeastMask ? 255 : 0;
    return mask;
}

void print_errors(const eval::DepthErrors& errors) {
    fmt::print(
        "{} pixels have a true disparity; {:.2f} % of these pixels have an estimate\nerrors with "
        "gaps filled: {:.2f} % over 0.5 px, {:.2f} % over 1 px, {:.2f} % over 2 px\nerrors of the "
        "estimates only: {:.2f} % over 0.5 px, {:.2f} % over 1 px, {:.2f} % over 2 px; median "
        "{:.3f} px\n",
        errors.counted,
        errors.density_percent,
        errors.bad.over_0_5_percent,
        errors.bad.over_1_percent,
        errors.bad.over_2_percent,
        errors.known_bad.over_0_5_percent,
        errors.known_bad.over_1_percent,
        errors.known_bad.over_2_percent,
        errors.known.median_abs);
    if (errors.coverage.count == 0) return;
    fmt::print(
        "errors within 1 sigma: {:.1f} %, within 2 sigma: {:.1f} %, within 3 sigma: {:.1f} %; "
        "sparsification {:.3f} (0 = sigma sorts the errors perfectly, 1 = a sort by sigma is no "
        "better than chance)\n",
        100.0 * errors.coverage.within_1_sigma,
        100.0 * errors.coverage.within_2_sigma,
        100.0 * errors.coverage.within_3_sigma,
        errors.sparsification.auc);
}

/// Returns the --scale with which truth and estimate would agree, if they differ by a usual factor.
std::optional<double> suspected_scale(const eval::DepthErrors& errors, double used) {
    const auto factor = eval::suspected_factor(errors.truth_over_estimate);
    return factor ? std::optional<double>(used * *factor) : std::nullopt;
}

/// Warns that the scale of the truth is probably wrong. The scale stays unchanged, because only the
/// user can know the correct scale.
void warn_of_scale(const EvalDepthOptions& options,
                   const Truth& truth,
                   double ratio,
                   double scale) {
    log_warning(
        fmt::format("{}: after division by {:g}, its disparities are {:.3g} times the disparities "
                    "of {} (median). If the file stores {:g} times the disparity, the figures of "
                    "this call are wrong: run again with --scale {:g}",
                    options.truth,
                    truth.scale,
                    ratio,
                    options.estimate,
                    scale,
                    scale));
}

/// `surefoot eval depth`: compares a disparity image with the truth.
int eval_depth(const EvalDepthOptions& options) {
    const auto estimate_px = io::read_pfm(options.estimate);
    if (!estimate_px) return report(estimate_px.error());
    const auto truth = read_truth(options.truth, options.scale);
    if (!truth) return report(truth.error());
    const auto mask = read_mask(options.mask);
    if (!mask) return report(mask.error());
    const auto sigma_px = options.sigma.empty() ? Image<float>{} : io::read_pfm(options.sigma);
    if (!sigma_px) return report(sigma_px.error());
    const auto errors = eval::depth_errors(
        {estimate_px->view(), truth->disparity_px.view(), mask->view(), sigma_px->view()});
    if (!errors) return report(errors.error());
    if (errors->counted == 0) {
        return report(input_error(
            fmt::format("{}: no pixel has a true disparity{}; check the file of the true disparity",
                        options.truth,
                        options.mask.empty() ? "" : " inside the mask (--mask)")));
    }
    const auto suspected = suspected_scale(*errors, truth->scale);
    if (suspected) warn_of_scale(options, *truth, errors->truth_over_estimate, *suspected);
    if (options.common.json) {
        print_answer(depth_json(*errors, {truth->scale, suspected}));
    } else {
        print_errors(*errors);
    }
    return kExitOk;
}

}  // namespace

void add_eval_depth(VerbGroup verbs) {
    auto [verb, o] =
        verbs.add<EvalDepthOptions>("depth",
                                    "compare a disparity image with the true disparity",
                                    "surefoot eval depth tests/conformance/depth/disparity.pfm "
                                    "tests/conformance/depth/truth.pfm --sigma "
                                    "tests/conformance/depth/sigma.pfm --json",
                                    eval_depth,
                                    Reads::no_settings);
    verb.option(
            "estimate", o.estimate, "file of the estimated disparity, in px; +inf means unknown")
        .required()
        .value("EST.pfm");
    verb.option("truth",
                o.truth,
                "file of the true disparity: a PFM, or a grey PNG in which 0 means unknown")
        .required()
        .value("TRUTH");
    verb.option("--scale",
                o.scale,
                "value that a disparity of 1 px has in the file of the true disparity (default: "
                "256 for 16-bit images, as in KITTI; 1 for other files)")
        .value("S")
        .positive();
    verb.option("--mask",
                o.mask,
                "mask image: the verb compares only pixels with a mask value above 200. In masks "
                "of Middlebury these pixels are visible in both cameras")
        .value("M");
    verb.option("--sigma",
                o.sigma,
                "file with the standard deviation of the estimated disparity, in px")
        .value("SIGMA.pfm");
}

}  // namespace surefoot::app

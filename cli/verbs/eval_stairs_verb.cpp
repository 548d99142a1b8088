// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "studies/runs/stairs_json.hpp"
#include "surefoot/eval/stairs/feature_errors.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {
namespace {

struct EvalStairsOptions {
    CommonOptions common;
    std::string found;  ///< path of stairs.json, or of the folder that contains it
    std::string truth;
    eval::FeatureMatch match;
};

/// Reads terrain features from a stairs.json. `path` is the file or the folder that contains it.
Result<ListedFeatures> read_features(const std::string& path) {
    const std::string inside = path + "/stairs.json";
    const std::string& file = io::is_file(inside) ? inside : path;
    const auto text = io::read_file(file);
    if (!text) return text.error();
    return parse_stairs(*text, file);
}

std::string in_mm(const eval::MatchErrors& figures) {
    if (figures.count == 0) return "-";
    return fmt::format("{:+.1f} / {:.1f} / {:.1f} ({})",
                       1e3 * figures.mean_m,
                       1e3 * figures.std_m,
                       1e3 * figures.max_abs_m,
                       figures.count);
}

void print_kind(const char* name, const eval::KindErrors& kind, const char* height) {
    fmt::print(
        "{:8} {:3} of {:3} found, {:3} without a true partner; error of the position in walking "
        "direction {}, error of the {} {}\n",
        name,
        kind.matched,
        kind.truth,
        kind.extra.size(),
        in_mm(kind.across),
        height,
        in_mm(kind.height));
}

void print_errors(const eval::FeatureErrors& errors, const std::set<std::string>& lists) {
    fmt::print(
        "errors (found minus true) in mm: mean / standard deviation / largest magnitude (number of "
        "pairs)\n");
    if (lists.contains("flights")) {
        print_kind("flights", errors.flights, "riser");
        fmt::print(
            "         number of steps correct in {} of {} found flights; error of the going {}, "
            "error of the width {}\n",
            errors.flights.steps_right,
            errors.flights.matched,
            in_mm(errors.flights.going),
            in_mm(errors.flights.width));
    }
    if (lists.contains("drops")) print_kind("drops", errors.drops, "height");
    if (lists.contains("kerbs")) print_kind("kerbs", errors.kerbs, "height");
    if (lists.contains("sills")) print_kind("sills", errors.sills, "height");
    if (lists.contains("doors")) {
        print_kind("doors", errors.doors, "sill");
        fmt::print("         error of the width {}\n", in_mm(errors.doors.width));
    }
    if (lists.contains("edges")) print_kind("edges", errors.edges, "height");
}

/// `surefoot eval stairs`: compares detected terrain features with the true ones.
int eval_stairs(const EvalStairsOptions& options) {
    const auto found = read_features(options.found);
    if (!found) return report(found.error());
    const auto truth = read_features(options.truth);
    if (!truth) return report(truth.error());
    std::set<std::string> lists;
    for (const std::string& list : truth->lists) {
        if (found->lists.contains(list)) {
            lists.insert(list);
        } else {
            log_warning(
                fmt::format("{}: the list '{}' is missing, so this kind of feature is not compared "
                            "with the truth",
                            options.found,
                            list));
        }
    }
    const eval::FeatureErrors errors =
        eval::feature_errors(found->features, truth->features, options.match);
    if (options.common.json) {
        print_answer(feature_errors_json(errors, lists));
    } else {
        print_errors(errors, lists);
    }
    return kExitOk;
}

}  // namespace

void add_eval_stairs(VerbGroup verbs) {
    auto [verb, o] = verbs.add<EvalStairsOptions>(
        "stairs",
        "compare found flights, drops, kerbs, sills, doors and edges with the true features",
        "surefoot stairs out/floor_recording/elevation.asc --out out/floor_truth\n"
        "  surefoot eval stairs out/floor out/floor_truth --json",
        eval_stairs,
        Reads::no_settings);
    verb.option("found",
                o.found,
                "found features: a file stairs.json, or the folder that contains it, for example "
                "the output folder of 'surefoot run'")
        .required()
        .value("FOUND");
    verb.option("truth",
                o.truth,
                "true features, in the same frame: a file stairs.json that 'surefoot stairs' made "
                "from true heights, or a file that you write by hand. A list that the file lacks "
                "is not compared")
        .required()
        .value("TRUTH");
    verb.option("--across",
                o.match.across_m,
                "largest distance between a found feature and its true partner in the walking "
                "direction, in m")
        .value("M")
        .positive()
        .show_default();
    verb.option("--along",
                o.match.along_m,
                "largest distance between a found feature and its true partner across the walking "
                "direction, in m")
        .value("M")
        .positive()
        .show_default();
    verb.option("--turn",
                o.match.turn_deg,
                "largest angle between the walking directions of a found feature and its true "
                "partner, in deg")
        .value("DEG")
        .positive()
        .show_default();
}

}  // namespace surefoot::app

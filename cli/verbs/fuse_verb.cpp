// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "cli/json/map_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "surefoot/elevation/fusion/reference_update.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/io/raw_floats.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::app {
namespace {

struct FuseOptions {
    CommonOptions common;
    std::string steps;
    std::string out_dir;
};

/// Settings of this verb. The group "reference" configures the map update of the reference
/// implementation (ETH elevation_mapping).
struct FuseSettings {
    elevation::ReferenceConfig reference;
    void describe(ConfigVisitor& visitor) { visitor.group("reference", reference); }
};

Result<elevation::ReferenceConfig> load(const CommonOptions& options) {
    FuseSettings settings;
    if (options.preset != "ethz") {
        return usage_error(
            fmt::format("fuse --preset '{}': this verb runs only the map update of the reference "
                        "implementation; give --preset ethz",
                        options.preset));
    }
    if (auto status = apply_overrides(options, io::describe_config(settings)); !status)
        return status.error();
    return settings.reference;
}

Result<std::vector<elevation::ReferencePoint>> read_points(const std::string& path) {
    const auto values = io::read_floats(path);
    if (!values) return values.error();
    if (values->size() % 4 != 0) {
        return input_error(
            fmt::format("{}: the file has {} values; the number must be a multiple of 4, because "
                        "each point has x, y, z and variance",
                        path,
                        values->size()));
    }
    std::vector<elevation::ReferencePoint> points(values->size() / 4);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const float* v = values->data() + 4 * i;
        points[i] = {v[0], v[1], v[2], v[3]};
        const bool is_measurement =
            std::all_of(v, v + 4, [](float value) { return std::isfinite(value); }) && v[3] >= 0.0F;
        if (!is_measurement) {
            return input_error(
                fmt::format("{}: point {} (counted from 0) is ({}, {}, {}) with variance {}; give "
                            "finite numbers and a variance of at least 0",
                            path,
                            i,
                            v[0],
                            v[1],
                            v[2],
                            v[3]));
        }
    }
    return points;
}

/// Parses the line of a step, "K time T move_to X Y ...". The points of step K are in the file
/// cloudK.f32 of `folder`.
Result<elevation::FuseStep> parse_step(std::string_view line,
                                       const std::string& where,
                                       const std::string& folder) {
    std::vector<std::string_view> words;
    for (const std::string_view word : io::split(line, " \t")) {
        if (!word.empty()) words.push_back(word);
    }
    if (words.size() < 6 || words[1] != "time" || words[3] != "move_to") {
        return input_error(fmt::format(
            "{}: the line must be 'K time T move_to X Y', but it is '{}'", where, line));
    }
    const auto index = io::parse_int64(words[0]);
    const auto time_s = io::parse_double(words[2]);
    const auto x_m = io::parse_double(words[4]);
    const auto y_m = io::parse_double(words[5]);
    const auto is_number = [](const std::optional<double>& value) {
        return value && std::isfinite(*value);
    };
    if (!index || !is_number(time_s) || !is_number(x_m) || !is_number(y_m)) {
        return input_error(
            fmt::format("{}: one of the values K = '{}', T = '{}', X = '{}', Y = '{}' is not a "
                        "finite number; correct this value",
                        where,
                        words[0],
                        words[2],
                        words[4],
                        words[5]));
    }
    auto cloud = read_points(fmt::format("{}/cloud{}.f32", folder, *index));
    if (!cloud) return cloud.error();
    return elevation::FuseStep{*time_s, *x_m, *y_m, std::move(cloud).value()};
}

Result<std::vector<elevation::FuseStep>> read_steps(const std::string& path) {
    const auto text = io::read_file(path);
    if (!text) return text.error();
    std::vector<elevation::FuseStep> steps;
    int line_number = 0;
    for (const std::string_view line : io::split(*text, "\n")) {
        ++line_number;
        if (line.empty() || line.front() == ' ' || line.front() == '#') continue;
        auto step = parse_step(line, fmt::format("{}:{}", path, line_number), io::folder_of(path));
        if (!step) return step.error();
        steps.push_back(std::move(step).value());
    }
    if (steps.empty())
        return input_error(fmt::format(
            "{}: the file contains no step; add a line 'K time T move_to X Y' for each step",
            path));
    return steps;
}

/// `surefoot fuse`: runs only the elevation map update of the reference implementation, on given
/// clouds.
int fuse(const FuseOptions& options) {
    const auto config = load(options.common);
    if (!config) return report(config.error());
    const auto steps = read_steps(options.steps);
    if (!steps) return report(steps.error());
    if (auto status = io::make_folder(options.out_dir); !status) return report(status.error());
    const auto results = elevation::run_fuse_steps(*config, *steps);
    for (std::size_t k = 0; k < results.size(); ++k) {
        const auto& result = results[k];
        const std::pair<const char*, const grid::Layer*> layers[] = {
            {"elevation", &result.elevation_m},
            {"variance", &result.variance_m2},
            {"time", &result.time_s}};
        for (const auto& [name, layer] : layers) {
            const std::string file = fmt::format("{}/step{}_{}.asc", options.out_dir, k, name);
            if (auto status = io::write_esri_grid(file, result.geometry, *layer); !status)
                return report(status.error());
        }
    }
    if (options.common.json) {
        print_answer(fuse_json(results.size(), options.out_dir));
    } else {
        fmt::print("{} steps fused; the layers of each step are in {}/\n",
                   results.size(),
                   options.out_dir);
    }
    return kExitOk;
}

}  // namespace

void add_fuse(VerbGroup verbs) {
    auto [verb, o] = verbs.add<FuseOptions>(
        "fuse",
        "run only the elevation map update of the reference implementation (ETH "
        "elevation_mapping), on given point clouds",
        "surefoot fuse tests/conformance/elevation/steps.txt --preset ethz --out out/fused",
        fuse,
        Reads::own_settings);
    verb.option("steps",
                o.steps,
                "file of steps, one line 'K time T move_to X Y' for each step (T in s, X and Y in "
                "m). The points of step K are in the file cloudK.f32 in the same folder")
        .required()
        .value("STEPS.txt");
    verb.option(
            "--out", o.out_dir, "folder for the layers elevation, variance and time of each step")
        .required()
        .value("DIR");
}

}  // namespace surefoot::app

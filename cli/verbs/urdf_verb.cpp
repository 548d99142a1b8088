// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/json/program_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/live/find_model.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/settings/urdf_file.hpp"

namespace surefoot::app {
namespace {

struct UrdfOptions {
    CommonOptions common;
    std::string model;
    std::string out_file;  ///< empty = stdout
};

/// `surefoot urdf`: converts a model file to URDF.
int urdf(const UrdfOptions& options) {
    const auto model = find_model(options.model);
    if (!model) return report(model.error());
    const std::string text = io::urdf_text(*model);
    if (!options.out_file.empty()) {
        if (auto written = io::write_file(options.out_file, text); !written)
            return report(written.error());
    }
    if (options.common.json)
        print_answer(urdf_json(*model, options.out_file));
    else if (options.out_file.empty())
        fmt::print("{}", text);
    else
        fmt::print("written: {}\n", options.out_file);
    return kExitOk;
}

}  // namespace

void add_urdf(VerbGroup verbs) {
    auto [verb, o] = verbs.add<UrdfOptions>("urdf",
                                            "write the model of a machine as a URDF file",
                                            "surefoot urdf rex --out out/rex.urdf",
                                            urdf,
                                            Reads::no_settings);
    verb.option("model",
                o.model,
                "model to write: a model file (docs/reference/model_file.md), or the name of a "
                "built-in model, for example rex")
        .required()
        .value("FILE|NAME");
    verb.option("--out", o.out_file, "file for the URDF (default: print the URDF on stdout)")
        .value("FILE");
}

}  // namespace surefoot::app

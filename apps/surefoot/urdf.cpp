// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/surefoot/find_model.hpp"
#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/verbs.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/settings/urdf_file.hpp"

namespace surefoot::app {

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

}  // namespace surefoot::app

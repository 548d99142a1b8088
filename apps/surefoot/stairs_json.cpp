// SPDX-License-Identifier: Apache-2.0
#include "apps/surefoot/stairs_json.hpp"

#include <nlohmann/json.hpp>

#include "server/page/feature_lists.hpp"

namespace surefoot::app {
namespace {

using wire::Json;

Json classes_json(const stairs::GroundClasses& classes, double resolution_m) {
    const auto counts = stairs::count_classes(classes);
    Json json = Json::object();
    for (std::size_t i = 0; i < counts.size(); ++i)
        json[stairs::kGroundClassNames[i]] = {{"cells", counts[i]},
                                              {"area_m2", counts[i] * resolution_m * resolution_m}};
    return json;
}

}  // namespace

std::string stairs_json(const stairs::TerrainFeatures& features,
                        const stairs::GroundClasses& classes,
                        double resolution_m,
                        const std::vector<std::string>& assumed) {
    Json json = page::feature_lists(features);  // pages have them by the same names
    json["classes"] = classes_json(classes, resolution_m);
    json["assumed"] = assumed;
    return json.dump(2);
}

}  // namespace surefoot::app

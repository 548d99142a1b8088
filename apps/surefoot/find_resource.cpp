// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/surefoot/resources.hpp"

namespace surefoot::app {

Result<std::string> find_resource(std::string_view folder, std::string_view name) {
    const std::string wanted = fmt::format("{}/{}.yaml", folder, name);
    std::string known;
    for (const Resource& resource : resources()) {
        if (resource.name == wanted) return std::string(resource.text);
        if (resource.name.starts_with(fmt::format("{}/", folder))) {
            const auto stem =
                resource.name.substr(folder.size() + 1, resource.name.size() - folder.size() - 6);
            known += fmt::format("{}{}", known.empty() ? "" : ", ", stem);
        }
    }
    return usage_error(fmt::format("there is no '{}' among the {}: {}", name, folder, known));
}

}  // namespace surefoot::app

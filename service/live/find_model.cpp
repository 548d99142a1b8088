// SPDX-License-Identifier: Apache-2.0
#include "service/live/find_model.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

namespace surefoot::app {
namespace {

Result<io::MachineModel> parse_built_in(std::string_view name) {
    const auto text = machines::find_resource(model_resources(), "models", name);
    if (!text) return text.error();
    return io::parse_model(*text, fmt::format("model {}", name));
}

}  // namespace

Result<io::MachineModel> find_model(const std::string& path_or_name) {
    return std::filesystem::exists(path_or_name) ? io::read_model(path_or_name)
                                                 : parse_built_in(path_or_name);
}

std::optional<io::MachineModel> built_in_model(std::string_view name) {
    auto model = parse_built_in(name);
    if (!model) return std::nullopt;
    return std::move(model).value();
}

}  // namespace surefoot::app

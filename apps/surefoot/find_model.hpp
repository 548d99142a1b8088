// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/io/settings/model_file.hpp"
#include "surefoot/machines/built_in_machines.hpp"

namespace surefoot::app {

/// The files of models/. The gate process, which shows nothing, has none of them.
[[nodiscard]] const std::vector<machines::Resource>& model_resources();

/// A model of a machine by path or by built-in name; whatever is wrong with it is a usage error.
[[nodiscard]] Result<io::MachineModel> find_model(const std::string& path_or_name);
/// The built-in model of this name, where there is one.
[[nodiscard]] std::optional<io::MachineModel> built_in_model(std::string_view name);

}  // namespace surefoot::app

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

/// The files of models/, compiled into this program. surefoot-gate does not contain them, because
/// it draws no pictures.
[[nodiscard]] const std::vector<machines::Resource>& model_resources();

/// Loads the model of a machine by path or by built-in name. Every failure is a usage error.
[[nodiscard]] Result<io::MachineModel> find_model(const std::string& path_or_name);
/// The built-in model of this name; nullopt if there is none.
[[nodiscard]] std::optional<io::MachineModel> built_in_model(std::string_view name);

}  // namespace surefoot::app

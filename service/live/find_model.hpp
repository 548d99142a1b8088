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

/// Returns the files of models/, which this program contains. surefoot-gate does not contain these
/// files, because it draws no pictures.
[[nodiscard]] const std::vector<machines::Resource>& model_resources();

/// Loads the model of a machine by path or by built-in name. Every failure is a usage error.
[[nodiscard]] Result<io::MachineModel> find_model(const std::string& path_or_name);
/// Returns the built-in model of this name; nullopt if no such model exists.
[[nodiscard]] std::optional<io::MachineModel> built_in_model(std::string_view name);

}  // namespace surefoot::app

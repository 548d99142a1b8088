// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/io/settings/machine_file.hpp"

namespace surefoot::machines {

/// A file of the repository that is embedded in the program.
struct Resource {
    std::string_view name;  ///< for example "machines/rex.yaml"
    std::string_view text;
};
/// Returns all files of machines/.
[[nodiscard]] const std::vector<Resource>& built_in_machines();

/// Returns the text of `folder/name.yaml` in `resources`. An unknown name is a usage error that
/// lists the known names.
[[nodiscard]] Result<std::string> find_resource(const std::vector<Resource>& resources,
                                                std::string_view folder,
                                                std::string_view name);

/// Reads a machine file by path or built-in name. Every problem of the file is a usage error. Runs
/// the gate's self-test (gate::Canaries), so that all programs refuse the same machines. Takes
/// about 10 ms.
[[nodiscard]] Result<io::MachineFile> load_machine(const std::string& path_or_name);

}  // namespace surefoot::machines

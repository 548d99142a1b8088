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
    std::string_view name;  ///< "machines/rex.yaml"
    std::string_view text;
};
/// The files of machines/.
[[nodiscard]] const std::vector<Resource>& built_in_machines();

/// Text of `folder/name.yaml` among `resources`. An unknown name is a usage error that lists the
/// known names.
[[nodiscard]] Result<std::string> find_resource(const std::vector<Resource>& resources,
                                                std::string_view folder,
                                                std::string_view name);

/// A machine file by path or by built-in name. Every problem of the file is a usage error. Reading
/// includes the gate's self-test (gate::Canaries), so that every program refuses the same machines.
/// Takes about 10 ms.
[[nodiscard]] Result<io::MachineFile> load_machine(const std::string& path_or_name);

}  // namespace surefoot::machines
